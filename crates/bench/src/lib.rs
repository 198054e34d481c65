//! The benchmarks of incise: the paper's table, time, error, stability, and a report of all.
//!
//! [`program`] is the command line of `incise-bench`. The feature `reference`, on by default, builds
//! the benches of errors; the linear algebra of their reference takes minutes to compile.

#[cfg(feature = "reference")]
mod accuracy;
mod allocations;
mod backend;
mod chart;
mod clock;
mod cut;
mod frame_rates;
mod html_report;
mod json;
mod machine;
mod method;
mod models;
mod motion;
#[cfg(not(feature = "gpu"))]
mod no_gpu;
mod numbers;
mod options;
mod output;
mod picture;
mod printout;
mod program;
mod refine;
mod skip;
mod solver;
mod stability;
mod statistics;
mod step;
mod table;
mod text_table;
mod work_precision;
mod workload;

pub use program::program;
