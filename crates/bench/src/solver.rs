//! The solver alone: projections a second, and frames a second of both kinds.

use crate::{SolverArguments, machine, models};
use incise_mesh::Surface;
use incise_pbd_gpu::{ConstraintError, Material, Solver, SolverParams, StepError};
use std::error::Error;
use std::io::Write;
use std::time::Instant;

/// Iterations of a measured frame.
const ITERATIONS: u32 = 10;

/// Measures and prints.
pub(crate) fn run(arguments: &SolverArguments, out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    writeln!(out, "{}, commit {}", machine::machine(), machine::commit())?;
    let stretch_only = Material {
        bending: None,
        ..Material::default()
    };
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let models = models::load(arguments.from.models.as_deref(), &arguments.only)?;
    let used = models.iter().map(|l| (l.model.name(), l.source.as_str()));
    models::tell_built_in(arguments.from.models.as_deref(), used);
    for loaded in models {
        writeln!(
            out,
            "{} ({}), {} triangles, {ITERATIONS} iterations, fastest of {} frames",
            loaded.model.name(),
            loaded.source,
            loaded.surface.topology().triangle_count(),
            arguments.frames
        )?;
        for threads in [1, cores] {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()?;
            for (name, material) in [
                ("stretch", stretch_only),
                ("stretch and bending", Material::default()),
            ] {
                let (seconds, projections) =
                    pool.install(|| measure(&loaded.surface, &material, arguments.frames))?;
                writeln!(
                    out,
                    "  {threads} threads, {name:20} {:8.3} ms a frame, {:6.1} FPS, {:6.1} M projections/s",
                    seconds * 1e3,
                    1.0 / seconds,
                    projections / seconds / 1e6
                )?;
            }
        }
    }
    Ok(())
}

/// Why a model cannot be measured.
#[derive(Debug, thiserror::Error)]
enum MeasureError {
    #[error(transparent)]
    Constraint(#[from] ConstraintError),
    #[error(transparent)]
    Step(#[from] StepError),
}

/// The fastest frame's time \[s\] and its projections.
fn measure(
    surface: &Surface,
    material: &Material,
    frames: u32,
) -> Result<(f64, f64), MeasureError> {
    let mut surface = surface.clone();
    let mut solver = Solver::new(&mut surface, material)?;
    let params = SolverParams {
        iterations: ITERATIONS,
        ..SolverParams::paper()
    };
    let mut best = f64::INFINITY;
    for _ in 0..frames {
        let begin = Instant::now();
        solver.step(&mut surface, 1.0 / 60.0, &params)?;
        best = best.min(begin.elapsed().as_secs_f64());
    }
    let stats = solver.stats();
    let projections = stats.stretch_projections + stats.bending_projections;
    #[expect(
        clippy::cast_precision_loss,
        reason = "a frame has far fewer than 2^53 projections"
    )]
    Ok((best, projections as f64))
}
