//! The kinds of strokes by name, and the paths of those at rest.

use super::at_rest::{Stroke, log_between};
use super::in_scene::{Motion, Pins, Setting};
use super::trial::Trial;
use incise_mesh::{Surface, cube_sphere, icosphere, torus};
use incise_models::scenes::{Directions, cuboid};
use incise_models::{Model, build_model};
use incise_scene::SceneError;
use std::f64::consts::TAU;
use std::sync::LazyLock;

/// A kind of stroke.
#[derive(Debug)]
pub(super) struct Kind {
    pub(super) name: &'static str,
    pub(super) run: fn(&mut Directions, &mut Trial) -> Result<(), SceneError>,
}

/// Bodies of strokes; the first ones are convex.
const BODIES: [fn() -> Surface; 6] = [
    || icosphere(2, 0.5),
    || icosphere(3, 0.5),
    || cube_sphere(8, 0.5),
    cube,
    || torus(0.35, 0.15, 32, 16),
    bunny,
];
const CONVEX: usize = 4;
/// Angle by which a closed path overlaps its start \[rad\].
const OVERLAP: f64 = 0.15;
/// Drift of a blade across its edge, relative to its motion along the edge.
const DRIFTS: [f64; 2] = [0.001, 0.05];

fn cube() -> Surface {
    cuboid([1.0; 3], [1; 3])
}

pub(super) fn bunny() -> Surface {
    static BUNNY: LazyLock<Surface> = LazyLock::new(|| build_model(Model::Bunny));
    BUNNY.clone()
}

/// Declares a kind of stroke at rest through one of some bodies.
macro_rules! at_rest {
    ($name:literal, $bodies:expr, $path:expr) => {
        Kind {
            name: $name,
            run: |random, trial| {
                let mut stroke = Stroke::new(random, &$bodies);
                $path(&mut stroke);
                stroke.run(trial);
                Ok(())
            },
        }
    };
}

/// Declares a kind of stroke in a scene.
macro_rules! in_scene {
    ($name:literal, $setting:expr) => {
        Kind {
            name: $name,
            run: |random, trial| $setting.run(random, trial),
        }
    };
}

/// All kinds.
pub(super) const KINDS: &[Kind] = &[
    at_rest!("stab", BODIES, |s: &mut Stroke<'_>| stab(s, 0.6)),
    at_rest!("pull_out", BODIES, pull_out),
    at_rest!("cone", BODIES[..CONVEX], cone),
    at_rest!("cube", [cube as fn() -> Surface], |s: &mut Stroke<'_>| {
        s.count = Some(16);
        straight(s);
    }),
    at_rest!(
        "gap",
        [(|| icosphere(3, 0.5)) as fn() -> Surface],
        |s: &mut Stroke<'_>| {
            s.count = Some(24);
            s.is_full = true;
            s.is_gaping = true;
            let x = s.between(-0.3, 0.3);
            s.walk(|t| [-1.2, 1.2].map(|y| [x, y, ease(t, -1.2, 1.2)]));
        }
    ),
    in_scene!("tension_1.05", Setting::pulled(1.05, 0.0)),
    in_scene!("tension_1.2", Setting::pulled(1.2, 0.0)),
    in_scene!("tension_2", Setting::pulled(2.0, 0.0)),
    in_scene!("tension_3", Setting::pulled(3.0, 0.0)),
    in_scene!("swing_1.05", Setting::pulled(1.05, 0.3)),
    in_scene!("swing_1.2", Setting::pulled(1.2, 0.3)),
    in_scene!("swing_2", Setting::pulled(2.0, 0.3)),
    in_scene!("swing_3", Setting::pulled(3.0, 0.3)),
    in_scene!(
        "ground",
        Setting {
            has_gravity: true,
            has_ground: true,
            has_contacts: true,
            motion: Motion::Down,
            ..Setting::pulled(1.0, 0.0)
        }
    ),
    in_scene!(
        "hanging",
        Setting {
            has_gravity: true,
            pins: Pins::Top,
            motion: Motion::Horizontal,
            ..Setting::pulled(1.0, 0.0)
        }
    ),
    in_scene!(
        "face",
        Setting {
            has_contacts: true,
            has_face: true,
            motion: Motion::Down,
            ..Setting::pulled(1.0, 0.0)
        }
    ),
];

/// Interpolates between two numbers.
const fn ease(t: f64, from: f64, to: f64) -> f64 {
    from + (to - from) * t
}

/// A straight blade, both ends outside, moves obliquely through the whole body.
fn straight(s: &mut Stroke<'_>) {
    s.is_full = true;
    let [x, dx] = [s.between(-0.3, 0.3), s.between(-0.2, 0.2)];
    let [dz, drift] = [s.between(-0.3, 0.3), s.between(-0.3, 0.3)];
    s.walk(|t| {
        let z = ease(t, -1.6, 1.6);
        [-1.0, 1.0].map(|end| [x + dx * end, 1.6 * end + drift * z, z + dz * end])
    });
}

/// A blade moves into the body along its edge, to a height, with a drift across it.
fn stab(s: &mut Stroke<'_>, depth: f64) {
    let [x, y] = [s.between(-0.4, 0.4), s.between(-0.4, 0.4)];
    let drift = log_between(s.random, DRIFTS[0], DRIFTS[1]);
    s.walk(|t| {
        let z = ease(t, -1.2, depth);
        [0.0, -3.0].map(|end| [x + drift * z, y, z + end])
    });
}

/// A blade moves in by a stab or a drag, and back the same way.
fn pull_out(s: &mut Stroke<'_>) {
    if s.random.signed() < 0.0 {
        let depth = s.between(-0.5, 0.6);
        stab(s, depth);
    } else {
        let [x, end, depth] = [
            s.between(-0.4, 0.4),
            s.between(-0.5, 0.5),
            s.between(-0.5, 0.5),
        ];
        s.walk(|t| [end, 1.3].map(|y| [x, y, ease(t, -1.2, depth)]));
    }
    for path in &mut s.paths {
        path.extend(path.clone().into_iter().rev());
    }
}

/// A blade stabs to a point inside, circles about it and closes the cone around a plug.
fn cone(s: &mut Stroke<'_>) {
    s.is_full = true;
    let [x, y, z] = [0; 3].map(|_| s.between(-0.1, 0.1));
    let slope = s.between(0.47, 0.84);
    let drift = log_between(s.random, DRIFTS[0], DRIFTS[1]);
    let apex = [x, y, z];
    // Positions along a side of the cone, from its apex, at an angle.
    let side = |angle: f64, along: f64| {
        let r = slope * along;
        [
            apex[0] + r * angle.cos(),
            apex[1] + along,
            apex[2] + r * angle.sin(),
        ]
    };
    let side_of = |angle: f64, along: f64| [0.0, 2.0].map(|end| side(angle, along + end));
    s.walk(|t| {
        let lift = ease(t, 1.5, 0.0);
        side_of(-drift * lift, lift)
    });
    s.walk(|t| side_of((TAU + OVERLAP) * t, 0.0));
    s.walk(|t| side_of(OVERLAP + drift * t, ease(t, 0.0, 1.5)));
}
