//! One file a kernel, each with its twin in WGSL beside it, operation by operation.
//!
//! A substep works on the displacement `d` since its start; positions `x` stay as they are until
//! `integrate` adds it. Constraints evaluate `(x_a - x_b) + (d_a - d_b)`: differences of neighbors
//! are exact or nearly so, and gravity's share of a small step, which is lost when added to `x`, is kept.
//!
//! A product and a sum are always rounded apart, never fused, so that every instruction set gives the
//! same bits. So does a device that rounds every operation by itself, while no number on the way is
//! denormal, below 1.2e-38: WGSL lets devices take such a number for zero, and all of them do. It takes
//! edges shorter than 1e-19 m to notice.

pub(crate) mod arctangent;
pub(crate) mod bending;
pub(crate) mod block;
#[cfg(test)]
pub(crate) mod bounds;
pub(crate) mod colliders;
pub(crate) mod contacts;
pub(crate) mod displacements;
pub(crate) mod ground;
pub(crate) mod integrate;
pub(crate) mod pins;
pub(crate) mod predict;
pub(crate) mod stretch;
pub(crate) mod tethers;
pub(crate) mod volume;
