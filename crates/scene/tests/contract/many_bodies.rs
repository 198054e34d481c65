//! Scenes of many bodies: their bits on any number of threads, and their ids.

use incise_models::{Model, build_model};
use incise_pbd_gpu::{Collider, Material, SolverParams, Volume};
use incise_scene::{Scene, SceneError, SceneParams, SleepParams};
use incise_test_support::surfaces::sphere;
use std::num::NonZeroUsize;

/// Returns the bits of all positions and velocities, and the statistics that sum over bodies.
fn run(pool: usize, threads: Option<usize>) -> (Vec<[u32; 4]>, u32) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(pool);
    pool.build().unwrap().install(|| {
        let mut scene = Scene::new(SceneParams {
            solver: SolverParams {
                residual: Some(1e-4),
                threads: threads.and_then(NonZeroUsize::new),
                ..SolverParams::paper()
            },
            sleep: Some(SleepParams::default()),
            ..SceneParams::default()
        });
        scene.colliders.push(Collider::ground(0.0));
        let material = Material {
            volume: Some(Volume::default()),
            ..Material::default()
        };
        let bodies: Vec<_> = (0..30)
            .map(|i: u16| {
                // Sizes from 20 to 1,280 triangles.
                let surface = sphere(u32::from(i % 4), [3.0 * f32::from(i), 1.02, 0.0]);
                scene.add_body(surface, &material).unwrap()
            })
            .collect();
        let mut skipped = 0;
        for _ in 0..12 {
            skipped += scene.step().unwrap().iterations_skipped;
        }
        let mut bits = Vec::new();
        for id in bodies {
            let body = scene.body(id).unwrap();
            let all = body.surface().positions().iter();
            bits.extend(
                all.chain(body.solver().velocities())
                    .map(|p| p.map(f32::to_bits)),
            );
        }
        (bits, skipped)
    })
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let one = run(1, None);
    assert!(one.1 > 0, "iterations are skipped");
    for pool in [2, 3, 5, 8] {
        assert!(one == run(pool, None), "{pool} threads differ from one");
    }
    assert!(one == run(4, Some(1)), "the calling thread alone differs");
}

#[test]
fn the_id_of_a_removed_body_is_not_reused() -> Result<(), SceneError> {
    let mut scene = Scene::new(SceneParams::default());
    let mut add = || scene.add_body(build_model(Model::Sphere20), &Material::default());
    let (first, second) = (add()?, add()?);
    let body = scene.remove_body(first)?;
    assert_eq!(body.surface(), scene.body(second).unwrap().surface());
    let unknown = SceneError::UnknownBody { body: first };
    assert_eq!(scene.remove_body(first).err(), Some(unknown));
    let third = scene.add_body(build_model(Model::Sphere20), &Material::default())?;
    assert!(third != first && third != second, "ids are not used again");
    scene.step()?;
    Ok(())
}
