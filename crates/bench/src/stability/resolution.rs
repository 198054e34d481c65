//! The same sheet of more and more triangles.

use super::case::{Case, Worst};
use super::failure::Failure;
use super::scenes::{FRAME, HANGING, sheet, whole};
use super::stage::Stage;
use incise_mesh::VertexId;
use incise_pbd_gpu::{Material, SolverParams, Stiffness};

pub(super) const CASES: [Case; 2] = [
    Case {
        id: "T4",
        torture: "a sheet of 200 to 1e6 triangles let down, substeps as its edges",
        law: "change of the sag from one to the next, of that before",
        bound: 1.0,
        run: sag,
    },
    Case {
        id: "T4",
        torture: "a sheet that does not stretch, 200 to 2e4 triangles, 10 iterations",
        law: "sag after 2 s of the height",
        bound: 0.05,
        run: fixed_iterations,
    },
];

/// How soft the sheet is [m/N], whatever its triangles are: a net of springs resists as its springs do.
const COMPLIANCE: f32 = 0.02;
/// How fast a wave crosses it [m/s]: the root of stiffness by mass an area.
const WAVE: f32 = 7.0;
/// How long it falls \[frames\].
const FRAMES: u32 = 15;

/// How far the lower edge of a sheet of a square meter has come down \[m\].
fn come_down(
    stage: &mut Stage,
    squares: u32,
    material: &Material,
    params: &SolverParams,
    frames: u32,
) -> Result<f64, Failure> {
    let mut mover = stage.enter(sheet([squares, squares], [1.0, 1.0])?, material)?;
    for v in (0..=squares).map(VertexId) {
        mover.solver.pin(&mut mover.surface, v)?;
    }
    mover.advance(FRAME, params, frames)?;
    let middle = VertexId(squares * (squares + 1) + squares / 2);
    Ok(-1.0 - mover.surface.position(middle).y)
}

fn sag(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    let material = Material {
        stretch: Stiffness::Compliance(COMPLIANCE),
        bending: None,
        ..Material::default()
    };
    let on_device = stage.device.is_some();
    let sizes: &[u32] = if on_device {
        // A device that is software takes minutes for more.
        stage.pick(&[10, 20, 40], &[10, 32, 100])
    } else {
        stage.pick(&[10, 20, 40], &[10, 32, 100, 316, 707])
    };
    let mut sags = Vec::new();
    for &squares in sizes {
        let params = SolverParams {
            iterations: 1,
            // No wave passes an edge unseen.
            substeps: whole(WAVE * squares as f32 * FRAME),
            ..HANGING
        };
        sags.push(come_down(stage, squares, &material, &params, FRAMES)?);
        if let [.., first, second, third] = sags[..] {
            let (before, now) = (second - first, third - second);
            worst.judge(Ok((now / before).abs()), || {
                format!("{} triangles: {third:.4} m", 2 * squares * squares)
            });
        }
    }
    Ok(worst)
}

fn fixed_iterations(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    let material = Material {
        bending: None,
        ..Material::default()
    };
    for &squares in stage.pick(&[10][..], &[10, 32, 100]) {
        let found = come_down(stage, squares, &material, &HANGING, 120).map(f64::abs);
        worst.judge(found, || format!("{} triangles", 2 * squares * squares));
    }
    Ok(worst)
}
