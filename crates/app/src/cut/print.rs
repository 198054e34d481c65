//! The report of `incise cut` as text.

use super::Report;
use crate::numbers::counted;
use crate::pieces;
use incise_cut::Caps;
use std::io::{self, Write};

/// Prints the report.
pub(super) fn print(report: &Report, is_exact: bool, out: &mut impl Write) -> io::Result<()> {
    writeln!(
        out,
        "{}: {}, volume {:.6e}",
        report.input.display(),
        counted(report.triangles, "triangle"),
        report.volume
    )?;
    if report.boundary_edges > 0 && report.caps == Caps::Bodies.name() {
        writeln!(
            out,
            "  {}: parts with a boundary are cut as sheets, without caps; --caps all-loops adds \
             them, `incise fill` closes holes",
            counted(report.boundary_edges, "boundary edge")
        )?;
    }
    print_steps(report, out)?;
    if report.triangles_hit > 0 {
        writeln!(
            out,
            "  {} hit{}; {}, smallest angle {:.1}, median {:.1} degrees",
            counted(report.triangles_hit, "triangle"),
            match report.steps {
                Some(_) => String::new(),
                None => format!(" in {}", counted(report.loops, "loop")),
            },
            counted(report.cap_triangles, report.cap_noun()),
            report.cap_min_angle_deg,
            report.cap_median_angle_deg
        )?;
        if report.cap_flat_triangles > 0 {
            writeln!(
                out,
                "  {} without area: the cut passes very close to a vertex; move the \
                 plane or the blade a little",
                counted(report.cap_flat_triangles, report.cap_noun())
            )?;
        }
        if is_exact && report.snap > 0.0 {
            writeln!(
                out,
                "  snap {}: {} and {} moved; {} left",
                report.snap,
                counted(report.snapped_vertices, "vertex"),
                counted(report.merged_points, "point"),
                counted(report.short_rim_edges, "short rim edge")
            )?;
        }
        if is_exact && report.remesh > 0.0 {
            writeln!(
                out,
                "  remesh {}: {} flipped, {} and {} contracted; the \
                 surface moved by {:.1e} at most",
                report.remesh,
                counted(report.flipped_edges, "edge"),
                counted(report.collapsed_vertices, "vertex"),
                counted(report.collapsed_points, "rim point"),
                report.moved_surface
            )?;
        }
        if is_exact && report.snap.max(report.remesh) > 0.0 {
            writeln!(out, "  volume {:.1e} moved", report.moved_volume)?;
        }
    }
    writeln!(
        out,
        "  {}, {} method",
        counted(report.pieces.len(), "piece"),
        report.method
    )?;
    pieces::print(&report.pieces, &report.removed, out)?;
    let t = &report.milliseconds;
    writeln!(
        out,
        "  ms: read {:.2}, BVH build {:.2}, BVH update {:.2}, detection {:.2}, split {:.2}, \
         remeshing {:.2}, cap {:.2}, refinement {:.2}, separation {:.2}, commit {:.2}, write {:.2}",
        t.read,
        t.bvh_build,
        t.bvh_update,
        t.detection,
        t.split,
        t.remeshing,
        t.cap,
        t.refinement,
        t.separation,
        t.commit,
        t.write
    )
}

/// Prints the motion of the blade along its path.
fn print_steps(report: &Report, out: &mut impl Write) -> io::Result<()> {
    let (Some(steps), Some(cutting), Some(tips)) =
        (report.steps, report.cutting_steps, report.tips)
    else {
        return Ok(());
    };
    write!(out, "  {}, {cutting} with a cut; ", counted(steps, "step"))?;
    match tips {
        0 => writeln!(out, "the blade ends outside the body"),
        tips => writeln!(
            out,
            "the blade ends inside the body, at a tip of {}",
            counted(tips, "vertex")
        ),
    }
}
