//! Hole filling: cases with a known answer.

use super::punched::{area, collar, disc, euler, fill_and_check, inner_loop, reread, without};
use incise_mesh::{Surface, TriangleId, Vec3, icosphere};
use incise_refine::{HoleError, HoleParams, RefinementLevel, fill_hole, fill_holes};
use std::f32::consts::TAU;

fn sheet(n: u16) -> Surface {
    let at = |x: u16, y: u16| u32::from(y * (n + 1) + x);
    let points = (0..=n).flat_map(|y| (0..=n).map(move |x| [f32::from(x), f32::from(y), 0.0]));
    let squares = (0..n).flat_map(|y| (0..n).map(move |x| (x, y)));
    let triangles: Vec<[u32; 3]> = squares
        .flat_map(|(x, y)| {
            let [a, b, c, d] = [at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    Surface::from_triangles(&points.collect::<Vec<_>>(), &triangles).unwrap()
}

#[test]
fn a_missing_triangle_is_restored() {
    let body = icosphere(2, 1.0);
    let before = body.topology().triangle(TriangleId(7));
    let open = without(&body, &[TriangleId(7)]);
    let coarse = HoleParams {
        level: RefinementLevel::Z(2.0),
        ..HoleParams::default()
    };
    let (surface, report) = fill_and_check(&open, &coarse);
    assert_eq!(report.holes[0].triangles, [TriangleId(7)]);
    let now = surface.topology().triangle(TriangleId(7));
    let turned = [now, [now[1], now[2], now[0]], [now[2], now[0], now[1]]];
    assert!(turned.contains(&before), "the orientation is restored");
    assert!(report.holes[0].planar);
}

#[test]
fn holes_that_touch_at_a_vertex_are_filled_separately() {
    let body = icosphere(3, 1.0);
    let topology = body.topology();
    // Every other triangle around a vertex with six.
    let v = topology
        .vertices()
        .find(|&v| topology.outgoing_fan(v).count() == 6);
    let fan: Vec<TriangleId> = (topology.outgoing_fan(v.unwrap()))
        .map(|h| h.triangle())
        .collect();
    let open = without(&body, &[fan[0], fan[2], fan[4]]);
    let (surface, report) = fill_and_check(&open, &HoleParams::default());
    assert_eq!(
        report.holes.iter().map(|h| h.rim_edges).collect::<Vec<_>>(),
        [3, 3, 3]
    );
    assert_eq!(euler(&surface), 2);
    let (again, _) = fill_and_check(&reread(&open), &HoleParams::default());
    assert_eq!(euler(&again), 2);
}

#[test]
fn an_open_sheet_becomes_a_body() {
    // The patch is a second, coplanar sheet without duplicate edges.
    let (surface, report) = fill_and_check(&sheet(5), &HoleParams::default());
    assert_eq!((report.holes.len(), report.holes[0].rim_edges), (1, 20));
    assert!(report.holes[0].planar);
    assert_eq!(euler(&surface), 2);
    assert!(surface.volume().abs() < 1e-12);
    // A single triangle gets three more around a new vertex, because a second triangle on the same
    // corners would not be a manifold.
    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let single = Surface::from_triangles(&corners, &[[0, 1, 2]]).unwrap();
    let coarse = HoleParams {
        level: RefinementLevel::Z(3.0),
        ..HoleParams::default()
    };
    let (surface, _) = fill_and_check(&single, &coarse);
    assert_eq!(surface.topology().triangle_count(), 4);
}

#[test]
fn half_a_sphere_gets_a_planar_cap() {
    let body = icosphere(3, 1.0);
    let topology = body.topology();
    let lower = |t: &TriangleId| body.triangle_positions(*t).iter().any(|p| p.z < -1e-6);
    let gone: Vec<TriangleId> = topology.triangles().filter(lower).collect();
    let open = without(&body, &gone);
    let (surface, report) = fill_and_check(&open, &HoleParams::default());
    let hole = &report.holes[0];
    let rim: f64 = hole.triangles.iter().map(|&t| area(&surface, t)).sum();
    // By Gauss's theorem the area vectors of a closed surface sum to zero.
    let vector = |t: TriangleId| {
        let [a, b, c] = surface.triangle_positions(t);
        (b - a).cross(&(c - a)) / 2.0
    };
    let sum: Vec3 = surface.topology().triangles().map(vector).sum();
    assert!(sum.norm() < 1e-6, "{sum}");
    if hole.planar {
        let up: Vec3 = open.topology().triangles().map(vector).sum();
        assert!((rim - up.norm()).abs() < 1e-6, "area {rim} of a planar cap");
    }
}

#[test]
fn finer_levels_have_more_triangles_at_their_target() {
    let body = icosphere(4, 1.0);
    let hole = disc(body.topology(), TriangleId(100), 400);
    let open = without(&body, &hole);
    let mut last = 0;
    for level in RefinementLevel::FIVE {
        let params = HoleParams {
            level,
            ..HoleParams::default()
        };
        let (_, report) = fill_and_check(&open, &params);
        let hole = &report.holes[0];
        assert!(hole.triangles.len() > last, "{level} is finer");
        last = hole.triangles.len();
        let ratio = hole.mean_edge / hole.target_edge;
        assert!((0.6..1.4).contains(&ratio), "{level}: {ratio}");
    }
}

/// The rim's edges grow from one side to the other, and so must the patch's.
#[test]
fn patch_edges_follow_the_rim_edges() {
    let (mut rim, mut a) = (Vec::new(), 0.0f32);
    while a < 2.0 * TAU / 2.0 - 0.02 {
        rim.push([a.cos(), a.sin(), 0.2 * (2.0 * a).sin()]);
        a += 0.02 + 0.09 * (1.0 - a.cos());
    }
    let mut surface = collar(&rim);
    let boundary = inner_loop(&surface, rim.len());
    let report = fill_hole(&mut surface, &boundary, &HoleParams::default()).unwrap();
    assert!(!report.holes[0].planar);
    let mean = |is_there: &dyn Fn(f64) -> bool| {
        let own = report.holes[0].triangles.iter().filter(|&&t| {
            let [a, b, c] = surface.triangle_positions(t);
            is_there((a.x + b.x + c.x) / 3.0)
        });
        let areas: Vec<f64> = own.map(|&t| area(&surface, t)).collect();
        (areas.iter().sum::<f64>() / areas.len() as f64).sqrt()
    };
    let (fine, coarse) = (mean(&|x| x > 0.6), mean(&|x| x < -0.3));
    assert!(coarse > 2.0 * fine, "{coarse} and {fine}");
}

#[test]
fn rims_above_the_limit_stay_open() {
    let open = without(&sheet(6), &[28, 29, 50].map(TriangleId));
    let mut surface = open.clone();
    let params = HoleParams {
        max_rim_edges: 10,
        ..HoleParams::default()
    };
    let report = fill_holes(&mut surface, &params).unwrap();
    assert_eq!((report.holes.len(), report.left_open), (2, 1));
    assert_eq!(surface.topology().boundary_loops().len(), 1);
    assert_eq!(euler(&surface), 1);
    for v in surface.topology().vertices() {
        assert_eq!(
            surface.position(v).z,
            0.0,
            "a planar hole has a planar patch"
        );
    }
}

#[test]
fn a_long_rim_is_split() {
    let n = 3000u16;
    let rim: Vec<[f32; 3]> = (0..n)
        .map(|i| f32::from(i) / f32::from(n) * TAU)
        .map(|a| [a.cos(), a.sin(), 0.3 * (3.0 * a).sin()])
        .collect();
    let mut surface = collar(&rim);
    let boundary = inner_loop(&surface, rim.len());
    let coarse = HoleParams {
        level: RefinementLevel::Z(4.0),
        ..HoleParams::default()
    };
    let report = fill_hole(&mut surface, &boundary, &coarse).unwrap();
    assert_eq!(report.holes[0].rim_edges, 3000);
    super::punched::check_manifold(&surface);
    let total: f64 = report.holes[0]
        .triangles
        .iter()
        .map(|&t| area(&surface, t))
        .sum();
    assert!(
        (3.0..6.0).contains(&total),
        "area of a single sheet: {total}"
    );
}

#[test]
fn a_closed_body_has_no_holes() {
    let body = icosphere(1, 1.0);
    let mut surface = body.clone();
    let report = fill_holes(&mut surface, &HoleParams::default()).unwrap();
    assert!(report.holes.is_empty() && report.undo.is_none() && report.delta.is_empty());
    assert_eq!(
        surface.fingerprint(),
        body.fingerprint(),
        "the surface is unchanged"
    );
}

/// A figure of eight and a trefoil knot have no embedded patch; simple rims have one.
#[test]
fn self_intersecting_patches_are_reported() {
    let rim = |n: u16, at: &dyn Fn(f32) -> [f32; 3]| -> Vec<[f32; 3]> {
        (0..n)
            .map(|i| at(TAU * f32::from(i) / f32::from(n)))
            .collect()
    };
    let crossing: [(&str, Vec<[f32; 3]>); 2] = [
        (
            "eight",
            rim(40, &|a| {
                [(a + 0.03).cos() + 0.2, (2.0 * a + 0.06).sin(), 0.0]
            }),
        ),
        (
            "trefoil",
            rim(60, &|a| {
                let r = 2.0 + (3.0 * a).cos();
                [r * (2.0 * a).cos(), r * (2.0 * a).sin(), (3.0 * a).sin()]
            }),
        ),
    ];
    for (name, rim) in &crossing {
        let mut surface = collar(rim);
        let hole = inner_loop(&surface, rim.len());
        let report = fill_hole(&mut surface, &hole, &HoleParams::default()).unwrap();
        assert!(report.holes[0].self_intersecting, "{name}");
        assert!(!report.holes[0].planar, "{name}");
        surface.validate().unwrap();
    }
    let simple = [
        rim(40, &|a| [a.cos(), a.sin(), 0.0]),
        rim(40, &|a| [a.cos(), a.sin(), 0.3 * (3.0 * a).sin()]),
        rim(40, &|a| {
            [
                a.cos() * (1.0 + 0.5 * (5.0 * a).cos()),
                a.sin(),
                0.5 * (2.0 * a).cos(),
            ]
        }),
    ];
    for rim in &simple {
        let mut surface = collar(rim);
        let hole = inner_loop(&surface, rim.len());
        let report = fill_hole(&mut surface, &hole, &HoleParams::default()).unwrap();
        assert!(!report.holes[0].self_intersecting, "{rim:?}");
    }
}

/// Angles and triangle counts inside a zigzag rim are those of a planar patch at any level.
#[test]
fn bent_patches_are_as_good_as_planar_ones() {
    let rim: Vec<[f32; 3]> = (0..24u8)
        .map(|i| {
            (
                f32::from(i) * TAU / 24.0,
                if i % 2 == 0 { 0.1 } else { -0.1 },
            )
        })
        .map(|(a, z)| [a.cos(), a.sin(), z])
        .collect();
    let mut surface = collar(&rim);
    let hole = inner_loop(&surface, rim.len());
    for z in [1.0, 0.5, 0.2, 0.1, 0.05] {
        let mut surface = surface.clone();
        let params = HoleParams {
            level: RefinementLevel::Z(z),
            ..HoleParams::default()
        };
        let report = fill_hole(&mut surface, &hole, &params).unwrap();
        let patch = &report.holes[0];
        assert!(!patch.planar && !patch.self_intersecting);
        let total: f64 = patch.triangles.iter().map(|&t| area(&surface, t)).sum();
        let ideal = total / (0.75f64.sqrt() / 2.0 * patch.target_edge * patch.target_edge);
        let count = patch.triangles.len() as f64;
        assert!(
            (0.5 * ideal..2.0 * ideal).contains(&count),
            "{z}: {count} for {ideal}"
        );
        assert!(patch.angles.percentile_5 > 30.0, "{z}: {:?}", patch.angles);
    }
    // A level that is far too fine fails early.
    let fine = HoleParams {
        level: RefinementLevel::Z(1e-9),
        ..HoleParams::default()
    };
    let error = fill_hole(&mut surface, &hole, &fine).unwrap_err();
    assert_eq!(error, HoleError::TooManyTriangles { limit: 1_000_000 });
}

/// A collinear rim gives triangles without area, and a planar bow tie crosses itself.
#[test]
fn degenerate_rims_are_reported() {
    let line: Vec<[f32; 3]> = (0..8u8)
        .map(|i| [f32::from(i.min(8 - i)) + 1.0, 0.0, 0.0])
        .collect();
    let bow = [
        [1.0, 1.0, 0.0],
        [-1.0, -1.0, 0.0],
        [-1.0, 1.0, 0.0],
        [1.0, -1.0, 0.0],
    ];
    for (rim, is_line) in [(&line[..], true), (&bow[..], false)] {
        let mut surface = collar(rim);
        let hole = inner_loop(&surface, rim.len());
        let report = fill_hole(&mut surface, &hole, &HoleParams::default()).unwrap();
        let patch = &report.holes[0];
        let flat = patch
            .triangles
            .iter()
            .filter(|&&t| area(&surface, t) < 1e-9)
            .count();
        assert_eq!(patch.flat_triangles, flat, "{rim:?}");
        assert_eq!(patch.flat_triangles > 0, is_line, "{rim:?}");
        assert_eq!(patch.self_intersecting, !is_line, "{rim:?}");
    }
    let mut surface = collar(&[[1.0, 0.0, 0.0], [-0.5, 0.8, 0.0], [-0.5, -0.8, 0.0]]);
    let hole = inner_loop(&surface, 3);
    let report = fill_hole(&mut surface, &hole, &HoleParams::default()).unwrap();
    assert_eq!(
        (report.holes[0].flat_triangles, report.holes[0].slivers),
        (0, 0)
    );
}
