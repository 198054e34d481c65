//! `incise cut`: a mesh along a plane or a blade's sweep, one file a piece.

use crate::clock::{milliseconds, timed};
use crate::cut_options::CutOptions;
use crate::failure::Failure;
use crate::json::{all_lossy, lossy};
use crate::pieces::{self, Piece};
use crate::teller::Teller;
use incise_mesh::geometry::is_flat;
use incise_mesh::{AngleStats, TriangleId, Warning, read_mesh};
use serde::Serialize;
use std::io::{self, Write};
use std::path::PathBuf;

/// Cuts a mesh along a plane or a blade's sweep and writes its pieces.
///
/// They go to `DIR/piece_000.obj` and on, one closed component a file. Files of that name from an earlier run are
/// overwritten, and removed where there are fewer pieces now. A cut that is refused writes nothing and leaves them as they are.
#[derive(clap::Args)]
#[command(group = clap::ArgGroup::new("cutter").required(true).args(["plane", "blade"]))]
pub(crate) struct CutArguments {
    /// The mesh: obj, ply, stl, glb or gltf.
    input: PathBuf,
    #[command(flatten)]
    cut: CutOptions,
    /// Where the pieces go.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Print JSON.
    #[arg(long)]
    json: bool,
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
pub(crate) fn run(
    arguments: &CutArguments,
    teller: &mut Teller<impl Write>,
) -> Result<(), Failure> {
    let path = &arguments.input;
    let options = arguments.cut.check()?;
    let progress = teller.stages(3);
    progress.begin("read");
    let (read, surface) = timed(|| {
        let data = read_mesh(path)?;
        data.into_surface().map_err(|source| Failure::NotFit {
            path: path.clone(),
            source,
        })
    });
    let (mut surface, warnings) = surface?;
    progress.step();
    for warning in &warnings {
        // Without an error output only the JSON tells.
        let _ = progress.aside(|| writeln!(io::stderr(), "incise: {}: {warning}", path.display()));
    }
    progress.begin("cut");
    let (triangles, volume) = (surface.topology().triangle_count(), surface.volume());
    let sweep = options.sweep(&surface)?;
    let cut = options.cut(&mut surface, &sweep, path)?;
    let (outcome, params) = (cut.outcome, options.params());
    let cap = AngleStats::of(outcome.cap.iter().map(|&t| surface.triangle_positions(t)));
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
        snap: params.snap,
        remesh: params.remesh,
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
            search_tree: milliseconds(cut.search_tree),
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
    let told = teller.report(&report, arguments.json, |report, out| {
        print(report, options.is_exact(), out)
    });
    Ok(told?)
}

fn print(report: &Report, is_exact: bool, out: &mut impl Write) -> io::Result<()> {
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
