//! Contacts between bodies of a scene: they rest on each other, wake each other and sleep together.

use super::*;
use incise_scene::FrameStats;
use std::num::NonZeroUsize;

/// Blocks of few triangles roll on their edges for a while.
const SLEEP: SleepParams = SleepParams {
    speed: 6e-2,
    seconds: 0.5,
};

fn ball(at: [f32; 3], radius: f32) -> Surface {
    merged(&[moved(&cube_sphere(6, 1.0), at, [radius; 3])])
}

fn block(at: [f32; 3]) -> Surface {
    merged(&[moved(&cube(3), at, [0.2; 3])])
}

fn lowest(scene: &Scene, id: BodyId) -> f32 {
    let body = scene.body(id).unwrap();
    height_range(body, piece_of(body.surface(), VertexId(0)))[0]
}

/// Returns a scene of blocks of 0.4 m in a column, with gaps, above the ground.
fn column(blocks: u8, sleep: Option<SleepParams>) -> (Scene, Vec<BodyId>) {
    let mut scene = Scene::new(SceneParams {
        sleep,
        ..params([0.0, -9.81, 0.0], Some(0.0))
    });
    let material = Material {
        damping: 1.0,
        ..firm(0.7, 0.0)
    };
    let ids = (0..blocks).map(|i| {
        let y = 0.22 + 0.45 * f32::from(i);
        scene.add_body(block([0.0, y, 0.0]), &material).unwrap()
    });
    let ids = ids.collect();
    (scene, ids)
}

#[test]
fn a_body_rests_on_another_one() {
    for contacts in [Some(ContactParams::default()), None] {
        let mut scene = Scene::new(SceneParams {
            contacts,
            ..params([0.0, -9.81, 0.0], Some(0.0))
        });
        let lower = scene.add_body(ball([0.0, 1.0, 0.0], 1.0), &firm(1.0, 0.0));
        let upper = scene.add_body(ball([0.02, 3.05, 0.01], 1.0), &firm(1.0, 0.0));
        let (lower, upper) = (lower.unwrap(), upper.unwrap());
        for _ in 0..48 {
            scene.step().unwrap();
        }
        let low = lowest(&scene, upper);
        assert_eq!(low > 1.0, contacts.is_some(), "it is {low} m high");
        let surfaces = [lower, upper].map(|id| scene.body(id).unwrap().surface().clone());
        let deep = max_penetration(&merged_as_they_are(&surfaces));
        assert!(deep < 0.02 || contacts.is_none(), "{deep} m in each other");
    }
}

/// Returns surfaces as one, at their present positions.
fn merged_as_they_are(parts: &[Surface]) -> Surface {
    let parts: Vec<Surface> = (parts.iter())
        .map(|part| {
            let mut part = part.clone();
            let now: Vec<_> = part
                .positions()
                .iter()
                .map(|&[x, y, z, _]| [x, y, z])
                .collect();
            part.rest_positions_mut().copy_from_slice(&now);
            part
        })
        .collect();
    merged(&parts)
}

#[test]
fn a_collision_of_bodies_conserves_momentum() {
    let mut scene = Scene::new(params([0.0; 3], None));
    let first = scene
        .add_body(ball([0.0; 3], 1.0), &firm(0.5, 0.0))
        .unwrap();
    let second = ball([2.5, 0.4, 0.1], 0.7);
    let second = scene.add_body(second, &firm(0.2, 0.0)).unwrap();
    set_piece_velocity(&mut scene, first, 0, [3.0, 0.0, 0.0]);
    let total = |scene: &Scene| {
        let solvers = [first, second].map(|id| scene.body(id).unwrap().solver());
        let [a, b] = solvers.map(|solver| solver.momentum());
        let energy: f64 = solvers.iter().map(|solver| solver.kinetic_energy()).sum();
        ([0, 1, 2].map(|k| a[k] + b[k]), energy)
    };
    let (before, energy) = total(&scene);
    for _ in 0..60 {
        scene.step().unwrap();
    }
    let (after, energy_after) = total(&scene);
    for k in 0..3 {
        assert!((after[k] - before[k]).abs() < 1e-3 * before[0], "{after:?}");
    }
    assert!(energy_after < energy, "{energy} J became {energy_after}");
    let pushed = scene.body(second).unwrap().solver().momentum();
    assert!(
        pushed[0] > 0.1 * before[0],
        "the other one goes on: {pushed:?}"
    );
}

#[test]
fn a_column_comes_to_rest_and_sleeps_as_one() {
    let (mut scene, ids) = column(4, Some(SLEEP));
    let mut fell_asleep = Vec::new();
    for _ in 0..1200 {
        let stats: &FrameStats = scene.step().unwrap();
        fell_asleep.extend(Some(stats.fell_asleep).filter(|&count| count > 0));
        if stats.sleeping_bodies == 4 {
            break;
        }
    }
    assert_eq!(fell_asleep, [4], "they fall asleep in one frame");
    for (i, &id) in (0_u8..).zip(&ids) {
        let low = lowest(&scene, id);
        assert!(
            (low - 0.4 * f32::from(i)).abs() < 0.05,
            "block {i} is {low} m high"
        );
    }
    scene.wake(ids[3]).unwrap();
    scene.step().unwrap();
    assert_eq!(scene.stats().woken, 4, "an island wakes as one");
}

#[test]
fn a_falling_body_wakes_what_it_touches() {
    let mut scene = Scene::new(SceneParams {
        sleep: Some(SLEEP),
        ..params([0.0, -9.81, 0.0], Some(0.0))
    });
    let material = Material {
        damping: 1.0,
        ..firm(0.7, 0.0)
    };
    let below = scene.add_body(block([0.0, 0.2, 0.0]), &material).unwrap();
    let aside = scene.add_body(block([3.0, 0.2, 0.0]), &material).unwrap();
    for _ in 0..300 {
        scene.step().unwrap();
    }
    assert_eq!(scene.stats().sleeping_bodies, 2);
    scene.add_body(block([0.05, 1.2, 0.0]), &material).unwrap();
    let mut woke = false;
    for _ in 0..40 {
        scene.step().unwrap();
        woke |= !scene.is_asleep(below).unwrap();
        assert!(scene.is_asleep(aside).unwrap(), "nothing touches it");
    }
    assert!(woke, "it is hit");
}

/// Bits of all bodies of a pile, with and without threads.
#[test]
fn a_pile_has_the_same_bits_on_any_number_of_threads() {
    let run = |pool: usize, threads: Option<usize>| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(pool);
        pool.build().unwrap().install(|| {
            let mut scene = Scene::new(params([0.0, -9.81, 0.0], Some(0.0)));
            scene.params.solver.threads = threads.and_then(NonZeroUsize::new);
            let ids: Vec<_> = (0_u8..12)
                .map(|i| {
                    let [x, y, z] = [i % 2, i / 2, i / 3 % 2].map(f32::from);
                    let at = [0.3 * x, 0.5 + 0.9 * y, 0.2 * z];
                    scene.add_body(ball(at, 0.4), &firm(0.5, 0.0)).unwrap()
                })
                .collect();
            let mut contacts = 0;
            for _ in 0..40 {
                contacts += scene.step().unwrap().contacts;
            }
            let mut bits = Vec::new();
            for id in ids {
                let body = scene.body(id).unwrap();
                let all = body.surface().positions().iter();
                let all = all.chain(body.solver().velocities());
                bits.extend(all.map(|p| p.map(f32::to_bits)));
            }
            (bits, contacts)
        })
    };
    let one = run(1, None);
    assert!(one.1 > 1000, "{} contacts", one.1);
    for pool in [2, 3, 5] {
        assert!(one == run(pool, None), "{pool} threads differ from one");
    }
    assert!(one == run(4, Some(1)), "the calling thread alone differs");
}
