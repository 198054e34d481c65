//! `incise-bench refine`: time and quality of the section meshes (caps) that cuts need.

use crate::measure::{Budget, mean, measure, median, percentile, sorted};
use crate::options::{ModelArguments, OutputArguments};
use crate::output::Output;
use crate::workload::{Workload, workloads};
use clap::Args;
use incise_cut::{CutParams, Cutter};
use incise_mesh::Surface;
use incise_models::scenes::RelativePlane;
use incise_refine::{
    RefineError, RefineParams, RefinementLevel, Section, SectionMesh, SectionMeshParams,
    SectionMeshScratch, SectionMeshSize, triangulate_section,
};
use serde::Serialize;
use std::error::Error;
use std::io::Write;

/// Triangulates cross-sections of models at several levels.
///
/// Points, triangles and times are medians over sections; times are those of the fastest of five
/// repetitions. Angles are the smallest of every triangle, in degrees, over all meshes: minimum,
/// minimum of sections without a corner below 40 degrees, 5th percentile, that of the worst mesh,
/// and median. Edges are inner edges over their target lengths: mean, maximum, and the number above
/// 1.8. `middle` is the plane through the middle, `seeded` are seeded planes.
#[derive(Args, Clone)]
pub(crate) struct RefineArguments {
    #[command(flatten)]
    models: ModelArguments,
    /// Number of seeded planes per model, besides the one through the middle.
    #[arg(long, value_name = "N", default_value_t = 100)]
    planes: u32,
    /// Omit larger models.
    #[arg(long, value_name = "N", default_value_t = 200_000)]
    max_triangles: usize,
    /// Refinement levels, separated by commas: the five names, or numbers z.
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "2x-coarser,1.5x-coarser,original,1.5x-finer,2x-finer"
    )]
    levels: Vec<RefinementLevel>,
    #[command(flatten)]
    parameters: Parameters,
    #[command(flatten)]
    output: OutputArguments,
}

/// The parameters of all rows.
#[derive(Args, Clone, Copy, Debug, Serialize)]
struct Parameters {
    /// Growth of the target edge length per meter of distance from the boundary.
    #[arg(long, default_value_t = RefineParams::default().grading)]
    grading: f64,
    /// Shortest edges along the boundary, in local edge lengths.
    #[arg(long, default_value_t = 0.1)]
    snap: f64,
    /// Seed of the planes.
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// Measures all workloads, prints and writes the rows.
pub(crate) fn run(arguments: &RefineArguments, out: &mut dyn Write) -> Result<(), Box<dyn Error>> {
    let workloads = workloads(&arguments.models, arguments.max_triangles)?;
    let mut output = Output::open("refine", &arguments.output, arguments.parameters, out)?;
    let (mut failed, mut meshes) = (0, 0);
    output.start(workloads.len(), 1);
    for workload in &workloads {
        output.progress.begin(&workload.name);
        for row in rows(workload, arguments)? {
            failed += row.failures.len();
            meshes += row.meshes;
            output.row(&workload.name, &row)?;
        }
        output.progress.step();
    }
    output.table()?;
    output.print(format_args!(
        "Failed: {failed} of {} sections.",
        meshes + failed
    ))?;
    match failed {
        0 => Ok(()),
        failed => Err(format!("{failed} sections could not be cut or triangulated").into()),
    }
}

/// Repetitions per section; the fastest counts.
const REPEATS: u32 = 5;

/// Smallest boundary angle of sections whose smallest triangle angle counts: sharper corners limit
/// the angle of any mesh \[degrees\].
const FREE_ANGLE: f64 = 40.0;

/// A section with the target edge length at its points \[m\].
struct CutSection {
    points: Vec<[f64; 2]>,
    loops: Vec<Vec<u32>>,
    lengths: Vec<f64>,
}

/// Section meshes of one model at one level.
#[derive(Debug, Default, Serialize)]
struct Row {
    source: String,
    /// `middle`: the plane through the middle; `seeded`: seeded planes.
    planes: &'static str,
    /// Refinement level z.
    level: f64,
    meshes: usize,
    rim_points: f64,
    triangles: f64,
    triangulation_ms: f64,
    refinement_ms: f64,
    million_triangles_a_second: f64,
    smallest_angle: f64,
    /// Of sections without a corner below 40 degrees.
    smallest_angle_free: f64,
    rim_angle: f64,
    angle_5: f64,
    angle_5_worst: f64,
    angle_median: f64,
    edge_mean: f64,
    edge_longest: f64,
    long_edges: usize,
    /// Errors of sections that could not be cut or triangulated.
    failures: Vec<String>,
}

/// Cuts a workload by the plane through its middle and by seeded ones, at every level, and
/// triangulates the sections.
///
/// # Errors
/// An error of building the workload or of an undo, or [`RefineError`] of a section; errors of cuts
/// are recorded.
fn rows(workload: &Workload, arguments: &RefineArguments) -> Result<Vec<Row>, Box<dyn Error>> {
    let parameters = &arguments.parameters;
    let mut surface = workload.surface()?;
    let mut cutter = Cutter::new(&surface);
    let mut rows = Vec::new();
    for &level in &arguments.levels {
        let params = CutParams {
            snap: parameters.snap,
            refine: RefineParams {
                level,
                grading: parameters.grading,
                ..RefineParams::default()
            },
            ..CutParams::default()
        };
        let middle = vec![RelativePlane::middle()];
        let seeded = RelativePlane::seeded(parameters.seed, arguments.planes);
        for (name, planes) in [("middle", middle), ("seeded", seeded)] {
            if planes.is_empty() {
                continue;
            }
            let (mut sections, mut failures) = (Vec::new(), Vec::new());
            for plane in planes {
                match cut_once(&mut surface, &mut cutter, &plane, &params)? {
                    Ok(found) => sections.extend(found),
                    Err(failure) => failures.push(failure),
                }
            }
            rows.push(Row {
                source: workload.source.clone(),
                planes: name,
                level: level.z(),
                ..triangulate_all(&sections, failures, parameters)?
            });
        }
    }
    Ok(rows)
}

/// Cuts along a plane and undoes it; none where the plane misses. The inner error is the cut's.
fn cut_once(
    surface: &mut Surface,
    cutter: &mut Cutter,
    plane: &RelativePlane,
    params: &CutParams,
) -> Result<Result<Option<CutSection>, String>, Box<dyn Error>> {
    let (sweep, d) = plane.sweep(surface)?;
    let outcome = match cutter.cut(surface, &sweep, params) {
        Ok(outcome) => outcome,
        Err(error) => return Ok(Err(format!("{error} (normal {:?}, d {d})", plane.normal))),
    };
    let Some(undo) = outcome.undo else {
        return Ok(Ok(None));
    };
    let (section, lengths) = cutter.sections().next().ok_or("a cut has a section")?;
    let section = CutSection {
        points: section.points.to_vec(),
        loops: section.loops.to_vec(),
        lengths: lengths.to_vec(),
    };
    cutter.undo(surface, undo)?;
    Ok(Ok(Some(section)))
}

impl CutSection {
    fn section(&self) -> Section<'_> {
        Section {
            points: &self.points,
            loops: &self.loops,
        }
    }

    /// Returns the fastest of several times \[ms\], and the mesh.
    fn triangulate(
        &self,
        params: &SectionMeshParams<'_>,
        scratch: &mut SectionMeshScratch,
    ) -> Result<(f64, SectionMesh), RefineError> {
        let mut mesh = SectionMesh::default();
        let times = measure(&Budget::runs(REPEATS), |times| {
            let section = self.section();
            mesh = times.time(|| triangulate_section(&section, params, |_, _| false, scratch))?;
            Ok::<(), RefineError>(())
        })?;
        Ok((times.min() * 1e3, mesh))
    }
}

/// Triangulates every section; returns the row without source, planes and level.
fn triangulate_all(
    sections: &[CutSection],
    mut failures: Vec<String>,
    parameters: &Parameters,
) -> Result<Row, RefineError> {
    let mut scratch = SectionMeshScratch::default();
    let (mut triangulation, mut both) = (Vec::new(), Vec::new());
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    let (mut angles, mut edges, mut worst) = (Vec::new(), Vec::new(), f64::INFINITY);
    let (mut long_edges, mut rim_angle, mut free) = (0, f64::INFINITY, f64::INFINITY);
    for section in sections {
        let params = |size| SectionMeshParams {
            size,
            grading: parameters.grading,
            ..SectionMeshParams::default()
        };
        let target = params(SectionMeshSize::Local(&section.lengths));
        let (bare, _) = section.triangulate(&params(SectionMeshSize::Any), &mut scratch)?;
        let (whole, mesh) = section.triangulate(&target, &mut scratch)?;
        if let Err(error) = mesh.validate(&section.section(), 1e-6) {
            failures.push(error.to_string());
            continue;
        }
        let quality = mesh.quality(&section.section(), &target);
        triangulation.push(bare);
        both.push(whole);
        points.push(section.points.len() as f64);
        triangles.push(mesh.triangles.len() as f64);
        long_edges += quality.long_edges.len();
        rim_angle = rim_angle.min(quality.rim_angle);
        if quality.rim_angle >= FREE_ANGLE {
            free = free.min(quality.angles[0]);
        }
        worst = worst.min(percentile(&quality.angles, 5));
        angles.extend(quality.angles);
        edges.extend(quality.edges);
    }
    let (angles, edges) = (sorted(angles), sorted(edges));
    let seconds = both.iter().sum::<f64>() / 1e3;
    let refinement = both.iter().zip(&triangulation).map(|(a, b)| a - b);
    Ok(Row {
        meshes: both.len(),
        rim_points: median(points),
        million_triangles_a_second: triangles.iter().sum::<f64>() / seconds / 1e6,
        triangles: median(triangles),
        refinement_ms: median(refinement.collect()),
        triangulation_ms: median(triangulation),
        smallest_angle: percentile(&angles, 0),
        smallest_angle_free: free,
        rim_angle,
        angle_5: percentile(&angles, 5),
        angle_5_worst: worst,
        angle_median: percentile(&angles, 50),
        edge_mean: mean(&edges),
        edge_longest: percentile(&edges, 100),
        long_edges,
        failures,
        ..Row::default()
    })
}
