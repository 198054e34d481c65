//! Pins that contradict each other.

use super::case::{Case, Worst};
use super::error::StressError;
use super::runner::Runner;
use super::scenes::{FRAME, HANGING, elastic_shell};
use incise_mesh::VertexId;
use incise_models::sheet;
use incise_pbd_gpu::Material;

pub(super) const CASES: [Case; 1] = [Case {
    id: "contradiction",
    stress: "two pins 10 times as far apart as the sheet is wide, then one let go",
    invariant: "largest strain 10 s after",
    bound: 0.05,
    run: contradiction,
}];

/// The upper corners of a sheet of 8 times 8 squares.
const CORNERS: [VertexId; 2] = [VertexId(0), VertexId(8)];

fn contradiction(runner: &mut Runner) -> Result<Worst, StressError> {
    let mut worst = Worst::default();
    for (name, material) in [
        ("PBD", Material::default()),
        ("compliance 0", elastic_shell(0.0, 0.0)),
        ("compliance 1e-6", elastic_shell(1e-6, 1e-3)),
    ] {
        let mut body = runner.enter(sheet([8, 8], [1.0, 1.0]), &material)?;
        let mut run = || -> Result<f64, StressError> {
            for v in CORNERS {
                body.solver.pin(&mut body.surface, v)?;
            }
            body.solver.set_pin_target(CORNERS[1], [10.0, 0.0, 0.0])?;
            body.advance(FRAME, &HANGING, 600)?;
            body.solver.unpin(&mut body.surface, CORNERS[1])?;
            body.advance(FRAME, &HANGING, 600)?;
            Ok(body.largest_strain())
        };
        let outcome = run();
        worst.judge(outcome, || name.to_owned());
    }
    Ok(worst)
}
