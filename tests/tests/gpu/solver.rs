//! The GPU backend of the solver: steps, edits, readback, kernels and errors.

pub(crate) mod bodies;
pub(crate) mod contacts;
pub(crate) mod deltas;
pub(crate) mod growth;
pub(crate) mod kernels;
pub(crate) mod long;
pub(crate) mod misuse;
pub(crate) mod motion;
pub(crate) mod pipelines;
pub(crate) mod solids;
pub(crate) mod steps;
