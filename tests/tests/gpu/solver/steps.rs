//! GPU steps with all features match CPU steps bit for bit on a strict adapter.

use incise_mesh::{Surface, VertexId};
use incise_models::{Model, build_model};
use incise_pbd_gpu::{Context, GpuBackend, Material, Schedule, Solver, SolverParams, Volume};
use incise_test_support::cpu_gpu_pair::{DT, solver_for, with_most_features};
use incise_test_support::params::set_ground;
use incise_test_support::surfaces::scaled;

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

fn equal_in_more_substeps(context: Context, factors: [f32; 3], pressure: f32, schedule: Schedule) {
    let (mut on_cpu, mut cpu) = small_body(factors, pressure, schedule);
    let (mut on_gpu, mut solver) = small_body(factors, pressure, schedule);
    let height = on_cpu.bounds().min[1] - 0.005;
    for solver in [&mut cpu, &mut solver] {
        set_ground(solver, height);
    }
    let params = SolverParams::paper();
    let mut gpu = GpuBackend::from_context(context).expect("a device");
    gpu.force_schedule(Some(schedule));
    let body = gpu.add(&on_gpu, &mut solver).expect("room");
    // A larger body that is stepped beside it takes the given substeps.
    let (large, mut of_large) = set_up(Model::Sphere80, schedule, &Material::default());
    let beside = gpu.add(&large, &mut of_large).expect("room");
    for _ in 0..8 {
        cpu.step(&mut on_cpu, DT, &params).expect("a step");
        let bodies = [(body, &mut solver), (beside, &mut of_large)];
        gpu.step(bodies, DT, &params).expect("a step");
    }
    assert_eq!(of_large.substeps(), 1);
    gpu.read(body, &mut on_gpu, &mut solver).expect("a state");
    assert!(cpu.substeps() > 1);
    assert_eq!(cpu.substeps(), solver.substeps());
    assert!(bits(&on_cpu) == bits(&on_gpu));
    let strain = cpu.stretch_error(&on_cpu);
    assert!(strain < 0.05, "the ground flattens it: strain {strain}");
}

/// All features of the solver with moving pins, and bodies so small that they get more substeps.
pub(crate) fn to_the_bit(context: Context) {
    let [whole, patches] = [Schedule::WholeBody, Schedule::Patches];
    for (model, schedule, frames) in [
        (Model::Sphere80, whole, 30),
        (Model::Sphere768, whole, 10),
        (Model::Sphere768, patches, 20),
        (Model::Octopus, patches, 3),
    ] {
        equal(context.clone(), model, schedule, frames);
    }
    let ball = [0.01; 3];
    for (factors, pressure, schedule) in [
        (ball, 1.0, patches),
        (ball, 1.02, whole),
        (ball, 0.98, patches),
        ([0.01, 1e-5, 0.01], 1.0, whole),
    ] {
        equal_in_more_substeps(context.clone(), factors, pressure, schedule);
    }
}
