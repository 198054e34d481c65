//! Solids on the GPU match the CPU bit for bit: free, cut, pinned, on colliders and edited.

mod edits;
mod supports;

use incise_cut::{CutParams, Cutter, Sweep};
use incise_mesh::{Surface, VertexId, cuboid, icosphere, torus};
use incise_pbd_gpu::{Context, GpuBackend, Material, Solid, Solver, SolverParams};
use incise_test_support::cpu_gpu_pair::{CpuGpuPair, DT};
use incise_test_support::params::set_ground;
use incise_test_support::random::Random;

/// A single iteration of 720 substeps a second, with gravity.
const PARAMS: SolverParams = SolverParams {
    iterations: 1,
    substep: Some(1.0 / 720.0),
    gravity: [0.0, -9.81, 0.0],
    diagonal_scale: 0.5,
    conserve: true,
    ..SolverParams::paper()
};

/// Free and cut solids, supports, edits and refused calls.
pub(crate) fn to_the_bit(context: Context) {
    single_sweeps(&context);
    cut_in_flight(&context);
    supports::on_pins(&context);
    supports::on_colliders(&context);
    edits::edits_between_frames(&context);
    edits::changed_substeps(&context);
    edits::late_copies(&context);
    edits::contacts_are_refused(&context);
    edits::numbers_that_are_none(&context);
}

/// A closeness that every adapter reaches in a frame, and the limit of loops of some.
pub(crate) fn within_rounding(_: Context) {
    incise_test_support::gpu::on_every_adapter(|context| {
        let mut gpu = GpuBackend::from_context(context).expect("a device");
        for mut twin in twins(&mut gpu) {
            twin.edit(|surface, solver| solver.pin(surface, VertexId(0)).expect("a vertex"));
            let height = twin.on_cpu.bounds().min[1] + 1e-3;
            for solver in [&mut twin.cpu, &mut twin.solver] {
                set_ground(solver, height);
            }
            twin.step(&mut gpu, &PARAMS);
            twin.read(&mut gpu);
            let pairs = twin.on_cpu.positions().iter().zip(twin.on_gpu.positions());
            for (cpu, found) in pairs {
                for k in 0..3 {
                    let error = (cpu[k] - found[k]).abs();
                    let name = &gpu.adapter().name;
                    assert!(error <= 1e-4, "{cpu:?} is {found:?} on {name}");
                }
            }
            gpu.remove(twin.body);
        }
        supports::many_colliders(&mut gpu);
    });
}

/// Returns a material with cells of a given size \[m\].
fn solid(young_modulus: f32, cell_size: f32, relaxation_time: f32) -> Material {
    let material = Material::solid(young_modulus, 0.4, 1000.0);
    Material {
        solid: material.solid.map(|solid| Solid {
            cell_size: Some(cell_size),
            relaxation_time,
            ..solid
        }),
        ..material
    }
}

/// Soft and stiff bodies of different shapes, about 1 m across.
fn bodies() -> [(Surface, Material); 3] {
    [
        (icosphere(2, 0.5), solid(1e5, 0.2, 0.005)),
        // So stiff that cells repeat a share of their forces.
        (torus(0.35, 0.15, 24, 12), solid(3e7, 0.1, 0.0)),
        // More than 256 cells a color.
        (cuboid([0.5, 0.3, 0.3], [5, 3, 3]), solid(1e6, 0.06, 0.02)),
    ]
}

fn twins(gpu: &mut GpuBackend) -> Vec<CpuGpuPair> {
    let twin = |(mut surface, material): (Surface, Material)| {
        let solver = Solver::new(&mut surface, &material).expect("a closed body");
        CpuGpuPair::from_solver(gpu, surface, solver)
    };
    bodies().into_iter().map(twin).collect()
}

/// Compares what an edit or a step may change, bit for bit.
fn assert_equal(twin: &mut CpuGpuPair, gpu: &mut GpuBackend, when: &str) {
    twin.assert_equal(gpu, when);
    let energies = [&twin.cpu, &twin.solver].map(Solver::elastic_energy);
    assert_eq!(
        energies.map(f64::to_bits)[0],
        energies.map(f64::to_bits)[1],
        "elastic energies {when}: {energies:?}"
    );
    let bounds = gpu.bounds(twin.body).expect("a box");
    assert_eq!(bounds, twin.on_cpu.bounds(), "the embedded vertices {when}");
}

/// Gives a body random velocities, and displaces its vertices at random.
fn shake(twin: &mut CpuGpuPair, gpu: &mut GpuBackend, random: &mut Random, by: f32, speed: f32) {
    let seed = random.bits();
    twin.edit(|surface, solver| {
        let mut random = Random::new(seed);
        let vertices: Vec<VertexId> = surface.topology().vertices().collect();
        for v in vertices {
            let p = &mut surface.positions_mut()[v.index()];
            for c in &mut p[..3] {
                *c += by * signed(&mut random);
            }
            let to = [(); 3].map(|()| speed * signed(&mut random));
            solver.set_velocity(v, to).expect("a vertex");
        }
        solver.mark_all_changed();
    });
    twin.update(gpu);
}

/// Returns a number from -0.9 to 0.9.
fn signed(random: &mut Random) -> f32 {
    random.fraction() * [-1.0, 1.0][random.below(2)]
}

/// One substep of deformed bodies: cells that turn, are flat or inside out.
fn single_sweeps(context: &Context) {
    let mut gpu = GpuBackend::from_context(context.clone()).expect("a device");
    let mut random = Random::new(1);
    for (i, mut twin) in twins(&mut gpu).into_iter().enumerate() {
        for by in [0.0, 0.01, 0.3] {
            shake(&mut twin, &mut gpu, &mut random, by, 1.0);
            let dt = 1.0 / 720.0;
            twin.cpu
                .step(&mut twin.on_cpu, dt, &PARAMS)
                .expect("a step");
            gpu.step([(twin.body, &mut twin.solver)], dt, &PARAMS)
                .expect("a step");
            let projected = gpu.stats().cell_projections;
            assert_eq!(projected, twin.cpu.stats().cell_projections, "all cells");
            let when = format!("after a substep of body {i}, displaced by {by} m");
            assert_equal(&mut twin, &mut gpu, &when);
        }
        gpu.remove(twin.body);
    }
}

/// Cuts a body along a plane through the middle of its box.
fn cut(twin: &mut CpuGpuPair, normal: [f64; 3]) {
    twin.edit(|surface, solver| {
        let bounds = surface.bounds();
        let distance = (0..3).map(|k| normal[k] * bounds.center()[k]).sum();
        let sweep = Sweep::from_plane(normal, distance, &bounds).expect("a plane");
        let outcome = Cutter::new(surface).cut(surface, &sweep, &CutParams::default());
        let outcome = outcome.expect("a cut");
        assert!(!outcome.is_miss(), "the plane cuts the body");
        solver
            .apply_delta(surface, &outcome.delta)
            .expect("it fits");
        outcome.delta.triangles_added.len()
    });
}

/// Bodies fly, alone and beside a surface, and are cut.
fn cut_in_flight(context: &Context) {
    let mut gpu = GpuBackend::from_context(context.clone()).expect("a device");
    let mut random = Random::new(2);
    let mut twins = twins(&mut gpu);
    let mut sphere = icosphere(2, 0.5);
    let shell = Solver::new(&mut sphere, &Material::default()).expect("a body");
    let mut beside = CpuGpuPair::from_solver(&mut gpu, sphere, shell);
    for twin in &mut twins {
        shake(twin, &mut gpu, &mut random, 0.02, 1.0);
    }
    for frame in 0..9 {
        if frame == 4 {
            for twin in &mut twins {
                cut(twin, [0.3, 1.0, 0.2]);
                twin.update(&mut gpu);
            }
        }
        for twin in twins.iter_mut().chain([&mut beside]) {
            twin.cpu
                .step(&mut twin.on_cpu, DT, &PARAMS)
                .expect("a step");
        }
        let all = twins.iter_mut().chain([&mut beside]);
        let all = all.map(|twin| (twin.body, &mut twin.solver));
        gpu.step(all, DT, &PARAMS).expect("a step");
        if frame % 3 == 0 {
            for (i, twin) in twins.iter_mut().enumerate() {
                assert_equal(twin, &mut gpu, &format!("of body {i} in frame {frame}"));
            }
            beside.assert_equal(&mut gpu, "of a surface beside solids");
        }
    }
    let before = gpu.memory().rented;
    for twin in &mut twins {
        twin.read(&mut gpu);
        twin.solver.mark_all_changed();
        twin.update(&mut gpu);
    }
    assert_eq!(
        gpu.memory().rented,
        before,
        "uploads free what they replace"
    );
    for twin in twins.iter().chain([&beside]) {
        gpu.remove(twin.body);
    }
    assert_eq!(gpu.memory().rented, 0, "removed bodies free their memory");
}
