//! The four bodies of the table that are not spheres, as implicit functions: y up, facing z.

use crate::implicit::{Body, Primitive, ellipsoid, tilted_ellipsoid, tube};
use crate::tube::Tube;
use incise_mesh::Vec3;

/// Grid spacing of each body, fine enough for its thinnest part.
pub(super) const BUNNY_CELL: f64 = 0.045;
pub(super) const OCTOPUS_CELL: f64 = 0.042;
pub(super) const BANANA_CELL: f64 = 0.03;
pub(super) const ARMADILLO_CELL: f64 = 0.0195;

/// Height of the bumps on the armadillo's shell.
const BUMP_HEIGHT: f64 = 0.028;

pub(super) fn bunny() -> Body {
    Body::new()
        .with(ellipsoid([0.0, 0.62, -0.15], [0.50, 0.56, 0.70]), 0.1)
        .with(ellipsoid([0.0, 0.66, 0.36], [0.35, 0.44, 0.34]), 0.2)
        .with_pair(ellipsoid([0.39, 0.38, -0.36], [0.22, 0.36, 0.38]), 0.05)
        .with(ellipsoid([0.0, 1.30, 0.60], [0.30, 0.31, 0.37]), 0.16)
        .with(ellipsoid([0.0, 1.20, 0.94], [0.15, 0.13, 0.16]), 0.08)
        .with_pair(ellipsoid([0.17, 1.18, 0.70], [0.15, 0.14, 0.16]), 0.08)
        .with_pair(
            tilted_ellipsoid([0.24, 1.88, 0.38], [0.145, 0.50, 0.11], [0.25, 1.0, -0.35]),
            0.08,
        )
        .without_pair(
            tilted_ellipsoid(
                [0.245, 1.95, 0.50],
                [0.075, 0.36, 0.075],
                [0.25, 1.0, -0.35],
            ),
            0.05,
        )
        .with_pair(ellipsoid([0.36, 0.10, 0.06], [0.15, 0.11, 0.36]), 0.06)
        .with_pair(
            tube(&[
                [0.20, 0.55, 0.52, 0.15],
                [0.19, 0.25, 0.66, 0.11],
                [0.19, 0.10, 0.74, 0.10],
                [0.19, 0.09, 0.88, 0.09],
            ]),
            0.06,
        )
        .with(ellipsoid([0.0, 0.46, -0.90], [0.19, 0.19, 0.18]), 0.06)
}

pub(super) fn octopus() -> Body {
    /// Each arm: initial direction (x, z), curl to its left, reach, height of its tip.
    const ARMS: [[f64; 5]; 8] = [
        [0.924, 0.383, 0.30, 1.75, 0.32],
        [0.383, 0.924, 0.42, 1.60, 0.10],
        [-0.383, 0.924, 0.25, 1.70, 0.45],
        [-0.924, 0.383, 0.45, 1.65, 0.09],
        [-0.924, -0.383, 0.30, 1.75, 0.38],
        [-0.383, -0.924, 0.40, 1.65, 0.09],
        [0.383, -0.924, 0.28, 1.75, 0.28],
        [0.924, -0.383, 0.45, 1.60, 0.12],
    ];
    let mut body = Body::new()
        .with(ellipsoid([0.0, 0.46, 0.0], [0.42, 0.34, 0.42]), 0.1)
        .with(
            tilted_ellipsoid([0.0, 1.12, -0.16], [0.50, 0.66, 0.52], [0.0, 1.0, -0.3]),
            0.20,
        )
        .with_pair(ellipsoid([0.30, 0.66, 0.30], [0.13, 0.13, 0.13]), 0.05);
    for [x, z, curl, reach, tip] in ARMS {
        let at = |out: f64, left: f64, y: f64, radius: f64| {
            [x * out - z * left, y, z * out + x * left, radius]
        };
        body = body.with(
            tube(&[
                at(0.20, 0.0, 0.36, 0.19),
                at(0.52, 0.0, 0.20, 0.16),
                at(0.90, -0.06, 0.13, 0.13),
                at(0.55 * reach + 0.30, 0.02, 0.11, 0.10),
                at(0.85 * reach, 0.45 * curl, 0.10 + 0.3 * (tip - 0.09), 0.075),
                at(reach, curl, tip, 0.058),
            ]),
            0.10,
        );
    }
    body
}

pub(super) fn banana() -> Body {
    Body::new().with(
        Primitive::Tube(
            Tube::new(&[
                [-1.36, 0.98, 0.0, 0.085],
                [-1.30, 0.80, 0.0, 0.075],
                [-1.18, 0.52, 0.0, 0.095],
                [-1.02, 0.30, 0.0, 0.19],
                [-0.70, 0.06, 0.0, 0.27],
                [-0.25, -0.10, 0.0, 0.305],
                [0.25, -0.10, 0.0, 0.30],
                [0.70, 0.06, 0.0, 0.26],
                [1.02, 0.30, 0.0, 0.18],
                [1.17, 0.50, 0.0, 0.09],
                [1.21, 0.60, 0.0, 0.065],
            ])
            .with_ridges(0.045),
        ),
        0.1,
    )
}

pub(super) fn armadillo() -> Body {
    let mut body = Body::new()
        .with(ellipsoid([0.0, 1.30, 0.02], [0.40, 0.58, 0.33]), 0.1)
        .with(ellipsoid([0.0, 1.12, 0.12], [0.33, 0.42, 0.29]), 0.10)
        .with(ellipsoid([0.0, 1.36, -0.14], [0.48, 0.62, 0.34]), 0.08)
        .with(
            tube(&[[0.0, 1.75, 0.0, 0.24], [0.0, 2.05, 0.16, 0.17]]),
            0.12,
        )
        .with(ellipsoid([0.0, 2.12, 0.22], [0.20, 0.20, 0.26]), 0.08)
        .with(
            tube(&[
                [0.0, 2.11, 0.38, 0.13],
                [0.0, 2.05, 0.60, 0.085],
                [0.0, 2.00, 0.78, 0.06],
            ]),
            0.08,
        )
        .with_pair(
            tilted_ellipsoid([0.20, 2.40, 0.10], [0.10, 0.21, 0.05], [0.45, 1.0, -0.25]),
            0.06,
        )
        .with_pair(ellipsoid([0.115, 2.20, 0.40], [0.045, 0.045, 0.045]), 0.03)
        .with_pair(
            tube(&[
                [0.36, 1.70, 0.0, 0.18],
                [0.70, 1.60, 0.08, 0.145],
                [0.90, 1.78, 0.24, 0.12],
                [0.96, 2.12, 0.36, 0.095],
            ]),
            0.08,
        )
        .with_pair(ellipsoid([0.97, 2.22, 0.39], [0.11, 0.12, 0.08]), 0.06)
        .with_pair(
            tube(&[
                [0.24, 0.98, 0.02, 0.25],
                [0.38, 0.66, 0.07, 0.20],
                [0.42, 0.34, 0.0, 0.14],
                [0.43, 0.13, 0.0, 0.13],
            ]),
            0.10,
        )
        .with_pair(ellipsoid([0.44, 0.10, 0.14], [0.15, 0.10, 0.26]), 0.06)
        .with(
            tube(&[
                [0.0, 0.92, -0.25, 0.22],
                [0.0, 0.58, -0.58, 0.15],
                [0.0, 0.28, -0.92, 0.10],
                [0.0, 0.20, -1.30, 0.05],
            ]),
            0.10,
        )
        .with_relief(shell_bumps, BUMP_HEIGHT);
    for (base, tip) in [
        ([0.89, 2.29, 0.40, 0.045], [0.80, 2.44, 0.46, 0.024]),
        ([0.96, 2.32, 0.40, 0.045], [0.94, 2.50, 0.46, 0.024]),
        ([1.03, 2.29, 0.40, 0.045], [1.09, 2.46, 0.46, 0.024]),
        ([1.06, 2.18, 0.40, 0.045], [1.19, 2.26, 0.47, 0.024]),
    ] {
        body = body.with_pair(tube(&[base, tip]), 0.03);
    }
    for x in [0.34, 0.44, 0.54] {
        body = body.with_pair(
            tube(&[
                [x, 0.08, 0.34, 0.055],
                [x * 1.06 - 0.024, 0.05, 0.50, 0.028],
            ]),
            0.04,
        );
    }
    body
}

/// Returns the height of the rows of bumps on the back, between two smooth edges.
fn shell_bumps(p: Vec3) -> f64 {
    const PITCH: f64 = 0.115;
    let mask = smooth_step((-0.06 - p.z) / 0.12)
        * smooth_step((p.y - 0.86) / 0.1)
        * smooth_step((1.92 - p.y) / 0.1)
        * smooth_step((0.5 - p.x.abs()) / 0.1);
    if mask == 0.0 {
        return 0.0;
    }
    let row = p.y / PITCH;
    // Every other row is shifted by half a bump, like scales.
    let shift = if row.floor() % 2.0 == 0.0 { 0.0 } else { 0.5 };
    -BUMP_HEIGHT * mask * bump(row) * bump(p.x / PITCH + shift)
}

/// Returns a wave of period 1, which is 0 at integers and 1 between them.
fn bump(t: f64) -> f64 {
    let s = t - t.floor();
    let arch = 4.0 * s * (1.0 - s);
    arch * arch
}

/// Returns a smooth step from 0 at 0 to 1 at 1.
fn smooth_step(t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
