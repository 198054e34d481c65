//! [`choices!`](crate::choices): an enum of names.

/// Declares an enum whose variants are names, with `Default` for the first one.
///
/// ```
/// incise_params::choices! {
///     /// Time integration.
///     #[derive(Debug, Clone, Copy, PartialEq, Eq)]
///     pub enum Integrator {
///         /// Of first order.
///         Euler = "euler",
///         /// Of second order.
///         Bdf2 = "bdf2",
///     }
/// }
///
/// assert_eq!(Integrator::from_name("bdf2"), Some(Integrator::Bdf2));
/// assert_eq!(Integrator::default().name(), "euler");
/// ```
#[macro_export]
macro_rules! choices {
    (
        $(#[$meta:meta])*
        $vis:vis enum $name:ident {$(
            $(#[doc = $doc:literal])+
            $variant:ident = $text:literal,
        )+}
    ) => {
        $(#[$meta])*
        $vis enum $name {$(
            $(#[doc = $doc])+
            $variant,
        )+}

        impl $name {
            /// Names of all variants.
            pub const NAMES: &'static [&'static str] = &[$($text),+];

            /// Returns the name in files and other languages.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $text,)+
                }
            }

            /// Returns the variant of a name.
            #[must_use]
            pub fn from_name(name: &str) -> Option<Self> {
                match name {
                    $($text => Some(Self::$variant),)+
                    _ => None,
                }
            }
        }

        impl ::core::default::Default for $name {
            fn default() -> Self {
                let [first, ..] = [$(Self::$variant),+];
                first
            }
        }

        impl $crate::Parameter for $name {
            const KIND: $crate::Kind = $crate::Kind::Choice(Self::NAMES);

            fn initial() -> Self {
                <Self as ::core::default::Default>::default()
            }

            fn value(&self) -> $crate::Value {
                $crate::Value::Text(self.name().to_owned())
            }

            fn set_value(
                &mut self,
                value: &$crate::Value,
            ) -> ::core::result::Result<(), $crate::ParamError> {
                // `none` may be a name.
                let name = value.to_string();
                let found = Self::from_name(&name);
                let wrong = || match value {
                    $crate::Value::Text(_) => $crate::ParamError::wrong_value(value, Self::KIND),
                    _ => $crate::ParamError::wrong_type(value, Self::KIND),
                };
                *self = found.ok_or_else(wrong)?;
                Ok(())
            }

            fn check_range(
                &self,
                _: &'static $crate::Range,
            ) -> ::core::result::Result<(), $crate::OutOfRange> {
                Ok(())
            }
        }

        $crate::__serde_choices!($name { $($text),+ });
    };
}

/// Implements serde's traits: the name in self-describing formats, else the number of the variant.
#[cfg(feature = "serde")]
#[doc(hidden)]
#[macro_export]
macro_rules! __serde_choices {
    ($name:ident { $($text:literal),+ }) => {
        impl $crate::macros::serde::Serialize for $name {
            fn serialize<S: $crate::macros::serde::Serializer>(
                &self,
                serializer: S,
            ) -> ::core::result::Result<S::Ok, S::Error> {
                if serializer.is_human_readable() {
                    return serializer.serialize_str(self.name());
                }
                let mut numbers = 0_u32..;
                let number = Self::NAMES
                    .iter()
                    .zip(&mut numbers)
                    .find(|(n, _)| **n == self.name());
                serializer.serialize_u32(number.map_or(0, |(_, number)| number))
            }
        }

        impl<'de> $crate::macros::serde::Deserialize<'de> for $name {
            fn deserialize<D: $crate::macros::serde::Deserializer<'de>>(
                deserializer: D,
            ) -> ::core::result::Result<Self, D::Error> {
                if deserializer.is_human_readable() {
                    return $crate::macros::deserialize_value(deserializer);
                }
                let number: u32 = $crate::macros::serde::Deserialize::deserialize(deserializer)?;
                let name = Self::NAMES.get(number as usize);
                name.and_then(|name| Self::from_name(name)).ok_or_else(|| {
                    $crate::macros::serde::de::Error::custom(format_args!(
                        "there is no choice {number}"
                    ))
                })
            }
        }
    };
}

/// Implements nothing without the feature `serde`.
#[cfg(not(feature = "serde"))]
#[doc(hidden)]
#[macro_export]
macro_rules! __serde_choices {
    ($($tokens:tt)*) => {};
}
