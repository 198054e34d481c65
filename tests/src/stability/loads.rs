//! A ribbon with loads of up to a million times a vertex's mass.

use super::motions::{ENERGY, whole};
use super::runner::{Body, Runner};
use super::{Case, Found, Run};
use incise_mesh::{Vec3, VertexId};
use incise_models::scenes::FRAME;
use incise_models::{pose, sheet};
use incise_pbd_gpu::{Material, Solver, SolverParams};
use incise_test_support::energy::Limits;
use incise_test_support::materials::elastic_shell;
use incise_test_support::params::TEN_ITERATIONS;

pub(super) const CASES: [Case; 3] = [
    Case {
        id: "T3",
        stress: "load on a swinging ribbon, 1 to 1e6 times a vertex",
        invariants: &[ENERGY],
        run: loads,
    },
    Case {
        id: "T3",
        stress: "load on a hanging ribbon, 1 to 1e6 times a vertex",
        invariants: &[("mean strain after 10 s", 0.05)],
        run: stretched_by_loads,
    },
    Case {
        id: "map",
        stress: "a swinging ribbon over time steps, compliances and loads",
        invariants: &[ENERGY],
        run: map,
    },
];

/// Squares of the ribbon, from its pinned end to its load.
const SQUARES: u32 = 10;
/// Loads of the ribbon, in masses of a vertex inside.
const LOADS: [f32; 7] = [1.0, 10.0, 1e2, 1e3, 1e4, 1e5, 1e6];

/// A ribbon of a meter pinned at its upper end, level if it is to swing. The two vertices of its
/// lower end have `load` times the mass of a vertex inside.
fn ribbon<'a>(runner: &'a Runner, material: &Material, load: f32, level: bool) -> Found<Body<'a>> {
    let mut surface = sheet([1, SQUARES], [0.1, 1.0]);
    if level {
        pose(&mut surface, |p| Vec3::new(p.x, 0.0, p.y));
    }
    let mut solver = Solver::new(&mut surface, material)?;
    for v in [0, 1].map(VertexId) {
        solver.pin(&mut surface, v)?;
    }
    let inside = solver.masses()[SQUARES as usize];
    for v in [2 * SQUARES, 2 * SQUARES + 1].map(VertexId) {
        solver.set_mass(&mut surface, v, inside * load)?;
    }
    runner.body_with(surface, solver)
}

/// Shells of a loaded ribbon; it is right that the last one stretches.
fn loaded() -> [(&'static str, Material); 3] {
    [
        ("stiffness 1", Material::default()),
        ("compliance 0", elastic_shell(0.0, 0.1)),
        ("compliance 1e-6", elastic_shell(1e-6, 0.1)),
    ]
}

fn loads(runner: &Runner) -> Vec<Run> {
    let mut runs = Vec::new();
    for load in LOADS {
        for (k, (name, material)) in loaded().into_iter().enumerate() {
            let limits = Limits::above(-1.0).within(10.0).recovering_if(k < 2);
            let found = ribbon(runner, &material, load, true)
                .and_then(|mut body| body.energy_over(FRAME, &TEN_ITERATIONS, 600, limits));
            runs.push(Run::new(format!("{load:e}, {name}"), found));
        }
    }
    runs
}

fn stretched_by_loads(runner: &Runner) -> Vec<Run> {
    let mut runs = Vec::new();
    for load in LOADS {
        for (name, material) in &loaded()[..2] {
            let found = ribbon(runner, material, load, false).and_then(|mut body| {
                let limits = Limits::above(-2.0).within(2.0);
                let found = body.energy_over(FRAME, &TEN_ITERATIONS, 600, limits)?;
                Ok(found.within_energy(body.solver.stretch_error(&body.surface)))
            });
            runs.push(Run::new(format!("{load:e}, {name}"), found));
        }
    }
    runs
}

/// The stability map: time steps of half orders of magnitude, compliances of whole ones, and loads.
fn map(runner: &Runner) -> Vec<Run> {
    let params = SolverParams {
        iterations: 1,
        ..TEN_ITERATIONS
    };
    let rows: Vec<(f32, i32)> = [1.0, 1e3, 1e6]
        .into_iter()
        .flat_map(|load| (2..=10).map(move |rate| (load, rate)))
        .collect();
    let found = runner.each(&rows, |&(load, rate)| {
        let dt = 10.0_f32.powf(-0.5 * rate as f32);
        // A quarter of a swing at least.
        let frames = 200.max(whole(0.5 / dt));
        let cell = |compliance: i32| {
            let material = elastic_shell(10.0_f32.powi(compliance), 0.1);
            let found = ribbon(runner, &material, load, true)
                .and_then(|mut body| body.energy_over(dt, &params, frames, Limits::above(-1.0)));
            let steps = 10.0_f64.powf(f64::from(rate) / 2.0);
            let at = format!("1/{steps:.0} s, 1e{compliance} m/N, load {load:e}");
            Run::new(at, found)
        };
        (-12..=2).map(cell).collect::<Vec<Run>>()
    });
    found.into_iter().flatten().collect()
}
