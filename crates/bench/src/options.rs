//! Options that several benches share.

use crate::backend::Executor;
use clap::Args;
use incise_progress::{Progress, Visibility};
use std::path::PathBuf;

/// Output of rows and progress.
#[derive(Args, Clone, Debug, Default)]
pub(crate) struct OutputArguments {
    /// Also write the rows as one JSON array, an object per row; long runs write it repeatedly.
    #[arg(long, value_name = "FILE")]
    pub(crate) json: Option<PathBuf>,
    /// Print nothing but warnings and errors: neither rows nor progress.
    #[arg(short, long)]
    pub(crate) quiet: bool,
}

impl OutputArguments {
    /// Returns the progress of a run of `parts`, each of `steps`.
    pub(crate) fn progress(&self, parts: usize, steps: u64) -> Progress {
        let shown = if self.quiet {
            Visibility::Never
        } else {
            Visibility::Everywhere
        };
        Progress::new(parts as u64, steps, shown)
    }
}

/// Parses a positive number or a fraction.
pub(crate) fn positive(text: &str) -> Result<f64, String> {
    let number = |s: &str| s.trim().parse::<f64>().ok();
    let value = match text.split_once('/') {
        Some((above, below)) => number(above).zip(number(below)).map(|(a, b)| a / b),
        None => number(text),
    };
    value
        .filter(|v| v.is_finite() && *v > 0.0)
        .ok_or_else(|| format!("'{text}' is not a positive number or fraction"))
}

/// Choice of the GPU.
#[derive(Args, Clone, Debug)]
pub(crate) struct AdapterArguments {
    /// Part of the name of the GPU.
    #[arg(long, value_name = "NAME")]
    pub(crate) adapter: Option<String>,
}

/// Source of models.
#[derive(Args, Clone, Debug)]
pub(crate) struct ModelArguments {
    /// Folder of models (bunny*.obj, armadillo*.ply, ...) that replace the built-in ones.
    #[arg(long, value_name = "DIR")]
    pub(crate) models: Option<PathBuf>,
}

/// Backends and output of a bench that compares backends.
#[derive(Args, Clone, Debug)]
pub(crate) struct RunArguments {
    /// Backends of the solver, separated by commas; everything runs on each.
    #[arg(
        long,
        value_enum,
        value_name = "NAMES",
        value_delimiter = ',',
        default_value = "cpu"
    )]
    backend: Vec<Executor>,
    #[command(flatten)]
    pub(crate) gpu: AdapterArguments,
    #[command(flatten)]
    pub(crate) rows: OutputArguments,
}

impl RunArguments {
    /// Returns the backends in the given order, each once.
    pub(crate) fn backends(&self) -> Vec<Executor> {
        let mut each = Vec::new();
        for &executor in &self.backend {
            if !each.contains(&executor) {
                each.push(executor);
            }
        }
        each
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        run: RunArguments,
    }

    #[test]
    fn a_backend_named_twice_runs_once() {
        let line = Line::try_parse_from(["bench", "--backend", "gpu,cpu,gpu"]).unwrap();
        assert_eq!(line.run.backends(), [Executor::Gpu, Executor::Cpu]);
    }

    #[test]
    fn a_time_step_is_a_number_or_a_fraction() {
        assert_eq!(positive("1/60"), Ok(1.0 / 60.0));
        assert_eq!(positive("0.5"), Ok(0.5));
        for bad in ["0", "-1", "1/0", "a", "1/2/3", "nan"] {
            assert!(positive(bad).is_err(), "{bad}");
        }
    }
}
