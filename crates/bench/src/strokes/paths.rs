//! Paths of blades at rest, relative to the body.

use super::at_rest::{Path, Stroke, log_between, pick};
use incise_mesh::Vec3;
use incise_mesh::geometry::to_f32;
use std::f64::consts::{PI, TAU};

/// Angle by which a closed path overlaps its start \[rad\].
const OVERLAP: f64 = 0.15;
/// Drift of a blade across its edge, relative to its motion along the edge.
const DRIFTS: [f64; 2] = [0.001, 0.05];
/// Maximum motion between two poses on circles of a radius of 0.13 m or more \[m\].
const CIRCLE_STEP: f64 = 0.1;
/// Height at which a blade is outside.
const OUT: f64 = 1.5;

/// Interpolates between two numbers.
const fn ease(t: f64, from: f64, to: f64) -> f64 {
    from + (to - from) * t
}

/// Returns a random drift, see [`DRIFTS`].
fn drift(s: &mut Stroke<'_>) -> f64 {
    log_between(s.random, DRIFTS[0], DRIFTS[1])
}

/// A blade, both ends outside, moves obliquely through the whole body.
pub(super) fn straight(s: &mut Stroke<'_>) {
    s.is_full = true;
    let [x, dx] = [s.between(-0.3, 0.3), s.between(-0.2, 0.2)];
    let [dz, drift] = [s.between(-0.3, 0.3), s.between(-0.3, 0.3)];
    s.walk(|t| {
        let z = ease(t, -1.6, 1.6);
        [-1.0, 1.0].map(|end| [x + dx * end, 1.6 * end + drift * z, z + dz * end])
    });
}

/// As [`straight`], in 16 steps.
pub(super) fn coarse(s: &mut Stroke<'_>) {
    s.count = Some(16);
    straight(s);
}

/// A blade moves across its edge through the whole body, in half of the strokes through its middle.
pub(super) fn press(s: &mut Stroke<'_>) {
    s.is_full = true;
    let spread = pick(s.random, &[0.0, 0.3]);
    let x = s.between(-spread, spread);
    s.walk(|t| [-1.2, 1.2].map(|y| [x, y, ease(t, -1.2, 1.2)]));
}

/// As [`press`], in 24 steps; the sides are pulled apart behind the blade.
pub(super) fn gap(s: &mut Stroke<'_>) {
    (s.count, s.is_gaping) = (Some(24), true);
    press(s);
}

/// A blade of five points bends to and fro.
pub(super) fn bent(s: &mut Stroke<'_>) {
    s.is_full = true;
    let x = s.between(-0.3, 0.3);
    let [bend, bow] = [s.between(-0.2, 0.2), s.between(-0.4, 0.4)];
    s.walk(|t| {
        [-1.0, -0.5, 0.0, 0.5, 1.0].map(|end: f64| {
            let wave = (TAU * t).sin() * (1.0 - end * end);
            [x + bend * wave, 1.2 * end, ease(t, -1.6, 1.6) + bow * wave]
        })
    });
}

/// A blade turns about an axis along its edge.
pub(super) fn curved(s: &mut Stroke<'_>) {
    s.is_full = true;
    let x = s.between(-0.2, 0.2);
    let radius = pick(s.random, &[-1.6, 1.6]);
    s.walk(|t| {
        let angle = ease(t, -0.85, 0.85);
        let [dx, z] = [radius * (0.8 - angle.cos()), 1.6 * angle.sin()];
        [-1.2, 1.2].map(|y| [x + dx, y, z])
    });
}

/// A long blade moves to and fro along its edge while it moves on.
pub(super) fn saw(s: &mut Stroke<'_>, amplitude: f64, count: f64) {
    s.is_full = true;
    let x = s.between(-0.3, 0.3);
    s.walk(|t| {
        let dy = amplitude * (TAU * count * t).sin();
        [-1.8, 1.8].map(|y| [x, y + dy, ease(t, -1.2, 1.2)])
    });
}

/// A blade turns back inside the body and leaves it beside its way in; half of them go through.
pub(super) fn u_turn(s: &mut Stroke<'_>) {
    s.is_full = s.random.signed() < 0.0;
    let end = if s.is_full {
        -1.3
    } else {
        s.between(-0.2, 0.2)
    };
    let radius = s.between(0.25, 0.45);
    s.limit_step(CIRCLE_STEP);
    s.walk(|t| [end, 1.3].map(|y| [-radius, y, ease(t, -1.3, 0.0)]));
    s.walk(|t| {
        let (sin, cos) = (PI * t).sin_cos();
        [end, 1.3].map(|y| [-radius * cos, y, radius * sin])
    });
    s.walk(|t| [end, 1.3].map(|y| [radius, y, ease(t, 0.0, -1.3)]));
}

/// A blade, one end inside, moves inwards on a spiral.
pub(super) fn spiral(s: &mut Stroke<'_>) {
    let end = s.between(-0.4, 0.4);
    s.limit_step(CIRCLE_STEP);
    s.walk(|t| {
        let (sin, cos) = (1.5 * TAU * t).sin_cos();
        let radius = ease(t, OUT, 0.2);
        [end, 1.3].map(|y| [radius * cos, y, radius * sin])
    });
}

/// A blade stops and jitters on its straight way.
pub(super) fn stop_and_go(s: &mut Stroke<'_>) {
    straight(s);
    let mut path = Path::new();
    for pose in std::mem::take(&mut s.paths[0]) {
        path.push(pose.clone());
        let jitter = pick(s.random, &[None, Some(0.0), Some(1e-4), Some(1e-3)]);
        if let Some(jitter) = jitter {
            let offset = to_f32(Vec3::from_fn(|_, _| s.between(-jitter, jitter)));
            let moved = pose.iter().map(|p| [0, 1, 2].map(|k| p[k] + offset[k]));
            path.extend([moved.collect(), pose.clone()]);
        }
    }
    s.paths[0] = path;
}

/// A blade moves into the body along its edge, to a depth, with a drift across it.
pub(super) fn stab(s: &mut Stroke<'_>, depth: f64) {
    let [x, y] = [s.between(-0.4, 0.4), s.between(-0.4, 0.4)];
    let drift = drift(s);
    s.walk(|t| {
        let z = ease(t, -1.2, depth);
        [0.0, -3.0].map(|end| [x + drift * z, y, z + end])
    });
}

/// A blade moves in by a stab or a drag, and back the same way.
pub(super) fn pull_out(s: &mut Stroke<'_>) {
    if s.random.signed() < 0.0 {
        let depth = s.between(-0.5, 0.6);
        stab(s, depth);
    } else {
        let [x, depth] = [s.between(-0.4, 0.4), s.between(-0.5, 0.5)];
        let end = s.between(-0.5, 0.5);
        s.walk(|t| [end, 1.3].map(|y| [x, y, ease(t, -1.2, depth)]));
    }
    for path in &mut s.paths {
        path.extend(path.clone().into_iter().rev());
    }
}

/// A blade stabs to a point inside, circles about it, and closes the cone around a plug.
pub(super) fn cone(s: &mut Stroke<'_>) {
    let apex = [0; 3].map(|_| s.between(-0.1, 0.1));
    let slope = s.between(0.47, 0.84);
    around(s, |angle, along| {
        let (sin, cos) = angle.sin_cos();
        let r = slope * along;
        [apex[0] + r * cos, apex[1] + along, apex[2] + r * sin]
    });
}

/// A blade cuts a cylinder from above; another one passes through above its lower end.
pub(super) fn undercut(s: &mut Stroke<'_>) {
    let [radius, bottom] = [s.between(0.3, 0.5), s.between(-0.3, 0.2)];
    around(s, |angle, along| {
        let (sin, cos) = angle.sin_cos();
        [radius * cos, bottom + along, radius * sin]
    });
    s.lift();
    let y = bottom + s.between(0.05, 0.2);
    s.walk(|t| [-0.7, 0.7].map(|x| [x, y, ease(t, -1.2, 0.7)]));
}

/// A blade moves in along its edge, circles, and moves out; `line` has positions on the edge at an
/// angle and a distance from the tip.
fn around(s: &mut Stroke<'_>, line: impl Fn(f64, f64) -> [f64; 3]) {
    s.is_full = true;
    s.limit_step(CIRCLE_STEP);
    let drift = drift(s);
    let blade = |angle: f64, lift: f64| [0.0, 2.0].map(|end| line(angle, lift + end));
    s.walk(|t| blade(-drift * ease(t, OUT, 0.0), ease(t, OUT, 0.0)));
    s.walk(|t| blade((TAU + OVERLAP) * t, 0.0));
    s.walk(|t| blade(TAU + OVERLAP + drift * OUT * t, OUT * t));
}

/// A blade slits the body; another one passes through the whole body across that slit.
pub(super) fn cross(s: &mut Stroke<'_>, degrees: f64) {
    s.is_full = true;
    let depth = s.between(-0.2, 0.5);
    s.walk(|t| [-1.2, 1.2].map(|y| [0.0, y, ease(t, -1.2, depth)]));
    s.lift();
    let (sin, cos) = degrees.to_radians().sin_cos();
    let x = s.between(-0.1, 0.1);
    s.walk(|t| {
        let z = ease(t, -1.2, 1.2);
        [-2.0, 2.0].map(|y| [x * cos + y * sin, y * cos - x * sin, z])
    });
}

/// A blade, one end inside, leaves the body on its way and enters it again.
pub(super) fn reentry(s: &mut Stroke<'_>) {
    let x = s.between(-0.3, 0.3);
    s.walk(|t| {
        let end = 0.7 + 0.6 * (3.0 * TAU * t).cos();
        [end, end + 1.5].map(|y| [x, y, ease(t, -1.2, 1.2)])
    });
}

/// A short blade passes through the shell of a hollow body, its cavity, and the shell.
pub(super) fn cavity(s: &mut Stroke<'_>) {
    let [x, middle] = [s.between(-0.3, 0.3), s.between(-0.3, 0.3)];
    s.walk(|t| [-0.2, 0.2].map(|y| [x, middle + y, ease(t, -1.2, 1.2)]));
}

/// A short blade passes through the body, with one end or none outside.
pub(super) fn short(s: &mut Stroke<'_>, has_end_outside: bool) {
    let [x, low] = [s.between(-0.3, 0.3), s.between(-0.4, 0.2)];
    let high = if has_end_outside {
        1.3
    } else {
        low + s.between(0.1, 0.5)
    };
    s.walk(|t| [low, high].map(|y| [x, y, ease(t, -1.2, 1.2)]));
}

/// A blade across a sheet moves in from its border; half of them go through.
pub(super) fn sheet_border(s: &mut Stroke<'_>) {
    s.is_full = s.random.signed() < 0.0;
    let depth = if s.is_full { OUT } else { s.between(-0.5, 0.6) };
    let [from, to] = [s.between(-0.4, 0.4), s.between(-0.4, 0.4)];
    s.walk(|t| {
        let [across, along] = [ease(t, from, to), ease(t, -OUT, depth)];
        [-1.0, 1.0].map(|height| [across, along, height])
    });
}

/// A short blade comes down into a sheet, moves in it, and goes up again.
pub(super) fn sheet_inside(s: &mut Stroke<'_>) {
    let [x, turn] = [s.between(-0.5, 0.5), s.between(-0.5, 0.5)];
    s.walk(|t| {
        let height = 3.0 * (PI * t).cos().abs();
        [-1.0, 1.0].map(|end| [x + turn * t, ease(t, -0.7, 0.7), height + end])
    });
}
