//! The report of `incise simulate` as text.

use super::Report;
use crate::numbers::counted;
use crate::pieces;
use std::io::{self, Write};

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
    if let Some(hits @ 1..) = report.triangles_hit {
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
    let t = &report.milliseconds;
    writeln!(
        out,
        "  ms: simulate {:.2}, write {:.2}",
        t.simulate, t.write
    )
}
