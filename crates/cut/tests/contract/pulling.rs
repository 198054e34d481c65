//! Blades that are pulled out along their edge, and stabs that go on to both sides.

use crate::common::{check, check_manifold, lattice_box, params};
use incise_cut::{Cutter, Incision, IncisionState};
use incise_mesh::geometry::to_f32;
use incise_mesh::{Surface, Vec3, cube_sphere, icosphere, sheet, torus};
use proptest::prelude::*;

/// Length of the blade \[m\], more than the diameter of each body.
const LENGTH: f64 = 2.0;

/// A blade that keeps its direction, and the frame of its motion.
#[derive(Debug, Clone, Copy)]
struct Knife {
    /// The unit vectors of its edge, into the body, and of its motion across.
    along: Vec3,
    across: Vec3,
    /// Distance of the plane in which it moves from the middle of the body \[m\].
    offset: f64,
}

/// How far a blade has moved across, and how deep its end is, from the middle of the body \[m\].
type Place = [f64; 2];

fn knife() -> impl Strategy<Value = Knife> {
    let frame = (0.0..3.1, 0.0..6.2, 0.0..6.2, -0.1..0.1);
    frame.prop_map(|(polar, azimuth, turn, offset): (f64, f64, f64, f64)| {
        let (sin, cos) = polar.sin_cos();
        let along = Vec3::new(sin * azimuth.cos(), sin * azimuth.sin(), cos);
        let side = Vec3::new(cos * azimuth.cos(), cos * azimuth.sin(), -sin);
        let across = side * turn.cos() + along.cross(&side) * turn.sin();
        Knife {
            along,
            across,
            offset,
        }
    })
}

fn body(number: u8) -> Surface {
    match number {
        0 => icosphere(3, 0.5),
        1 => icosphere(2, 0.5),
        2 => cube_sphere(6, 0.5),
        3 => cube_sphere(1, 0.5),
        _ => torus(0.35, 0.15, 32, 16),
    }
}

/// Returns the places of a straight motion of the blade's end in equal steps, without its start.
fn motion(from: Place, to: Place, step: f64) -> Vec<Place> {
    let length = (to[0] - from[0]).hypot(to[1] - from[1]);
    let count = (1u16..).find(|&count| f64::from(count) * step >= length);
    let count = count.unwrap();
    let place = |i: u16| {
        let part = f64::from(i) / f64::from(count);
        [0, 1].map(|k| from[k] + (to[k] - from[k]) * part)
    };
    (1..=count).map(place).collect()
}

/// A body, and the blade in it.
struct Trial {
    body: Surface,
    cutter: Cutter,
    incision: Incision,
    knife: Knife,
    snap: f64,
}

impl Trial {
    fn new(body: &Surface, knife: Knife, snap: f64) -> Self {
        Self {
            body: body.clone(),
            cutter: Cutter::new(body),
            incision: Incision::default(),
            knife,
            snap,
        }
    }

    /// Moves the blade's end to places in turn. Returns the area of the new walls \[m²\].
    fn advance(&mut self, places: &[Place]) -> f64 {
        let before = self.body.area();
        for &[across, depth] in places {
            let Knife {
                along: edge,
                across: motion,
                offset,
            } = self.knife;
            let end = edge * depth + motion * across + edge.cross(&motion) * offset;
            let blade = [to_f32(end - edge * LENGTH), to_f32(end)];
            let (cutter, body) = (&mut self.cutter, &mut self.body);
            let outcome = cutter.advance(body, &mut self.incision, &blade, &params(self.snap));
            let _ = outcome.unwrap_or_else(|error| panic!("[{across}, {depth}]: {error}"));
        }
        check(&self.body);
        self.body.area() - before
    }
}

/// Moves a blade along poses, none of which is refused. Returns the body and the state.
fn moved(mut body: Surface, poses: &[[[f32; 3]; 2]], snap: f64) -> (Surface, IncisionState) {
    let mut cutter = Cutter::new(&body);
    let mut incision = Incision::default();
    for pose in poses {
        let outcome = cutter.advance(&mut body, &mut incision, pose, &params(snap));
        let _ = outcome.unwrap_or_else(|error| panic!("{pose:?}: {error}"));
        check_manifold(&body);
    }
    (body, incision.state())
}

#[test]
fn a_blade_that_turns_back_as_it_leaves_cuts_through() {
    let cube = lattice_box([1; 3], |p| p.map(|x| x - 0.5));
    for last in [-0.4f32, -0.35, -0.3, -0.15] {
        let places = [(-0.7, 0.1), (0.3, 0.1), (0.3, last), (0.7, last)];
        let poses = places.map(|(x, y)| [[x, y, -1.0], [x, y, 1.0]]);
        let (body, state) = moved(cube.clone(), &poses, 0.0);
        assert_eq!(
            (state, body.piece_count()),
            (IncisionState::Finished, 2),
            "{last}"
        );
    }
}

/// Less than half an edge ahead of the tip, to which it has not caught up.
#[test]
fn a_blade_that_is_put_in_again_leaves_no_bridge() {
    let cells = lattice_box([4; 3], |p| p.map(|x| x - 0.5));
    for (body, snap) in [(cells, 0.1), (icosphere(2, 0.5), 0.0)] {
        let at = |x: f32, lift: f32| [[x, 0.01, -2.0 - lift], [x, 0.01, 1.0 - lift]];
        let cut = [-0.8, -0.3, -0.2, -0.15].map(|x| at(x, 0.0));
        let out = [at(-0.15, 2.1), at(-0.15, 2.2), at(-0.15, 0.0)];
        let on = [-0.1, -0.05, 0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6].map(|x| at(x, 0.0));
        let (body, _) = moved(body, &[&cut[..], &out, &on].concat(), snap);
        assert_eq!(body.piece_count(), 2, "snap {snap}");
    }
}

#[test]
fn a_blade_that_is_pulled_out_of_a_sheet_goes_on_at_its_tip() {
    let whole = sheet([1.0, 1.0], [10, 7]);
    let at = |y: f32, lift: f32| [[0.013, y, -1.0 - lift], [0.013, y, 1.0 - lift]];
    let cut = [-1.0, -0.3, -0.1, -0.08].map(|y| at(y, 0.0));
    let poses = [&cut[..], &[at(-0.08, 2.0)]].concat();
    let (body, state) = moved(whole.clone(), &poses, 0.1);
    assert_eq!((state, body.piece_count()), (IncisionState::Abandoned, 1));
    let on = [-0.08, 0.1, 0.3, 0.8].map(|y| at(y, 0.0));
    let (body, _) = moved(whole, &[&poses[..], &on].concat(), 0.1);
    assert_eq!(body.piece_count(), 2);
}

proptest! {
    /// A blade that is pulled out almost along its edge abandons its cut.
    ///
    /// Its walls are no larger than its motion across, even if its end had passed the body.
    #[test]
    fn a_blade_that_is_pulled_out_abandons_its_cut(
        number in 0u8..5,
        knife in knife(),
        depth in prop::sample::select(vec![-0.2, -0.05, 0.1, 0.2, 1.0]),
        step in 0.02f64..0.15,
        drift in prop::sample::select(vec![-0.1, 0.0, 0.02]),
        snap in prop::sample::select(vec![0.0, 0.1]),
        stop in -0.2f64..0.2,
    ) {
        let body = body(number);
        let mut trial = Trial::new(&body, knife, snap);
        let _ = trial.advance(&[[-0.9, depth]]);
        let _ = trial.advance(&motion([-0.9, depth], [stop, depth], step));
        prop_assume!(trial.incision.is_inside());
        let way = depth + 0.9;
        let walls = trial.advance(&motion([stop, depth], [stop + drift * way, -0.9], step));
        let state = trial.incision.state();
        // A drift may cut on through a thin part.
        prop_assert!(state == IncisionState::Abandoned || drift != 0.0, "{:?}", state);
        prop_assert!(!trial.incision.is_inside() || state == IncisionState::Abandoned);
        prop_assert_eq!(trial.body.piece_count(), 1);
        // Half an edge is caught up with, along the depth of the body; both walls count.
        let edges = body.mean_edge_length().min(0.1 * body.bounds().diagonal());
        let moved = 0.5 * edges + drift.max(0.0) * way;
        prop_assert!(walls <= 2.0 * moved, "{} of {}", walls, 2.0 * moved);
    }

    /// A stab that is widened to one side and then to the other makes one slit.
    #[test]
    fn a_stab_is_widened_to_both_sides(
        number in 0u8..4,
        knife in knife(),
        depth in -0.2f64..0.1,
        step in 0.02f64..0.1,
        snap in prop::sample::select(vec![0.0, 0.1]),
        half in 0.15f64..0.3,
    ) {
        let mut trial = Trial::new(&body(number), knife, snap);
        let _ = trial.advance(&motion([0.0, -0.9], [0.0, depth], step));
        let first = trial.advance(&motion([0.0, depth], [half, depth], step));
        let back = trial.advance(&motion([half, depth], [0.0, depth], step));
        let second = trial.advance(&motion([0.0, depth], [-half, depth], step));
        let _ = trial.advance(&motion([-half, depth], [-half, -0.9], step));
        prop_assert!(first > 0.0 && back == 0.0, "{} {}", first, back);
        prop_assert!(second > 0.25 * first, "{} {}", first, second);
        prop_assert_eq!(trial.body.piece_count(), 1);
    }
}
