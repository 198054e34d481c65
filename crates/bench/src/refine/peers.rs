//! What other programs need for the same sections: their results, see `crates/bench/peers/README.md`,
//! beside covers made now.

use super::ours::{self, Ours};
use super::row::Stamp;
use super::{RefineArguments, comparison};
use crate::columns;
use crate::json::Json;
use crate::subject::Subject;
use comparison::{Faster, Line};
use serde::Deserialize;
use std::error::Error;
use std::io::Write;
use std::path::Path;

/// What stands in the columns.
const LEGEND: &str = "\
Covers of the same sections at z = 1, the plane through the middle and the seeded ones, one thread. A block for each set of sections that programs
could cover, incise first. ms: the sum over sections of the median run, fastest: of the fastest run; ms/1000: median ms for a thousand triangles.
x, x fast: how many times longer the program took than incise, both ways. Angles in degrees, the smallest of every triangle, of all covers
together: the least, the 5th percentile, the median. Edge: inner edges over the section's mean target, mean and longest. An incise cover serves both
lips; all times are for one cover. Rims: changed where the program puts points on them, after which the cover fits no surface.";

/// A program's results.
#[derive(Debug, Clone, Deserialize)]
pub(super) struct Peer {
    pub(super) program: String,
    pub(super) setting: String,
    /// Whether it leaves the rims as they are.
    pub(super) keeps_rims: bool,
    /// All sections of a model together.
    pub(super) models: Vec<Pool>,
    pub(super) sections: Vec<Theirs>,
}

/// Covers of one model.
#[derive(Debug, Clone, Deserialize)]
pub(super) struct Pool {
    pub(super) model: String,
    pub(super) sections: usize,
    pub(super) triangles: usize,
    pub(super) smallest_angle: f64,
    pub(super) angle_5: f64,
    pub(super) angle_median: f64,
    pub(super) edge_mean: f64,
    pub(super) edge_longest: f64,
}

/// One cover.
#[derive(Debug, Clone, Deserialize)]
pub(super) struct Theirs {
    pub(super) model: String,
    pub(super) planes: String,
    pub(super) section: usize,
    /// The section's fingerprint.
    pub(super) rims: String,
    /// Of the rims.
    pub(super) points: usize,
    pub(super) ms: f64,
    pub(super) ms_fastest: f64,
}

/// Covers the sections of all subjects and prints the others' results beside.
pub(super) fn run(
    arguments: &RefineArguments,
    subjects: &[Subject],
    stamp: &Stamp,
    json: &mut Json,
    out: &mut impl Write,
) -> Result<(), Box<dyn Error>> {
    let peers: Vec<Peer> =
        (arguments.peers.iter().map(|path| read(path))).collect::<Result<_, _>>()?;
    for peer in &peers {
        writeln!(out, "{}: {}", peer.program, peer.setting)?;
    }
    let (mut lines, mut faster): (Vec<Line>, Vec<Faster>) = (Vec::new(), Vec::new());
    let mut warnings = Vec::new();
    for subject in subjects {
        let ours: Vec<Ours> = ours::of(subject, arguments.planes, stamp)?;
        let compared = comparison::compare(&subject.name, &ours, &peers, stamp);
        lines.extend(compared.lines);
        faster.extend(compared.faster);
        warnings.extend(compared.warnings);
    }
    let cells: Vec<_> = [Line::NAMES.map(str::to_owned)]
        .into_iter()
        .chain(lines.iter().map(Line::cells))
        .collect();
    write!(out, "{}", columns::folded(&cells, 2))?;
    writeln!(
        out,
        "{LEGEND}\n\nThe faster one, section by section, of those that keep the rims:"
    )?;
    let cells: Vec<_> = [Faster::NAMES.map(str::to_owned)]
        .into_iter()
        .chain(faster.iter().map(Faster::cells))
        .collect();
    write!(out, "{}", columns::columns(&cells, 1))?;
    for warning in &warnings {
        writeln!(out, "Left out: {warning}")?;
    }
    Ok(json.write(&lines)?)
}

fn read(path: &Path) -> Result<Peer, String> {
    let failed = |fault: &dyn std::fmt::Display| format!("{}: {fault}", path.display());
    let text = std::fs::read_to_string(path).map_err(|fault| failed(&fault))?;
    serde_json::from_str(&text).map_err(|fault| failed(&fault))
}
