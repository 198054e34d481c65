//! Input that the method refuses: the surface then stays bit for bit as it is.

use incise_cut::{CutError, Cutter, Sweep};
use incise_mesh::{Surface, icosphere, sheet, torus};
use incise_paper::{PaperError, PaperParams, cut};

fn plane(surface: &Surface) -> Sweep {
    Sweep::from_plane([0.2, 1.0, 0.3], 0.03, &surface.bounds()).unwrap()
}

/// Returns the error of a cut, which must change nothing.
fn refused(
    surface: &mut Surface,
    cutter: &mut Cutter,
    sweep: &Sweep,
    params: &PaperParams,
) -> PaperError {
    let before = (surface.clone(), surface.fingerprint());
    let error = cut(cutter, surface, sweep, params).expect_err("a refusal");
    assert_eq!(before.0, *surface, "the surface changed");
    assert_eq!(before.1, surface.fingerprint(), "the surface was edited");
    error
}

#[test]
fn a_cutter_of_another_surface_is_refused() {
    let params = PaperParams::default();
    let mut body = icosphere(3, 0.5);
    let mut cutter = Cutter::new(&torus(0.4, 0.15, 48, 24));
    let sweep = plane(&body);
    let error = refused(&mut body, &mut cutter, &sweep, &params);
    assert_eq!(error, PaperError::Cut(CutError::SurfaceEdited));
    cutter.refit(&body);
    body.positions_mut()[3][0] += 0.01;
    assert!(
        !cut(&mut cutter, &mut body, &sweep, &params)
            .unwrap()
            .cut
            .is_miss()
    );
    body.validate_closed().unwrap();
}

#[test]
fn parameters_have_ranges() {
    let mut body = icosphere(3, 0.5);
    let mut cutter = Cutter::new(&body);
    let params = PaperParams {
        beta: -1.0,
        ..PaperParams::default()
    };
    let sweep = plane(&body);
    let error = refused(&mut body, &mut cutter, &sweep, &params);
    let text = "beta is -1; it must be a finite number of at least 0";
    assert_eq!(error.to_string(), text);
}

#[test]
fn only_full_slices_of_bodies_without_holes_are_cut() {
    let params = PaperParams::default();
    let mut body = icosphere(3, 0.5);
    let stroke = Sweep::new(
        [[-1.0, 0.01, -1.0], [-1.0, 0.01, 1.0]],
        [[0.1, 0.01, -1.0], [0.1, 0.01, 1.0]],
    );
    let mut cutter = Cutter::new(&body);
    let error = refused(&mut body, &mut cutter, &stroke.unwrap(), &params);
    assert!(matches!(error, PaperError::PartialCut { .. }), "{error:?}");

    let mut cloth = sheet([1.0, 1.0], [17, 13]);
    let mut cutter = Cutter::new(&cloth);
    let sweep = Sweep::from_plane([1.0, 0.2, 0.1], 0.03, &cloth.bounds()).unwrap();
    let error = refused(&mut cloth, &mut cutter, &sweep, &params);
    assert!(matches!(error, PaperError::OpenSurface { .. }), "{error:?}");

    // A plane along the ring: a disk with a hole.
    let mut ring = torus(0.4, 0.15, 32, 16);
    let mut cutter = Cutter::new(&ring);
    let normals = [
        [1.0, 0.013, 0.013],
        [0.013, 1.0, 0.013],
        [0.013, 0.013, 1.0],
    ];
    let is_refused = |&normal: &[f64; 3]| {
        let sweep = Sweep::from_plane(normal, 0.002, &ring.bounds()).unwrap();
        let mut copy = ring.clone();
        let mut cutter = Cutter::new(&copy);
        match cut(&mut cutter, &mut copy, &sweep, &params) {
            Err(PaperError::NestedSection { .. }) => true,
            result => {
                assert!(!result.unwrap().cut.is_miss());
                false
            }
        }
    };
    let nested: Vec<[f64; 3]> = normals.into_iter().filter(is_refused).collect();
    let [normal] = nested[..] else {
        panic!("one plane runs along the ring, not {nested:?}");
    };
    let sweep = Sweep::from_plane(normal, 0.002, &ring.bounds()).unwrap();
    let error = refused(&mut ring, &mut cutter, &sweep, &params);
    assert!(
        matches!(error, PaperError::NestedSection { .. }),
        "{error:?}"
    );
}

#[test]
fn only_the_named_piece_is_cut() {
    let mut body = icosphere(3, 0.5);
    let mut cutter = Cutter::new(&body);
    let sweep = plane(&body);
    let _ = cut(&mut cutter, &mut body, &sweep, &PaperParams::default()).unwrap();
    let across = Sweep::from_plane([1.0, 0.1, 0.0], 0.02, &body.bounds()).unwrap();
    let params = PaperParams {
        only_piece: Some(1),
        ..PaperParams::default()
    };
    let outcome = cut(&mut cutter, &mut body, &across, &params).unwrap();
    assert_eq!(outcome.cut.report.loops, 1);
    assert_eq!(body.piece_count(), 3);
}
