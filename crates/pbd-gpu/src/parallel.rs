//! Shares the constraints of a pass between threads.
//!
//! This is the only module with `unsafe` code. It rests on one invariant: the parts of a pass write
//! to different particles. [`ConstraintSet`](crate::constraints::batches::ConstraintSet) keeps it
//! for the constraints of a color, and the functions of [`passes`] state it for every other pass.
#![expect(
    unsafe_code,
    reason = "threads write different elements of the same arrays"
)]

mod parking;
pub(crate) mod passes;
mod team;

pub(crate) use team::{Leader, with_team};
