//! Intersection curves of a sweep, as a preview of a cut and as the input of other methods.

use incise_cut::{CutParams, Cutter, Sweep};
use incise_mesh::{Surface, Vec3, cube_sphere, icosphere, sheet, torus};

const NORMAL: [f64; 3] = [0.2, 1.0, 0.3];

fn plane(surface: &Surface) -> Sweep {
    Sweep::from_plane(NORMAL, 0.03, &surface.bounds()).unwrap()
}

/// Closed curves cross edges from below to above, and as many triangles as the cut reports.
#[test]
fn curves_of_a_plane_are_those_of_the_cut() {
    for mut surface in [
        icosphere(3, 0.5),
        cube_sphere(8, 0.5),
        torus(0.4, 0.15, 32, 16),
    ] {
        let before = surface.clone();
        let mut cutter = Cutter::new(&surface);
        let sweep = plane(&surface);
        let curves = cutter.intersect(&surface, &sweep, None).unwrap();
        assert_eq!((curves.end(&surface), curves.sheet(&surface)), (None, None));
        let height = |p: Vec3| Vec3::from(NORMAL).dot(&p) - 0.03;
        let (mut crossings, mut count) = (0, 0);
        for curve in curves.iter() {
            assert!(curve.is_closed());
            count += 1;
            for point in curve.points() {
                assert!(height(point.position).abs() < 1e-6, "{point:?}");
                let Some(crossing) = point.crossing else {
                    continue;
                };
                crossings += 1;
                let topology = surface.topology();
                let half_edge = crossing.half_edge;
                let ends = [topology.origin(half_edge), topology.target(half_edge)];
                let heights = ends.map(|v| height(surface.position(v)));
                assert!(heights[0] < heights[1], "{crossing:?} rises: {heights:?}");
                let [a, b] = crossing.ends;
                assert!(a < b && ends.contains(&a) && ends.contains(&b));
                let [p, q] = crossing.ends.map(|v| surface.position(v));
                let there = p + (q - p) * f64::from(crossing.t);
                assert_eq!(there, point.position);
            }
        }
        let candidates = curves.candidates();
        assert_eq!(surface, before);
        let outcome = cutter
            .cut(&mut surface, &sweep, &CutParams::default())
            .unwrap();
        let report = outcome.report;
        assert_eq!((report.candidates, report.loops), (candidates, count));
        assert_eq!(report.hits, crossings, "a crossing for each triangle");
    }
}

#[test]
fn open_curves_end_inside_a_body_or_at_the_boundary_of_a_sheet() {
    let body = icosphere(3, 0.5);
    let stroke = Sweep::new(
        [[-1.0, 0.01, -1.0], [-1.0, 0.01, 1.0]],
        [[0.1, 0.01, -1.0], [0.1, 0.01, 1.0]],
    );
    let mut cutter = Cutter::new(&body);
    let curves = cutter.intersect(&body, &stroke.unwrap(), None).unwrap();
    assert!(curves.end(&body).is_some());
    assert_eq!(curves.sheet(&body), None);
    assert!(curves.iter().all(|curve| !curve.is_closed()));

    let cloth = sheet([1.0, 1.0], [17, 13]);
    let mut cutter = Cutter::new(&cloth);
    let sweep = Sweep::from_plane([1.0, 0.2, 0.1], 0.03, &cloth.bounds()).unwrap();
    let curves = cutter.intersect(&cloth, &sweep, None).unwrap();
    assert_eq!(curves.iter().count(), 1);
    assert_eq!(curves.end(&cloth), None);
    assert!(curves.sheet(&cloth).is_some());
}

#[test]
fn only_the_named_piece_is_crossed() {
    let mut body = cube_sphere(8, 0.5);
    let mut cutter = Cutter::new(&body);
    let sweep = plane(&body);
    let _ = cutter
        .cut(&mut body, &sweep, &CutParams::default())
        .unwrap();
    let across = Sweep::from_plane([1.0, 0.1, 0.0], 0.02, &body.bounds()).unwrap();
    let mut count = |piece| {
        let curves = cutter.intersect(&body, &across, piece).unwrap();
        curves.iter().count()
    };
    assert_eq!([count(None), count(Some(0)), count(Some(1))], [2, 1, 1]);
    assert_eq!(count(Some(2)), 0);
}
