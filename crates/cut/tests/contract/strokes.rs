//! Straight strokes in any number of steps: none is refused, and each gives the pieces of one
//! slice.

use crate::common::{check, params};
use incise_cut::{CutError, Cutter, Incision, IncisionState, Sweep};
use incise_mesh::{Surface, VertexId, cube_sphere, icosphere, torus};
use proptest::prelude::*;

/// Maximum difference of the volumes of a piece after steps and after one slice [whole volume].
///
/// A step may be displaced by a hundredth of an edge, and snapping moves the surface.
const MAX_VOLUME_ERROR: f64 = 5e-3;

/// A blade of two points that moves straight along an axis, through a body of about 1 m.
#[derive(Debug, Clone, Copy)]
struct Stroke {
    place: [f32; 3],
    axis: usize,
    tilt: [f32; 3],
    steps: u16,
    snap: f64,
}

impl Stroke {
    /// Returns the blade's first pose and its motion \[m\].
    fn blade(&self) -> ([[f32; 3]; 2], [f32; 3]) {
        let Self {
            place, axis, tilt, ..
        } = *self;
        let along = (axis + 1) % 3;
        let across = 3 - axis - along;
        let ends = [-1.2f32, 1.2].map(|end| {
            let mut p = place;
            p[axis] = -1.0 + tilt[0] * end;
            p[along] += end;
            p[across] += tilt[1] * end;
            p
        });
        let mut motion = [0.0; 3];
        motion[axis] = 2.0;
        motion[across] = tilt[2];
        (ends, motion)
    }

    /// Cuts a body in equal steps.
    ///
    /// # Errors
    /// The first step that is refused, and why.
    fn steps(&self, whole: &Surface) -> Result<Surface, (u16, CutError)> {
        let (ends, motion) = self.blade();
        let mut body = whole.clone();
        let mut cutter = Cutter::new(&body);
        let mut incision = Incision::default();
        for i in 0..=self.steps {
            let s = f32::from(i) / f32::from(self.steps);
            let pose = ends.map(|p| [0, 1, 2].map(|c| p[c] + motion[c] * s));
            let outcome = cutter.advance(&mut body, &mut incision, &pose, &params(self.snap));
            let _ = outcome.map_err(|error| (i, error))?;
        }
        assert!(!incision.is_inside(), "the blade is out");
        Ok(body)
    }

    /// Cuts a body in equal steps, moves its pieces apart and the blade back in any number of
    /// steps, and checks that this cuts nothing.
    fn check_way_back(&self, whole: &Surface, gap: f32, steps: u16) {
        let (ends, motion) = self.blade();
        let mut body = whole.clone();
        let mut cutter = Cutter::new(&body);
        let mut incision = Incision::default();
        let mut move_to = |body: &mut Surface, cutter: &mut Cutter, s: f32| {
            let pose = ends.map(|p| [0, 1, 2].map(|c| p[c] + motion[c] * s));
            let outcome = cutter.advance(body, &mut incision, &pose, &params(self.snap));
            (outcome.map(|outcome| outcome.is_miss()), incision.state())
        };
        for i in 0..=self.steps {
            let (outcome, _) =
                move_to(&mut body, &mut cutter, f32::from(i) / f32::from(self.steps));
            let _ = outcome.unwrap();
        }
        let across = 3 - self.axis - (self.axis + 1) % 3;
        let vertices: Vec<VertexId> = body.topology().vertices().collect();
        let piece = |v: VertexId| body.piece(body.topology().outgoing(v).triangle());
        let mean = |heights: &mut dyn Iterator<Item = f32>| {
            let (sum, count) = heights.fold((0.0, 0.0), |(sum, n), height| (sum + height, n + 1.0));
            sum / count
        };
        let means = (0..body.piece_bound()).map(|own| {
            let own = vertices.iter().filter(|&&v| piece(v) == own);
            mean(&mut own.map(|v| body.positions()[v.index()][across]))
        });
        let means: Vec<f32> = means.collect();
        let middle = mean(&mut means.iter().copied());
        let sides: Vec<f32> = means.iter().map(|mean| (mean - middle).signum()).collect();
        let moves: Vec<f32> = vertices.iter().map(|&v| sides[piece(v) as usize]).collect();
        for (v, side) in vertices.iter().zip(moves) {
            body.positions_mut()[v.index()][across] += gap / 2.0 * side;
        }
        cutter.refit(&body);
        let cut = body.clone();
        for i in 0..=steps {
            let s = 1.0 - f32::from(i) / f32::from(steps);
            let (outcome, state) = move_to(&mut body, &mut cutter, s);
            assert_eq!(outcome, Ok(true), "at {s}");
            let states = [IncisionState::Outside, IncisionState::Finished];
            assert!(states.contains(&state), "{state:?} at {s}");
            assert_eq!(body, cut, "at {s}");
        }
    }

    /// Cuts a body at once.
    fn slice(&self, whole: &Surface) -> Surface {
        let (ends, motion) = self.blade();
        let to = ends.map(|p| [0, 1, 2].map(|c| p[c] + motion[c]));
        let mut body = whole.clone();
        let sweep = Sweep::new(ends, to).unwrap();
        let outcome = Cutter::new(&body).cut(&mut body, &sweep, &params(0.0));
        let _ = outcome.unwrap();
        body
    }

    /// Checks that no step is refused and that the pieces are those of one slice.
    fn check(&self, whole: &Surface) {
        let body = self.steps(whole);
        let body = body.unwrap_or_else(|(step, error)| panic!("step {step}: {error}"));
        check(&body);
        let sorted = |body: &Surface| {
            let mut volumes = body.piece_volumes();
            volumes.sort_by(f64::total_cmp);
            volumes
        };
        let (found, expected) = (sorted(&body), sorted(&self.slice(whole)));
        assert_eq!(found.len(), expected.len(), "{found:?} {expected:?}");
        for (a, b) in found.iter().zip(&expected) {
            let error = (a - b).abs() / whole.volume();
            assert!(error < MAX_VOLUME_ERROR, "{found:?} {expected:?}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 100, ..ProptestConfig::default() })]
    #[test]
    fn straight_strokes_give_the_pieces_of_one_slice(
        body in prop::sample::select(vec![
            icosphere(0, 0.5), icosphere(1, 0.5), icosphere(3, 0.5), cube_sphere(1, 0.5),
            cube_sphere(8, 0.5), torus(0.35, 0.15, 3, 3), torus(0.35, 0.15, 5, 4),
            torus(0.35, 0.15, 8, 6), torus(0.35, 0.15, 32, 16),
        ]),
        place in prop::array::uniform3(-0.25f32..0.25),
        axis in 0usize..3,
        tilt in prop::array::uniform3(-0.3f32..0.3),
        steps in prop::sample::select(vec![1u16, 2, 3, 4, 5, 7, 10, 16, 40, 100]),
        snap in prop::sample::select(vec![0.0, 0.1]),
    ) {
        Stroke { place, axis, tilt, steps, snap }.check(&body);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, ..ProptestConfig::default() })]
    /// On its way back through the finished cut the blade entered each piece once more.
    #[test]
    fn straight_strokes_cut_nothing_on_the_way_back(
        body in prop::sample::select(vec![
            icosphere(1, 0.5), icosphere(3, 0.5), cube_sphere(8, 0.5), torus(0.35, 0.15, 8, 6),
            torus(0.35, 0.15, 32, 16),
        ]),
        place in prop::array::uniform3(-0.25f32..0.25),
        axis in 0usize..3,
        tilt in prop::array::uniform3(-0.3f32..0.3),
        steps in prop::sample::select(vec![1u16, 2, 5, 10, 16, 40, 100]),
        back in prop::sample::select(vec![1u16, 2, 7, 16, 40, 100]),
        gap in prop::sample::select(vec![0.0f32, 0.0, 0.02, 0.2]),
        snap in prop::sample::select(vec![0.0, 0.1]),
    ) {
        Stroke { place, axis, tilt, steps, snap }.check_way_back(&body, gap, back);
    }
}

/// Beside the tip, the sweep rose as far as the other side of the hole, where it cut the body as
/// well.
#[test]
fn a_sweep_does_not_rise_across_the_hole_of_a_torus() {
    let stroke = Stroke {
        place: [0.0, 0.068_062_4, 0.0],
        axis: 2,
        tilt: [0.0, 0.0, -0.094_090_186],
        steps: 5,
        snap: 0.0,
    };
    stroke.check(&torus(0.35, 0.15, 5, 4));
    let stroke = Stroke {
        place: [0.050_573_826, 0.024_977_833, -0.222_970_3],
        axis: 1,
        tilt: [-0.275_939_5, -0.136_402_43, -0.061_997_83],
        steps: 2,
        snap: 0.0,
    };
    stroke.check(&torus(0.35, 0.15, 32, 16));
}

/// The rises from both sides of the hole passed each other, and the sweep turned back.
#[test]
fn rises_from_both_sides_of_a_hole_do_not_cross() {
    let stroke = Stroke {
        place: [-0.193_852_87, -0.101_784_59, -0.104_550_004],
        axis: 2,
        tilt: [-0.219_284_83, 0.209_114_61, 0.261_267_36],
        steps: 2,
        snap: 0.0,
    };
    stroke.check(&torus(0.35, 0.15, 8, 6));
}

/// The blade grazes the body, whose surface faces the motion. Straight away from the surface, the
/// sweep ran ahead of the blade into the body.
#[test]
fn a_sweep_does_not_rise_ahead_of_a_grazing_blade() {
    let stroke = Stroke {
        place: [0.214_510_89, -0.090_519_61, -0.193_208_78],
        axis: 0,
        tilt: [-0.116_068_095, 0.271_088_3, -0.055_601_403],
        steps: 2,
        snap: 0.0,
    };
    stroke.check(&torus(0.35, 0.15, 32, 16));
}

/// Snapping moved the surface beside the end of a tip across the tip.
#[test]
fn snapping_keeps_the_surface_off_the_tip() {
    let stroke = Stroke {
        place: [0.082_242_85, -0.193_473_67, -0.083_123_386],
        axis: 1,
        tilt: [-0.278_513, 0.264_458_54, 0.187_189_22],
        steps: 4,
        snap: 0.1,
    };
    stroke.check(&torus(0.35, 0.15, 32, 16));
    let stroke = Stroke {
        place: [-0.015_807_42, -0.119_829_06, -0.161_536_66],
        axis: 0,
        tilt: [0.016_323_715, -0.050_689_25, -0.106_547_28],
        steps: 100,
        snap: 0.1,
    };
    stroke.check(&icosphere(3, 0.5));
    let stroke = Stroke {
        place: [0.192_915_17, -0.207_673_37, -0.050_940_9],
        axis: 1,
        tilt: [0.163_010_72, 0.263_392_93, -0.109_904_096],
        steps: 16,
        snap: 0.1,
    };
    stroke.check(&cube_sphere(8, 0.5));
}

/// Ends of a slit next to mesh edges were moved by more than the length of the tip.
#[test]
fn ends_of_a_short_tip_move_by_a_part_of_its_length() {
    let stroke = Stroke {
        place: [0.128_012_18, -0.218_253_02, 0.062_860_1],
        axis: 2,
        tilt: [0.147_957_65, -0.205_786_76, 0.092_713_06],
        steps: 10,
        snap: 0.1,
    };
    stroke.check(&torus(0.35, 0.15, 3, 3));
}

/// Ends of a slit are moved along it. From there the straight line to the blade's last pose ran
/// into a part of the body that the blade had not reached.
#[test]
fn a_sweep_goes_back_to_the_last_pose_beside_the_tip() {
    let stroke = Stroke {
        place: [0.125_276_86, -0.072_498_68, -0.194_986_02],
        axis: 1,
        tilt: [0.052_356_96, 0.228_035_57, -0.016_831_964],
        steps: 7,
        snap: 0.0,
    };
    stroke.check(&torus(0.35, 0.15, 3, 3));
    let stroke = Stroke {
        place: [-0.194_459_65, -0.147_641_09, 0.190_704_76],
        axis: 1,
        tilt: [-0.299_606_03, -0.184_873_85, -0.045_485_914],
        steps: 40,
        snap: 0.0,
    };
    stroke.check(&torus(0.35, 0.15, 3, 3));
}
