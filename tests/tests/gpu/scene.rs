//! Scenes on a GPU: the bits of the CPU, transfers, sleep, and the fallback to the CPU.

pub(crate) mod backend;
mod common;
pub(crate) mod models;
pub(crate) mod scenes;
mod sleep;
pub(crate) mod solids;

use incise_pbd_gpu::Context;

/// Edited, cut and sleeping bodies match the CPU on a strict adapter.
pub(crate) fn to_the_bit(context: Context) {
    scenes::same_bits(context.clone());
    sleep::same_frames(context);
}

/// Blades and sleeping bodies transfer no more than they need.
pub(crate) fn transfers(context: Context) {
    scenes::transfers(context.clone());
    sleep::costs(context);
}
