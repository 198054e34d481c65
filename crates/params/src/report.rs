//! [`report!`](crate::report): a struct of counts and times that other languages read by name.

use crate::{Field, ParamError, Value, names};
use std::time::Duration;

/// A struct of counts and times, made by [`report!`](crate::report).
pub trait Report {
    /// The counts, then a struct `seconds` of the times and their sum.
    const FIELDS: &'static [Field];

    /// Returns all values by name, for files and other languages.
    fn value(&self) -> Value;

    /// Returns a value by its dotted name, or a short one, see [`resolve`](crate::resolve).
    ///
    /// # Errors
    /// [`ParamError::Unknown`] and [`ParamError::Ambiguous`].
    fn get(&self, name: &str) -> Result<Value, ParamError> {
        let path = names::resolve(Self::FIELDS, name)?;
        Ok(self.value().at(&path).unwrap_or(Value::None))
    }
}

/// Returns a time as a number \[s\].
#[must_use]
pub fn seconds(time: Duration) -> Value {
    Value::Number(time.as_secs_f64())
}

/// Declares a struct of counts and times.
///
/// Each line is a public field. The block `seconds` lists times, each of them a field of type
/// [`Duration`], and the macro adds the method `total`, which returns their sum. It implements
/// [`Report`](crate::Report), and with the feature `serde` `Serialize`.
///
/// ```
/// use incise_params::{Report, Value};
/// use std::time::Duration;
///
/// incise_params::report! {
///     /// Counts and times of a search.
///     #[derive(Debug, Clone, Copy, Default)]
///     pub struct SearchReport {
///         /// Triangles found.
///         triangles: usize;
///         /// Distance searched.
///         distance: f64, unit: "m";
///     }
///     seconds {
///         /// Time of building the tree.
///         build;
///         /// Time of the query.
///         query;
///     }
/// }
///
/// let report = SearchReport { query: Duration::from_millis(250), ..SearchReport::default() };
/// assert_eq!(report.total(), report.query);
/// assert_eq!(report.get("query"), Ok(Value::Number(0.25)));
/// assert_eq!(report.get("seconds.total"), Ok(Value::Number(0.25)));
/// ```
#[macro_export]
macro_rules! report {
    (
        $(#[$meta:meta])*
        $vis:vis struct $name:ident {$(
            $(#[doc = $doc:literal])+
            $field:ident: $type:ty $(, unit: $unit:literal)?;
        )+}
        seconds {$(
            $(#[doc = $time_doc:literal])+
            $time:ident;
        )+}
    ) => {
        $(#[$meta])*
        $vis struct $name {
            $(
                $(#[doc = $doc])+
                $(#[doc = concat!("\n\nUnit: ", $unit, ".")])?
                pub $field: $type,
            )+
            $(
                $(#[doc = $time_doc])+
                pub $time: ::core::time::Duration,
            )+
        }

        impl $name {
            /// Returns the sum of all times.
            #[must_use]
            pub fn total(&self) -> ::core::time::Duration {
                [$(self.$time),+].into_iter().sum()
            }
        }

        impl $crate::Report for $name {
            const FIELDS: &'static [$crate::Field] = &[
                $($crate::Field::new(
                    stringify!($field),
                    concat!($($doc, "\n",)+),
                    <$type as $crate::Parameter>::KIND,
                    $crate::Range::FINITE,
                    concat!($($unit)?),
                    || $crate::Value::None,
                ),)+
                $crate::Field::new(
                    "seconds",
                    "Times.",
                    $crate::Kind::Struct(&[
                        $($crate::Field::new(
                            stringify!($time),
                            concat!($($time_doc, "\n",)+),
                            $crate::Kind::Number,
                            $crate::Range::NOT_NEGATIVE,
                            "s",
                            || $crate::Value::None,
                        ),)+
                        $crate::Field::new(
                            "total",
                            "Sum of all times.",
                            $crate::Kind::Number,
                            $crate::Range::NOT_NEGATIVE,
                            "s",
                            || $crate::Value::None,
                        ),
                    ]),
                    $crate::Range::FINITE,
                    "",
                    || $crate::Value::None,
                ),
            ];

            fn value(&self) -> $crate::Value {
                $crate::Value::Map(vec![
                    $((stringify!($field).to_owned(), $crate::Parameter::value(&self.$field)),)+
                    ("seconds".to_owned(), $crate::Value::Map(vec![
                        $((stringify!($time).to_owned(), $crate::macros::seconds(self.$time)),)+
                        ("total".to_owned(), $crate::macros::seconds(self.total())),
                    ])),
                ])
            }
        }

        $crate::__serde_report!($name);
    };
}

/// Implements `Serialize`: values by name.
#[cfg(feature = "serde")]
#[doc(hidden)]
#[macro_export]
macro_rules! __serde_report {
    ($name:ident) => {
        impl $crate::macros::serde::Serialize for $name {
            fn serialize<S: $crate::macros::serde::Serializer>(
                &self,
                serializer: S,
            ) -> ::core::result::Result<S::Ok, S::Error> {
                $crate::macros::serde::Serialize::serialize(
                    &$crate::Report::value(self),
                    serializer,
                )
            }
        }
    };
}

/// Implements nothing without the feature `serde`.
#[cfg(not(feature = "serde"))]
#[doc(hidden)]
#[macro_export]
macro_rules! __serde_report {
    ($name:ident) => {};
}
