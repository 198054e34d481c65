//! Backends of the command line.

use clap::ValueEnum;

/// A backend of the solver.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum BackendChoice {
    /// The CPU.
    Cpu,
    /// A GPU; a software adapter if there is no other.
    Gpu,
    /// A hardware GPU for bodies that are faster on it, the CPU for all others.
    Auto,
}

impl BackendChoice {
    /// Returns the name on the command line and in tables.
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

/// A backend of benches that compare backends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Executor {
    /// The CPU.
    Cpu,
    /// A GPU; a software adapter if there is no other.
    Gpu,
}

impl Executor {
    /// Returns the name on the command line and in tables.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Cpu => BackendChoice::Cpu.name(),
            Self::Gpu => BackendChoice::Gpu.name(),
        }
    }
}
