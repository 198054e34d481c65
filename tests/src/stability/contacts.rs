//! Bodies that fall on others or hit them, plates that close on a body, and a knot.

use super::group::Group;
use super::runner::Runner;
use super::{Case, Found, Run, larger};
use incise_mesh::Vec3;
use incise_models::scenes::contacts::{
    BAR, CLOSING_SPEED, DRAPED, OPEN_AGAIN, PLATE, bars, block_on_plate, closing, drape,
    plate_distance, tunnel,
};
use incise_models::scenes::cuts::sliced_materials;
use incise_models::scenes::{Grouping, Rope, knot, sprung};
use incise_pbd_gpu::{Material, Stiffness};

pub(super) const CASES: [Case; 6] = [
    Case {
        id: "tunnel",
        stress: "a ball hits a held plate of a tenth of its size by 10 of its diagonals a second",
        invariants: &[("vertices that pass through the plate", 0.0)],
        run: through_plates,
    },
    Case {
        id: "closing",
        stress: "two plates close on a weightless model to half its size, wait and open again",
        invariants: &[
            (
                "distance of a vertex in a plate at the end of a frame, in sizes",
                1e-3,
            ),
            ("speed of a vertex, relative to that of a plate", 10.0),
            (
                "relative volume error, a second after the plates left",
                0.01,
            ),
        ],
        run: press,
    },
    Case {
        id: "knot",
        stress: "a weightless rope with an open trefoil knot, pulled at both ends",
        invariants: &[(
            "missing distance between parts of the rope that are not neighbors, in diameters",
            0.5,
        )],
        run: |runner| vec![Run::new("220 rings".to_owned(), tighten(runner))],
    },
    Case {
        id: "drape",
        stress: "a sheet falls on a held ball, with either side up",
        invariants: &[(
            "depth of a vertex of the sheet in the ball, or of all of the sheet below its top, \
             in radii",
            0.05,
        )],
        run: |runner| {
            [("up", 1.0), ("down", -1.0)]
                .map(|(name, side)| Run::new(format!("outer side {name}"), hang(runner, side)))
                .into()
        },
    },
    Case {
        id: "bars",
        stress: "a bar of 12 triangles falls across a held one, at every angle, as bodies and as \
                 pieces",
        invariants: &[(
            "height that it has lost after a second, in thicknesses",
            0.5,
        )],
        run: cross,
    },
    Case {
        id: "block",
        stress: "a block of 20 cm hits a plate of 2 cm, held at its rim, at 2 to 20 m/s",
        invariants: &[(
            "depth of one in the other at the end of a frame, or of the block below the plate, in \
             thicknesses",
            0.5,
        )],
        run: hit,
    },
];

fn through_plates(runner: &Runner) -> Vec<Run> {
    let mut runs = Vec::new();
    for scale in [1.0, 1e-2, 1e2] {
        for offset in [0.0, 0.21, 0.37, 0.8] {
            runs.extend(sliced_materials().map(|shell| (scale, offset, shell)));
        }
    }
    runner.each(&runs, |(scale, offset, (name, material))| {
        let fly = || -> Found<[f64; 1]> {
            let mut group = Group::new(tunnel(&runner.backend, material, *offset, *scale))?;
            let mut through = 0;
            let mut before = group.positions(1)?;
            for _ in 0..60 {
                group.step(1)?;
                let now = group.positions(1)?;
                let ways = before.iter().zip(&now);
                through += ways
                    .filter(|(p, q)| comes_through(&(*p / *scale), &(*q / *scale)))
                    .count();
                before = now;
            }
            Ok([through as f64])
        };
        Run::new(format!("{name}, {offset} m aside, scale {scale}"), fly())
    })
}

/// Returns whether the segment from `p` to `q` goes down through the plate's middle.
fn comes_through(p: &Vec3, q: &Vec3) -> bool {
    let at = p + (q - p) * (p.y / (p.y - q.y));
    p.y > 0.0 && q.y <= 0.0 && at.x.abs() < 2.0 && at.z.abs() < 2.0
}

fn press(runner: &Runner) -> Vec<Run> {
    let mut runs = Vec::new();
    for subject in runner.closed_subjects(6000) {
        for (name, stretch) in [("firm", 0.0), ("soft", 1e-4)] {
            runs.extend([0, 1].map(|axis| (subject, name, stretch, axis)));
        }
    }
    runner.each(&runs, |&(subject, name, stretch, axis)| {
        let squeeze = || -> Found<[f64; 3]> {
            let material = Material {
                stretch: Stiffness::Compliance(stretch),
                ..sprung()
            };
            let surface = subject.surface.clone();
            let bounds = surface.bounds();
            let middle = bounds.center();
            let size = f64::from(bounds.max[axis] - bounds.min[axis]);
            let mut group = Group::new(closing(&runner.backend, surface, &material, axis))?;
            let (mut depth, mut speed) = (0.0, 0.0);
            let mut frame = 0_u32;
            while f64::from(frame) / 60.0 < OPEN_AGAIN + 1.0 {
                frame += 1;
                group.step(1)?;
                let away = size * plate_distance(f64::from(frame) / 60.0);
                for p in group.positions(0)? {
                    depth = larger(depth, (p[axis] - middle[axis]).abs() - away);
                }
                speed = larger(speed, group.speed([0.0; 3])?);
            }
            Ok([depth, speed / (size * CLOSING_SPEED), group.volume_error()?])
        };
        Run::new(format!("{}, {name}, axis {axis}", subject.name), squeeze())
    })
}

/// Length of rope in which parts are neighbors \[m\]: half a turn of a tight knot.
const NEIGHBORS: f64 = 6.0 * Rope::RADIUS;

fn tighten(runner: &Runner) -> Found<[f64; 1]> {
    let (scripted, rope) = knot(&runner.backend)?;
    let mut group = Group::new(Ok(scripted))?;
    let mut missing = 0.0;
    for _ in 0..120 {
        group.step(1)?;
        let centers = rope.centers(group.body(0)?.surface());
        let mut nearest = f64::INFINITY;
        for (i, p) in centers.iter().enumerate() {
            for (j, q) in centers.iter().enumerate().skip(i + 1) {
                if (j - i) as f64 * rope.spacing > NEIGHBORS {
                    nearest = nearest.min((p - q).norm());
                }
            }
        }
        missing = larger(missing, 1.0 - nearest / (2.0 * Rope::RADIUS));
    }
    Ok([missing])
}

fn hang(runner: &Runner, side: f64) -> Found<[f64; 1]> {
    let mut group = Group::new(drape(&runner.backend, side))?;
    let mut worst = 0.0;
    for _ in 0..180 {
        group.step(1)?;
        let points = group.positions(1)?;
        let top = points.iter().map(|p| p.y).fold(f64::NEG_INFINITY, f64::max);
        let inside = points.iter().map(|p| DRAPED - p.norm()).fold(0.0, larger);
        worst = larger(worst, larger(inside, DRAPED - top) / DRAPED);
    }
    Ok([worst])
}

fn cross(runner: &Runner) -> Vec<Run> {
    let mut runs = Vec::new();
    for (name, grouping) in Grouping::ALL {
        runs.extend(
            (15_u32..=90)
                .step_by(5)
                .map(|angle| (name, grouping, angle)),
        );
    }
    runner.each(&runs, |&(name, grouping, angle)| {
        let fall = || -> Found<[f64; 1]> {
            let radians = f64::from(angle).to_radians();
            let mut group = Group::new(bars(&runner.backend, grouping, radians))?;
            group.step(60)?;
            Ok([(BAR - group.center(1)?.y) / BAR])
        };
        Run::new(format!("{angle} degrees, {name}"), fall())
    })
}

fn hit(runner: &Runner) -> Vec<Run> {
    let speeds = [2.0_f32, 5.0, 10.0, 20.0];
    let of = |(name, grouping)| speeds.map(|speed| (name, grouping, speed));
    let runs: Vec<(&str, Grouping, f32)> = Grouping::ALL.into_iter().flat_map(of).collect();
    runner.each(&runs, |&(name, grouping, speed)| {
        let fall = || -> Found<[f64; 1]> {
            let mut group = Group::new(block_on_plate(&runner.backend, grouping, speed))?;
            let mut worst = 0.0;
            for _ in 0..120 {
                group.step(1)?;
                let below = group.center(0)?.y - group.center(1)?.y;
                worst = larger(worst, larger(group.depth()?, below) / PLATE);
            }
            Ok([worst])
        };
        Run::new(format!("{speed} m/s, {name}"), fall())
    })
}
