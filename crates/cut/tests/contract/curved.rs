//! Blades of more than two points that move on from frame to frame.

use crate::common::{check, check_manifold, params, shortest_edge};
use incise_cut::{CutError, Cutter, Incision};
use incise_mesh::geometry::{to_f32, to_f64};
use incise_mesh::{Surface, Vec3, icosphere, sheet, torus};
use proptest::prelude::*;

/// The shape of a blade with ends at -1 and 1, as its distance from the line between them.
#[derive(Debug, Clone)]
enum Shape {
    /// An arc of this height.
    Arc(f32),
    /// Two straight parts.
    Bent(f32),
    /// Points on alternating sides.
    Zigzag(f32),
    /// Points at any distances.
    Any([f32; 8]),
}

impl Shape {
    /// Returns the height of point `i` at `s`, from -1 to 1 along the blade.
    fn height(&self, i: u16, s: f32) -> f32 {
        match self {
            Self::Arc(height) => height * (1.0 - s * s),
            Self::Bent(height) => height * (1.0 - s.abs()),
            Self::Zigzag(height) => height * if i.is_multiple_of(2) { 1.0 } else { -1.0 },
            Self::Any(heights) => heights[usize::from(i)],
        }
    }
}

fn shape() -> impl Strategy<Value = Shape> {
    prop_oneof![
        (-0.5f32..0.5).prop_map(Shape::Arc),
        (-0.5f32..0.5).prop_map(Shape::Bent),
        (-0.2f32..0.2).prop_map(Shape::Zigzag),
        prop::array::uniform8(-0.15f32..0.15).prop_map(Shape::Any),
    ]
}

/// A curved blade that moves along x and turns about y.
#[derive(Debug, Clone)]
struct Motion {
    shape: Shape,
    points: u16,
    half: f32,
    center: [f32; 3],
    /// The direction of the curve, from x at 0 to y at 1 \[quarter turns\].
    lean: f32,
    turn: f32,
    drop: f32,
}

impl Motion {
    fn pose(&self, x: f32) -> Vec<[f32; 3]> {
        let (sin, cos) = (self.turn * x).sin_cos();
        let lean = std::f32::consts::FRAC_PI_2 * self.lean;
        let point = |i: u16| {
            let s = 2.0 * f32::from(i) / f32::from(self.points - 1) - 1.0;
            let (along, out) = (self.half * s, self.shape.height(i, s));
            let (forward, up) = (out * lean.cos(), out * lean.sin());
            [
                x + self.center[0] + forward * cos + along * sin,
                self.center[1] + up + self.drop * x,
                self.center[2] + along * cos - forward * sin,
            ]
        };
        (0..self.points).map(point).collect()
    }
}

fn motion() -> impl Strategy<Value = Motion> {
    let center = prop::array::uniform3(-0.2f32..0.2);
    (
        shape(),
        3..9u16,
        0.2..1.2f32,
        center,
        0.0..1.0f32,
        -0.4..0.4f32,
        -0.2..0.2f32,
    )
        .prop_map(|(shape, points, half, center, lean, turn, drop)| Motion {
            shape,
            points,
            half,
            center,
            lean,
            turn,
            drop,
        })
}

/// Moves a blade through a surface and checks it after each step.
///
/// A step is refused only at the walls of the incision, where its tip is on the surface, or where
/// the blade is in the body without touching it.
fn stroke(whole: &Surface, motion: &Motion, steps: u16, snap: f64) {
    let is_closed = whole.topology().is_closed();
    let mut body = whole.clone();
    let mut cutter = Cutter::new(&body);
    let mut incision = Incision::default();
    for i in 0..=steps {
        let pose = motion.pose(-1.3 + 2.6 * f32::from(i) / f32::from(steps));
        let before = body.clone();
        match cutter.advance(&mut body, &mut incision, &pose, &params(snap)) {
            Ok(_) => {}
            Err(error) => {
                let is_expected = matches!(
                    error,
                    CutError::TipBlocked { .. }
                        | CutError::PartialCut { .. }
                        | CutError::OpenSection
                );
                assert!(is_expected, "step {i}: {error}");
                assert_eq!(body, before, "a refused step changes nothing");
                incision.restart(&pose);
            }
        }
        if is_closed {
            check(&body);
            let error = (body.volume() / before.volume() - 1.0).abs();
            let bound = if snap == 0.0 { 1e-5 } else { 2e-3 };
            assert!(error < bound, "step {i}: the volume changes by {error}");
        } else {
            check_manifold(&body);
        }
        cutter.bvh().validate(&body).unwrap();
    }
}

proptest! {
    #[test]
    fn curved_blades_keep_bodies_closed(
        body in 0..2usize,
        motion in motion(),
        steps in 3..40u16,
        snap in prop::sample::select(vec![0.0, 0.1]),
    ) {
        let whole = [icosphere(3, 0.5), torus(0.35, 0.15, 32, 16)][body].clone();
        stroke(&whole, &motion, steps, snap);
    }

    #[test]
    fn curved_blades_cut_sheets(
        motion in motion(),
        steps in 3..40u16,
        snap in prop::sample::select(vec![0.0, 0.1]),
    ) {
        stroke(&sheet([1.0, 1.0], [21, 17]), &motion, steps, snap);
    }
}

/// Points nearest to the tip would lie on other segments of these blades.
#[test]
fn zigzag_and_bent_blades_keep_their_shape() {
    let motion = |shape, points, height, lean, drop| Motion {
        shape,
        points,
        half: 0.2,
        center: [0.0, height, 0.0],
        lean,
        turn: 0.0,
        drop,
    };
    let zigzag = motion(Shape::Zigzag(-0.119_419_105), 4, 0.0, 0.0, 0.0);
    let bent = motion(
        Shape::Bent(0.171_757_55),
        3,
        0.131_841_03,
        0.186_417_94,
        0.040_011_782,
    );
    for (motion, steps) in [(zigzag, 23), (bent, 19)] {
        stroke(&icosphere(3, 0.5), &motion, steps, 0.0);
    }
}

/// The middle point of a blade lies exactly in the cloth, where the tip is.
#[test]
fn a_point_of_the_blade_in_the_cloth() {
    let whole = sheet([1.0, 1.0], [21, 17]);
    for bend in [0.0, 0.05, -0.05] {
        for steps in [5u16, 12, 33] {
            let mut body = whole.clone();
            let mut cutter = Cutter::new(&body);
            let mut incision = Incision::default();
            for i in 0..=steps {
                let x = -0.7 + 1.4 * f32::from(i) / f32::from(steps);
                let pose = [[x, 0.013, -0.5], [x + bend, 0.013, 0.0], [x, 0.013, 0.5]];
                let outcome = cutter.advance(&mut body, &mut incision, &pose, &params(0.1));
                let _ =
                    outcome.unwrap_or_else(|error| panic!("bend {bend} step {i}/{steps}: {error}"));
                check_manifold(&body);
            }
            assert_eq!(body.piece_count(), 2, "bend {bend} steps {steps}");
        }
    }
}

/// Points at which a blade is straight change no step.
#[test]
fn straight_points_of_a_blade_change_nothing() {
    let mut whole = icosphere(3, 1.0);
    for p in whole.positions_mut() {
        (p[1], p[2]) = (0.4 * p[1], 0.7 * p[2]);
    }
    for p in whole.rest_positions_mut() {
        (p[1], p[2]) = (0.4 * p[1], 0.7 * p[2]);
    }
    let starts = [
        [0.700_692_8, -0.482_137_38, 0.209_689_48],
        [0.560_518_4, -0.525_513_7, 0.276_867_72],
        [0.406_644_46, -0.567_450_64, 0.301_513_1],
        [0.250_880_66, -0.604_729_4, 0.281_734_08],
    ];
    let end = Vec3::new(0.242_237_42, 0.043_534_167, -0.213_666_93);
    let mut counts = Vec::new();
    for points in [2u16, 3, 4, 5, 6, 9] {
        let mut body = whole.clone();
        let mut cutter = Cutter::new(&body);
        let mut incision = Incision::default();
        for start in starts {
            let at = |i: u16| to_f64(start).lerp(&end, f64::from(i) / f64::from(points - 1));
            let pose: Vec<[f32; 3]> = (0..points).map(|i| to_f32(at(i))).collect();
            let _ = cutter
                .advance(&mut body, &mut incision, &pose, &params(0.1))
                .unwrap();
            check(&body);
        }
        let shortest = shortest_edge(&body);
        assert!(shortest > 0.0, "{points} points: {shortest}");
        counts.push((points, body.topology().triangle_count()));
    }
    assert!(counts.iter().all(|c| c.1 == counts[0].1), "{counts:?}");
}
