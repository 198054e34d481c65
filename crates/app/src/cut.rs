//! `incise cut`: a mesh along a plane or a blade's sweep, one file a piece.

use crate::clock::{milliseconds, timed};
use crate::failure::Failure;
use crate::json::{all_lossy, lossy};
use crate::numbers::{Numbers, numbers};
use crate::pieces::{self, Piece};
use clap::ValueEnum;
use incise_cut::{CutError, CutMethod, CutParams, Cutter, Sweep, starts_inside};
use incise_mesh::geometry::area_vector;
use incise_mesh::geometry::is_flat;
use incise_mesh::{AngleStats, Surface, TriangleId, Warning, read_mesh};
use incise_refine::{RefineMethod, RefineParams, RefinementLevel};
use serde::Serialize;
use std::io::{self, Write};
use std::path::PathBuf;

/// Cuts a mesh and writes its pieces to `DIR/piece_000.obj` and on, one closed component a file. Files of
/// that name from an earlier run are overwritten, and removed where there are fewer pieces now. A cut that is refused
/// writes nothing and leaves them as they are.
#[derive(clap::Args)]
#[command(group = clap::ArgGroup::new("cutter").required(true).args(["plane", "blade"]))]
pub(crate) struct CutArguments {
    /// The mesh: obj, ply, stl, glb or gltf.
    input: PathBuf,
    /// Cut along the plane `nx x + ny y + nz z = d`.
    #[arg(long, value_name = "NX,NY,NZ,D", value_parser = numbers::<4>, allow_hyphen_values = true)]
    plane: Option<Numbers<4>>,
    /// Cut along the sweep of a blade's edge: from here, start and end ...
    ///
    /// The sweep is two triangles. Where the four corners do not lie in one plane it is folded along the diagonal from
    /// the start of --blade to the end of --to.
    #[arg(long, value_name = "X,Y,Z,X,Y,Z", value_parser = numbers::<6>, allow_hyphen_values = true, requires = "to")]
    blade: Option<Numbers<6>>,
    /// ... to here, in the same order.
    #[arg(long, value_name = "X,Y,Z,X,Y,Z", value_parser = numbers::<6>, allow_hyphen_values = true, requires = "blade", conflicts_with = "plane")]
    to: Option<Numbers<6>>,
    /// How fine caps get: 2x-coarser, 1.5x-coarser, original, 1.5x-finer, 2x-finer, or z times the surface's edges.
    /// The rim's own edges stay, so a small cap has little to make coarser.
    #[arg(long, default_value = "original")]
    level: RefinementLevel,
    /// The exact method: by how much the caps' edges get longer with every unit off the rim. 0 keeps the
    /// surface's edge length at the rim to the middle; 0.3 makes caps that cost their outline and not their area.
    /// [default: 0]
    #[arg(long, value_name = "G", value_parser = grading, allow_hyphen_values = true)]
    grading: Option<f64>,
    /// Refuse the cut when a cap needs more triangles than this.
    #[arg(long, value_name = "N", default_value_t = RefineParams::default().max_triangles)]
    max_triangles: usize,
    /// How the mesh is opened.
    #[arg(long, value_enum, default_value_t = Method::Exact)]
    method: Method,
    /// How caps are refined; by default `delaunay` with the exact method and `paper` with `rebuild`, which knows no other.
    #[arg(long, value_enum, value_name = "REFINEMENT")]
    refine_method: Option<Refinement>,
    /// The exact method: edges along the rim that are shorter than this part of the surface's edges are
    /// contracted. 0 keeps the exact geometry and leaves slivers, which a solver pays for; below 0.5.
    /// [default: 0.1]
    #[arg(long, value_name = "S", value_parser = snap, allow_hyphen_values = true)]
    snap: Option<f64>,
    /// The exact method: slivers that the blade leaves in the old surface beside the rim go, where the surface moves by no
    /// more than this part of its edges for that. 0 leaves them, 0.1 about halves them; below 0.5.
    /// [default: 0]
    #[arg(long, value_name = "T", value_parser = remesh, allow_hyphen_values = true)]
    remesh: Option<f64>,
    /// Where the pieces go.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, ValueEnum)]
enum Method {
    /// Split the hit triangles along the sweep and close any cross-section: no surface is lost.
    Exact,
    /// The paper's: delete the hit triangles, rebuild the rim, patch and refine the hole.
    Rebuild,
}

impl Method {
    fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Rebuild => "rebuild",
        }
    }
}

#[derive(Clone, Copy, ValueEnum)]
enum Refinement {
    /// A core of equilateral triangles and a band around it.
    Delaunay,
    /// The paper's: ears cut off, then triangles divided and edges swapped. One edge length for each part of the section.
    Paper,
}

impl Refinement {
    fn name(self) -> &'static str {
        match self {
            Self::Delaunay => "delaunay",
            Self::Paper => "paper",
        }
    }
}

/// A share of an edge, from 0 up to 0.5.
fn snap(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|s| (0.0..0.5).contains(s));
    number.ok_or_else(|| String::from("snap is a part of an edge: at least 0 and below 0.5"))
}

/// A share of an edge, from 0 up to 0.5.
fn remesh(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|t| (0.0..0.5).contains(t));
    number.ok_or_else(|| String::from("remesh is a part of an edge: at least 0 and below 0.5"))
}

/// How targets grow: nothing or more.
fn grading(text: &str) -> Result<f64, String> {
    let number = text
        .parse()
        .ok()
        .filter(|g: &f64| *g >= 0.0 && g.is_finite());
    number.ok_or_else(|| String::from("a grading is 0 or a positive number"))
}

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
    /// What was repaired or passed over when the mesh was read.
    warnings: Vec<Warning>,
    triangles: usize,
    volume: f64,
    triangles_hit: usize,
    loops: usize,
    /// The exact method: vertices of the mesh that were taken into the rim.
    snapped_vertices: usize,
    /// The exact method: intersection points that were merged into others.
    merged_points: usize,
    /// The exact method: rim edges that stay shorter than asked for.
    short_rim_edges: usize,
    /// The exact method: edges beside the rim that remeshing flipped.
    flipped_edges: usize,
    /// The exact method: vertices beside the rim that remeshing contracted onto others.
    collapsed_vertices: usize,
    /// The exact method: intersection points that remeshing merged into others.
    collapsed_points: usize,
    /// The exact method: no point of the surface was moved farther by remeshing, in the input's unit.
    moved_surface: f64,
    /// The exact method: what snapping and remeshing moved, in cubes of the input's unit.
    moved_volume: f64,
    cap_triangles: usize,
    /// Triangles of the caps without area.
    cap_flat_triangles: usize,
    cap_min_angle_deg: f64,
    cap_median_angle_deg: f64,
    pieces: Vec<Piece>,
    /// Pieces of an earlier run that are there no more.
    #[serde(serialize_with = "all_lossy")]
    removed: Vec<PathBuf>,
    milliseconds: Times,
}

/// Time of each stage \[ms\].
#[derive(Serialize)]
struct Times {
    read: f64,
    search_tree: f64,
    search_tree_update: f64,
    detection: f64,
    split: f64,
    remeshing: f64,
    cap: f64,
    refinement: f64,
    separation: f64,
    commit: f64,
    write: f64,
}

/// Cuts and writes.
pub(crate) fn run(arguments: &CutArguments, out: &mut impl Write) -> Result<(), Failure> {
    let refinement = arguments.check()?;
    let path = &arguments.input;
    let (read, surface) = timed(|| {
        let data = read_mesh(path)?;
        data.into_surface().map_err(|source| Failure::NotFit {
            path: path.clone(),
            source,
        })
    });
    let (mut surface, warnings) = surface?;
    for warning in &warnings {
        // Without an error output only the JSON tells.
        let _ = writeln!(io::stderr(), "incise: {}: {warning}", path.display());
    }
    let (triangles, volume) = (surface.topology().triangle_count(), surface.volume());
    let sweep = arguments.sweep(&surface).map_err(Failure::Sweep)?;
    if crosses_itself(&sweep) {
        return Err(Failure::SweepCrossesItself);
    }
    let params = CutParams {
        method: match arguments.method {
            Method::Exact => CutMethod::Exact,
            Method::Rebuild => CutMethod::Rebuild,
        },
        snap: arguments.snap.unwrap_or(CutParams::default().snap),
        remesh: (arguments.remesh).unwrap_or(CutParams::default().remesh),
        refine: RefineParams {
            method: match refinement {
                Refinement::Delaunay => RefineMethod::Delaunay,
                Refinement::Paper => RefineMethod::Paper,
            },
            level: arguments.level,
            grading: arguments.grading.unwrap_or_default(),
            max_triangles: arguments.max_triangles,
            ..RefineParams::default()
        },
        ..CutParams::default()
    };
    let (search_tree, mut cutter) = timed(|| Cutter::new(&surface));
    let outcome = cutter
        .cut(&mut surface, &sweep, &params)
        .map_err(|source| Failure::Cut {
            path: path.clone(),
            source,
        })?;
    if outcome.report.hits == 0 && starts_inside(&surface, &sweep) {
        return Err(Failure::SweepInside { path: path.clone() });
    }
    let cap = AngleStats::of(outcome.cap.iter().map(|&t| surface.triangle_positions(t)));
    let is_flat = |&&t: &&TriangleId| is_flat(surface.triangle_positions(t));
    let flat = outcome.cap.iter().filter(is_flat).count();
    let (write, written) = timed(|| pieces::write(&surface, path, &arguments.output));
    let written = written?;
    let report = Report {
        input: path.clone(),
        method: arguments.method.name(),
        refine_method: refinement.name(),
        snap: params.snap,
        remesh: params.remesh,
        level: arguments.level.z(),
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
            search_tree: milliseconds(search_tree),
            search_tree_update: milliseconds(outcome.report.search_tree),
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
    if arguments.json {
        serde_json::to_writer_pretty(&mut *out, &report).map_err(io::Error::from)?;
        writeln!(out)?;
    } else {
        print(&report, out)?;
    }
    Ok(())
}

impl CutArguments {
    /// How caps are refined, if the options go together.
    fn check(&self) -> Result<Refinement, Failure> {
        let refuse = |option, with| Err(Failure::NotWith { option, with });
        let rebuild = "--method rebuild";
        match (self.method, self.refine_method) {
            (Method::Rebuild, _) if self.snap.is_some() => refuse("--snap", rebuild),
            (Method::Rebuild, _) if self.remesh.is_some() => refuse("--remesh", rebuild),
            (Method::Rebuild, _) if self.grading.is_some() => refuse("--grading", rebuild),
            (Method::Rebuild, Some(Refinement::Delaunay)) => refuse(
                "--refine-method delaunay",
                "--method rebuild, whose refinement is the paper's",
            ),
            (Method::Rebuild, _) => Ok(Refinement::Paper),
            (Method::Exact, Some(Refinement::Paper)) if self.grading.is_some() => refuse(
                "--grading",
                "--refine-method paper, which has one edge length for each part of the section",
            ),
            (Method::Exact, given) => Ok(given.unwrap_or(Refinement::Delaunay)),
        }
    }

    fn sweep(&self, surface: &Surface) -> Result<Sweep, CutError> {
        if let Some(Numbers([x, y, z, d])) = self.plane {
            return Sweep::across_box([x, y, z], d, &surface.bounds());
        }
        let edge = |numbers: Option<Numbers<6>>| {
            let Numbers([a, b, c, d, e, f]) = numbers.unwrap_or(Numbers([0.0; 6]));
            [[a, b, c], [d, e, f]].map(|p| incise_mesh::geometry::round(p.into()))
        };
        Sweep::new(edge(self.blade), edge(self.to))
    }
}

/// Cosine of the angle between the normals of a sweep's triangles from which on they lie on each other: a
/// blade that bends that much has its ends exchanged.
const FOLDED: f64 = -0.999;

/// Whether the sweep's two triangles lie on each other. They could be cut along, but what was meant is the
/// blade's way without the crossing.
fn crosses_itself(sweep: &Sweep) -> bool {
    let [first, second] = sweep.triangles().map(area_vector);
    first.dot(&second) < FOLDED * first.norm() * second.norm()
}

fn print(report: &Report, out: &mut impl Write) -> io::Result<()> {
    writeln!(
        out,
        "{}: {} triangles, volume {:.6e}",
        report.input.display(),
        report.triangles,
        report.volume
    )?;
    if report.triangles_hit == 0 {
        writeln!(out, "  the cut misses the mesh")?;
    } else {
        writeln!(
            out,
            "  {} triangles hit in {} loops; {} cap triangles, smallest angle {:.1}, median {:.1} degrees",
            report.triangles_hit,
            report.loops,
            report.cap_triangles,
            report.cap_min_angle_deg,
            report.cap_median_angle_deg
        )?;
        if report.cap_flat_triangles > 0 {
            writeln!(
                out,
                "  {} cap triangles have no area: the cut passes a vertex by a hair; move the plane or the blade a little",
                report.cap_flat_triangles
            )?;
        }
        let is_exact = report.method == Method::Exact.name();
        if is_exact && report.snap > 0.0 {
            writeln!(
                out,
                "  snap {}: {} vertices and {} points moved; {} short rim edges left",
                report.snap, report.snapped_vertices, report.merged_points, report.short_rim_edges
            )?;
        }
        if is_exact && report.remesh > 0.0 {
            writeln!(
                out,
                "  remesh {}: {} edges flipped, {} vertices and {} rim points contracted; the surface moved by {:.1e} at most",
                report.remesh,
                report.flipped_edges,
                report.collapsed_vertices,
                report.collapsed_points,
                report.moved_surface
            )?;
        }
        if is_exact && report.snap.max(report.remesh) > 0.0 {
            writeln!(out, "  volume {:.1e} moved", report.moved_volume)?;
        }
    }
    writeln!(
        out,
        "  {} pieces, {} method, {} refinement",
        report.pieces.len(),
        report.method,
        report.refine_method
    )?;
    pieces::print(&report.pieces, &report.removed, out)?;
    let t = &report.milliseconds;
    writeln!(
        out,
        "  ms: read {:.2}, search tree {:.2} and {:.2}, detection {:.2}, split {:.2}, remeshing {:.2}, cap {:.2}, refinement {:.2}, separation {:.2}, commit {:.2}, write {:.2}",
        t.read,
        t.search_tree,
        t.search_tree_update,
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
