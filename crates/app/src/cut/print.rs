//! The report of `incise cut` as text.

use super::Report;
use crate::clock::milliseconds;
use crate::numbers::counted;
use crate::pieces;
use incise_cut::Caps;
use std::io::{self, Write};

/// Prints the report.
pub(super) fn print(report: &Report, out: &mut impl Write) -> io::Result<()> {
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
    if report.cut.hits > 0 {
        writeln!(
            out,
            "  {} hit{}; {}, smallest angle {:.1}, median {:.1} degrees",
            counted(report.cut.hits, "triangle"),
            match report.steps {
                Some(_) => String::new(),
                None => format!(" in {}", counted(report.cut.loops, "loop")),
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
        let is_on = |amount: &f64| *amount > 0.0;
        let [snap, remesh] = [report.snap, report.remesh].map(|amount| amount.filter(is_on));
        if let Some(snap) = snap {
            writeln!(
                out,
                "  snap {snap}: {} and {} moved; {} left",
                counted(report.cut.snapped_vertices, "vertex"),
                counted(report.cut.merged_points, "point"),
                counted(report.cut.short_rim_edges, "short rim edge")
            )?;
        }
        if let Some(remesh) = remesh {
            writeln!(
                out,
                "  remesh {remesh}: {} flipped, {} and {} contracted; the \
                 surface moved by {:.1e} at most",
                counted(report.cut.flipped_edges, "edge"),
                counted(report.cut.collapsed_vertices, "vertex"),
                counted(report.cut.collapsed_points, "rim point"),
                report.cut.moved_surface
            )?;
        }
        if snap.or(remesh).is_some() {
            writeln!(out, "  volume {:.1e} moved", report.cut.moved_volume)?;
        }
    }
    writeln!(
        out,
        "  {}, {} method",
        counted(report.pieces.len(), "piece"),
        report.method
    )?;
    pieces::print(&report.pieces, &report.removed, out)?;
    let (t, cut) = (&report.seconds, &report.cut);
    let stages = [
        ("read", t.read),
        ("BVH build", t.bvh_build),
        ("BVH update", cut.bvh_update.as_secs_f64()),
        ("detection", cut.detection.as_secs_f64()),
        ("split", cut.split.as_secs_f64()),
        ("remeshing", cut.remeshing.as_secs_f64()),
        ("cap", cut.cap.as_secs_f64()),
        ("refinement", cut.refinement.as_secs_f64()),
        ("separation", cut.separation.as_secs_f64()),
        ("commit", cut.commit.as_secs_f64()),
        ("write", t.write),
    ];
    let stages = stages.map(|(name, time)| format!("{name} {:.2}", milliseconds(time)));
    writeln!(out, "  ms: {}", stages.join(", "))
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
