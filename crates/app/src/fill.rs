//! `incise fill`: closes the holes of a mesh.

use crate::clock::{milliseconds, timed};
use crate::failure::Failure;
use crate::format::Format;
use crate::input::{FLAT_VOLUME, InputOptions, components_without_volume};
use crate::json::lossy;
use crate::numbers::counted;
use crate::param_options::{OptionSet, ParamOptions};
use crate::pieces::{check_target, output_path};
use crate::reporter::Reporter;
use clap::Arg;
use incise_mesh::geometry::to_file;
use incise_mesh::{Surface, Warning};
use incise_refine::{HoleParams, HoleReport, fill_holes};
use serde::Serialize;
use std::fmt;
use std::io::{self, Write};
use std::path::PathBuf;

/// Closes every hole of a mesh and writes it. The outer boundary of an open sheet is a hole too.
#[derive(clap::Args)]
#[command(after_long_help = AFTER_HELP)]
pub(crate) struct FillArguments {
    /// The mesh (obj, ply, stl, glb or gltf), or a built-in model such as Bunny.
    #[arg(value_name = "FILE|MODEL")]
    input: PathBuf,
    #[command(flatten)]
    reading: InputOptions,
    /// The file for the closed mesh: obj or ply.
    #[arg(short, long, value_name = "FILE", value_parser = output_path())]
    output: PathBuf,
    #[command(flatten)]
    params: ParamOptions<FillOptionSet>,
}

/// All parameters of filling.
#[derive(Debug)]
struct FillOptionSet;

impl OptionSet for FillOptionSet {
    type Params = HoleParams;

    fn option(_: &str, option: Arg) -> Option<Arg> {
        Some(option)
    }
}

const AFTER_HELP: &str = "\
Examples:
  incise fill scan.ply -o closed.ply
  incise fill scan.ply --fair --level 1.5x-finer -o closed.obj

JSON report (--json): input, output, level, fair, triangles_before, warnings, left_open, vertices,
triangles, closed, area, volume, seconds, and for each of the holes rim_edges, at, triangles,
inserted_vertices, planar, faired, self_intersecting, flat_triangles, slivers, min_angle_deg,
median_angle_deg, mean_edge, target.";

/// The report as JSON.
#[derive(Serialize)]
struct Report {
    #[serde(serialize_with = "lossy")]
    input: PathBuf,
    #[serde(serialize_with = "lossy")]
    output: PathBuf,
    level: f64,
    fair: bool,
    /// Triangles of the repaired input.
    triangles_before: usize,
    warnings: Vec<FillWarning>,
    holes: Vec<Hole>,
    /// Holes left open by --max-edges.
    left_open: usize,
    vertices: usize,
    triangles: usize,
    closed: bool,
    area: f64,
    /// Defined for closed meshes only.
    volume: f64,
    seconds: Times,
}

/// A warning about the input or about the filled mesh.
#[derive(Serialize)]
#[serde(untagged)]
enum FillWarning {
    /// A repair of the input.
    Mesh(Warning),
    /// A property of closed components that `incise cut` refuses, or that is rarely intended.
    Components {
        /// `zero_volume` or `negative_volume`.
        kind: &'static str,
        /// Number of components.
        count: usize,
    },
}

impl fmt::Display for FillWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Mesh(warning) => warning.fmt(f),
            Self::Components {
                kind: "zero_volume",
                count,
            } => write!(
                f,
                "closed components without volume, which cannot be cut: {count}; remove them or \
                 give them thickness"
            ),
            Self::Components { count, .. } => write!(
                f,
                "closed components with negative volume: {count}; each is a cavity or inside out"
            ),
        }
    }
}

/// A closed hole.
#[derive(Serialize)]
struct Hole {
    rim_edges: usize,
    /// A point of the rim, in the input's unit.
    at: [f32; 3],
    triangles: usize,
    inserted_vertices: usize,
    planar: bool,
    faired: bool,
    /// Whether the patch intersects itself.
    self_intersecting: bool,
    /// Patch triangles without area.
    flat_triangles: usize,
    /// Other patch triangles with an angle below 5 degrees.
    slivers: usize,
    min_angle_deg: f64,
    median_angle_deg: f64,
    mean_edge: f64,
    target: f64,
}

/// Times of the stages \[s\].
#[derive(Serialize)]
struct Times {
    read: f64,
    fill: f64,
    write: f64,
}

/// Runs the command.
pub(crate) fn run(
    arguments: &FillArguments,
    reporter: &mut Reporter<impl Write>,
) -> Result<(), Failure> {
    let (input, output) = (&arguments.input, &arguments.output);
    let format = Format::of_file(output)?;
    let params = arguments.params.params()?;
    let progress = reporter.stages(3);
    progress.begin("read");
    let (read, surface) = timed(|| arguments.reading.read_open(input));
    let (mut surface, warnings) = surface?;
    check_target(output, input)?;
    progress.step();
    progress.begin("fill");
    let triangles_before = surface.topology().triangle_count();
    let (fill, filled) = timed(|| fill_holes(&mut surface, &params));
    let filled = filled.map_err(|source| Failure::Fill {
        path: input.clone(),
        source,
    })?;
    progress.step();
    let holes = filled.holes.iter().map(|h| Hole::of(h, &surface)).collect();
    let mut warnings: Vec<FillWarning> = warnings.into_iter().map(FillWarning::Mesh).collect();
    if surface.topology().is_closed() && surface.volume() < 0.0 && surface.flip().is_ok() {
        warnings.push(FillWarning::Mesh(Warning::Inverted));
    }
    warnings.extend(warnings_of_components(&surface));
    for warning in &warnings {
        progress.suspend(|| reporter.warn(format_args!("{}: {warning}", input.display())));
    }
    progress.begin("write");
    let (write, written) = timed(|| format.write(output, &surface));
    for warning in written? {
        progress.suspend(|| reporter.warn(format_args!("{}: {warning}", output.display())));
        warnings.push(FillWarning::Mesh(warning));
    }
    progress.end();
    let report = Report {
        input: input.clone(),
        output: output.clone(),
        level: params.level.z(),
        fair: params.fair,
        triangles_before,
        warnings,
        holes,
        left_open: filled.left_open,
        vertices: surface.topology().vertices().count(),
        triangles: surface.topology().triangle_count(),
        closed: surface.topology().is_closed(),
        area: surface.area(),
        volume: surface.volume(),
        seconds: Times {
            read: read.as_secs_f64(),
            fill: fill.as_secs_f64(),
            write: write.as_secs_f64(),
        },
    };
    Ok(reporter.report(&report, print)?)
}

/// Warns of closed components without volume, and of those with negative volume.
fn warnings_of_components(surface: &Surface) -> impl Iterator<Item = FillWarning> {
    let is_inverted = |part: &Surface| {
        let limit = -FLAT_VOLUME * part.area().powf(1.5);
        part.topology().is_closed() && part.volume() < limit
    };
    let parts = surface.extract_pieces();
    let inverted = parts.filter(|(_, part)| is_inverted(part)).count();
    let counts = [
        ("zero_volume", components_without_volume(surface)),
        ("negative_volume", inverted),
    ];
    let found = counts.into_iter().filter(|&(_, count)| count > 0);
    found.map(|(kind, count)| FillWarning::Components { kind, count })
}

impl Hole {
    fn of(hole: &HoleReport, surface: &Surface) -> Self {
        let [x, y, z, _] = surface.positions()[hole.rim_vertex.index()];
        let at = to_file(surface.origin(), [x, y, z]);
        Self {
            rim_edges: hole.rim_edges,
            at,
            triangles: hole.triangles.len(),
            inserted_vertices: hole.new_vertices,
            planar: hole.planar,
            faired: hole.faired,
            self_intersecting: hole.self_intersecting,
            flat_triangles: hole.flat_triangles,
            slivers: hole.slivers,
            min_angle_deg: hole.angles.min,
            median_angle_deg: hole.angles.median,
            mean_edge: hole.mean_edge,
            target: hole.target_edge,
        }
    }
}

fn print(report: &Report, out: &mut impl Write) -> io::Result<()> {
    writeln!(
        out,
        "{}: {}, {} closed, {} left open",
        report.input.display(),
        counted(report.triangles_before, "triangle"),
        counted(report.holes.len(), "hole"),
        report.left_open
    )?;
    for hole in &report.holes {
        writeln!(
            out,
            "  {} at {:?}: {}{}{}{}, smallest angle {:.1}, median {:.1} degrees, \
             edges {:.2} times the target",
            counted(hole.rim_edges, "edge"),
            hole.at,
            counted(hole.triangles, "triangle"),
            if hole.planar { ", planar" } else { "" },
            if hole.faired { ", faired" } else { "" },
            if hole.self_intersecting {
                ", intersects itself"
            } else {
                ""
            },
            hole.min_angle_deg,
            hole.median_angle_deg,
            hole.mean_edge / hole.target,
        )?;
        if hole.flat_triangles > 0 {
            writeln!(
                out,
                "    {} without area: the rim lies on a line or doubles back; weld its \
                 vertices or remodel it",
                counted(hole.flat_triangles, "triangle")
            )?;
        }
        if hole.slivers > 0 {
            writeln!(
                out,
                "    {} with an angle below 5 degrees",
                counted(hole.slivers, "sliver")
            )?;
        }
    }
    let state = if report.closed {
        format!("closed, volume {:.6e}", report.volume)
    } else {
        String::from("open")
    };
    writeln!(
        out,
        "  {}: {}, {}, area {:.6e}, {state}",
        report.output.display(),
        counted(report.vertices, "vertex"),
        counted(report.triangles, "triangle"),
        report.area
    )?;
    let t = &report.seconds;
    writeln!(
        out,
        "  ms: read {:.2}, fill {:.2}, write {:.2}",
        milliseconds(t.read),
        milliseconds(t.fill),
        milliseconds(t.write)
    )
}
