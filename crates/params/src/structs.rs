//! [`params!`](crate::params): a struct of parameters.

/// Declares a struct of parameters.
///
/// Each line is a public field: documentation, name, type, default, and if they apply, range and
/// unit. Types implement [`Parameter`](crate::Parameter); structs nest. The macro makes the plain
/// struct, `Default`, [`Params`](crate::Params) with the table `FIELDS` and the check of ranges,
/// and with the feature `serde` both traits of serde.
///
/// ```
/// use incise_params::{Params, Range};
///
/// incise_params::params! {
///     /// Parameters of a spring.
///     #[derive(Debug, Clone, PartialEq)]
///     pub struct Spring {
///         /// Stiffness.
///         stiffness: f32 = 10.0, range: Range::POSITIVE, unit: "N/m";
///         /// Rest length; `None` takes the present one.
///         length: Option<f32> = None, range: Range::NOT_NEGATIVE, unit: "m";
///     }
/// }
///
/// let spring = Spring { stiffness: -1.0, ..Spring::default() };
/// let error = spring.check_ranges().unwrap_err().to_string();
/// assert_eq!(error, "stiffness is -1; it must be a finite number above 0");
/// assert_eq!(Spring::FIELDS[1].unit, "m");
/// ```
#[macro_export]
macro_rules! params {
    (
        $(#[$meta:meta])*
        $vis:vis struct $name:ident {$(
            $(#[doc = $doc:literal])+
            $field:ident: $type:ty = $default:expr
            $(, range: $range:expr)? $(, unit: $unit:literal)?;
        )+}
    ) => {
        $(#[$meta])*
        $vis struct $name {$(
            $(#[doc = $doc])+
            #[doc = concat!(
                "\n\nDefault: `", stringify!($default), "`", $(" \\[", $unit, "\\]",)? "."
            )]
            pub $field: $type,
        )+}

        impl ::core::default::Default for $name {
            fn default() -> Self {
                Self { $($field: $default,)+ }
            }
        }

        impl $crate::Params for $name {
            const FIELDS: &'static [$crate::Field] = &[$(
                $crate::Field::new(
                    stringify!($field),
                    concat!($($doc, "\n",)+),
                    <$type as $crate::Parameter>::KIND,
                    $crate::__range!($($range)?),
                    concat!($($unit)?),
                    || {
                        let default = <Self as ::core::default::Default>::default();
                        $crate::Parameter::value(&default.$field)
                    },
                ),
            )+];

            fn check_ranges(&self) -> ::core::result::Result<(), $crate::OutOfRange> {
                $(
                    let range = const { &$crate::__range!($($range)?) };
                    $crate::Parameter::check_range(&self.$field, range)
                        .map_err(|error| error.within(&stringify!($field)))?;
                )+
                Ok(())
            }
        }

        impl $crate::Parameter for $name {
            const KIND: $crate::Kind = $crate::Kind::Struct(<Self as $crate::Params>::FIELDS);

            fn initial() -> Self {
                <Self as ::core::default::Default>::default()
            }

            fn value(&self) -> $crate::Value {
                $crate::Value::Map(vec![$(
                    (stringify!($field).to_owned(), $crate::Parameter::value(&self.$field)),
                )+])
            }

            fn set_value(
                &mut self,
                value: &$crate::Value,
            ) -> ::core::result::Result<(), $crate::ParamError> {
                $crate::macros::set_map(self, value)
            }

            fn set_part(
                &mut self,
                path: &str,
                value: &$crate::Value,
            ) -> ::core::result::Result<(), $crate::ParamError> {
                let (head, rest) = $crate::macros::split(path);
                match head {
                    $(stringify!($field) => {
                        let range = const { &$crate::__range!($($range)?) };
                        $crate::macros::set_part(&mut self.$field, rest, value, range)
                            .map_err(|error| error.within(&stringify!($field)))
                    })+
                    _ => Err($crate::ParamError::Unknown {
                        name: path.to_owned(),
                        known: [$(stringify!($field)),+].join(", "),
                    }),
                }
            }

            fn check_range(
                &self,
                _: &'static $crate::Range,
            ) -> ::core::result::Result<(), $crate::OutOfRange> {
                $crate::Params::check_ranges(self)
            }
        }

        $crate::__serde_struct!($name { $($field: $type),+ });
    };
}

/// The range of a field, all finite numbers without one.
#[doc(hidden)]
#[macro_export]
macro_rules! __range {
    () => {
        $crate::Range::FINITE
    };
    ($range:expr) => {
        $range
    };
}

/// Implements serde's traits: values by name in self-describing formats, else a tuple of all
/// fields, which has the bytes of a derived implementation.
#[cfg(feature = "serde")]
#[doc(hidden)]
#[macro_export]
macro_rules! __serde_struct {
    ($name:ident { $($field:ident: $type:ty),+ }) => {
        impl $crate::macros::serde::Serialize for $name {
            fn serialize<S: $crate::macros::serde::Serializer>(
                &self,
                serializer: S,
            ) -> ::core::result::Result<S::Ok, S::Error> {
                if serializer.is_human_readable() {
                    $crate::macros::serde::Serialize::serialize(
                        &$crate::Parameter::value(self),
                        serializer,
                    )
                } else {
                    $crate::macros::serde::Serialize::serialize(&($(&self.$field,)+), serializer)
                }
            }
        }

        impl<'de> $crate::macros::serde::Deserialize<'de> for $name {
            fn deserialize<D: $crate::macros::serde::Deserializer<'de>>(
                deserializer: D,
            ) -> ::core::result::Result<Self, D::Error> {
                if deserializer.is_human_readable() {
                    return $crate::macros::deserialize_value(deserializer);
                }
                let ($($field,)+) = $crate::macros::serde::Deserialize::deserialize(deserializer)?;
                Ok(Self { $($field),+ })
            }
        }
    };
}

/// Implements nothing without the feature `serde`.
#[cfg(not(feature = "serde"))]
#[doc(hidden)]
#[macro_export]
macro_rules! __serde_struct {
    ($($tokens:tt)*) => {};
}
