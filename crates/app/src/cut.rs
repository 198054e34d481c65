//! `incise cut`: cuts a mesh along a plane, a blade's sweep or its path, and writes the pieces.

mod print;

use crate::blade_path::BladePath;
use crate::clock::{milliseconds, timed};
use crate::cut_options::{CutOptions, CutPlan};
use crate::failure::Failure;
use crate::input::{InputOptions, boundary_edges, closed_volume, file_bounds};
use crate::json::{all_lossy, lossy};
use crate::pieces::{OutputOptions, Piece};
use crate::reporter::Reporter;
use crate::stroke::{Stroke, cut_along_path};
use incise_mesh::geometry::is_flat;
use incise_mesh::{AngleStats, Surface, TriangleId, Warning};
use print::print;
use serde::Serialize;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Cuts a mesh along a plane, a blade's sweep or its path, and writes its pieces.
///
/// Writes one component per file: `DIR/piece_000.obj` and so on, or all of them as the nodes of
/// one file of glTF. Files of these names from an earlier run are overwritten or removed. A refused
/// cut writes nothing. A part with a boundary is a sheet: it is cut without caps, see --caps.
#[derive(clap::Args)]
#[command(
    group = clap::ArgGroup::new("cutter").required(true).args(["plane", "blade", "path"]),
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
    /// Move a blade through the mesh, pose by pose. The cut may end inside (exact method).
    ///
    /// Each line of the file is a pose, x y z of every point of the blade's edge: two for a
    /// straight blade, more for a curved one, the same number on every line. Numbers are separated
    /// by spaces, and # starts a comment. Where the blade stops inside the body, the cut has two
    /// walls that coincide. Motions of less than half an edge length inside the body add up.
    #[arg(long, value_name = "FILE")]
    path: Option<PathBuf>,
    #[command(flatten)]
    output: OutputOptions,
}

const AFTER_HELP: &str = "\
Examples:
  Two halves of a built-in model:
    incise cut Bunny --plane 0,1,0.2,0.05 -o pieces
  A blade's edge along the z axis that moves along x, caps refined with shorter edges:
    incise cut scan.ply --blade -1,0,-1,-1,0,1 --to 1,0,-1,1,0,1 --level 1.5x-finer -o pieces
  A cut into a ball that stops at its center: a blade along the z axis in three poses:
    printf '%s\\n' '-1 0 -1 -1 0 1' '-0.4 0 -1 -0.4 0 1' '0 0 -1 0 0 1' > knife.txt
    incise cut Sphere768 --path knife.txt -o pieces
  A scan with holes, with caps where the cut is a closed curve:
    incise cut scan.ply --plane 0,1,0,0.4 --caps all-loops -o pieces
  Exact volumes, a report for a script:
    incise cut part.stl --plane 1,0.1,0,0.037 --snap 0 --json -o pieces

Levels (--level), ratio of a cap's edge length to that of the surface at the rim:
  2x-coarser = 2, 1.5x-coarser = 1.5, original = 1, 1.5x-finer = 0.667, 2x-finer = 0.5

JSON report (--json), lengths in the input's unit:
  input, method, refine_method, snap, remesh, level, grading
                         the input and the parameters of the cut
  warnings               repairs made while reading, attributes that are dropped
  caps                   curves of the cut that get caps: bodies, all-loops or none
  triangles, boundary_edges, volume
                         of the input; volume of its closed parts
  triangles_hit, loops   triangles that the sweep crosses; 0 if it misses; loops of the section
  snapped_vertices, merged_points, short_rim_edges
                         vertices moved into the rim, points merged, rim edges left short (--snap)
  flipped_edges, collapsed_vertices, collapsed_points, moved_surface
                         changes by --remesh, and the largest distance that the surface moved
  moved_volume           volume moved across the sweep by --snap and --remesh
  cap_triangles, cap_flat_triangles, cap_min_angle_deg, cap_median_angle_deg
                         triangles of the caps, those without area, their angles [degrees]
  steps, cutting_steps   with --path, else null: motions from pose to pose, and those that cut;
                         counts and times of the cut are sums over all steps
  tips                   with --path: vertices of the tip in the body at the end; 0 outside
  wall_triangles         with --path: triangles of the walls at the end, as cap_triangles
  pieces                 file, vertices, triangles, area, volume, cavity, boundary_edges and
                         euler_characteristic of each piece
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
    /// Edges of the input with one triangle.
    boundary_edges: usize,
    caps: &'static str,
    /// Of closed parts of the input.
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
    /// Motions of the blade from pose to pose; none without a path.
    steps: Option<usize>,
    /// Steps that cut.
    cutting_steps: Option<usize>,
    /// Vertices of the tip at the end.
    tips: Option<usize>,
    /// Triangles of walls and caps at the end.
    wall_triangles: Option<usize>,
    pieces: Vec<Piece>,
    /// Removed pieces of an earlier run.
    #[serde(serialize_with = "all_lossy")]
    removed: Vec<PathBuf>,
    milliseconds: Times,
}

impl Report {
    /// Returns the noun for a triangle on a side of the cut.
    fn cap_noun(&self) -> &'static str {
        match self.steps {
            Some(_) => "wall triangle",
            None => "cap triangle",
        }
    }
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
    let blade_path = arguments.blade_path(options)?;
    let progress = reporter.stages(3);
    progress.begin("read");
    let (read, surface) = timed(|| arguments.reading.read_for_cut(path, options.is_exact()));
    let (mut surface, mut warnings) = surface?;
    progress.step();
    for warning in &warnings {
        progress.suspend(|| reporter.warn(format_args!("{}: {warning}", path.display())));
    }
    progress.begin("cut");
    let (triangles, volume) = (surface.topology().triangle_count(), closed_volume(&surface));
    let boundary_edges = boundary_edges(&surface);
    let Stroke {
        report: counts,
        walls,
        cutting_steps,
        tips,
        bvh_build,
    } = match &blade_path {
        Some((file, blade_path)) => {
            cut_along_path(&mut surface, blade_path, &options.params(), file)?
        }
        None => cut_once(options, &mut surface, path)?,
    };
    let params = options.params();
    let cap = AngleStats::from_triangles(walls.iter().map(|&t| surface.triangle_positions(t)));
    let is_flat = |&&t: &&TriangleId| is_flat(surface.triangle_positions(t));
    let flat = walls.iter().filter(is_flat).count();
    progress.step();
    progress.begin("write");
    let (write, written) = timed(|| arguments.output.write(&[(&surface, path)]));
    let written = written?;
    progress.end();
    for warning in &written.warnings {
        reporter.warn(format_args!(
            "{}: {warning}",
            arguments.output.path().display()
        ));
    }
    warnings.extend(written.warnings);
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
        boundary_edges,
        caps: options.caps().name(),
        volume,
        triangles_hit: counts.hits,
        loops: counts.loops,
        snapped_vertices: counts.snapped_vertices,
        merged_points: counts.merged_nodes,
        short_rim_edges: counts.short_rim_edges,
        flipped_edges: counts.flipped_edges,
        collapsed_vertices: counts.collapsed_vertices,
        collapsed_points: counts.collapsed_nodes,
        moved_surface: counts.moved_surface,
        moved_volume: counts.moved_volume,
        cap_triangles: walls.len(),
        cap_flat_triangles: flat,
        cap_min_angle_deg: cap.min,
        cap_median_angle_deg: cap.median,
        steps: blade_path.as_ref().map(|(_, path)| path.len() - 1),
        cutting_steps: blade_path.as_ref().map(|_| cutting_steps),
        tips: blade_path.as_ref().map(|_| tips),
        wall_triangles: blade_path.as_ref().map(|_| walls.len()),
        pieces: written.pieces.into_iter().map(|(_, piece)| piece).collect(),
        removed: written.removed,
        milliseconds: Times {
            read: milliseconds(read),
            bvh_build: milliseconds(bvh_build),
            bvh_update: milliseconds(counts.bvh_update),
            detection: milliseconds(counts.detection),
            split: milliseconds(counts.split),
            remeshing: milliseconds(counts.remeshing),
            cap: milliseconds(counts.cap),
            refinement: milliseconds(counts.refinement),
            separation: milliseconds(counts.separation),
            commit: milliseconds(counts.commit),
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

impl CutArguments {
    /// Reads the path of the blade, if the command line names one.
    fn blade_path(&self, options: CutPlan<'_>) -> Result<Option<(&Path, BladePath)>, Failure> {
        let Some(file) = self.path.as_deref() else {
            return Ok(None);
        };
        if !options.is_exact() {
            return Err(Failure::NotWith {
                option: "--path",
                with: "--method paper, which has no cuts that end inside the body",
            });
        }
        Ok(Some((file, BladePath::read(file)?)))
    }
}

/// Cuts along the planes or the sweep of the command line.
fn cut_once(options: CutPlan<'_>, surface: &mut Surface, input: &Path) -> Result<Stroke, Failure> {
    let sweeps = options.sweeps(surface, input)?;
    options.cut(surface, &sweeps, input)
}
