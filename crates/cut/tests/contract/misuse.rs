//! Misuse of a [`Cutter`] is an error that names the remedy: never a panic, never a silent miss.

use incise_cut::{CutError, CutParams, Cutter, Incision, Sweep};
use incise_mesh::{Surface, TriangleId, icosphere, torus};

fn body() -> Surface {
    icosphere(3, 0.5)
}

/// A plane through the middle of every body here.
fn plane() -> Sweep {
    Sweep::from_plane([0.2, 1.0, 0.3], 0.03, &body().bounds()).expect("a plane")
}

/// Asserts that a cut and a preview are refused with `expected` and change nothing.
fn assert_refused(surface: &mut Surface, cutter: &mut Cutter, expected: &CutError) {
    let preview = cutter.intersect(surface, &plane(), None);
    assert_eq!(preview.err().as_ref(), Some(expected), "a preview");
    let fingerprint = surface.fingerprint();
    let result = cutter.cut(surface, &plane(), &CutParams::default());
    assert_eq!(result.as_ref().err(), Some(expected), "a cut");
    assert_eq!(surface.fingerprint(), fingerprint, "the surface changed");
}

/// Asserts that a cut succeeds after a refit, as the error advises.
fn assert_cuts_after_refit(surface: &mut Surface, cutter: &mut Cutter) {
    cutter.refit(surface);
    cutter.bvh().validate(surface).expect("the BVH fits");
    let outcome = cutter.cut(surface, &plane(), &CutParams::default());
    let is_miss = outcome.expect("a full slice").is_miss();
    assert!(!is_miss, "the plane crosses the body");
    surface.validate_closed().expect("a closed surface");
    cutter.bvh().validate(surface).expect("the BVH fits");
}

#[test]
fn a_cutter_of_another_surface_is_refused() {
    let others = [
        icosphere(1, 0.5),
        icosphere(5, 0.5),
        // The same triangles, other positions.
        icosphere(3, 0.4),
        torus(0.4, 0.15, 48, 24),
        Surface::default(),
    ];
    for mut other in others {
        let mut cutter = Cutter::new(&body());
        assert_refused(&mut other, &mut cutter, &CutError::SurfaceEdited);
        if other.topology().triangle_count() > 0 {
            assert_cuts_after_refit(&mut other, &mut cutter);
        }
    }
}

#[test]
fn a_cutter_of_an_empty_surface_is_refused() {
    let mut cutter = Cutter::new(&Surface::default());
    assert_refused(&mut body(), &mut cutter, &CutError::SurfaceEdited);
}

#[test]
fn a_clone_of_the_surface_is_the_same_surface() {
    let whole = body();
    let mut copy = whole.clone();
    let outcome = Cutter::new(&whole).cut(&mut copy, &plane(), &CutParams::default());
    assert!(!outcome.expect("a full slice").is_miss());
}

/// Far away from the sweep and from the old boxes, then across the sweep again.
#[test]
fn a_cut_finds_a_body_wherever_it_has_moved() {
    let mut surface = body();
    let mut cutter = Cutter::new(&surface);
    surface.positions_mut().iter_mut().for_each(|p| p[1] += 9.0);
    let outcome = cutter.cut(&mut surface, &plane(), &CutParams::default());
    assert!(outcome.expect("no error").is_miss());
    surface.positions_mut().iter_mut().for_each(|p| p[1] -= 9.0);
    let outcome = cutter.cut(&mut surface, &plane(), &CutParams::default());
    assert!(!outcome.expect("a full slice").is_miss());
    surface.validate_closed().expect("a closed surface");
}

#[test]
fn new_masses_need_no_triangles_in_a_refit() {
    let mut surface = body();
    let mut cutter = Cutter::new(&surface);
    surface.positions_mut().iter_mut().for_each(|p| p[3] = 2.0);
    cutter.refit_moved(&surface, &[]);
    let outcome = cutter.cut(&mut surface, &plane(), &CutParams::default());
    assert!(!outcome.expect("a full slice").is_miss());
}

#[test]
fn an_undo_past_the_cutter_is_refused() {
    let mut surface = body();
    let mut cutter = Cutter::new(&surface);
    let outcome = cutter.cut(&mut surface, &plane(), &CutParams::default());
    let undo = outcome.expect("a full slice").undo.expect("a hit");
    undo.revert(&mut surface).expect("nothing was edited since");
    assert_refused(&mut surface, &mut cutter, &CutError::SurfaceEdited);
    assert_cuts_after_refit(&mut surface, &mut cutter);
}

#[test]
fn an_undo_with_a_cutter_that_missed_the_cut_fits_its_bvh() {
    let mut surface = body();
    let mut old = Cutter::new(&surface);
    let outcome = Cutter::new(&surface).cut(&mut surface, &plane(), &CutParams::default());
    let undo = outcome.expect("a full slice").undo.expect("a hit");
    assert_refused(&mut surface, &mut old, &CutError::SurfaceEdited);
    old.undo(&mut surface, undo).expect("it is the last edit");
    old.bvh().validate(&surface).expect("the BVH fits");
    assert_cuts_after_refit(&mut surface, &mut old);
}

#[test]
fn compacting_after_a_cut_is_refused() {
    let mut surface = body();
    let mut cutter = Cutter::new(&surface);
    // Not along `plane`, which would only touch the caps when it cuts again.
    let across = Sweep::from_plane([1.0, 0.1, 0.0], 0.0, &surface.bounds()).expect("a plane");
    let outcome = cutter.cut(&mut surface, &across, &CutParams::default());
    assert!(!outcome.expect("a full slice").is_miss());
    surface.compact();
    assert_refused(&mut surface, &mut cutter, &CutError::SurfaceEdited);
    assert_cuts_after_refit(&mut surface, &mut cutter);
}

#[test]
fn an_edited_topology_is_refused() {
    let mut surface = body();
    let mut cutter = Cutter::new(&surface);
    let mut edit = surface.edit();
    let first = TriangleId(0).half_edges()[0];
    edit.flip_edge(first).expect("an interior edge");
    drop(edit.finish());
    assert_refused(&mut surface, &mut cutter, &CutError::SurfaceEdited);
    // A partial refit cannot follow an edit, so the cutter rebuilds the whole BVH.
    cutter.refit_moved(&surface, &[]);
    cutter.bvh().validate(&surface).expect("the BVH fits");
    assert_cuts_after_refit(&mut surface, &mut cutter);
}

#[test]
fn an_edit_that_is_dropped_is_none() {
    let mut surface = body();
    let mut cutter = Cutter::new(&surface);
    let mut edit = surface.edit();
    edit.remove_triangle(TriangleId(7));
    drop(edit);
    let outcome = cutter.cut(&mut surface, &plane(), &CutParams::default());
    assert!(!outcome.expect("a full slice").is_miss());
}

#[test]
fn positions_that_are_not_finite_are_refused_wherever_they_are() {
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for k in 0..3 {
            let whole = body();
            for v in whole.topology().vertices().step_by(37) {
                let mut surface = whole.clone();
                let mut cutter = Cutter::new(&surface);
                surface.positions_mut()[v.index()][k] = value;
                let expected = CutError::VertexNotFinite { vertex: v };
                assert_refused(&mut surface, &mut cutter, &expected);
                cutter.refit(&surface);
                assert_refused(&mut surface, &mut cutter, &expected);
                let mut new = Cutter::new(&surface);
                assert_refused(&mut surface, &mut new, &expected);
                let around: Vec<_> = (surface.topology().outgoing_fan(v))
                    .map(|h| h.triangle())
                    .collect();
                let mut moved = Cutter::new(&whole);
                moved.refit_moved(&surface, &around);
                assert_refused(&mut surface, &mut moved, &expected);
                // Repaired, it cuts again, whichever refit was called.
                surface.positions_mut()[v.index()] = whole.positions()[v.index()];
                moved.refit_moved(&surface, &around);
                let outcome = moved.cut(&mut surface.clone(), &plane(), &CutParams::default());
                assert!(!outcome.expect("a full slice").is_miss());
                assert_cuts_after_refit(&mut surface, &mut cutter);
            }
        }
    }
}

/// The whole body, whose box is then empty, and one of two pieces.
#[test]
fn bodies_and_pieces_of_nan_are_no_misses() {
    let mut surface = body();
    let mut cutter = Cutter::new(&surface);
    let across = Sweep::from_plane([1.0, 0.1, 0.0], 0.0, &surface.bounds()).expect("a plane");
    let outcome = cutter.cut(&mut surface, &across, &CutParams::default());
    assert!(!outcome.expect("a full slice").is_miss());
    for piece in [Some(1), None] {
        let topology = surface.topology();
        let triangles: Vec<TriangleId> = topology
            .triangles()
            .filter(|&t| piece.is_none_or(|piece| surface.piece(t) == piece))
            .collect();
        let corners = triangles.iter().flat_map(|&t| topology.triangle(t));
        let mut vertices: Vec<_> = corners.collect();
        vertices.sort_unstable();
        for v in &vertices {
            surface.positions_mut()[v.index()] = [f32::NAN; 4];
        }
        cutter.refit(&surface);
        let expected = CutError::VertexNotFinite {
            vertex: vertices[0],
        };
        assert_refused(&mut surface, &mut cutter, &expected);
    }
}

#[test]
fn a_miss_says_so() {
    let mut surface = body();
    let beside = Sweep::from_plane([0.2, 1.0, 0.3], 3.0, &surface.bounds()).expect("a plane");
    let mut cutter = Cutter::new(&surface);
    let outcome = cutter.cut(&mut surface, &beside, &CutParams::default());
    let outcome = outcome.expect("a miss is no error");
    assert!(outcome.is_miss() && outcome.undo.is_none() && outcome.cap.is_empty());
}

#[test]
fn an_incision_follows_a_surface_without_its_tip() {
    let mut surface = body();
    let mut cutter = Cutter::new(&surface);
    let mut incision = Incision::default();
    let pose = |y: f32| [[0.0, y, -1.0], [0.01, y, 1.0]];
    for y in [0.7, 0.2] {
        let outcome = cutter.advance(&mut surface, &mut incision, &pose(y), &CutParams::default());
        assert!(outcome.is_ok(), "a step: {outcome:?}");
    }
    assert!(incision.is_inside(), "the blade stops in the body");
    incision.follow_rest(&Surface::default());
    let mut other = icosphere(1, 0.5);
    let mut cutter = Cutter::new(&other);
    let outcome = cutter.advance(&mut other, &mut incision, &pose(0.1), &CutParams::default());
    assert!(outcome.is_ok(), "a step without a tip: {outcome:?}");
    other.validate_closed().expect("a closed surface");
}
