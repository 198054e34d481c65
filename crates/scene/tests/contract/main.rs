//! Tests of the contract of this crate, on the CPU.

mod allocations;
mod backend;
mod blade_faces;
mod contact_volumes;
mod contacts;
mod cut_threads;
mod cut_with;
mod errors;
mod frame;
mod incisions;
mod interior_springs;
mod join_split;
mod many_bodies;
mod many_cuts;
#[cfg(target_os = "linux")]
mod no_driver;
mod render_buffers;
#[cfg(feature = "serde")]
mod save;
mod sheets;
mod sleep;
mod sleep_long;
mod slices;
mod solid_incisions;
mod solid_undo;
mod solids;
mod undo_in_motion;
mod undo_stack;
mod walls;
