//! Blades that cut out a plug: around a point, or around a cylinder and below it.

use crate::common::{check, lattice_box, params};
use incise_cut::{CutParams, Cutter, Incision, IncisionState};
use incise_mesh::geometry::to_f32;
use incise_mesh::{Surface, Vec3, cube_sphere, icosphere};
use proptest::prelude::*;
use std::f64::consts::TAU;

/// A blade that moves in along its edge, circles, passes its start, and moves out again.
#[derive(Debug, Clone, Copy)]
struct Circle {
    /// The middle of the circle of the blade's lower end \[m\].
    middle: [f64; 3],
    /// Radius there, and its growth along the axis.
    radius: f64,
    slope: f64,
    /// Turn of the blade on its way in [rad/m].
    drift: f64,
    steps: u32,
    /// The turn beyond the start [rad].
    overlap: f64,
    /// Whether the blade's first point is the upper one.
    is_reversed: bool,
}

impl Circle {
    fn blade(&self, angle: f64, lift: f64) -> [[f32; 3]; 2] {
        let (sin, cos) = angle.sin_cos();
        let mut blade = [0.0, 2.0].map(|end| {
            let along = lift + end;
            let r = self.radius + self.slope * along;
            to_f32(Vec3::from(self.middle) + Vec3::new(r * cos, along, r * sin))
        });
        if self.is_reversed {
            blade.reverse();
        }
        blade
    }

    /// Returns the poses in turn: in, around, and out.
    fn poses(&self) -> [Vec<[[f32; 3]; 2]>; 2] {
        const OUT: f64 = 1.5;
        let steps = |n: u32| (0..=n).map(move |i| f64::from(i) / f64::from(n));
        let turn = TAU + self.overlap;
        let enter = steps(self.steps).map(|s| OUT * (1.0 - s));
        let enter = enter.map(|lift| self.blade(-self.drift * lift, lift));
        let around = steps(self.steps).map(|s| self.blade(turn * s, 0.0));
        let leave = steps(self.steps).map(|s| self.blade(turn, OUT * s));
        [enter.chain(around).collect(), leave.collect()]
    }

    /// Cuts a body: no step is refused, the cut is complete, and on its way out the blade cuts
    /// nothing.
    fn cut(&self, body: &mut Surface, params: &CutParams) {
        let mut cutter = Cutter::new(body);
        let mut incision = Incision::default();
        let [cutting, leaving] = self.poses();
        for pose in cutting {
            let _ = cutter.advance(body, &mut incision, &pose, params).unwrap();
            check(body);
        }
        let state = incision.state();
        assert_eq!(state, IncisionState::Finished, "the cut is complete");
        for pose in leaving {
            let outcome = cutter.advance(body, &mut incision, &pose, params);
            assert!(outcome.unwrap().is_miss(), "nothing is cut on the way out");
        }
    }
}

/// Checks that a body is in two parts of at least 2 % of its volume.
fn assert_parted(body: &Surface, volume: f64) {
    let volumes = body.piece_volumes();
    assert_eq!(volumes.len(), 2, "{volumes:?}");
    assert!(volumes.iter().all(|&v| v > 0.02 * volume), "{volumes:?}");
    let error = (volumes.iter().sum::<f64>() / volume - 1.0).abs();
    assert!(error < 1e-4, "{error}");
}

/// Returns one of three balls of radius 1 m, at rest or stretched and bent.
fn ball(i: usize, is_bent: bool) -> Surface {
    let mut ball = [icosphere(3, 1.0), cube_sphere(8, 1.0), icosphere(4, 1.0)][i].clone();
    for p in ball.positions_mut().iter_mut().filter(|_| is_bent) {
        p[0] *= 1.3;
        p[1] += 0.05 * (3.0 * p[0]).sin();
    }
    ball
}

fn circles(
    radius: impl Strategy<Value = f64>,
    slope: impl Strategy<Value = f64>,
) -> impl Strategy<Value = Circle> {
    let middle = [(); 3].map(|()| -0.1..0.1f64);
    let drift = prop_oneof![Just(0.0), 0.001..0.01f64];
    let turns = (24u32..90, 0.02..0.3f64, any::<bool>());
    (middle, radius, slope, drift, turns).prop_map(|(middle, radius, slope, drift, turns)| Circle {
        middle,
        radius,
        slope,
        drift,
        steps: turns.0,
        overlap: turns.1,
        is_reversed: turns.2,
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn a_cone_cuts_out_a_plug(
        body in 0usize..3,
        is_bent in any::<bool>(),
        circle in circles(Just(0.0), 0.4..0.85f64),
        snap in prop::sample::select(vec![0.0, 0.1]),
    ) {
        let mut body = ball(body, is_bent);
        let volume = body.volume();
        circle.cut(&mut body, &params(snap));
        assert_parted(&body, volume);
    }

    #[test]
    fn a_cylinder_is_closed(
        body in 0usize..3,
        is_bent in any::<bool>(),
        circle in circles(0.25..0.5f64, Just(0.0)),
        snap in prop::sample::select(vec![0.0, 0.1]),
    ) {
        let mut body = ball(body, is_bent);
        circle.cut(&mut body, &params(snap));
        prop_assert_eq!(body.piece_volumes().len(), 1);
    }

    #[test]
    fn a_cylinder_and_a_cut_below_free_a_plug(
        body in 0usize..3,
        circle in circles(0.25..0.5f64, Just(0.0)),
        height in 0.05..0.25f64,
        snap in prop::sample::select(vec![0.0, 0.1]),
    ) {
        let mut body = ball(body, false);
        let volume = body.volume();
        circle.cut(&mut body, &params(snap));
        let mut incision = Incision::default();
        let mut cutter = Cutter::new(&body);
        for i in 0..=32u8 {
            let z = -1.2 + 2.0 * f64::from(i) / 32.0;
            let at = |x: f64| to_f32(Vec3::from(circle.middle) + Vec3::new(x, height, z));
            let pose = [-0.7, 0.7].map(at);
            let _ = cutter.advance(&mut body, &mut incision, &pose, &params(snap)).unwrap();
            check(&body);
        }
        assert_parted(&body, volume);
    }
}
/// A blade that closes a circle in 16 steps, of up to three edges each.
#[test]
fn a_fast_blade_closes_its_circle() {
    for (steps, slope) in [(16, 0.5), (16, 0.8), (24, 0.6)] {
        for (radius, overlap) in [(0.0, 0.1), (0.0, 0.3), (0.15, 0.1), (0.15, 0.02)] {
            let circle = Circle {
                middle: [0.0123, 0.2345, -0.0345],
                radius,
                slope,
                drift: 0.0,
                steps,
                overlap,
                is_reversed: false,
            };
            let mut body = icosphere(4, 1.0);
            let volume = body.volume();
            circle.cut(&mut body, &params(0.1));
            if radius == 0.0 {
                assert_parted(&body, volume);
            } else {
                assert_eq!(body.piece_count(), 1, "{circle:?}");
            }
        }
    }
}

/// Edges of a cube of twelve triangles are longer than the whole circle.
#[test]
fn a_plug_is_cut_out_of_a_cube_of_twelve_triangles() {
    for (steps, slope) in [(24, 0.6), (40, 0.7), (90, 0.5)] {
        for is_reversed in [false, true] {
            let circle = Circle {
                middle: [0.023, 0.02, -0.045],
                radius: 0.0,
                slope,
                drift: 0.002,
                steps,
                overlap: 0.1,
                is_reversed,
            };
            let mut body = lattice_box([1; 3], |p| p.map(|x| 2.0 * x - 1.0));
            let volume = body.volume();
            circle.cut(&mut body, &params(0.1));
            assert_parted(&body, volume);
        }
    }
}
