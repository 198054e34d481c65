//! [`CapsOption`]: the option `--caps` of commands that cut.

use clap::ValueEnum;
use incise_cut::Caps;
use serde::Deserialize;

/// The curves of a cut along which caps and walls close it, see [`Caps`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CapsOption {
    /// Those in closed bodies. A part with a boundary is a sheet and stays open.
    #[default]
    Bodies,
    /// Also closed curves in sheets: for the scan of a body that has holes elsewhere.
    AllLoops,
    /// None: bodies stay open, too.
    None,
}

impl CapsOption {
    /// Returns the name on the command line.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Bodies => "bodies",
            Self::AllLoops => "all-loops",
            Self::None => "none",
        }
    }

    /// Returns the parameter for the cutter.
    #[must_use]
    pub fn caps(self) -> Caps {
        match self {
            Self::Bodies => Caps::Bodies,
            Self::AllLoops => Caps::AllLoops,
            Self::None => Caps::None,
        }
    }
}
