//! The report of `incise simulate`, as JSON and as text.

use super::bodies::Input;
use crate::clock::milliseconds;
use crate::json::all_lossy;
use crate::numbers::counted;
use crate::pieces::{self, Piece};
use serde::Serialize;
use std::io::{self, Write};
use std::path::PathBuf;

/// The report as JSON.
#[derive(Serialize)]
pub(super) struct Report {
    pub(super) inputs: Vec<Input>,
    pub(super) backend: &'static str,
    /// The GPU that held a body at the end; none for the CPU.
    pub(super) device: Option<String>,
    /// Why the CPU continued in place of a GPU; none if it did not.
    pub(super) fallback_reason: Option<String>,
    pub(super) frames: u32,
    pub(super) dt: f64,
    pub(super) iterations: u32,
    /// Length of a substep \[s\]; none for one per frame.
    pub(super) substep: Option<f32>,
    /// Triangles that the sweep crosses; none without a cut.
    pub(super) hits: Option<usize>,
    /// A message for every cut that could not be made.
    pub(super) failed_cuts: Vec<String>,
    /// A message for every plane and blade that hit nothing.
    pub(super) missed_cuts: Vec<String>,
    /// Motions of the blade from pose to pose; none without a path.
    pub(super) steps: Option<usize>,
    /// Steps that cut.
    pub(super) cutting_steps: Option<usize>,
    pub(super) pieces: Vec<PieceOfBody>,
    /// Number of drawn pictures.
    #[cfg(feature = "gpu")]
    pub(super) pictures: usize,
    /// Removed pieces of an earlier run.
    #[serde(serialize_with = "all_lossy")]
    pub(super) removed: Vec<PathBuf>,
    pub(super) seconds: Times,
}

/// A written piece and its body.
#[derive(Serialize)]
pub(super) struct PieceOfBody {
    /// Index of the body's input.
    pub(super) body: usize,
    #[serde(flatten)]
    pub(super) piece: Piece,
}

/// Times of the stages \[s\].
#[derive(Serialize)]
pub(super) struct Times {
    pub(super) simulate: f64,
    pub(super) write: f64,
}

/// Prints the report.
pub(super) fn print(report: &Report, out: &mut impl Write) -> io::Result<()> {
    let names: Vec<_> = (report.inputs.iter())
        .map(|input| input.file.to_string_lossy())
        .collect();
    writeln!(
        out,
        "{}: {} of {:.6} s on {}",
        names.join(", "),
        counted(
            usize::try_from(report.frames).unwrap_or(usize::MAX),
            "frame"
        ),
        report.dt,
        report.device.as_deref().unwrap_or("the CPU")
    )?;
    if let Some(hits @ 1..) = report.hits {
        write!(out, "  {} hit", counted(hits, "triangle"))?;
        match (report.steps, report.cutting_steps) {
            (Some(steps), Some(cutting)) => {
                writeln!(out, "; {}, {cutting} with a cut", counted(steps, "step"))?;
            }
            _ => writeln!(out)?,
        }
    }
    let pieces = report.pieces.iter().map(|of_body| &of_body.piece);
    pieces::print(pieces, &report.removed, out)?;
    #[cfg(feature = "gpu")]
    if report.pictures > 0 {
        writeln!(out, "  {} drawn", counted(report.pictures, "picture"))?;
    }
    let t = &report.seconds;
    writeln!(
        out,
        "  ms: simulate {:.2}, write {:.2}",
        milliseconds(t.simulate),
        milliseconds(t.write)
    )
}
