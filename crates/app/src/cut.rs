//! `incise cut`: cuts a mesh along a plane or a blade's sweep and writes one file per piece.

use crate::clock::{milliseconds, timed};
use crate::cut_options::CutOptions;
use crate::failure::Failure;
use crate::input::{InputOptions, file_bounds};
use crate::json::{all_lossy, lossy};
use crate::numbers::counted;
use crate::pieces::{self, Piece, output_path};
use crate::reporter::Reporter;
use incise_mesh::geometry::is_flat;
use incise_mesh::{AngleStats, TriangleId, Warning};
use serde::Serialize;
use std::io::{self, Write};
use std::path::PathBuf;

/// Cuts a mesh along a plane or a blade's sweep and writes its pieces.
///
/// Writes one closed component per file: `DIR/piece_000.obj` and so on. Files of these
/// names from an earlier run are overwritten or removed. A refused cut writes nothing.
#[derive(clap::Args)]
#[command(
    group = clap::ArgGroup::new("cutter").required(true).args(["plane", "blade"]),
    after_long_help = AFTER_HELP
)]
pub(crate) struct CutArguments {
    /// The mesh (obj, ply, stl, glb or gltf), or a built-in model such as Bunny.
    #[arg(value_name = "FILE|MODEL")]
    input: PathBuf,
    #[command(flatten)]
    reading: InputOptions,
    #[command(flatten)]
    cut: CutOptions,
    /// The folder for the pieces.
    #[arg(short, long, value_name = "DIR", value_parser = output_path())]
    output: PathBuf,
}

const AFTER_HELP: &str = "\
Examples:
  Two halves of a built-in model:
    incise cut Bunny --plane 0,1,0.2,0.05 -o pieces
  A blade's edge along the z axis that moves along x, caps refined with shorter edges:
    incise cut scan.ply --blade -1,0,-1,-1,0,1 --to 1,0,-1,1,0,1 --level 1.5x-finer -o pieces
  Exact volumes, a report for a script:
    incise cut part.stl --plane 1,0.1,0,0.037 --snap 0 --json -o pieces

Levels (--level), ratio of a cap's edge length to that of the surface at the rim:
  2x-coarser = 2, 1.5x-coarser = 1.5, original = 1, 1.5x-finer = 0.667, 2x-finer = 0.5

JSON report (--json), lengths in the input's unit:
  input, method, refine_method, snap, remesh, level, grading
                         the input and the parameters of the cut
  warnings               repairs made while reading
  triangles, volume      of the input
  triangles_hit, loops   triangles that the sweep crosses; 0 if it misses; loops of the section
  snapped_vertices, merged_points, short_rim_edges
                         vertices moved into the rim, points merged, rim edges left short (--snap)
  flipped_edges, collapsed_vertices, collapsed_points, moved_surface
                         changes by --remesh, and the largest distance that the surface moved
  moved_volume           volume moved across the sweep by --snap and --remesh
  cap_triangles, cap_flat_triangles, cap_min_angle_deg, cap_median_angle_deg
                         triangles of the caps, those without area, their angles [degrees]
  pieces                 file, vertices, triangles, area, volume, cavity of each piece
  removed                pieces of an earlier run that were removed
  milliseconds           time of each stage

Exit code 4: the cut misses the mesh, and the pieces are those of the uncut mesh.";

/// The report as JSON.
#[derive(Serialize)]
struct Report {
    #[serde(serialize_with = "lossy")]
    input: PathBuf,
    method: &'static str,
    refine_method: &'static str,
    snap: f64,
    remesh: f64,
    level: f64,
    grading: f64,
    /// Repairs made while reading.
    warnings: Vec<Warning>,
    triangles: usize,
    volume: f64,
    triangles_hit: usize,
    loops: usize,
    /// Vertices of the mesh that snapping moved into the rim.
    snapped_vertices: usize,
    /// Intersection points that snapping merged.
    merged_points: usize,
    /// Rim edges shorter than the snapping distance.
    short_rim_edges: usize,
    /// Edges that remeshing flipped.
    flipped_edges: usize,
    /// Vertices that remeshing contracted onto others.
    collapsed_vertices: usize,
    /// Rim points that remeshing merged.
    collapsed_points: usize,
    /// Largest distance that remeshing moved the surface, in the input's unit.
    moved_surface: f64,
    /// Volume moved by snapping and remeshing, in cubes of the input's unit.
    moved_volume: f64,
    cap_triangles: usize,
    /// Cap triangles without area.
    cap_flat_triangles: usize,
    cap_min_angle_deg: f64,
    cap_median_angle_deg: f64,
    pieces: Vec<Piece>,
    /// Removed pieces of an earlier run.
    #[serde(serialize_with = "all_lossy")]
    removed: Vec<PathBuf>,
    milliseconds: Times,
}

/// Times of the stages \[ms\].
#[derive(Serialize)]
struct Times {
    read: f64,
    bvh_build: f64,
    bvh_update: f64,
    detection: f64,
    split: f64,
    remeshing: f64,
    cap: f64,
    refinement: f64,
    separation: f64,
    commit: f64,
    write: f64,
}

/// Runs the command.
pub(crate) fn run(
    arguments: &CutArguments,
    reporter: &mut Reporter<impl Write>,
) -> Result<(), Failure> {
    let path = &arguments.input;
    let options = arguments.cut.check()?;
    let progress = reporter.stages(3);
    progress.begin("read");
    let (read, surface) = timed(|| arguments.reading.read_closed(path));
    let (mut surface, warnings) = surface?;
    progress.step();
    for warning in &warnings {
        progress.suspend(|| reporter.warn(format_args!("{}: {warning}", path.display())));
    }
    progress.begin("cut");
    let (triangles, volume) = (surface.topology().triangle_count(), surface.volume());
    let sweep = options.sweep(&surface, path)?;
    let cut = options.cut(&mut surface, &sweep, path)?;
    let (outcome, params) = (cut.outcome, options.params());
    let cap =
        AngleStats::from_triangles(outcome.cap.iter().map(|&t| surface.triangle_positions(t)));
    let is_flat = |&&t: &&TriangleId| is_flat(surface.triangle_positions(t));
    let flat = outcome.cap.iter().filter(is_flat).count();
    progress.step();
    progress.begin("write");
    let (write, written) = timed(|| pieces::write(&surface, path, &arguments.output));
    let written = written?;
    progress.end();
    let report = Report {
        input: path.clone(),
        method: options.method(),
        refine_method: options.refinement(),
        snap: options.exact().snap,
        remesh: options.exact().remesh,
        level: params.refine.level.z(),
        grading: params.refine.grading,
        warnings,
        triangles,
        volume,
        triangles_hit: outcome.report.hits,
        loops: outcome.report.loops,
        snapped_vertices: outcome.report.snapped_vertices,
        merged_points: outcome.report.merged_nodes,
        short_rim_edges: outcome.report.short_rim_edges,
        flipped_edges: outcome.report.flipped_edges,
        collapsed_vertices: outcome.report.collapsed_vertices,
        collapsed_points: outcome.report.collapsed_nodes,
        moved_surface: outcome.report.moved_surface,
        moved_volume: outcome.report.moved_volume,
        cap_triangles: outcome.cap.len(),
        cap_flat_triangles: flat,
        cap_min_angle_deg: cap.min,
        cap_median_angle_deg: cap.median,
        pieces: written.pieces,
        removed: written.removed,
        milliseconds: Times {
            read: milliseconds(read),
            bvh_build: milliseconds(cut.bvh_build),
            bvh_update: milliseconds(outcome.report.bvh_update),
            detection: milliseconds(outcome.report.detection),
            split: milliseconds(outcome.report.split),
            remeshing: milliseconds(outcome.report.remeshing),
            cap: milliseconds(outcome.report.cap),
            refinement: milliseconds(outcome.report.refinement),
            separation: milliseconds(outcome.report.separation),
            commit: milliseconds(outcome.report.commit),
            write: milliseconds(write),
        },
    };
    reporter.report(&report, |report, out| {
        print(report, options.is_exact(), out)
    })?;
    if report.triangles_hit == 0 {
        return Err(Failure::Missed {
            path: path.clone(),
            bounds: file_bounds(&surface),
            output: "the files hold the uncut mesh",
        });
    }
    Ok(())
}

fn print(report: &Report, is_exact: bool, out: &mut impl Write) -> io::Result<()> {
    writeln!(
        out,
        "{}: {}, volume {:.6e}",
        report.input.display(),
        counted(report.triangles, "triangle"),
        report.volume
    )?;
    if report.triangles_hit > 0 {
        writeln!(
            out,
            "  {} hit in {}; {}, smallest angle {:.1}, median {:.1} \
             degrees",
            counted(report.triangles_hit, "triangle"),
            counted(report.loops, "loop"),
            counted(report.cap_triangles, "cap triangle"),
            report.cap_min_angle_deg,
            report.cap_median_angle_deg
        )?;
        if report.cap_flat_triangles > 0 {
            writeln!(
                out,
                "  {} without area: the cut passes very close to a vertex; move the \
                 plane or the blade a little",
                counted(report.cap_flat_triangles, "cap triangle")
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
        "  {}, {} method, {} refinement",
        counted(report.pieces.len(), "piece"),
        report.method,
        report.refine_method
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
