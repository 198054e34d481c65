//! GPU steps match CPU steps bit for bit on a strict adapter, in every schedule.

use incise_mesh::{Surface, VertexId};
use incise_models::{Model, build_model};
use incise_pbd_gpu::{Context, GpuBackend, Material, Schedule, Solver, SolverParams, Volume};
use incise_test_support::cpu_gpu_pair::{DT, SCHEDULES, solver_for, with_most_features};
use incise_test_support::gpu::{Needs, trial};
use incise_test_support::surfaces::scaled;
use libtest_mimic::Trial;

/// A body and its solver with a few pins on the move.
fn set_up(model: Model, schedule: Schedule, material: &Material) -> (Surface, Solver) {
    let mut surface = build_model(model);
    let mut solver = solver_for(&mut surface, material, schedule);
    for v in [0, 5].map(VertexId) {
        solver.pin(&mut surface, v).expect("a model's vertex");
    }
    (surface, solver)
}

fn bits(surface: &Surface) -> Vec<[u32; 3]> {
    let bits = |p: &[f32; 4]| [p[0], p[1], p[2]].map(f32::to_bits);
    surface.positions().iter().map(bits).collect()
}

fn equal(context: Context, model: Model, schedule: Schedule, frames: u32) {
    let (material, params) = with_most_features();
    let (mut on_cpu, mut cpu) = set_up(model, schedule, &material);
    let (mut on_gpu, mut solver) = set_up(model, schedule, &material);
    let mut gpu = GpuBackend::from_context(context).expect("a device");
    gpu.force_schedule(Some(schedule));
    let body = gpu.add(&on_gpu, &mut solver).expect("room");
    assert_eq!(gpu.schedule(body), Ok(schedule));
    for frame in 0..frames {
        let target = [0.1, 0.01 * frame as f32, 0.0];
        for solver in [&mut cpu, &mut solver] {
            solver.set_pin_target(VertexId(5), target).expect("pinned");
        }
        cpu.step(&mut on_cpu, DT, &params).expect("a step");
        gpu.step([(body, &mut solver)], DT, &params)
            .expect("a step");
        if frame % 10 == 0 || frame + 1 == frames {
            gpu.read(body, &mut on_gpu, &mut solver).expect("a state");
            assert!(
                bits(&on_cpu) == bits(&on_gpu),
                "positions differ in frame {frame}"
            );
            assert!(
                cpu.velocities() == solver.velocities(),
                "velocities differ in frame {frame}"
            );
        }
    }
}

/// A ball of 1 cm, which falls by more than an edge in a substep of the paper's parameters, or a
/// chip that is thinner than its fall.
fn small_body(factors: [f32; 3], pressure: f32, schedule: Schedule) -> (Surface, Solver) {
    let mut surface = scaled(build_model(Model::Sphere80), factors);
    let material = Material {
        volume: Some(Volume {
            pressure,
            ..Volume::default()
        }),
        ..Material::default()
    };
    let solver = solver_for(&mut surface, &material, schedule);
    (surface, solver)
}

fn equal_in_more_substeps(
    context: Context,
    (factors, pressure): ([f32; 3], f32),
    schedule: Schedule,
) {
    let (mut on_cpu, mut cpu) = small_body(factors, pressure, schedule);
    let (mut on_gpu, mut solver) = small_body(factors, pressure, schedule);
    let params = SolverParams {
        ground: Some(on_cpu.bounds().min[1] - 0.005),
        ..SolverParams::paper()
    };
    let mut gpu = GpuBackend::from_context(context).expect("a device");
    gpu.force_schedule(Some(schedule));
    let body = gpu.add(&on_gpu, &mut solver).expect("room");
    // A larger body that is stepped beside it takes the given substeps.
    let (large, mut of_large) = set_up(Model::Sphere80, schedule, &Material::default());
    let beside = gpu.add(&large, &mut of_large).expect("room");
    for _ in 0..60 {
        cpu.step(&mut on_cpu, DT, &params).expect("a step");
        let bodies = [(body, &mut solver), (beside, &mut of_large)];
        gpu.step(bodies, DT, &params).expect("a step");
    }
    assert_eq!(of_large.substeps(), params.substeps);
    gpu.read(body, &mut on_gpu, &mut solver).expect("a state");
    assert!(cpu.substeps() > params.substeps);
    assert_eq!(cpu.substeps(), solver.substeps());
    assert!(bits(&on_cpu) == bits(&on_gpu));
    let strain = cpu.stretch_error(&on_cpu);
    assert!(strain < 0.05, "the ground flattens it: strain {strain}");
}

pub(crate) fn trials() -> Vec<Trial> {
    let mut trials = Vec::new();
    for schedule in SCHEDULES {
        for (body, factors, pressure) in [
            ("ball", [0.01; 3], 1.0),
            ("inflated ball", [0.01; 3], 1.02),
            ("deflated ball", [0.01; 3], 0.98),
            ("chip", [0.01, 1e-5, 0.01], 1.0),
        ] {
            let name = format!("a {body} of 1 cm by {}", schedule.name());
            trials.push(trial(&name, Needs::Strict, move |context| {
                equal_in_more_substeps(context, (factors, pressure), schedule);
            }));
        }
    }
    for (model, frames) in [
        (Model::Sphere20, 120),
        (Model::Sphere80, 60),
        (Model::Sphere768, 20),
        (Model::Octopus, 3),
    ] {
        for schedule in SCHEDULES {
            let name = format!("{} by {}", model.name(), schedule.name());
            trials.push(trial(&name, Needs::Strict, move |context| {
                equal(context, model, schedule, frames);
            }));
        }
    }
    trials
}
