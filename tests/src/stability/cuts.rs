//! Bodies that blades cut: slices, slivers, plates, slits, and sleeping bodies.

use super::group::{Group, pieces, seconds};
use super::motions::ball;
use super::runner::{Body, Runner};
use super::{Case, Found, Outcome, Run, larger};
use incise_cut::{CutParams, Cutter};
use incise_mesh::geometry::area_vector;
use incise_mesh::{Bvh, Surface, TriangleId};
use incise_models::scenes::cuts::{
    PULLING, SHATTERING, SLICES, SLICING, random_plane, shatter, sliced_materials, slices,
    slit_ball, slit_materials, slivers, split_plate,
};
use incise_models::scenes::{Directions, FRAME, ScriptedScene, sprung};
use incise_pbd_gpu::{Collider, Material};
use incise_scene::{ContactParams, Scene, SceneError, SceneParams};
use incise_test_support::materials::shells;
use incise_test_support::params::TEN_ITERATIONS;

pub(super) const CASES: [Case; 7] = [
    Case {
        id: "contacts",
        stress: "a block cut into ten slices that lie on each other, with the default substeps",
        invariants: &[
            ("time until they sleep [s]", 60.0),
            (
                "depth of a vertex in another piece at the end of a second, in mean edges",
                0.1,
            ),
        ],
        run: |runner| {
            runner.each(&sliced_materials(), |(name, material)| {
                Run::new((*name).to_owned(), lie(runner, material))
            })
        },
    },
    Case {
        id: "gaping",
        stress: "a ball slit to its center, pulled apart across the slit by a tenth of its size",
        invariants: &[(
            "missing width of the slit up to a mean edge, or depth of a wall in the other, in \
             mean edges",
            0.1,
        )],
        run: |runner| pulled(runner, 0.1, |slit| larger(1.0 - slit.width, slit.depth)),
    },
    Case {
        id: "pressed",
        stress: "a ball slit to its center, pressed across the slit by a tenth of its size",
        invariants: &[("depth of a wall in the other, in mean edges", 0.1)],
        run: |runner| pulled(runner, -0.1, |slit| slit.depth),
    },
    Case {
        id: "T12",
        stress: "cuts through a sleeping body on the ground, which wakes and sleeps again",
        invariants: &[("time until it sleeps again [s]", 60.0)],
        run: sleepers,
    },
    Case {
        id: "plate",
        stress: "a plate of 1 cm on the ground is split in its plane",
        invariants: &[
            ("speed of a vertex after three seconds [m/s]", 0.01),
            ("relative volume error of a half in the last second", 0.01),
        ],
        run: split,
    },
    Case {
        id: "slivers",
        stress: "a weightless, damped ball cut by six random planes, with contacts",
        invariants: &[("time until its pieces sleep [s]", 60.0)],
        run: |runner| {
            runner.each(&[1, 2, 3, 4, 5, 6], |&seed| {
                let found = sliced(slivers(&runner.backend, seed), SLICING);
                let found = found.and_then(|mut group| Ok([seconds(group.settle(LONGEST)?)]));
                Run::new(format!("seed {seed}"), found)
            })
        },
    },
    Case {
        id: "shatter",
        stress: "a bunny cut by ten random planes in ten frames of its fall, with and without \
                 contacts",
        invariants: &[
            ("speed of a vertex relative to free fall [m/s]", 2.0),
            (
                "relative volume error of a piece, a second after the last cut",
                0.01,
            ),
        ],
        run: |runner| {
            let runs = [1, 2, 3].map(|seed| [(seed, true), (seed, false)]);
            runner.each(runs.as_flattened(), |&(seed, contacts)| {
                let at = format!("seed {seed}, contacts {contacts}");
                Run::new(at, fall_apart(runner, seed, contacts))
            })
        },
    },
];

/// Longest wait for pieces to sleep \[frames\]: a second beyond the bound.
const LONGEST: u32 = 61 * 60;

/// Steps a new scene by the frames of its cuts.
fn sliced(scripted: Result<ScriptedScene, SceneError>, cuts: u32) -> Found<Group> {
    let mut group = Group::new(scripted)?;
    group.step(cuts)?;
    Ok(group)
}

fn lie(runner: &Runner, material: &Material) -> Found<[f64; 2]> {
    let mut group = sliced(slices(&runner.backend, material), SLICES - 1)?;
    let made = pieces(group.body(0)?.surface()).len();
    if made != SLICES as usize {
        return Err(format!("{made} slices of {SLICES}").into());
    }
    let (mut frames, mut depth) = (0, 0.0);
    while !group.is_asleep()? && frames < LONGEST {
        frames += group.settle(60)?;
        if frames % 60 == 0 {
            let body = group.body(0)?;
            let edge = body.solver().mean_rest_length();
            depth = larger(depth, deepest(body.surface()) / edge);
        }
    }
    Ok([seconds(frames), depth])
}

/// Returns the largest depth of a vertex in another piece \[m\].
fn deepest(surface: &Surface) -> f64 {
    let bvh = Bvh::build(surface);
    let reach = surface.bounds().diagonal();
    let mut deepest = 0.0;
    for v in surface.topology().vertices() {
        let own = surface.piece(surface.topology().outgoing(v).triangle());
        let others = |t| surface.piece(t) != own;
        if let Some(found) = bvh.nearest(surface, surface.position(v), reach, others) {
            deepest = larger(deepest, -found.distance);
        }
    }
    deepest
}

fn split(runner: &Runner) -> Vec<Run> {
    // The second one's motions decay four times as fast.
    let damped = Material {
        damping: 4.0,
        ..sprung()
    };
    let materials = [("skin with springs", sprung()), ("damped", damped)];
    runner.each(&materials, |(name, material)| {
        let split = || -> Found<[f64; 2]> {
            let mut group = sliced(split_plate(&runner.backend, material), 1)?;
            if group.scene().stats().cuts == 0 {
                return Err("the plate is not cut".into());
            }
            group.step(180)?;
            let (mut speed, mut error) = (0.0, 0.0);
            for _ in 0..60 {
                group.step(1)?;
                speed = larger(speed, group.speed([0.0; 3])?);
                error = larger(error, group.volume_error()?);
            }
            Ok([speed, error])
        };
        Run::new((*name).to_owned(), split())
    })
}

fn fall_apart(runner: &Runner, seed: u64, contacts: bool) -> Found<[f64; 2]> {
    let contacts = contacts.then(ContactParams::default);
    let mut group = sliced(shatter(&runner.backend, seed, contacts), SHATTERING)?;
    let mut speed = 0.0;
    for frame in SHATTERING..SHATTERING + 60 {
        group.step(1)?;
        let fall = 9.81 * f64::from(frame + 1) / 60.0;
        speed = larger(speed, group.speed([0.0, -fall, 0.0])?);
    }
    Ok([speed, group.volume_error()?])
}

/// The state of a slit \[mean edges\].
struct Slit {
    /// Largest distance of a vertex from the other wall.
    width: f64,
    /// Largest depth of a vertex behind the other wall.
    depth: f64,
}

/// Pulls the ends of slit balls apart, or together for a negative distance \[m\].
fn pulled(runner: &Runner, distance: f32, value: fn(&Slit) -> f64) -> Vec<Run> {
    runner.each(&slit_materials(), |(name, material)| {
        let scripted = slit_ball(&runner.backend, material, distance);
        let found = sliced(scripted, 2 * u32::from(PULLING)).and_then(|group| {
            let body = group.body(0)?;
            let slit = measure(body.surface(), body.solver().mean_rest_length());
            Ok([value(&slit)])
        });
        Run::new((*name).to_owned(), found)
    })
}

/// Minimum cosine between a wall's normal and the way to a vertex that is not beside the wall.
const MIN_COSINE: f64 = 0.7;

/// Measures the slit relative to the length of an edge \[m\].
///
/// A vertex's distance from the other wall is that along the normal there, so that walls may slide.
/// Vertices beside the other wall are left out.
fn measure(surface: &Surface, edge: f64) -> Slit {
    let topology = surface.topology();
    let cap = CutParams::default().cap_material;
    // Walls at rest face along x, towards each other.
    let wall_of = |t: TriangleId| {
        let [a, b, c] = topology.triangle(t).map(|v| surface.rest_position(v));
        (surface.material(t) == cap).then(|| (b - a).cross(&(c - a)).x > 0.0)
    };
    let bvh = Bvh::build(surface);
    let (mut width, mut depth) = (0.0, 0.0);
    for v in topology.vertices() {
        let mut walls = (topology.outgoing_fan(v)).filter_map(|h| wall_of(h.triangle()));
        let Some(own) = walls.next() else { continue };
        // Vertices of the tip are on both.
        if walls.any(|wall| wall != own) {
            continue;
        }
        let other = |t: TriangleId| wall_of(t) == Some(!own);
        let at = surface.position(v);
        let Some(found) = bvh.nearest(surface, at, 4.0 * edge, other) else {
            continue;
        };
        let normal = area_vector(surface.triangle_positions(found.triangle)).normalize();
        let is_beside = normal.dot(&(at - found.point)).abs() < MIN_COSINE * found.distance.abs();
        if !is_beside {
            width = larger(width, found.distance / edge);
            depth = larger(depth, -found.distance / edge);
        }
    }
    Slit { width, depth }
}

/// Cuts of a sleeping body.
const CUTS: u32 = 8;
/// The blade's position between cuts, far above.
const AWAY: [[f32; 3]; 2] = [[-1.0, 90.0, 0.0], [1.0, 90.0, 0.0]];

fn sleepers(runner: &Runner) -> Vec<Run> {
    let run = |(name, material): (&str, Material)| match cut_asleep(runner, &material) {
        Ok(times) => (times.into_iter().enumerate())
            .map(|(k, time)| Run::new(format!("{name}, cut {}", k + 1), Ok([time])))
            .collect(),
        Err(error) => vec![Run::new(name.to_owned(), Err::<Outcome, _>(error))],
    };
    shells().into_iter().flat_map(run).collect()
}

/// Cuts a body whenever it sleeps; returns the time until it sleeps for each cut \[s\].
fn cut_asleep(runner: &Runner, material: &Material) -> Found<Vec<f64>> {
    let params = SceneParams {
        dt: FRAME,
        solver: TEN_ITERATIONS,
        ..SceneParams::default()
    };
    let mut scene = Scene::with_backend(params, &runner.backend)?;
    scene.colliders.push(Collider::ground(0.0));
    scene.add_body(ball(0, 0.6), material)?;
    scene.add_blade(AWAY);
    let mut group = Group::new(Ok(scene.into()))?;
    let mut directions = Directions(13);
    let mut times = Vec::new();
    for _ in 0..CUTS {
        times.push(seconds(group.settle(LONGEST)?));
        // The next cut needs a sleeping body.
        if !group.is_asleep()? {
            break;
        }
        cut_once(&mut group, &mut directions)?;
    }
    Ok(times)
}

/// Cuts a random piece of a sleeping body, which must wake.
fn cut_once(group: &mut Group, directions: &mut Directions) -> Found<()> {
    let body = group.only();
    let scene = group.scene();
    let surface = scene.body(body)?.surface();
    let all = pieces(surface);
    let piece = all[below(directions, all.len())];
    let [before, after] = random_plane(surface, Some(piece), directions)?.ends();
    let blade = scene.blades().next().ok_or("the scene has a blade")?;
    scene.set_blade_piece(blade, Some(piece))?;
    scene.teleport_blade(blade, before)?;
    scene.move_blade(blade, after)?;
    let was_cut = scene.cut()?.failed_cuts == 0;
    if was_cut && scene.is_asleep(body)? {
        return Err("the body sleeps on after a cut".into());
    }
    scene.advance()?;
    Ok(scene.teleport_blade(blade, AWAY)?)
}

/// Returns a random whole number below `count`.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a saturating cast of a number that is not negative"
)]
fn below(directions: &mut Directions, count: usize) -> usize {
    let part = f64::midpoint(directions.signed(), 1.0);
    ((part * count as f64) as usize).min(count.saturating_sub(1))
}

/// Planes tried for one cut; some miss the piece.
const TRIES: u32 = 20;

/// Smallest part of the body's volume that a cut may leave as a piece.
///
/// Planes through ears and feet cut off chips a fraction of a millimeter thin. Gravity moves the
/// faces of a chip by more than a hundredth of its thickness per substep.
const CHIP: f64 = 1e-3;

/// Cuts the largest piece; tries another plane where one misses, fails or cuts off a chip.
pub(super) fn cut_largest(
    body: &mut Body<'_>,
    cutter: &mut Cutter,
    directions: &mut Directions,
) -> Found<()> {
    let before = pieces(&body.surface);
    let size = |p: &u32| body.surface.piece_triangles(*p);
    let largest = before.iter().copied().max_by_key(size).unwrap_or(0);
    let params = CutParams {
        only_piece: Some(largest),
        ..CutParams::default()
    };
    for _ in 0..TRIES {
        let sweep = random_plane(&body.surface, Some(largest), directions)?;
        cutter.refit(&body.surface);
        let Ok(outcome) = cutter.cut(&mut body.surface, &sweep, &params) else {
            continue;
        };
        if pieces(&body.surface).len() > before.len() && !has_chip(&body.surface) {
            return body.follow(&outcome.delta);
        }
        if let Some(undo) = outcome.undo {
            cutter.undo(&mut body.surface, undo)?;
        }
    }
    Err(format!("none of {TRIES} planes cut piece {largest}").into())
}

/// Returns whether a piece is smaller than a [`CHIP`].
fn has_chip(surface: &Surface) -> bool {
    let volumes = surface.piece_volumes();
    let smallest = CHIP * volumes.iter().sum::<f64>();
    (pieces(surface).iter()).any(|&piece| volumes[piece as usize] < smallest)
}
