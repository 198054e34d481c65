#![doc = include_str!("../README.md")]

mod choices;
mod error;
mod field;
mod names;
mod parameter;
mod range;
mod report;
mod structs;
mod value;
mod variants;

#[cfg(feature = "serde")]
mod serialize;

pub use error::{OutOfRange, ParamError};
pub use field::{Field, Kind};
pub use names::{all_fields, resolve, short_name};
pub use parameter::{Parameter, Params};
pub use range::Range;
pub use report::Report;
pub use value::Value;

/// Items that the macros use.
#[doc(hidden)]
pub mod macros {
    pub use crate::names::split;
    pub use crate::parameter::{set_map, set_part};
    pub use crate::report::seconds;
    #[cfg(feature = "serde")]
    pub use crate::serialize::{deserialize_value, next, variant_number};
    pub use crate::variants::{alternative, set_variant, split_alternative};
    #[cfg(feature = "serde")]
    pub use serde;
}
