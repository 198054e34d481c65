//! Invariants of single cuts by the exact method.

use incise_cut::{CutError, CutParams, Cutter, Sweep};
use incise_mesh::{Surface, cube_sphere, icosphere, torus};

fn params(snap: f64) -> CutParams {
    CutParams {
        snap,
        ..CutParams::default()
    }
}

fn check(surface: &Surface) {
    let topology = surface.topology();
    topology.validate().unwrap();
    assert!(topology.is_closed(), "the surface is open");
    let mut valence = vec![0; topology.vertex_slots()];
    for t in topology.triangles() {
        for v in topology.triangle(t) {
            valence[v.index()] += 1;
        }
    }
    for v in topology.vertices() {
        let fan = topology.outgoing_fan(v).count();
        assert_eq!(fan, valence[v.index()], "{v} has more than one fan");
        assert!(fan >= 3, "{v} has {fan} triangles");
    }
}

#[test]
fn a_ball_in_halves() {
    for snap in [0.0, 0.1] {
        for n in 0..5 {
            let whole = icosphere(n, 0.5);
            let mut body = whole.clone();
            let sweep = Sweep::from_plane([0.3, 0.7, 0.6], 0.01, &body.bounds()).unwrap();
            let outcome = Cutter::new(&body)
                .cut(&mut body, &sweep, &params(snap))
                .unwrap();
            check(&body);
            assert_eq!(outcome.delta.pieces_added.len(), 1);
            let error = (body.volume() - whole.volume()).abs() / whole.volume();
            assert!(error < if snap == 0.0 { 1e-6 } else { 2e-3 }, "{error}");
            outcome.undo.unwrap().revert(&mut body).unwrap();
            assert_eq!(body, whole);
        }
    }
}

/// A box whose upper half is narrower on one side: a step that faces up.
fn stair() -> Surface {
    let profile = [
        [0.0, 0.0],
        [2.0, 0.0],
        [2.0, 1.0],
        [1.0, 1.0],
        [1.0, 2.0],
        [0.0, 2.0],
    ];
    let corners: Vec<[f32; 3]> = [0.0, 1.0]
        .into_iter()
        .flat_map(|z| profile.map(|[x, y]| [x, y, z]))
        .collect();
    let front = [[0, 1, 2], [0, 2, 3], [0, 3, 5], [3, 4, 5]];
    let mut faces: Vec<[u32; 3]> = front.map(|[a, b, c]| [a + 6, b + 6, c + 6]).to_vec();
    faces.extend(front.map(|[a, b, c]| [a, c, b]));
    for i in 0..6 {
        let j = (i + 1) % 6;
        faces.extend([[i, j, j + 6], [i, j + 6, i + 6]]);
    }
    Surface::from_triangles(&corners, &faces).unwrap()
}

#[test]
fn a_body_that_stands_on_the_plane_is_not_cut() {
    let touched = [
        (
            stair(),
            [
                [1.0, 0.0, 0.0, 0.0],
                [1.0, 0.0, 0.0, 2.0],
                [0.0, 1.0, 0.0, 0.0],
            ],
        ),
        (
            stair(),
            [
                [0.0, 1.0, 0.0, 2.0],
                [0.0, 0.0, 1.0, 0.0],
                [0.0, 0.0, 1.0, 1.0],
            ],
        ),
        (
            cube_sphere(6, 0.5),
            [
                [1.0, 0.0, 0.0, -0.5],
                [0.0, 1.0, 0.0, 0.5],
                [0.0, 0.0, 1.0, -0.5],
            ],
        ),
    ];
    for (whole, planes) in touched {
        for (plane, side) in planes.into_iter().flat_map(|p| [(p, 1.0), (p, -1.0)]) {
            let [x, y, z, d] = plane.map(|n| n * side);
            for snap in [0.0, 0.1] {
                let mut body = whole.clone();
                let sweep = Sweep::from_plane([x, y, z], d, &body.bounds()).unwrap();
                let outcome = Cutter::new(&body)
                    .cut(&mut body, &sweep, &params(snap))
                    .unwrap();
                assert!(outcome.is_miss(), "{plane:?} cuts");
                assert_eq!(outcome.report.hits, 0);
                assert_eq!(body, whole);
            }
        }
    }
}

#[test]
fn a_plane_along_a_step_cuts_what_stands_on_it() {
    let whole = stair();
    for plane in [[0.0, 1.0, 0.0, 1.0], [1.0, 0.0, 0.0, 1.0]] {
        for side in [1.0, -1.0] {
            let [x, y, z, d] = plane.map(|n| n * side);
            let mut body = whole.clone();
            let sweep = Sweep::from_plane([x, y, z], d, &body.bounds()).unwrap();
            let outcome = Cutter::new(&body)
                .cut(&mut body, &sweep, &params(0.0))
                .unwrap();
            check(&body);
            assert_eq!(outcome.delta.pieces_added.len(), 1, "{plane:?}");
            let mut volumes = body.piece_volumes();
            volumes.retain(|&volume| volume != 0.0);
            volumes.sort_unstable_by(f64::total_cmp);
            assert!(
                (volumes[0] - 1.0).abs() < 1e-6 && (volumes[1] - 2.0).abs() < 1e-6,
                "{volumes:?}"
            );
        }
    }
}

#[test]
fn planes_through_vertices_and_edges() {
    for whole in [
        cube_sphere(6, 0.5),
        torus(0.35, 0.15, 24, 12),
        icosphere(2, 0.5),
    ] {
        for normal in [
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
            [1.0, 1.0, 0.0],
        ] {
            for snap in [0.0, 0.1] {
                let mut body = whole.clone();
                let sweep = Sweep::from_plane(normal, 0.0, &body.bounds()).unwrap();
                let outcome = Cutter::new(&body)
                    .cut(&mut body, &sweep, &params(snap))
                    .unwrap();
                if snap > 0.0 {
                    // Nodes that stand on vertices are merged with them.
                    assert_eq!(outcome.report.short_rim_edges, 0, "{normal:?}");
                }
                check(&body);
                let error = (body.volume() - whole.volume()).abs() / whole.volume();
                assert!(error < if snap == 0.0 { 1e-5 } else { 2e-3 }, "{error}");
            }
        }
    }
}

#[test]
fn a_sweep_that_ends_inside_is_refused() {
    let mut body = icosphere(3, 0.5);
    let before = body.clone();
    let sweep = Sweep::new(
        [[-1.0, 0.01, -1.0], [-1.0, 0.01, 1.0]],
        [[0.1, 0.01, -1.0], [0.1, 0.01, 1.0]],
    )
    .unwrap();
    let result = Cutter::new(&body).cut(&mut body, &sweep, &params(0.1));
    assert!(
        matches!(result, Err(CutError::PartialCut { .. })),
        "{result:?}"
    );
    assert_eq!(body, before);
}

#[test]
fn a_bent_sweep_leaves_its_crease_in_the_caps() {
    let whole = icosphere(3, 0.5);
    for bend in [-0.7, -0.2, 0.3, 0.8] {
        for snap in [0.0, 0.1] {
            let mut body = whole.clone();
            let sweep = Sweep::new(
                [[-1.0, 0.02, -1.0], [1.0, 0.02, -1.0]],
                [[-1.0, bend, 1.0], [1.0, 0.02, 1.0]],
            )
            .unwrap();
            let outcome = Cutter::new(&body)
                .cut(&mut body, &sweep, &params(snap))
                .unwrap();
            check(&body);
            assert_eq!(outcome.delta.pieces_added.len(), 1);
            let error = (body.volume() - whole.volume()).abs() / whole.volume();
            assert!(error < if snap == 0.0 { 1e-5 } else { 2e-3 }, "{error}");
        }
    }
}
