//! Kernels are compiled on first use, and steps are timed on request.

use incise_mesh::{Surface, VertexId};
use incise_pbd_gpu::{Context, GpuBackend, Material, Schedule, Solver, SolverParams, Stiffness};
use incise_test_support::cpu_gpu_pair::{DT, SCHEDULES, solver_for, with_most_features};
use incise_test_support::gpu::Needs;
use incise_test_support::params::set_ground;
use incise_test_support::surfaces::sphere;
use std::collections::BTreeSet;

/// Kernels of a body with stretch constraints only, with large and small colors.
const LEAST: [&str; 4] = ["integrate", "predict", "stretch", "tail"];

/// Kernels are compiled when a step first needs them, once per device; steps are timed.
pub(crate) fn compiled_and_timed(context: Context) {
    absent(fresh());
    comes(fresh());
    for schedule in SCHEDULES {
        of_schedule(fresh(), schedule);
    }
    timed(context);
}

/// Opens a device without kernels.
fn fresh() -> GpuBackend {
    GpuBackend::new(&Needs::AnyDevice.request()).expect("a device")
}

/// Returns a solver all of whose constraints are between patches.
fn undivided(surface: &mut Surface, material: &Material) -> Solver {
    Solver::with_patches(surface, material, None).expect("a valid body")
}

fn kernels(gpu: &GpuBackend) -> BTreeSet<&'static str> {
    gpu.kernels().collect()
}

/// Edges alone, and no multipliers.
fn bare() -> (Material, SolverParams) {
    let material = Material {
        bending: None,
        ..Material::default()
    };
    (material, SolverParams::paper())
}

fn absent(mut gpu: GpuBackend) {
    gpu.force_schedule(Some(Schedule::Patches));
    let (material, params) = bare();
    let mut surface = sphere(4, [0.0; 3]);
    let mut solver = undivided(&mut surface, &material);
    let body = gpu.add(&surface, &mut solver).expect("room");
    assert_eq!(kernels(&gpu), BTreeSet::new(), "nothing was stepped");
    let stats = *gpu
        .step([(body, &mut solver)], DT, &params)
        .expect("a step");
    let made = kernels(&gpu);
    assert!(made.is_subset(&LEAST.into()), "{made:?}");
    assert!(made.contains("stretch"), "{made:?}");
    assert_eq!(stats.kernels_compiled as usize, made.len());
    for _ in 0..3 {
        let stats = gpu
            .step([(body, &mut solver)], DT, &params)
            .expect("a step");
        assert_eq!(stats.kernels_compiled, 0);
    }
    assert_eq!(kernels(&gpu), made);
}

fn comes(mut gpu: GpuBackend) {
    gpu.force_schedule(Some(Schedule::Patches));
    let (material, params) = bare();
    let mut surface = sphere(4, [0.0; 3]);
    let mut solver = undivided(&mut surface, &material);
    let body = gpu.add(&surface, &mut solver).expect("room");
    let step = |gpu: &mut GpuBackend, solver: &mut Solver, params: &SolverParams| {
        let before = kernels(gpu);
        let done = gpu.step([(body, solver)], DT, params).expect("a step");
        let compiled = done.kernels_compiled as usize;
        let new: Vec<&str> = kernels(gpu).difference(&before).copied().collect();
        (new, compiled)
    };
    step(&mut gpu, &mut solver, &params);
    solver.pin(&mut surface, VertexId(0)).expect("a vertex");
    gpu.update(body, &surface, &mut solver).expect("it follows");
    assert_eq!(step(&mut gpu, &mut solver, &params), (vec!["pins"], 1));
    set_ground(&mut solver, -1.5);
    let colliders = vec!["colliders"];
    assert_eq!(step(&mut gpu, &mut solver, &params), (colliders, 1));
    solver
        .set_stretch(Stiffness::Compliance(1e-6))
        .expect("in range");
    let multipliers = vec!["reset_multipliers"];
    assert_eq!(step(&mut gpu, &mut solver, &params), (multipliers, 1));
    gpu.prefetch_bounds(body).expect("it is there");
    let boxes = vec!["bounds", "reset_bounds"];
    assert_eq!(step(&mut gpu, &mut solver, &params), (boxes, 2));
    gpu.bounds(body).expect("a box");
    assert_eq!(step(&mut gpu, &mut solver, &params), (Vec::new(), 0));
    let mut other = sphere(5, [3.0, 0.0, 0.0]);
    let mut bending = undivided(&mut other, &Material::default());
    let another = gpu.add(&other, &mut bending).expect("room");
    let before = kernels(&gpu);
    let both = [(body, &mut solver), (another, &mut bending)];
    gpu.step(both, DT, &params).expect("a step");
    let new: Vec<&str> = kernels(&gpu).difference(&before).copied().collect();
    assert!(new.contains(&"bending"), "{new:?}");
}

fn of_schedule(mut gpu: GpuBackend, schedule: Schedule) {
    let (material, params) = with_most_features();
    gpu.force_schedule(Some(schedule));
    let mut surface = sphere(3, [0.0; 3]);
    let mut solver = solver_for(&mut surface, &material, schedule);
    let body = gpu.add(&surface, &mut solver).expect("room");
    gpu.step([(body, &mut solver)], DT, &params)
        .expect("a step");
    let made = kernels(&gpu);
    let is_whole = schedule == Schedule::WholeBody;
    assert_eq!(made.contains("whole_body"), is_whole, "{made:?}");
    assert_eq!(made.contains("patches"), schedule == Schedule::Patches);
    // The guard of a damped body has two kernels.
    assert!(!is_whole || made.len() == 3, "{made:?}");
    assert!(made.contains("begin_guard") && made.contains("end_guard"));
    assert!(!made.contains("bounds") && !made.contains("pins"));
}

/// Two steps of a body; whether each has a time, and where the body is then.
fn steps(gpu: &mut GpuBackend, schedule: Schedule) -> ([Option<f64>; 2], Surface) {
    let (material, params) = with_most_features();
    gpu.force_schedule(Some(schedule));
    let mut surface = sphere(3, [0.0; 3]);
    let mut solver = solver_for(&mut surface, &material, schedule);
    let body = gpu.add(&surface, &mut solver).expect("room");
    let times = [(); 2].map(|()| {
        gpu.step([(body, &mut solver)], DT, &params)
            .expect("a step");
        gpu.step_seconds().expect("a device")
    });
    gpu.read(body, &mut surface, &mut solver).expect("a body");
    gpu.remove(body);
    (times, surface)
}

/// Every timed step has a time, and timing changes no result.
fn timed(context: Context) {
    let has_timestamps = context.has_timestamps();
    let mut gpu = GpuBackend::from_context(context).expect("a device");
    for schedule in SCHEDULES {
        let (none, plain) = steps(&mut gpu, schedule);
        assert_eq!(none, [None; 2], "nobody asked");
        assert_eq!(gpu.time_steps(true).expect("a device"), has_timestamps);
        let (times, surface) = steps(&mut gpu, schedule);
        for time in times {
            assert_eq!(time.is_some(), has_timestamps);
            // A step of six iterations is done after it was begun.
            assert!(time.is_none_or(|t| t.is_finite() && t > 0.0), "{time:?}");
        }
        assert_eq!(gpu.step_seconds().expect("a device"), None, "told once");
        assert_eq!(
            surface.positions(),
            plain.positions(),
            "{}",
            schedule.name()
        );
        assert!(!gpu.time_steps(false).expect("a device"));
        assert_eq!(
            steps(&mut gpu, schedule).0,
            [None; 2],
            "nobody asks any more"
        );
    }
}
