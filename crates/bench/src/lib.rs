//! The benchmarks of incise: the paper's table, time, error and stability.
//!
//! [`program`] is the command line of `incise-bench`. Every bench prints its rows as tables and
//! appends them to a file of JSON lines; `report.py` makes a page of such files. The feature
//! `reference`, on by default, builds the benches of errors; the linear algebra of their reference
//! takes minutes to compile.

#[cfg(feature = "reference")]
mod accuracy;
mod cut;
mod failure;
mod gpu;
mod measure;
mod models;
mod motion;
mod options;
mod output;
mod program;
mod refine;
mod skip;
mod solver;
mod stability;
mod step;
mod strokes;
mod table;
mod text_table;
mod workload;

pub use program::program;
