//! Kernels are compiled on first use, and unused ones never.

use incise_mesh::VertexId;
use incise_pbd_gpu::{Context, GpuBackend, Material, Schedule, Solver, SolverParams, Stiffness};
use incise_test_support::cpu_gpu_pair::{DT, SCHEDULES, solver_for, with_most_features};
use incise_test_support::gpu::{Needs, trial_alone};
use incise_test_support::surfaces::sphere;
use libtest_mimic::Trial;
use std::collections::BTreeSet;

/// Kernels of a body with stretch constraints only, with large and small colors.
const LEAST: [&str; 4] = ["integrate", "predict", "stretch", "tail"];

pub(crate) fn trials() -> Vec<Trial> {
    let any = Needs::AnyDevice;
    vec![
        trial_alone("unused_kernels_are_not_compiled", any, absent),
        trial_alone("new_kernels_are_compiled_once", any, comes),
        trial_alone("a_schedule_compiles_its_own_kernels", any, schedules),
    ]
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

fn absent(context: Context) {
    let mut gpu = GpuBackend::from_context(context).expect("a device");
    gpu.force_schedule(Some(Schedule::Colors));
    let (material, params) = bare();
    let mut surface = sphere(4, [0.0; 3]);
    let mut solver = Solver::new(&mut surface, &material).expect("a valid body");
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

fn comes(context: Context) {
    let mut gpu = GpuBackend::from_context(context).expect("a device");
    gpu.force_schedule(Some(Schedule::Colors));
    let (material, params) = bare();
    let mut surface = sphere(4, [0.0; 3]);
    let mut solver = Solver::new(&mut surface, &material).expect("a valid body");
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
    let grounded = SolverParams {
        ground: Some(-1.5),
        ..params
    };
    assert_eq!(step(&mut gpu, &mut solver, &grounded), (vec!["ground"], 1));
    solver
        .set_stretch(Stiffness::Compliance(1e-6))
        .expect("in range");
    let multipliers = vec!["reset_multipliers"];
    assert_eq!(step(&mut gpu, &mut solver, &grounded), (multipliers, 1));
    gpu.prefetch_bounds(body).expect("it is there");
    let boxes = vec!["bounds", "reset_bounds"];
    assert_eq!(step(&mut gpu, &mut solver, &grounded), (boxes, 2));
    gpu.bounds(body).expect("a box");
    assert_eq!(step(&mut gpu, &mut solver, &grounded), (Vec::new(), 0));
    let mut other = sphere(5, [3.0, 0.0, 0.0]);
    let mut bending = Solver::new(&mut other, &Material::default()).expect("a valid body");
    let another = gpu.add(&other, &mut bending).expect("room");
    let before = kernels(&gpu);
    let both = [(body, &mut solver), (another, &mut bending)];
    gpu.step(both, DT, &grounded).expect("a step");
    let new: Vec<&str> = kernels(&gpu).difference(&before).copied().collect();
    assert!(new.contains(&"bending"), "{new:?}");
}

fn schedules(_: Context) {
    let (material, params) = with_most_features();
    for schedule in SCHEDULES {
        let mut gpu = GpuBackend::new(&Needs::AnyDevice.request()).expect("a device");
        gpu.force_schedule(Some(schedule));
        let mut surface = sphere(3, [0.0; 3]);
        let mut solver = solver_for(&mut surface, &material, schedule);
        let body = gpu.add(&surface, &mut solver).expect("room");
        gpu.step([(body, &mut solver)], DT, &params)
            .expect("a step");
        let made = kernels(&gpu);
        assert_eq!(
            made.contains("whole_body"),
            schedule == Schedule::WholeBody,
            "{made:?}"
        );
        assert_eq!(made.contains("patches"), schedule == Schedule::Patches);
        if schedule == Schedule::WholeBody {
            assert_eq!(made.len(), 1, "{made:?}");
        }
        assert!(!made.contains("bounds") && !made.contains("pins"));
    }
}
