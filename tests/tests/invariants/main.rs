//! Invariants and properties across crates.

mod attributes;
mod cut_momentum;
mod cut_properties;
mod cuts_in_motion;
mod exact_properties;
mod exact_recut;
mod exact_remesh;
mod exact_series;
mod exact_special;
mod exact_transforms;
mod examples;
mod free_motion;
mod generated;
mod incision_momentum;
mod incision_paths;
mod incision_undo;
mod layering;
mod regressions;
mod seeded_cuts;
mod solver_deltas;
mod stability;
mod stress;
mod thread_count;
