//! CPU kernels of the solver, each with an equal WGSL kernel in the file beside it.
//!
//! A substep accumulates the displacement `d` since its start; `integrate` adds it to the positions
//! `x` at the end. Constraints evaluate `(x_a - x_b) + (d_a - d_b)`. Differences of adjacent
//! positions are nearly exact, and small contributions such as gravity, which would be lost when
//! added to `x`, are kept.
//!
//! Products and sums are rounded separately, never fused, so that every instruction set gives the
//! same bits. GPUs that round every operation give the same bits too, unless an intermediate result
//! is denormal (below 1.2e-38), which WGSL allows to flush to zero. That requires edges shorter
//! than 1e-19 m.

pub(crate) mod arctangent;
pub(crate) mod attachments;
pub(crate) mod bending;
pub(crate) mod block;
#[cfg(test)]
pub(crate) mod bounds;
pub(crate) mod cells;
pub(crate) mod colliders;
pub(crate) mod contact_features;
pub(crate) mod contacts;
pub(crate) mod elastic;
pub(crate) mod integrate;
pub(crate) mod lanes;
pub(crate) mod particle_state;
pub(crate) mod pins;
pub(crate) mod points;
pub(crate) mod predict;
pub(crate) mod rigid_motion;
pub(crate) mod stretch;
pub(crate) mod volume;
