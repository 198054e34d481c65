//! A body and what is done to it, made of bytes: whatever a fuzzer comes up with is a case. After every
//! step the laws of `incise-tests` hold, and nothing but a sweep that ends inside the body is refused.
#![forbid(unsafe_code)]
#![warn(missing_docs, clippy::missing_assert_message)]

mod case;
mod run;

pub use case::{Case, Knife, Step};
