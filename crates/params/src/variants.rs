//! [`variants!`](crate::variants): an enum whose variants are names, or have a number.

/// Declares an enum of alternatives: names, and variants with a number.
///
/// In files and other languages a variant with a number is a map with one entry. The name alone
/// chooses a variant without one, and a number alone the only variant that has one.
///
/// ```
/// use incise_params::{Parameter, Range, Value};
///
/// incise_params::variants! {
///     /// Stiffness of a spring.
///     #[derive(Debug, Clone, Copy, PartialEq)]
///     pub enum Stiffness = Self::Pbd(1.0);
///     names {
///         /// No spring.
///         Off = "off";
///     }
///     values {
///         /// Stiffness of position based dynamics.
///         Pbd(f32) = "stiffness", range: Range::FRACTION;
///         /// Inverse stiffness.
///         Compliance(f32) = "compliance", range: Range::NOT_NEGATIVE, unit: "m/N";
///     }
/// }
///
/// let mut spring = Stiffness::initial();
/// spring.set_part("compliance", &Value::Number(1e-4))?;
/// assert_eq!(spring, Stiffness::Compliance(1e-4));
/// spring.set_value(&Value::from("off"))?;
/// assert_eq!(spring.name(), "off");
/// # Ok::<(), incise_params::ParamError>(())
/// ```
#[macro_export]
macro_rules! variants {
    (
        $(#[$meta:meta])*
        $vis:vis enum $name:ident = $initial:expr;
        names {$(
            $(#[doc = $unit_doc:literal])+
            $unit:ident = $unit_text:literal;
        )*}
        values {$(
            $(#[doc = $doc:literal])+
            $variant:ident($type:ty) = $text:literal
            $(, range: $range:expr)? $(, unit: $measure:literal)?;
        )+}
    ) => {
        $(#[$meta])*
        $vis enum $name {
            $(
                $(#[doc = $unit_doc])+
                $unit,
            )*
            $(
                $(#[doc = $doc])+
                $(#[doc = concat!("\n\nUnit: ", $measure, ".")])?
                $variant($type),
            )+
        }

        impl $name {
            /// The alternatives, in the order of the variants.
            pub const VARIANTS: &'static [$crate::Field] = &[
                $(
                    $crate::Field::new(
                        $unit_text,
                        concat!($($unit_doc, "\n",)+),
                        $crate::Kind::Unit,
                        $crate::Range::FINITE,
                        "",
                        || $crate::Value::None,
                    ),
                )*
                $(
                    $crate::Field::new(
                        $text,
                        concat!($($doc, "\n",)+),
                        <$type as $crate::Parameter>::KIND,
                        $crate::__range!($($range)?),
                        concat!($($measure)?),
                        || $crate::Value::None,
                    ),
                )+
            ];

            /// Returns the name in files and other languages.
            #[must_use]
            pub const fn name(&self) -> &'static str {
                match self {
                    $(Self::$unit => $unit_text,)*
                    $(Self::$variant(_) => $text,)+
                }
            }
        }

        impl ::core::default::Default for $name {
            fn default() -> Self {
                $initial
            }
        }

        impl $crate::Parameter for $name {
            const KIND: $crate::Kind = $crate::Kind::Variants(Self::VARIANTS);

            fn initial() -> Self {
                <Self as ::core::default::Default>::default()
            }

            fn value(&self) -> $crate::Value {
                match self {
                    $(Self::$unit => $crate::Value::Text($unit_text.to_owned()),)*
                    $(Self::$variant(value) => $crate::Value::Map(vec![(
                        $text.to_owned(),
                        $crate::Parameter::value(value),
                    )]),)+
                }
            }

            fn set_value(
                &mut self,
                value: &$crate::Value,
            ) -> ::core::result::Result<(), $crate::ParamError> {
                let (name, value) = $crate::macros::alternative(value, Self::VARIANTS)?;
                self.set_part(name, value)
            }

            fn set_part(
                &mut self,
                path: &str,
                value: &$crate::Value,
            ) -> ::core::result::Result<(), $crate::ParamError> {
                let (head, rest) = $crate::macros::split_alternative(path, Self::VARIANTS);
                match head {
                    $($unit_text => {
                        *self = Self::$unit;
                        Ok(())
                    })*
                    $($text => {
                        let mut own = match *self {
                            Self::$variant(own) => own,
                            _ => $crate::Parameter::initial(),
                        };
                        $crate::macros::set_variant(&mut own, rest, value)
                            .map_err(|error| error.within(&$text))?;
                        *self = Self::$variant(own);
                        Ok(())
                    })+
                    _ => Err($crate::ParamError::wrong_type(
                        &$crate::Value::from(head),
                        <Self as $crate::Parameter>::KIND,
                    )),
                }
            }

            fn check_range(
                &self,
                _: &'static $crate::Range,
            ) -> ::core::result::Result<(), $crate::OutOfRange> {
                match self {
                    $(Self::$unit => Ok(()),)*
                    $(Self::$variant(own) => {
                        let range = const { &$crate::__range!($($range)?) };
                        $crate::Parameter::check_range(own, range)
                            .map_err(|error| error.within(&$text))
                    })+
                }
            }
        }

        $crate::__serde_variants!(
            $name { $($unit = $unit_text,)* } { $($variant: $type = $text),+ }
        );
    };
}

use crate::{Field, Kind, ParamError, Parameter, Value};

/// Returns the name of the alternative that a value chooses, and the value within it.
///
/// # Errors
/// [`ParamError::WrongType`].
pub fn alternative<'a>(
    value: &'a Value,
    variants: &'static [Field],
) -> Result<(&'static str, &'a Value), ParamError> {
    let wrong = || match value {
        Value::Map(_) | Value::Text(_) => ParamError::wrong_value(value, Kind::Variants(variants)),
        _ => ParamError::wrong_type(value, Kind::Variants(variants)),
    };
    let find = |name: &str| {
        let found = variants.iter().find(|variant| variant.name == name);
        found.ok_or_else(wrong)
    };
    match value {
        Value::Map(entries) => match entries.as_slice() {
            [(name, value)] => Ok((find(name)?.name, value)),
            _ => Err(wrong()),
        },
        Value::Text(name) if value.number().is_none() => match find(name)? {
            variant if matches!(variant.kind, Kind::Number) => Err(wrong()),
            variant => Ok((variant.name, &Value::None)),
        },
        _ if value.number().is_some() => {
            let numbers = variants.iter().filter(|v| matches!(v.kind, Kind::Number));
            match numbers.collect::<Vec<_>>().as_slice() {
                [variant] => Ok((variant.name, value)),
                _ => Err(wrong()),
            }
        }
        _ => Err(wrong()),
    }
}

/// Returns the alternative at the begin of a dotted name, whose own name may have dots, and the
/// rest.
#[must_use]
pub fn split_alternative<'a>(path: &'a str, variants: &[Field]) -> (&'a str, &'a str) {
    let rest = |variant: &Field| match path.strip_prefix(variant.name)? {
        "" => Some((path, "")),
        rest => Some((&path[..variant.name.len()], rest.strip_prefix('.')?)),
    };
    let found = variants.iter().find_map(rest);
    found.unwrap_or((path, ""))
}

/// Sets the value of an alternative or a part of it; none leaves it as it is.
///
/// # Errors
/// [`ParamError`].
pub fn set_variant<T: Parameter>(own: &mut T, rest: &str, value: &Value) -> Result<(), ParamError> {
    match (rest, value) {
        ("", Value::None) => Ok(()),
        ("", value) => own.set_value(value),
        (rest, value) => own.set_part(rest, value),
    }
}

/// Implements serde's traits: values by name in self-describing formats, else the number of the
/// variant and its value.
#[cfg(feature = "serde")]
#[doc(hidden)]
#[macro_export]
macro_rules! __serde_variants {
    (
        $name:ident
        { $($unit:ident = $unit_text:literal,)* }
        { $($variant:ident: $type:ty = $text:literal),+ }
    ) => {
        impl $crate::macros::serde::Serialize for $name {
            fn serialize<S: $crate::macros::serde::Serializer>(
                &self,
                serializer: S,
            ) -> ::core::result::Result<S::Ok, S::Error> {
                if serializer.is_human_readable() {
                    return $crate::macros::serde::Serialize::serialize(
                        &$crate::Parameter::value(self),
                        serializer,
                    );
                }
                let number = $crate::macros::variant_number(Self::VARIANTS, self.name());
                match self {
                    $(Self::$unit => {
                        $crate::macros::serde::Serialize::serialize(&(number, ()), serializer)
                    })*
                    $(Self::$variant(own) => {
                        $crate::macros::serde::Serialize::serialize(&(number, own), serializer)
                    })+
                }
            }
        }

        impl<'de> $crate::macros::serde::Deserialize<'de> for $name {
            fn deserialize<D: $crate::macros::serde::Deserializer<'de>>(
                deserializer: D,
            ) -> ::core::result::Result<Self, D::Error> {
                struct Visitor;

                impl<'de> $crate::macros::serde::de::Visitor<'de> for Visitor {
                    type Value = $name;

                    fn expecting(
                        &self,
                        f: &mut ::core::fmt::Formatter<'_>,
                    ) -> ::core::fmt::Result {
                        f.write_str(concat!("the enum ", stringify!($name)))
                    }

                    fn visit_seq<A: $crate::macros::serde::de::SeqAccess<'de>>(
                        self,
                        mut seq: A,
                    ) -> ::core::result::Result<$name, A::Error> {
                        let number: u32 = $crate::macros::next(&mut seq)?;
                        let variant = $name::VARIANTS.get(number as usize);
                        match variant.map_or("", |variant| variant.name) {
                            $($unit_text => Ok($name::$unit),)*
                            $($text => Ok($name::$variant($crate::macros::next(&mut seq)?)),)+
                            _ => Err($crate::macros::serde::de::Error::custom(format_args!(
                                "there is no alternative {number}"
                            ))),
                        }
                    }
                }

                if deserializer.is_human_readable() {
                    return $crate::macros::deserialize_value(deserializer);
                }
                deserializer.deserialize_tuple(2, Visitor)
            }
        }
    };
}

/// Implements nothing without the feature `serde`.
#[cfg(not(feature = "serde"))]
#[doc(hidden)]
#[macro_export]
macro_rules! __serde_variants {
    ($($tokens:tt)*) => {};
}
