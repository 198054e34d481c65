//! Bit-identical results on any number of threads, and no allocation while stepping.

use incise_pbd_gpu::{
    Collider, Contact, Material, PatchParams, Solver, SolverParams, Stiffness, Volume,
};
use incise_test_support::surfaces::sphere;
use std::num::NonZeroUsize;

fn run(
    pool: usize,
    threads: Option<usize>,
    material: &Material,
    patches: Option<&PatchParams>,
) -> Vec<[u32; 4]> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(pool)
        .build()
        .unwrap();
    pool.install(|| {
        let mut surface = sphere(5, [0.0, 1.01, 0.0]);
        let mut solver = Solver::with_patches(&mut surface, material, patches).unwrap();
        let params = SolverParams {
            threads: threads.and_then(NonZeroUsize::new),
            ..SolverParams::paper()
        };
        solver
            .set_colliders(&[Collider::ground(0.0).into()])
            .unwrap();
        for _ in 0..4 {
            solver.step(&mut surface, 1.0 / 60.0, &params).unwrap();
        }
        let bits = |p: &[f32; 4]| p.map(f32::to_bits);
        surface.positions().iter().map(bits).collect()
    })
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let incompressible = Material {
        volume: Some(Volume::default()),
        ..Material::default()
    };
    let compliant = Material {
        stretch: Stiffness::Compliance(1e-5),
        bending: Some(Stiffness::Compliance(1e-3)),
        ..Material::default()
    };
    let divided = PatchParams::default();
    for (material, patches) in [
        (incompressible, None),
        (incompressible, Some(&divided)),
        (compliant, None),
        (compliant, Some(&divided)),
    ] {
        let one = run(1, None, &material, patches);
        for pool in [2, 3, 5, 8, 64] {
            let many = run(pool, None, &material, patches);
            assert!(one == many, "{pool} threads differ from one");
        }
        for limit in [1, 2, 3] {
            let limited = run(4, Some(limit), &material, patches);
            assert!(one == limited, "a limit of {limit} threads differs");
        }
    }
}

#[test]
fn contacts_have_the_same_bits_on_any_number_of_threads() {
    let run = |threads| {
        let mut surface = sphere(4, [0.0; 3]);
        let mut solver = Solver::new(&mut surface, &Material::soft_body()).unwrap();
        let normal = [0.6, 0.8, 0.0];
        let slope = |vertex| Contact {
            friction: 0.5,
            ..Contact::plane(vertex, normal, -0.95)
        };
        let contacts: Vec<_> = surface.topology().vertices().map(slope).collect();
        let params = SolverParams {
            threads: NonZeroUsize::new(threads),
            ..SolverParams::paper()
        };
        for _ in 0..10 {
            solver.set_contacts(&contacts).unwrap();
            solver.step(&mut surface, 1.0 / 60.0, &params).unwrap();
        }
        let bits = |p: &[f32; 4]| p.map(f32::to_bits);
        surface.positions().iter().map(bits).collect::<Vec<_>>()
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(4);
    pool.build().unwrap().install(|| {
        let one = run(1);
        for threads in [2, 3, 4] {
            assert!(run(threads) == one, "{threads} threads differ from one");
        }
    });
}

#[test]
fn a_step_does_not_allocate() {
    let stiffnesses = [Stiffness::Pbd(1.0), Stiffness::Compliance(1e-6)];
    let patches = [
        None,
        Some(PatchParams {
            vertices: 64,
            room: 8,
        }),
    ];
    let residuals = [None, Some(1e-4)];
    for (stiffness, (residual, patches)) in stiffnesses
        .into_iter()
        .zip(residuals.into_iter().zip(patches))
    {
        let mut surface = sphere(3, [0.0, 1.2, 0.0]);
        let material = Material {
            stretch: stiffness,
            bending: Some(stiffness),
            volume: Some(Volume::default()),
            ..Material::default()
        };
        let mut solver = Solver::with_patches(&mut surface, &material, patches.as_ref()).unwrap();
        let params = SolverParams {
            residual,
            ..SolverParams::paper()
        };
        solver
            .set_colliders(&[Collider::ground(0.0).into()])
            .unwrap();
        solver.step(&mut surface, 1.0 / 60.0, &params).unwrap();
        let room = solver.capacity();
        for _ in 0..100 {
            solver.step(&mut surface, 1.0 / 60.0, &params).unwrap();
            assert_eq!(solver.capacity(), room);
        }
    }
}
