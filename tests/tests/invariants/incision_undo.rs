//! Undo of steps in the middle of a progressive cut, which then goes on.

use incise_cut::{CutParams, Cutter, Incision};
use incise_mesh::{Surface, Undo, icosphere, sheet, torus};
use incise_models::{Model, build_model};
use incise_tests::{assert_same_bits, cases};
use proptest::prelude::*;

type Pose = [[f32; 3]; 2];

/// A surface under a blade, and all steps so far.
struct Stroke {
    surface: Surface,
    cutter: Cutter,
    incision: Incision,
    params: CutParams,
    steps: Vec<Step>,
}

/// A step that can be undone.
struct Step {
    /// None for a miss and a refused step.
    undo: Option<Undo>,
    surface: Surface,
    incision: Incision,
}

impl Stroke {
    fn new(surface: &Surface, snap: f64) -> Self {
        Self {
            surface: surface.clone(),
            cutter: Cutter::new(surface),
            incision: Incision::default(),
            params: CutParams {
                snap,
                ..CutParams::default()
            },
            steps: Vec::new(),
        }
    }

    /// Moves the blade to a pose; a refused step starts a new incision there.
    fn advance(&mut self, pose: &Pose) {
        let (surface, incision) = (self.surface.clone(), self.incision.clone());
        let result =
            (self.cutter).advance(&mut self.surface, &mut self.incision, pose, &self.params);
        if result.is_err() {
            self.incision.restart(pose);
        }
        self.surface.validate().expect("a manifold");
        self.steps.push(Step {
            undo: result.ok().and_then(|outcome| outcome.undo),
            surface,
            incision,
        });
    }

    /// Undoes the last step and puts back the incision from before it.
    fn undo(&mut self) {
        let step = self.steps.pop().expect("a step");
        if let Some(undo) = step.undo {
            let undone = self.cutter.undo(&mut self.surface, undo);
            undone.expect("the last cut can be undone");
        }
        assert_same_bits(&step.surface, &self.surface);
        let bvh = self.cutter.bvh().validate(&self.surface);
        bvh.expect("the BVH matches the surface");
        self.incision = step.incision;
    }

    fn cuts(&self) -> usize {
        self.steps.iter().filter(|step| step.undo.is_some()).count()
    }
}

/// Returns the poses of a blade that turns while it moves across a surface.
fn poses(surface: &Surface, motion: &Motion, count: u16) -> Vec<Pose> {
    let bounds = surface.bounds();
    let at = |p: [f32; 3]| {
        [0, 1, 2].map(|k| {
            let [low, high] = [bounds.min[k], bounds.max[k]];
            // A sheet has no thickness.
            f32::midpoint(low, high) + 0.5 * (high - low).max(0.3) * p[k]
        })
    };
    let pose = |i: u16| {
        let s = f32::from(i) / f32::from(count) * motion.reach - 1.2;
        let (sin, cos) = (motion.turn * s).sin_cos();
        [-1.0, 1.0].map(|end: f32| {
            let mut p = motion.place;
            p[motion.axis] += s + end * motion.half * sin;
            p[(motion.axis + 1) % 3] += end * motion.half * cos;
            p[(motion.axis + 2) % 3] += motion.tilt[0] * end + motion.tilt[1] * s;
            at(p)
        })
    };
    (0..=count).map(pose).collect()
}

/// The motion of a blade, in units of half the size of the surface.
#[derive(Debug, Clone, Copy)]
struct Motion {
    axis: usize,
    place: [f32; 3],
    half: f32,
    turn: f32,
    tilt: [f32; 2],
    reach: f32,
}

fn motion() -> impl Strategy<Value = Motion> {
    let place = prop::array::uniform3(-0.4f32..0.4);
    let tilt = prop::array::uniform2(-0.3f32..0.3);
    (
        0..3usize,
        place,
        0.3..2.0f32,
        -0.4..0.4f32,
        tilt,
        1.0..2.6f32,
    )
        .prop_map(|(axis, place, half, turn, tilt, reach)| Motion {
            axis,
            place,
            half,
            turn,
            tilt,
            reach,
        })
}

fn surfaces() -> [Surface; 4] {
    [
        icosphere(3, 0.5),
        torus(0.35, 0.15, 32, 16),
        sheet([1.0, 1.0], [21, 17]),
        build_model(Model::Bunny),
    ]
}

proptest! {
    #![proptest_config(cases(40))]

    /// A stroke of which any steps are undone and repeated equals one without, bit for bit.
    #[test]
    fn a_stroke_goes_on_after_undo(
        body in 0..4usize,
        motion in motion(),
        count in 3..24u16,
        undone in prop::collection::vec((any::<prop::sample::Index>(), 1..6usize), 1..3),
        snap in prop::sample::select(vec![0.0, 0.1]),
    ) {
        let whole = &surfaces()[body];
        let poses = poses(whole, &motion, count);
        let mut straight = Stroke::new(whole, snap);
        poses.iter().for_each(|pose| straight.advance(pose));
        let mut repeated = Stroke::new(whole, snap);
        for (i, pose) in poses.iter().enumerate() {
            repeated.advance(pose);
            for (_, depth) in undone.iter().filter(|(at, _)| at.index(poses.len()) == i) {
                let first = (i + 1).saturating_sub(*depth);
                (first..=i).for_each(|_| repeated.undo());
                poses[first..=i].iter().for_each(|pose| repeated.advance(pose));
            }
        }
        assert_same_bits(&straight.surface, &repeated.surface);
        prop_assert_eq!(straight.incision, repeated.incision);
    }

    /// Undo of all steps, the last one first, ends with the whole surface, bit for bit.
    #[test]
    fn all_steps_are_undone_in_reverse_order(
        body in 0..4usize,
        motions in prop::collection::vec(motion(), 1..3),
        count in 3..24u16,
        snap in prop::sample::select(vec![0.0, 0.1]),
    ) {
        let whole = &surfaces()[body];
        let mut stroke = Stroke::new(whole, snap);
        for motion in motions {
            let poses = poses(whole, &motion, count);
            stroke.incision.restart(&poses[0]);
            poses.iter().for_each(|pose| stroke.advance(pose));
        }
        while !stroke.steps.is_empty() {
            stroke.undo();
        }
        assert_same_bits(whole, &stroke.surface);
    }
}

#[test]
fn strokes_of_these_tests_cut() {
    let motion = Motion {
        axis: 0,
        place: [0.0, 0.01, 0.02],
        half: 1.5,
        turn: 0.2,
        tilt: [0.1, 0.1],
        reach: 2.4,
    };
    for whole in surfaces() {
        let mut stroke = Stroke::new(&whole, 0.1);
        let poses = poses(&whole, &motion, 20);
        poses.iter().for_each(|pose| stroke.advance(pose));
        assert!(stroke.cuts() > 5, "{} cuts", stroke.cuts());
    }
}
