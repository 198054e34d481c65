//! `incise check`: prints the properties of a mesh and the reasons that it cannot be cut.

use crate::failure::Failure;
use crate::input::{InputOptions, read_unrepaired};
use crate::json::lossy;
use crate::reporter::Reporter;
use incise_mesh::{Defect, MeshReport, NotCuttable, RepairedCounts, check_with};
use serde::Serialize;
use std::fmt::Display;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Prints the properties of a mesh; exits with 1 if it cannot be cut.
///
/// A mesh with a boundary is cut as a sheet, by the exact method.
#[derive(clap::Args)]
#[command(after_long_help = AFTER_HELP)]
pub(crate) struct CheckArguments {
    /// The mesh (obj, ply, stl, glb or gltf), or a built-in model such as Bunny.
    #[arg(value_name = "FILE|MODEL")]
    file: PathBuf,
    #[command(flatten)]
    reading: InputOptions,
}

const AFTER_HELP: &str = "\
Examples:
  incise check scan.ply
  incise check scan.ply --json

JSON report (--json): file, cuttable, counts of vertices, triangles, edges and components, genus,
closed, manifold, oriented, area, volume, bounds, angles, edge lengths, warnings, defects and counts
of the repaired surface. Far from the origin also origin, to which bounds are relative.";

/// The report as JSON.
#[derive(Serialize)]
struct JsonReport<'a> {
    #[serde(serialize_with = "lossy")]
    file: &'a Path,
    /// Whether the exact method can cut it, as a body or as a sheet.
    cuttable: bool,
    #[serde(flatten)]
    report: &'a MeshReport,
}

/// Runs the command.
pub(crate) fn run(
    arguments: &CheckArguments,
    reporter: &mut Reporter<impl Write>,
) -> Result<(), Failure> {
    let path = &arguments.file;
    let data = read_unrepaired(path)?;
    let report = check_with(&data, arguments.reading.repairs(false));
    let is_sheet = !report.closed
        && check_with(&data, arguments.reading.repairs(true))
            .is_cuttable()
            .is_ok();
    let json = JsonReport {
        file: path,
        cuttable: is_sheet || report.is_cuttable().is_ok(),
        report: &report,
    };
    reporter.report(&json, |json, out| print(json, is_sheet, out))?;
    if is_sheet {
        return Ok(());
    }
    let refused = |defects: &[Defect]| {
        let source = NotCuttable::from(defects);
        arguments.reading.refuse(path, source, &data)
    };
    report.is_cuttable().map_err(refused)
}

fn print(json: &JsonReport<'_>, is_sheet: bool, out: &mut impl Write) -> io::Result<()> {
    let report = json.report;
    writeln!(out, "{}", json.file.display())?;
    let mut line = |name: &str, value: &dyn Display| writeln!(out, "  {name:<22}{value}");
    let yes_no = |yes| if yes { "yes" } else { "no" };
    line("vertices", &report.vertices)?;
    line("vertices in the file", &report.file_vertices)?;
    line("triangles", &report.triangles)?;
    line("edges", &report.edges)?;
    line("components", &report.components)?;
    line("Euler characteristic", &report.euler_characteristic)?;
    match report.genus {
        Some(genus) => line("genus", &genus)?,
        None => line("genus", &"none: not closed, manifold and oriented")?,
    }
    line("closed", &yes_no(report.closed))?;
    line("manifold", &yes_no(report.manifold))?;
    line("oriented", &yes_no(report.oriented))?;
    line("open edges", &report.open_edges)?;
    line("non-manifold edges", &report.nonmanifold_edges)?;
    line("non-manifold vertices", &report.nonmanifold_vertices)?;
    line("winding conflicts", &report.winding_conflicts)?;
    line("degenerate triangles", &report.degenerate_triangles)?;
    line("area", &significant(report.area))?;
    line("volume", &significant(report.volume))?;
    let (low, high) = (report.bounds.min, report.bounds.max);
    if report.origin == [0.0; 3] {
        line("box", &format!("{low:?} to {high:?}"))?;
    } else {
        let place = |p: [f32; 3]| [0, 1, 2].map(|k| report.origin[k] + f64::from(p[k]));
        line("box", &format!("{:?} to {:?}", place(low), place(high)))?;
    }
    let a = &report.angles;
    line(
        "angles",
        &format!(
            "{:.3} smallest, {:.3} at 5%, {:.3} median, {:.3} largest [degrees]",
            a.min, a.percentile_5, a.median, a.max
        ),
    )?;
    let [min, mean, max] = [
        report.edge_lengths.min,
        report.edge_lengths.mean,
        report.edge_lengths.max,
    ]
    .map(significant);
    line(
        "edge lengths",
        &format!("{min} shortest, {mean} mean, {max} longest"),
    )?;
    let is_changed = |repaired: &RepairedCounts| {
        (repaired.vertices, repaired.triangles, repaired.genus)
            != (report.vertices, report.triangles, report.genus)
    };
    if let Some(repaired) = report.repaired.filter(is_changed) {
        let genus = repaired.genus.map(|genus| format!(", genus {genus}"));
        line(
            "repaired",
            &format!(
                "vertices {}, triangles {}, components {}{}",
                repaired.vertices,
                repaired.triangles,
                repaired.components,
                genus.unwrap_or_default()
            ),
        )?;
    }
    for warning in &report.warnings {
        line("warning", warning)?;
    }
    for defect in &report.defects {
        line("defect", defect)?;
    }
    match is_sheet {
        true => line("cuttable", &"yes, as a sheet: without caps"),
        false => line("cuttable", &yes_no(json.cuttable)),
    }
}

/// Formats seven significant digits, the precision of 32-bit coordinates.
fn significant(value: f64) -> String {
    if value == 0.0 || (1e-4..1e7).contains(&value.abs()) {
        let digits = format!("{value:.6e}");
        let rounded: f64 = digits.parse().unwrap_or(value);
        format!("{rounded}")
    } else {
        format!("{value:.6e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_seven_digits() {
        assert_eq!(significant(0.0), "0");
        assert_eq!(significant(0.123_456_789), "0.1234568");
        assert_eq!(significant(-1.0 / 3e20), "-3.333333e-21");
    }
}
