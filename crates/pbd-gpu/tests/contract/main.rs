//! Tests of the contract of this crate, on the CPU.

mod attachments;
mod closed_forms;
mod cut;
mod delta;
mod determinism;
mod early_out;
mod invariants;
mod islands;
mod mass_transfer;
mod material_changes;
mod pressure;
mod refusals;
mod second_order;
mod solids;
mod stability;
mod undo;
mod volumes;
mod volumes_on_ground;
