//! `incise fill`: the holes of a mesh, closed.

use crate::clock::{milliseconds, timed};
use crate::failure::Failure;
use crate::json::lossy;
use crate::pieces::check_target;
use crate::teller::Teller;
use incise_mesh::{Surface, Warning, WriteError, read_mesh, write_obj, write_ply};
use incise_refine::{FilledHole, HoleParams, RefinementLevel, fill_holes};
use serde::Serialize;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Closes every hole of a mesh and writes it. The outer boundary of an open sheet is a hole too.
#[derive(clap::Args)]
pub(crate) struct FillArguments {
    /// The mesh: obj, ply, stl, glb or gltf.
    input: PathBuf,
    /// Where the closed mesh goes: obj or ply.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// How fine patches get, against the edges around each hole: 2x-coarser, 1.5x-coarser, original,
    /// 1.5x-finer, 2x-finer, or z.
    #[arg(long, value_name = "Z", default_value = "original")]
    level: RefinementLevel,
    /// Let patches go on as smoothly as they can from the surface around. Flat ends stay flat.
    #[arg(long)]
    fair: bool,
    /// Leave holes with more edges open.
    #[arg(long, value_name = "N")]
    max_edges: Option<usize>,
    /// Refuse when the patches need more triangles than this.
    #[arg(long, value_name = "N", default_value_t = HoleParams::default().max_triangles)]
    max_triangles: usize,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// The report as JSON.
#[derive(Serialize)]
struct Report {
    #[serde(serialize_with = "lossy")]
    input: PathBuf,
    #[serde(serialize_with = "lossy")]
    output: PathBuf,
    level: f64,
    fair: bool,
    /// Triangles of the input, repaired.
    triangles_before: usize,
    warnings: Vec<Warning>,
    holes: Vec<Hole>,
    /// Holes with more edges than were to be closed.
    left_open: usize,
    vertices: usize,
    triangles: usize,
    closed: bool,
    area: f64,
    /// Meaningless unless the mesh is closed; negative when its normals point inward.
    volume: f64,
    milliseconds: Times,
}

/// A hole that was closed.
#[derive(Serialize)]
struct Hole {
    rim_edges: usize,
    /// A point of the rim.
    at: [f32; 3],
    triangles: usize,
    inserted_vertices: usize,
    planar: bool,
    faired: bool,
    /// Whether the patch passes through itself, as it must where its rim crosses itself in a plane.
    self_crossing: bool,
    /// Triangles without area.
    flat_triangles: usize,
    /// Others with an angle below 5 degrees.
    slivers: usize,
    min_angle_deg: f64,
    median_angle_deg: f64,
    mean_edge: f64,
    target: f64,
}

/// Time of each stage \[ms\].
#[derive(Serialize)]
struct Times {
    read: f64,
    fill: f64,
    write: f64,
}

/// Fills and writes.
pub(crate) fn run(
    arguments: &FillArguments,
    teller: &mut Teller<impl Write>,
) -> Result<(), Failure> {
    let (input, output) = (&arguments.input, &arguments.output);
    let write = writer(output)?;
    let progress = teller.stages(3);
    progress.begin("read");
    let (read, surface) = timed(|| {
        let data = read_mesh(input)?;
        data.into_open_surface().map_err(|source| Failure::NotFit {
            path: input.clone(),
            source,
        })
    });
    let (mut surface, warnings) = surface?;
    check_target(output, input)?;
    progress.step();
    progress.begin("fill");
    let triangles_before = surface.topology().triangle_count();
    let params = HoleParams {
        level: arguments.level,
        fair: arguments.fair,
        max_edges: arguments.max_edges.unwrap_or(usize::MAX),
        max_triangles: arguments.max_triangles,
        ..HoleParams::default()
    };
    let (fill, filled) = timed(|| fill_holes(&mut surface, &params));
    let filled = filled.map_err(|source| Failure::Fill {
        path: input.clone(),
        source,
    })?;
    progress.step();
    progress.begin("write");
    let (write, written) = timed(|| write(output, &surface));
    written?;
    progress.end();
    let report = Report {
        input: input.clone(),
        output: output.clone(),
        level: arguments.level.z(),
        fair: arguments.fair,
        triangles_before,
        warnings,
        holes: filled.holes.iter().map(|h| Hole::of(h, &surface)).collect(),
        left_open: filled.left_open,
        vertices: surface.topology().vertices().count(),
        triangles: surface.topology().triangle_count(),
        closed: surface.topology().is_closed(),
        area: surface.area(),
        volume: surface.volume(),
        milliseconds: Times {
            read: milliseconds(read),
            fill: milliseconds(fill),
            write: milliseconds(write),
        },
    };
    Ok(teller.report(&report, arguments.json, print)?)
}

/// Writes a mesh in one of the formats.
type Writer = fn(&Path, &Surface) -> Result<(), WriteError>;

/// What writes a file of this name.
fn writer(path: &Path) -> Result<Writer, Failure> {
    let extension = path
        .extension()
        .map(|e| e.to_string_lossy().to_ascii_lowercase());
    match extension.as_deref() {
        Some("obj") => Ok(write_obj),
        Some("ply") => Ok(write_ply),
        _ => Err(Failure::OutputFormat {
            path: path.to_owned(),
        }),
    }
}

impl Hole {
    fn of(hole: &FilledHole, surface: &Surface) -> Self {
        let [x, y, z, _] = surface.positions[hole.vertex.index()];
        Self {
            rim_edges: hole.rim,
            at: [x, y, z],
            triangles: hole.triangles.len(),
            inserted_vertices: hole.inserted,
            planar: hole.planar,
            faired: hole.faired,
            self_crossing: hole.self_crossing,
            flat_triangles: hole.flat,
            slivers: hole.slivers,
            min_angle_deg: hole.angles.min,
            median_angle_deg: hole.angles.median,
            mean_edge: hole.mean_edge,
            target: hole.target,
        }
    }
}

fn print(report: &Report, out: &mut impl Write) -> io::Result<()> {
    writeln!(
        out,
        "{}: {} triangles, {} holes closed, {} left open",
        report.input.display(),
        report.triangles_before,
        report.holes.len(),
        report.left_open
    )?;
    for warning in &report.warnings {
        writeln!(out, "  {warning}")?;
    }
    for hole in &report.holes {
        writeln!(
            out,
            "  {} edges at {:?}: {} triangles{}{}{}, smallest angle {:.1}, median {:.1} degrees, edges {:.2} times the target",
            hole.rim_edges,
            hole.at,
            hole.triangles,
            if hole.planar { ", plane" } else { "" },
            if hole.faired { ", faired" } else { "" },
            if hole.self_crossing {
                ", crosses itself"
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
                "    {} of them have no area: the rim lies on a line or doubles back there; weld its vertices or remodel it",
                hole.flat_triangles
            )?;
        }
        if hole.slivers > 0 {
            writeln!(
                out,
                "    {} of them are slivers with an angle below 5 degrees",
                hole.slivers
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
        "  {}: {} vertices, {} triangles, area {:.6e}, {state}",
        report.output.display(),
        report.vertices,
        report.triangles,
        report.area
    )?;
    let t = &report.milliseconds;
    writeln!(
        out,
        "  ms: read {:.2}, fill {:.2}, write {:.2}",
        t.read, t.fill, t.write
    )
}
