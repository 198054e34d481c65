//! Options that several benches have.

use crate::backend::Executor;
use clap::Args;
use incise_progress::{Progress, Shown};
use std::path::PathBuf;

/// Where rows go, and what is told meanwhile.
#[derive(Args, Clone, Debug, Default)]
pub(crate) struct OutputArguments {
    /// Also write the rows as JSON, one object a row; a long run writes them as they come.
    #[arg(long, value_name = "FILE")]
    pub(crate) json: Option<PathBuf>,
    /// Print nothing but warnings and errors: neither rows nor progress.
    #[arg(short, long)]
    pub(crate) quiet: bool,
}

impl OutputArguments {
    /// The progress of a run of so many parts, each of so many steps.
    pub(crate) fn progress(&self, parts: usize, steps: u64) -> Progress {
        let shown = if self.quiet {
            Shown::Never
        } else {
            Shown::Everywhere
        };
        Progress::new(parts as u64, steps, shown)
    }
}

/// A positive number, or a fraction of two.
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

/// Which GPU.
#[derive(Args, Clone, Debug)]
pub(crate) struct AdapterArguments {
    /// A part of the name of the GPU to take.
    #[arg(long, value_name = "NAME")]
    pub(crate) adapter: Option<String>,
}

/// Where models come from.
#[derive(Args, Clone, Debug)]
pub(crate) struct ModelArguments {
    /// A folder with real models (bunny*.obj, armadillo*.ply, ...) to use instead of built-in ones.
    #[arg(long, value_name = "DIR")]
    pub(crate) models: Option<PathBuf>,
}

/// What executes a bench that compares, and where its rows go.
#[derive(Args, Clone, Debug)]
pub(crate) struct RunArguments {
    /// What executes the solver, separated by commas: everything runs on each.
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
    /// What executes the solver, in the order that was asked for, each once.
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
    fn what_is_named_twice_runs_once() {
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
