//! The kinds of strokes by name, and their bodies.

use super::at_rest::Stroke;
use super::in_scene::Setting;
use super::paths;
use super::trial::Trial;
use incise_mesh::{Surface, cube_sphere, icosphere, sheet, torus};
use incise_models::scenes::{Directions, cuboid, joined};
use incise_models::{Model, build_model};
use incise_scene::SceneError;
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
    || cuboid([1.0; 3], [1; 3]),
    || torus(0.35, 0.15, 32, 16),
    bunny,
];
const SHEETS: [fn() -> Surface; 1] = [|| sheet([1.0; 2], [16; 2])];
const HOLLOW: [fn() -> Surface; 1] = [hollow_ball];
const CUBE: usize = 3;
const CONVEX: usize = 4;
/// Angle by which a blade swings to both sides \[rad\].
const SWING: f64 = 0.3;

fn hollow_ball() -> Surface {
    let mut cavity = icosphere(3, 0.3);
    cavity.flip().expect("a sphere is a manifold");
    joined(&[icosphere(3, 0.5), cavity])
}

pub(super) fn bunny() -> Surface {
    static BUNNY: LazyLock<Surface> = LazyLock::new(|| build_model(Model::Bunny));
    BUNNY.clone()
}

/// Declares a kind of stroke at rest through one of some bodies, turned at random or not.
macro_rules! at_rest {
    ($name:literal, $bodies:expr, $path:expr) => {
        at_rest!($name, $bodies, $path, turned: true)
    };
    ($name:literal, $bodies:expr, $path:expr, turned: $is_turned:literal) => {
        Kind {
            name: $name,
            run: |random, trial| {
                let path: fn(&mut Stroke<'_>) = $path;
                let mut stroke = Stroke::new(random, &$bodies, $is_turned);
                path(&mut stroke);
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
    at_rest!("straight", BODIES, paths::straight),
    at_rest!("press", BODIES, paths::press, turned: false),
    at_rest!("bent", BODIES, paths::bent),
    at_rest!("curved", BODIES, paths::curved),
    at_rest!("saw_long", BODIES, |s| paths::saw(s, 0.5, 4.0)),
    at_rest!("saw_short", BODIES, |s| paths::saw(s, 0.05, 20.0)),
    at_rest!("u_turn", BODIES[..CONVEX], paths::u_turn),
    at_rest!("spiral", BODIES, paths::spiral),
    at_rest!("stop_and_go", BODIES, paths::stop_and_go),
    at_rest!("stab", BODIES, |s| paths::stab(s, 0.6)),
    at_rest!("pull_out", BODIES, paths::pull_out),
    at_rest!("cone", BODIES[..CONVEX], paths::cone),
    at_rest!("undercut", BODIES[..CONVEX], paths::undercut),
    at_rest!("cross_90", BODIES, |s| paths::cross(s, 90.0)),
    at_rest!("cross_45", BODIES, |s| paths::cross(s, 45.0)),
    at_rest!("cross_20", BODIES, |s| paths::cross(s, 20.0)),
    at_rest!("cross_5", BODIES, |s| paths::cross(s, 5.0)),
    at_rest!("reentry", BODIES, paths::reentry),
    at_rest!("cavity", HOLLOW, paths::cavity),
    at_rest!("short_inside", BODIES, |s| paths::short(s, false)),
    at_rest!("short_end", BODIES, |s| paths::short(s, true)),
    at_rest!("sheet_border", SHEETS, paths::sheet_border, turned: false),
    at_rest!("sheet_inside", SHEETS, paths::sheet_inside, turned: false),
    at_rest!("cube", BODIES[CUBE..CONVEX], paths::coarse),
    at_rest!("gap", BODIES[1..2], paths::gap),
    in_scene!("face", Setting::FACE),
    in_scene!("tension_1.05", Setting::pulled(1.05, 0.0)),
    in_scene!("tension_1.2", Setting::pulled(1.2, 0.0)),
    in_scene!("tension_2", Setting::pulled(2.0, 0.0)),
    in_scene!("tension_3", Setting::pulled(3.0, 0.0)),
    in_scene!("swing_1.05", Setting::pulled(1.05, SWING)),
    in_scene!("swing_1.2", Setting::pulled(1.2, SWING)),
    in_scene!("swing_2", Setting::pulled(2.0, SWING)),
    in_scene!("swing_3", Setting::pulled(3.0, SWING)),
    in_scene!("ground", Setting::GROUND),
    in_scene!("hanging", Setting::HANGING),
];
