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
        ..params([0.0, -9.81, 0.0])
    });
    scene.colliders.push(Collider::ground(0.0));
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
            ..params([0.0, -9.81, 0.0])
        });
        scene.colliders.push(Collider::ground(0.0));
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
    let mut scene = Scene::new(params([0.0; 3]));
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
        ..params([0.0, -9.81, 0.0])
    });
    scene.colliders.push(Collider::ground(0.0));
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
            let mut scene = Scene::new(params([0.0, -9.81, 0.0]));
            scene.colliders.push(Collider::ground(0.0));
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

/// Regression: penetration that came back as velocity threw the uppermost blocks.
#[test]
fn a_column_that_hits_the_ground_fast_comes_to_rest() {
    for gap in [0.01, 0.1] {
        let mut scene = Scene::new(params([0.0, -9.81, 0.0]));
        scene.colliders.push(Collider::ground(0.0));
        let ids: Vec<_> = (0_u8..5)
            .map(|i| {
                let at = [0.0, 0.5 + (0.19 + gap) * f32::from(i), 0.0];
                let block = merged(&[moved(&cube(6), at, [0.3, 0.095, 0.3])]);
                let id = scene.add_body(block, &firm(0.5, 0.0)).unwrap();
                set_piece_velocity(&mut scene, id, 0, [0.0, -14.0, 0.0]);
                id
            })
            .collect();
        let volume = |scene: &Scene, id| scene.body(id).unwrap().surface().piece_volumes()[0];
        let whole: Vec<f64> = ids.iter().map(|&id| volume(&scene, id)).collect();
        for _ in 0..600 {
            scene.step().unwrap();
        }
        let mut energy = 0.0;
        for (&id, whole) in ids.iter().zip(whole) {
            energy += scene.body(id).unwrap().solver().kinetic_energy();
            let kept = volume(&scene, id) / whole;
            assert!((kept - 1.0).abs() < 0.01, "{kept} is left, gap {gap} m");
        }
        assert!(energy < 0.01, "{energy} J after 10 s, gap {gap} m");
    }
}

/// A bar of 12 triangles falls onto another one, crossed at an angle: only edges meet.
#[test]
fn crossed_bars_hold_each_other_at_every_angle() {
    for degrees in [90.0_f32, 60.0, 30.0, 15.0, 75.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let bar = |angle: [f32; 2], y: f32| {
            // On an edge, turned by 45 degrees about its axis.
            let mut bar = merged(&[cube(1)]);
            for p in bar.rest_positions_mut() {
                let [x, u, v] = [p[0], (p[1] - p[2]) * 0.07, (p[1] + p[2]) * 0.07];
                *p = [
                    x * angle[0] - v * angle[1],
                    y + u,
                    x * angle[1] + v * angle[0],
                ];
            }
            merged(&[bar])
        };
        let mut scene = Scene::new(params([0.0, -9.81, 0.0]));
        let below = scene
            .add_body(bar([1.0, 0.0], 0.0), &firm(1.0, 0.0))
            .unwrap();
        let above = scene
            .add_body(bar([cos, sin], 0.5), &firm(1.0, 0.0))
            .unwrap();
        pin_piece(&mut scene, below, 0);
        let mut lowest_center = f32::INFINITY;
        for _ in 0..40 {
            scene.step().unwrap();
            let surface = scene.body(above).unwrap().surface();
            let heights = surface.positions().iter().map(|p| p[1]);
            lowest_center = lowest_center.min(heights.sum::<f32>() / 8.0);
        }
        assert!(
            lowest_center > 0.1,
            "its center came down to {lowest_center} m at {degrees} degrees"
        );
    }
}
