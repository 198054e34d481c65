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
}
