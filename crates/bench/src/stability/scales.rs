//! Bodies of millimeters to kilometers, next to the origin and far from it.

use super::case::{Case, Worst, larger};
use super::energy::{Limits, energy_over};
use super::error::StressError;
use super::runner::Runner;
use super::scenes::{FRAME, GROUND, HANGING, ball, elastic_shell, place};
use incise_mesh::geometry::to_f32;
use incise_mesh::{Aabb, Vec3, VertexId, icosphere, nearby_origin};
use incise_pbd_gpu::{Material, SolverParams, Stiffness};

pub(super) const CASES: [Case; 2] = [
    Case {
        id: "T8",
        stress: "bodies of 1 mm to 1 km",
        invariant: "largest energy, relative to the start",
        bound: 1.01,
        run: scales,
    },
    Case {
        id: "T8",
        stress: "fall of 1 s at 1e4 and 1e6 m from the origin, 60 and 1200 substeps a second",
        invariant: "relative error of the distance",
        bound: 1e-3,
        run: far,
    },
];

fn scales(runner: &mut Runner) -> Result<Worst, StressError> {
    let mut worst = Worst::default();
    let frames = runner.pick(300, 600);
    for exponent in (-3..=3).step_by(runner.pick(3, 1)) {
        let scale = 10.0_f64.powi(exponent);
        for (name, material) in [
            ("PBD", Material::default()),
            ("compliance 0", elastic_shell(0.0, 0.0)),
            ("compliance 1e-5", elastic_shell(1e-5, 1e-2)),
        ] {
            let mut surface = ball(1, 0.6);
            place(&mut surface, |p| p * scale);
            let mut body = runner.enter(surface, &material)?;
            // The ball of 1 km (1e-5 m/N) is strained by 5.8 % at rest, with 1 to 256 substeps
            // alike: all of its weight would stretch an edge by its own length.
            let weight = 9.81
                * body
                    .solver
                    .masses()
                    .iter()
                    .map(|&m| f64::from(m))
                    .sum::<f64>();
            let stretch = match material.stretch {
                Stiffness::Compliance(c) => weight * f64::from(c) / body.solver.mean_rest_length(),
                Stiffness::Pbd(_) => 0.0,
            };
            let limits = Limits::above(0.0).within(5.0 * scale);
            let limits = limits.recovering_if(stretch < 0.5);
            let outcome = energy_over(&mut body, FRAME, &GROUND, frames, limits);
            worst.judge(outcome, || format!("1e{exponent} m, {name}"));
        }
    }
    Ok(worst)
}

/// Returns the relative error of a free fall: `n (n + 1) / 2 g h^2` after `n` steps.
fn fall(runner: &mut Runner, distance: f64, substeps: u32) -> Result<f64, StressError> {
    let mut surface = icosphere(0, 0.5);
    // Positions are relative to the origin that a mesh gets which is read at this distance.
    let away = |p: Vec3| p + Vec3::repeat(distance);
    let vertices = surface.topology().vertices();
    let bounds = Aabb::around(vertices.map(|v| to_f32(away(surface.position(v)))));
    surface.set_origin(nearby_origin(&bounds));
    let origin = Vec3::from(surface.origin());
    place(&mut surface, |p| away(p) - origin);
    let start: Vec<f64> = surface.positions().iter().map(|p| p[1].into()).collect();
    let mut body = runner.enter(surface, &elastic_shell(1e3, 1e3))?;
    let params = SolverParams {
        iterations: 1,
        substeps,
        ..HANGING
    };
    body.advance(FRAME, &params, 60)?;
    let (n, h) = (
        60.0 * f64::from(substeps),
        f64::from(FRAME) / f64::from(substeps),
    );
    let way = 9.81 * h * h * n * (n + 1.0) / 2.0;
    let fallen = |v: VertexId| start[v.index()] - body.surface.position(v).y;
    let all = body.surface.topology().vertices();
    Ok(all.map(|v| (fallen(v) / way - 1.0).abs()).fold(0.0, larger))
}

fn far(runner: &mut Runner) -> Result<Worst, StressError> {
    let mut worst = Worst::default();
    for distance in [1e4, 1e6] {
        for substeps in [1, 20] {
            let outcome = fall(runner, distance, substeps);
            worst.judge(outcome, || {
                format!("{distance:e} m, {} substeps a second", 60 * substeps)
            });
        }
    }
    Ok(worst)
}
