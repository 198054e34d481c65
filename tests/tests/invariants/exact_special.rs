//! The exact method on degenerate input: planes through vertices, edges and faces, and errors that
//! leave the surface unchanged.

use incise_cut::{CutError, CutParams, Cutter, Sweep};
use incise_mesh::{Surface, TriangleId, VertexId, cube_sphere, icosphere, torus};
use incise_paper::{PaperError, PaperParams};
use incise_tests::{
    Blade, Body, Deformation, Shape, any_blade, any_body, assert_same_bits, cases, cut_and_check,
};
use proptest::prelude::*;

/// Bodies with many vertices, edges and triangles in common planes.
fn bodies() -> [Surface; 4] {
    let lattice = Body {
        shape: Shape::Torus(6, 4),
        deformation: Deformation::None,
        lattice: Some(4),
        seed: 3,
    };
    [
        cube_sphere(2, 0.5),
        icosphere(1, 0.5),
        torus(0.4, 0.15, 8, 4),
        lattice.build(),
    ]
}

/// Cuts a copy of the body along each plane, with both snapping distances.
fn cut_each(body: &Surface, blades: impl Iterator<Item = Blade> + Clone) {
    for snap in [0.0, 0.1] {
        for blade in blades.clone() {
            let Ok(sweep) = blade.sweep(body) else {
                continue;
            };
            let params = CutParams {
                snap,
                ..CutParams::default()
            };
            let mut surface = body.clone();
            let mut cutter = Cutter::new(body);
            if let Err(error) = cut_and_check(&mut surface, &mut cutter, &sweep, &params) {
                panic!("{blade:?} was refused: {error}");
            }
        }
    }
}

fn count(n: usize) -> u32 {
    u32::try_from(n).expect("bodies are small")
}

#[test]
fn planes_through_every_vertex() {
    for body in bodies() {
        let vertices = 0..count(body.topology().vertex_count());
        let axes = vertices.flat_map(|v| (0..3).map(move |k| Blade::AxisThroughVertex(k, v)));
        cut_each(&body, axes);
        let vertices = 0..count(body.topology().vertex_count());
        cut_each(
            &body,
            vertices.map(|v| Blade::ThroughVertices([v, v + 7, 3 * v + 11])),
        );
    }
}

#[test]
fn planes_along_every_edge() {
    for body in bodies() {
        let triangles = 0..count(body.topology().triangle_count());
        let edges = triangles.flat_map(|t| (0..3).map(move |corner| (t, corner)));
        cut_each(
            &body,
            edges.map(|(t, corner)| Blade::ThroughEdge(t, corner, [0.25, 1.0, 0.5])),
        );
    }
}

#[test]
fn planes_in_every_face() {
    for body in bodies() {
        let triangles = 0..count(body.topology().triangle_count());
        cut_each(&body, triangles.map(Blade::InFace));
    }
}

/// Lattice planes contain many vertices; each half is cut again.
#[test]
fn every_lattice_plane_of_a_cube() {
    for snap in [0.0, 0.1] {
        let mut surface = cube_sphere(2, 0.5);
        let mut cutter = Cutter::new(&surface);
        let params = CutParams {
            snap,
            ..CutParams::default()
        };
        let heights: Vec<f64> = {
            let mut all: Vec<f64> = surface
                .rest_positions()
                .iter()
                .map(|p| f64::from(p[2]))
                .collect();
            all.sort_by(f64::total_cmp);
            all.dedup();
            all
        };
        for axis in 0..3 {
            for &height in &heights {
                let mut normal = [0.0; 3];
                normal[axis] = 1.0;
                let sweep = Sweep::from_plane(normal, height, &surface.bounds()).expect("a plane");
                let cut = cut_and_check(&mut surface, &mut cutter, &sweep, &params);
                let _ = cut.expect("a full slice cuts");
            }
        }
    }
}

/// Returns a copy with one coordinate replaced by NaN or infinity.
fn with_broken_vertex(body: &Surface, v: VertexId, k: usize, value: f32) -> Surface {
    let mut broken = body.clone();
    broken.positions_mut()[v.index()][k] = value;
    broken
}

/// Cuts, asserts that a failed cut changes no bit, and returns its error.
fn assert_refused(surface: &mut Surface, sweep: &Sweep) -> Option<CutError> {
    let before = surface.clone();
    let result = Cutter::new(surface).cut(surface, sweep, &CutParams::default());
    let error = match result {
        Ok(outcome) if outcome.is_miss() => None,
        Ok(_) => return None,
        Err(error) => Some(error),
    };
    assert_same_bits(&before, surface);
    error
}

#[test]
fn a_vertex_that_is_not_finite_is_reported() {
    let body = icosphere(1, 0.5);
    let sweep = Sweep::from_plane([0.2, 1.0, 0.3], 0.03, &body.bounds()).expect("a plane");
    let mut named = 0;
    for v in body.topology().vertices() {
        for (k, value) in [(0, f32::NAN), (1, f32::INFINITY), (2, f32::NEG_INFINITY)] {
            let mut broken = with_broken_vertex(&body, v, k, value);
            match assert_refused(&mut broken, &sweep) {
                Some(CutError::VertexNotFinite { vertex }) => {
                    assert_eq!(vertex, v, "another vertex was named");
                    named += 1;
                }
                other => panic!("{v} at {value} along {k}: {other:?}"),
            }
        }
    }
    assert_eq!(named, 3 * body.topology().vertex_count());
}

#[test]
fn parameters_out_of_range_are_errors() {
    let mut body = icosphere(1, 0.5);
    let before = body.clone();
    let sweep = Sweep::from_plane([0.2, 1.0, 0.3], 0.03, &body.bounds()).expect("a plane");
    for snap in [-0.1, 0.5, 1.0, f64::NAN, f64::INFINITY] {
        let params = CutParams {
            snap,
            ..CutParams::default()
        };
        let result = Cutter::new(&body).cut(&mut body, &sweep, &params);
        assert!(
            matches!(result, Err(CutError::Parameter(_))),
            "snap {snap}: {:?}",
            result.map(|outcome| outcome.report)
        );
        assert_same_bits(&before, &body);
    }
    let corner = [0.0; 3];
    for value in [f32::NAN, f32::INFINITY] {
        let result = Sweep::new([corner, [1.0, 0.0, 0.0]], [[0.0, value, 0.0], [1.0; 3]]);
        assert_eq!(
            result,
            Err(CutError::SweepNotFinite { corner: 2 }),
            "{value}"
        );
    }
}

/// Sweeps up to 1e8 times as large as the body cut exactly; larger ones fail or miss.
#[test]
fn sweeps_of_any_size_cut_in_place_or_fail() {
    let params = CutParams {
        snap: 0.0,
        ..CutParams::default()
    };
    for body in [icosphere(2, 0.5), torus(0.4, 0.15, 24, 12)] {
        // Planes whose points are exact in 32 bits at any size: y = 1/32 and y = x.
        for (tilt, normal, d) in [
            (0.0, [0.0, 1.0, 0.0], 0.03125),
            (1.0, [-1.0, 1.0, 0.0], 0.0),
        ] {
            let d32 = incise_mesh::geometry::to_f32([d, 0.0, 0.0].into())[0];
            let across = |far: f32, d: f32| {
                let at = |x: f32, z: f32| [x * far, tilt * x * far + d, z * far];
                Sweep::new(
                    [at(-1.0, -1.0), at(-1.0, 1.0)],
                    [at(1.0, -1.0), at(1.0, 1.0)],
                )
            };
            let volumes = |sweep: &Sweep| {
                let mut surface = body.clone();
                let cut = cut_and_check(&mut surface, &mut Cutter::new(&body), sweep, &params);
                cut.map(|_| {
                    let mut volumes = surface.piece_volumes();
                    volumes.sort_by(f64::total_cmp);
                    volumes
                })
            };
            let plane = Sweep::from_plane(normal, d, &body.bounds()).expect("a plane");
            let expected = volumes(&plane).expect("a full slice");
            for exponent in (2..126).step_by(4) {
                let far = 2.0f32.powi(exponent);
                let sweep = across(far, d32).expect("a sweep");
                match volumes(&sweep) {
                    Ok(found) => {
                        assert!(exponent <= 28, "2^{exponent} is not refused");
                        for (found, expected) in found.iter().zip(&expected) {
                            let error = (found - expected).abs();
                            assert!(error < 1e-6, "2^{exponent}: {found} for {expected}");
                        }
                    }
                    Err(CutError::SweepTooLarge { times, .. }) => {
                        assert!(exponent > 28 && times > 5e8, "2^{exponent}: {times}");
                    }
                    Err(error) => panic!("2^{exponent}: {error}"),
                }
                if tilt == 0.0 {
                    let miss = across(far, 3.0).expect("a sweep");
                    assert_eq!(
                        assert_refused(&mut body.clone(), &miss),
                        None,
                        "2^{exponent}"
                    );
                }
            }
        }
    }
}

/// A cut with an outdated BVH is bit for bit the cut after a refit.
#[test]
fn an_outdated_bvh_changes_nothing() {
    let body = icosphere(2, 0.5);
    let sweep = Sweep::from_plane([0.2, 1.0, 0.3], 0.03, &body.bounds()).expect("a plane");
    for v in body.topology().vertices() {
        let mut surface = body.clone();
        let mut cutter = Cutter::new(&surface);
        let [x, y, z, w] = surface.positions()[v.index()];
        surface.positions_mut()[v.index()] = [x, -3.0 * y, z, w];
        let mut other = surface.clone();
        let result = cutter.cut(&mut surface, &sweep, &CutParams::default());
        assert!(result.is_ok(), "{v} moved: {:?}", result.err());
        let fitted = Cutter::new(&other).cut(&mut other, &sweep, &CutParams::default());
        assert!(fitted.is_ok(), "{v} moved: {:?}", fitted.err());
        assert_same_bits(&other, &surface);
    }
}

/// A ball with a hole is a sheet: a plane makes two sheets of it, through the hole or beside it.
/// The paper's method refuses the hole.
#[test]
fn a_ball_with_a_hole_is_cut_as_a_sheet() {
    let body = icosphere(2, 0.5);
    let sweep = Sweep::from_plane([0.2, 1.0, 0.3], 0.03, &body.bounds()).expect("a plane");
    let triangles: Vec<TriangleId> = body.topology().triangles().collect();
    let mut refused = 0;
    for t in triangles {
        let mut open = body.clone();
        open.remove_triangles(&[t]);
        let mut cut = open.clone();
        let outcome = Cutter::new(&cut).cut(&mut cut, &sweep, &CutParams::default());
        let outcome = outcome.unwrap_or_else(|error| panic!("without {t}: {error}"));
        cut.validate().expect("a manifold");
        assert_eq!(cut.open_pieces(), [true; 2], "without {t}");
        assert!(outcome.cap.is_empty());
        let before = open.clone();
        let mut cutter = Cutter::new(&open);
        match incise_paper::cut(&mut cutter, &mut open, &sweep, &PaperParams::default()) {
            Err(PaperError::OpenSurface { .. }) => {
                refused += 1;
                assert_same_bits(&before, &open);
            }
            outcome => assert!(outcome.is_ok(), "without {t}: {:?}", outcome.err()),
        }
    }
    assert_eq!(refused, 320, "the paper's method refuses every hole");
}

/// The sweep of a blade that flips: two triangles that overlap.
#[test]
fn a_bow_tie_is_cut_as_two_triangles() {
    let y = 0.03;
    let bow_tie = Sweep::new(
        [[-2.0, y, -2.0], [-2.0, y, 2.0]],
        [[2.0, y, 2.0], [2.0, y, -2.0]],
    );
    let bow_tie = bow_tie.expect("each of the two has an area");
    // In the first triangle only, in the second only, and in both.
    let places = [[-1.3, 0.0, 0.0], [1.3, 0.0, 0.0], [0.0, 0.0, -1.2]];
    for (place, slices) in places.into_iter().zip([1, 1, 2]) {
        for body in [
            icosphere(2, 0.5),
            torus(0.4, 0.15, 12, 8),
            cube_sphere(3, 0.5),
        ] {
            let mut body = body;
            for p in body.positions_mut() {
                (0..3).for_each(|k| p[k] += place[k]);
            }
            let cut = |sweep: &Sweep, snap: f64| {
                let params = CutParams {
                    snap,
                    ..CutParams::default()
                };
                let mut surface = body.clone();
                let cut = cut_and_check(&mut surface, &mut Cutter::new(&body), sweep, &params);
                let loops = cut.expect("a full slice").report.loops;
                let mut volumes = surface.piece_volumes();
                volumes.sort_by(f64::total_cmp);
                (loops, volumes)
            };
            for snap in [0.0, 0.1] {
                let plane = Sweep::from_plane([0.0, 1.0, 0.0], y.into(), &body.bounds());
                let (loops, expected) = cut(&plane.expect("a plane"), snap);
                let (found_loops, found) = cut(&bow_tie, snap);
                assert_eq!(found_loops, slices * loops, "loops at {place:?}");
                // The overlap slices twice at the same place, without a piece between.
                let found: Vec<f64> = found.into_iter().filter(|v| v.abs() > 1e-6).collect();
                assert_eq!(found.len(), expected.len(), "pieces at {place:?}");
                for (found, expected) in found.iter().zip(&expected) {
                    assert!(
                        (found - expected).abs() < 1e-6,
                        "{found} for {expected} at {place:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn sweeps_that_end_inside_change_nothing() {
    for body in [icosphere(3, 0.5), torus(0.4, 0.15, 24, 12)] {
        for end in [-0.3, -0.11, 0.0, 0.07, 0.2, 0.35] {
            for tilt in [-0.2, 0.0, 0.01, 0.3] {
                let mut surface = body.clone();
                let sweep = Sweep::new(
                    [[-1.0, 0.01, -1.0], [-1.0, 0.01 + tilt, 1.0]],
                    [[end, 0.01, -1.0], [end, 0.01 - tilt, 1.0]],
                );
                let error = assert_refused(&mut surface, &sweep.expect("a sweep"));
                assert!(
                    matches!(error, Some(CutError::PartialCut { .. })),
                    "to {end}, tilted by {tilt}: {error:?}"
                );
            }
        }
    }
}

proptest! {
    #![proptest_config(cases(50))]

    /// Only sweeps that end inside the body are partial cuts. Short sweeps that reach it always
    /// are.
    #[test]
    fn a_full_slice_is_not_partial(body in any_body(), blade in any_blade()) {
        let mut surface = body.build();
        let Ok(sweep) = blade.sweep(&surface) else { return Ok(()) };
        let error = assert_refused(&mut surface, &sweep);
        let is_partial = matches!(error, Some(CutError::PartialCut { .. }));
        prop_assert!(error.is_none() || is_partial, "{error:?}");
        prop_assert!(!(blade.is_full_plane() && is_partial), "{blade:?} is a full plane");
    }
}
