//! Blades on random paths through random bodies and sheets, with the solver that follows.

use incise_cut::{Caps, CutError, CutParams, Cutter, Incision};
use incise_mesh::{Surface, TriangleId};
use incise_pbd_gpu::{Material, Solver};
use incise_refine::RefineParams;
use incise_tests::{
    Body, Deformation, Shape, any_body, any_level, assert_no_fold_added, assert_same_bits, cases,
};
use proptest::prelude::*;

/// Checks everything that holds after each step, closed bodies or sheets.
fn check(surface: &Surface, cutter: &Cutter, is_closed: bool) {
    if is_closed {
        surface.validate_closed().expect("a closed manifold");
    } else {
        surface.validate().expect("a manifold");
    }
    cutter.bvh().validate(surface).expect("the BVH matches");
}

/// Opens a body at some of its triangles.
fn open(surface: &mut Surface, holes: &[u16]) {
    let triangles: Vec<TriangleId> = surface.topology().triangles().collect();
    for &hole in holes {
        let t = triangles[usize::from(hole) % triangles.len()];
        if surface.topology().is_triangle(t) && surface.topology().triangle_count() > 2 {
            let unused = surface.remove_triangles(&[t]);
            surface.remove_vertices(&unused);
        }
    }
}

type Edge = [[f32; 3]; 2];

/// Moves a blade through a surface, step by step, and undoes all steps.
///
/// Places are in units of the surface's bounding box, around its center.
fn follow(mut surface: Surface, mut places: Edge, moves: &[Edge], params: &CutParams) {
    let bounds = surface.bounds();
    let size = [0, 1, 2].map(|k| bounds.max[k] - bounds.min[k]);
    let at = |p: [f32; 3]| [0, 1, 2].map(|k| bounds.min[k] + size[k] * (0.5 + 0.7 * p[k]));
    // Bodies on a lattice have edges without length, which no solver takes.
    let mut solver = Solver::new(&mut surface, &Material::default()).ok();
    let mut is_closed = surface.topology().is_closed();
    let mut cutter = Cutter::new(&surface);
    let mut incision = Incision::default();
    let mut undos = Vec::new();
    for step in std::iter::once([[0.0; 3]; 2]).chain(moves.iter().copied()) {
        for (place, motion) in places.iter_mut().zip(step) {
            (0..3).for_each(|k| place[k] += motion[k]);
        }
        let before = surface.clone();
        let pose = places.map(at);
        match cutter.advance(&mut surface, &mut incision, &pose, params) {
            Ok(outcome) if outcome.is_miss() => assert_same_bits(&before, &surface),
            Ok(outcome) => {
                is_closed &= params.caps != Caps::None;
                check(&surface, &cutter, is_closed);
                assert_no_fold_added(&before, &surface, params, &outcome);
                if let Some(solver) = &mut solver {
                    solver
                        .apply_delta(&mut surface, &outcome.delta)
                        .expect("a known delta");
                    solver
                        .validate(&surface)
                        .expect("constraints equal those rebuilt");
                    cutter.refit_moved(&surface, &[]);
                }
                undos.push((outcome.undo.expect("a cut has an undo"), before));
            }
            Err(CutError::Refine(error)) => panic!("{error}"),
            Err(_) => {
                assert_same_bits(&before, &surface);
                incision.restart(&pose);
            }
        }
    }
    while let Some((undo, before)) = undos.pop() {
        cutter
            .undo(&mut surface, undo)
            .expect("every step can be undone");
        check(&surface, &cutter, before.topology().is_closed());
        assert_eq!(surface.topology(), before.topology(), "after an undo");
    }
}

proptest! {
    #![proptest_config(cases(20))]

    /// Every step leaves a manifold that the BVH and the solver match, and undo restores it. A
    /// refused step changes nothing.
    #[test]
    fn any_path_through_any_body(
        body in any_body(),
        holes in prop::collection::vec(any::<u16>(), 0..3),
        start in prop::array::uniform2(prop::array::uniform3(-1.0f32..1.0)),
        moves in prop::collection::vec(
            prop::array::uniform2(prop::array::uniform3(-0.3f32..0.3)), 1..8),
        level in any_level(),
        snap in prop::sample::select(vec![0.0, 0.1, 0.3]),
        remesh in prop::sample::select(vec![0.0, 0.1]),
        caps in prop::sample::select(vec![Caps::Bodies, Caps::Bodies, Caps::AllLoops, Caps::None]),
    ) {
        let mut surface = body.build();
        if holes.len() > 1 {
            open(&mut surface, &holes);
        }
        let params = CutParams {
            snap, remesh,
            refine: RefineParams { level, ..RefineParams::default() },
            caps,
            ..CutParams::default()
        };
        follow(surface, start, &moves, &params);
    }
}

/// Regression: a vertex with two fans hid the mesh triangle at the end of a curve.
#[test]
fn a_path_ends_beside_a_vertex_of_two_fans() {
    let body = Body {
        shape: Shape::CubeSphere(1),
        deformation: Deformation::Noise(0.0),
        lattice: None,
        seed: 589,
    };
    let mut surface = body.build();
    open(&mut surface, &[23804, 5030]);
    let start = [
        [0.0, 0.813_391_9, 0.787_326_16],
        [-0.502_347, 0.0, 0.795_488_83],
    ];
    let moves = [[[0.0; 3], [0.0, 0.0, -0.101_210_63]]];
    let params = CutParams {
        snap: 0.0,
        remesh: 0.0,
        ..CutParams::default()
    };
    follow(surface, start, &moves, &params);
}
