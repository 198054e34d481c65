//! What executes the solver, as the command line names it.

use clap::ValueEnum;

/// What executes the solver.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum BackendChoice {
    /// The processor.
    Cpu,
    /// A GPU, or software that acts as one where there is none.
    Gpu,
    /// A real GPU for bodies that are large enough to gain, the processor for all others.
    Auto,
}

impl BackendChoice {
    /// The name on the command line and in tables.
    pub(crate) fn name(self) -> &'static str {
        incise_scene::BackendChoice::from(self).name()
    }
}

impl From<BackendChoice> for incise_scene::BackendChoice {
    fn from(choice: BackendChoice) -> Self {
        match choice {
            BackendChoice::Cpu => Self::Cpu,
            BackendChoice::Gpu => Self::Gpu,
            BackendChoice::Auto => Self::Auto,
        }
    }
}

/// What executes the solver where nothing may choose by itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Executor {
    /// The processor.
    Cpu,
    /// A GPU, or software that acts as one where there is none.
    Gpu,
}

impl Executor {
    /// The name on the command line and in tables.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Cpu => BackendChoice::Cpu.name(),
            Self::Gpu => BackendChoice::Gpu.name(),
        }
    }
}
