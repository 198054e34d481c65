//! `incise cut`: cuts meshes along planes, a blade's sweep or its path, and writes the pieces.

mod print;

use crate::blade_path::BladePath;
use crate::clock::timed;
use crate::cut_method::MethodOptions;
use crate::cut_options::{CutOptions, CutPlan};
use crate::failure::Failure;
use crate::input::{InputOptions, boundary_edges, closed_volume, file_bounds};
use crate::json::{all_lossy, lossy};
use crate::pieces::{OutputOptions, Piece};
use crate::reporter::Reporter;
use crate::stroke::{CutSums, cut_along_path};
use incise_cut::CutReport;
use incise_mesh::geometry::is_flat;
use incise_mesh::{AngleStats, Surface, TriangleId, Warning};
use incise_progress::Progress;
use print::print;
use serde::Serialize;
use std::fmt::Display;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Cuts meshes along planes, a blade's sweep or its path, and writes their pieces.
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
    /// Meshes (obj, ply, stl, glb or gltf), or built-in models such as Bunny. All get the same cut.
    #[arg(value_name = "FILE|MODEL", required = true)]
    inputs: Vec<PathBuf>,
    #[command(flatten)]
    reading: InputOptions,
    #[command(flatten)]
    cut: CutOptions,
    #[command(flatten)]
    method: MethodOptions,
    /// Move a blade through the mesh, pose by pose. The cut may end inside.
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
  All parts of an assembly along one plane, into one file:
    incise cut arm.obj hand.obj --plane 1,0,0,0.2 -o cut.glb
  Exact volumes, a report for a script:
    incise cut part.stl --plane 1,0.1,0,0.037 --snap 0 --json -o pieces

Levels (--level), ratio of a cap's edge length to that of the surface at the rim:
  2x-coarser = 2, 1.5x-coarser = 1.5, original = 1, 1.5x-finer = 0.667, 2x-finer = 0.5

JSON report (--json), a list of reports for several inputs, lengths in the input's unit:
  input, method, snap, remesh, level, grading
                         the input and the parameters of the cut; the paper's method has no
                         snap, remesh and grading: null
  warnings               repairs made while reading, attributes that are dropped
  caps                   curves of the cut that get caps: bodies, all-loops or none
  triangles, boundary_edges, volume
                         of the input; volume of its closed parts
  missed_planes          numbers of the planes that miss, from 1
  cut                    counts and times [s] of the cut, see docs/parameters.md: hits, the
                         triangles that the sweep crosses, 0 if it misses; loops, merged_points,
                         moved_volume, seconds and others
  cap_triangles, cap_flat_triangles, cap_min_angle_deg, cap_median_angle_deg
                         triangles of the caps, those without area, their angles [degrees]
  steps, cutting_steps   with --path, else null: motions from pose to pose, and those that cut;
                         those of `cut` are sums over all steps
  tips                   with --path: vertices of the tip in the body at the end; 0 outside
  wall_triangles         with --path: triangles of the walls at the end, as cap_triangles
  pieces                 file, vertices, triangles, area, volume, cavity, boundary_edges and
                         euler_characteristic of each piece
  removed                pieces of an earlier run that were removed
  seconds                time of the other stages; `write` and `removed` are those of all inputs

Exit code 4: the cut misses all meshes, and the pieces are those of the uncut meshes.";

/// The report as JSON.
#[derive(Serialize)]
struct Report {
    #[serde(serialize_with = "lossy")]
    input: PathBuf,
    method: &'static str,
    /// Of the exact method only, as are `remesh` and `grading`.
    snap: Option<f64>,
    remesh: Option<f64>,
    level: f64,
    grading: Option<f64>,
    /// Repairs made while reading.
    warnings: Vec<Warning>,
    triangles: usize,
    /// Edges of the input with one triangle.
    boundary_edges: usize,
    caps: &'static str,
    /// Of closed parts of the input.
    volume: f64,
    /// Numbers of the planes that miss, from 1.
    missed_planes: Vec<usize>,
    /// Sums over all planes or steps.
    cut: CutReport,
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
    seconds: Times,
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

/// Times of the stages beside the cut \[s\].
#[derive(Serialize)]
struct Times {
    read: f64,
    bvh_build: f64,
    write: f64,
}

/// A mesh after the cut, with its report except for the files.
struct CutMesh {
    surface: Surface,
    report: Report,
}

/// Runs the command.
pub(crate) fn run(
    arguments: &CutArguments,
    reporter: &mut Reporter<impl Write>,
) -> Result<(), Failure> {
    let options = arguments.method.plan(&arguments.cut)?;
    let blade_path = arguments.blade_path(options)?;
    let stages = u32::try_from(2 * arguments.inputs.len() + 1);
    let progress = reporter.stages(stages.unwrap_or(u32::MAX));
    let mut meshes = Vec::with_capacity(arguments.inputs.len());
    for path in &arguments.inputs {
        let blade_path = blade_path.as_ref();
        meshes.push(arguments.cut_mesh(path, options, blade_path, reporter, &progress)?);
    }
    progress.begin("write");
    let bodies = meshes.iter().zip(&arguments.inputs);
    let bodies: Vec<_> = bodies
        .map(|(mesh, path)| (&mesh.surface, path.as_path()))
        .collect();
    let (write, written) = timed(|| arguments.output.write(&bodies));
    let written = written?;
    progress.end();
    for warning in &written.warnings {
        let output = arguments.output.path().display();
        reporter.warn(format_args!("{output}: {warning}"));
    }
    for mesh in &mut meshes {
        mesh.report.warnings.extend_from_slice(&written.warnings);
        mesh.report.removed.clone_from(&written.removed);
        mesh.report.seconds.write = write.as_secs_f64();
    }
    for (i, piece) in written.pieces {
        meshes[i].report.pieces.push(piece);
    }
    let reports: Vec<&Report> = meshes.iter().map(|mesh| &mesh.report).collect();
    match *reports {
        [report] => reporter.report(report, print)?,
        _ => reporter.report(&reports, |reports, out| {
            reports.iter().try_for_each(|report| print(report, out))
        })?,
    }
    if let [first, ..] = &*meshes
        && meshes.iter().all(|mesh| mesh.report.cut.hits == 0)
    {
        return Err(Failure::Missed {
            path: first.report.input.clone(),
            bounds: file_bounds(&first.surface),
            output: "the files hold the uncut mesh",
        });
    }
    Ok(())
}

impl CutArguments {
    /// Reads and cuts one of the inputs.
    fn cut_mesh(
        &self,
        path: &Path,
        options: CutPlan<'_>,
        blade_path: Option<&(&Path, BladePath)>,
        reporter: &Reporter<impl Write>,
        progress: &Progress,
    ) -> Result<CutMesh, Failure> {
        progress.begin("read");
        let (read, surface) = timed(|| self.reading.read_for_cut(path, options.is_exact()));
        let (mut surface, warnings) = surface?;
        progress.step();
        let warn = |message: &dyn Display| {
            let path = path.display();
            progress.suspend(|| reporter.warn(format_args!("{path}: {message}")));
        };
        warnings.iter().for_each(|warning| warn(warning));
        progress.begin("cut");
        let (triangles, volume) = (surface.topology().triangle_count(), closed_volume(&surface));
        let boundary_edges = boundary_edges(&surface);
        let params = options.params();
        let CutSums {
            stroke,
            walls,
            missed,
            bvh_build,
        } = match blade_path {
            Some((file, blade_path)) => cut_along_path(&mut surface, blade_path, &params, file)?,
            None => cut_once(options, &mut surface, path)?,
        };
        if stroke.report.hits > 0 {
            for plane in &missed {
                warn(&format_args!("plane {plane} misses the mesh"));
            }
        } else if self.inputs.len() > 1 {
            warn(&"the cut misses the mesh, whose files hold it uncut");
        }
        let cap = AngleStats::from_triangles(walls.iter().map(|&t| surface.triangle_positions(t)));
        let is_flat = |&&t: &&TriangleId| is_flat(surface.triangle_positions(t));
        let flat = walls.iter().filter(is_flat).count();
        progress.step();
        let report = Report {
            input: path.to_owned(),
            method: self.method.name(),
            snap: options.is_exact().then_some(params.snap),
            remesh: options.is_exact().then_some(params.remesh),
            level: params.refine.level.z(),
            grading: options.is_exact().then_some(params.refine.grading),
            warnings,
            triangles,
            boundary_edges,
            caps: params.caps.name(),
            volume,
            missed_planes: missed,
            cut: stroke.report,
            cap_triangles: walls.len(),
            cap_flat_triangles: flat,
            cap_min_angle_deg: cap.min,
            cap_median_angle_deg: cap.median,
            steps: blade_path.map(|(_, path)| path.len() - 1),
            cutting_steps: blade_path.map(|_| stroke.cutting_steps),
            tips: blade_path.map(|_| stroke.tip_vertices),
            wall_triangles: blade_path.map(|_| walls.len()),
            pieces: Vec::new(),
            removed: Vec::new(),
            seconds: Times {
                read: read.as_secs_f64(),
                bvh_build: bvh_build.as_secs_f64(),
                write: 0.0,
            },
        };
        Ok(CutMesh { surface, report })
    }

    /// Reads the path of the blade, if the command line names one.
    fn blade_path(&self, options: CutPlan<'_>) -> Result<Option<(&Path, BladePath)>, Failure> {
        let Some(file) = self.path.as_deref() else {
            return Ok(None);
        };
        if !options.is_exact() {
            return Err(Failure::NotWith {
                option: "--path".to_owned(),
                with: "--method paper, which has no cuts that end inside the body",
            });
        }
        Ok(Some((file, BladePath::read(file)?)))
    }
}

/// Cuts along the planes or the sweep of the command line.
fn cut_once(options: CutPlan<'_>, surface: &mut Surface, input: &Path) -> Result<CutSums, Failure> {
    let sweeps = options.sweeps(surface, input)?;
    options.cut(surface, &sweeps, input)
}
