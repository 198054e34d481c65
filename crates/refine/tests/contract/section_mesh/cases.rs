//! Sections with a known answer: touching, crossing and clockwise loops, quality, errors.

use super::sections::{Shape, check_any, check_clean, corners, polygon_area, run};
use incise_refine::{
    RefineError, Section, SectionMesh, SectionMeshParams, SectionMeshScratch, SectionMeshSize,
    triangulate_section,
};
use std::f64::consts::TAU;

/// Returns the sum of unsigned areas, which exceeds the section's area where triangles overlap.
fn covered(shape: &Shape, mesh: &SectionMesh) -> f64 {
    let area = |&t: &[u32; 3]| polygon_area(&corners(shape, mesh, t)).abs();
    mesh.triangles.iter().map(area).sum()
}

fn square(x: f64, y: f64, size: f64) -> [[f64; 2]; 4] {
    [[x, y], [x + size, y], [x + size, y + size], [x, y + size]]
}

fn hole<const N: usize>(mut points: [[f64; 2]; N]) -> [[f64; 2]; N] {
    points.reverse();
    points
}

fn circle(n: u32, radius: f64) -> Vec<[f64; 2]> {
    (0..n)
        .map(|i| f64::from(i) * TAU / f64::from(n))
        .map(|a| [radius * a.cos(), radius * a.sin()])
        .collect()
}

/// Returns the length of the shortest edge of a mesh.
fn shortest(shape: &Shape, mesh: &SectionMesh) -> f64 {
    let edges = mesh.triangles.iter().flat_map(|t| {
        let [a, b, c] = corners(shape, mesh, *t);
        [[a, b], [b, c], [c, a]]
    });
    let length = |[[px, py], [qx, qy]]: [[f64; 2]; 2]| (qx - px).hypot(qy - py);
    edges.map(length).fold(f64::INFINITY, f64::min)
}

/// Both sides of a slit have the same positions. No edge joins them; a whisker outside is clipped.
#[test]
fn slits_stay_open() {
    let slit = [
        [0.0, 4.0],
        [0.0, 2.0],
        [1.0, 2.0],
        [2.0, 2.0],
        [1.0, 2.0],
        [0.0, 2.0],
    ];
    let inside = [vec![[0.0, 0.0], [4.0, 0.0], [4.0, 4.0]], slit.to_vec()].concat();
    let outside = inside.iter().map(|&[x, y]| {
        let is_slit = y == 2.0 && x > 0.0;
        [if is_slit { -x } else { x }, y]
    });
    for (outline, is_open) in [(inside.clone(), true), (outside.collect(), false)] {
        let mut shape = Shape::default();
        shape.add(outline);
        let mesh = run(&shape, None).unwrap();
        let found = shortest(&shape, &mesh);
        assert_eq!(found > 0.0, is_open, "{found}");
        assert!((covered(&shape, &mesh) - 16.0).abs() < 1e-9);
    }
}

/// A slit whose ends are both inside the section is a loop of its own. One outside is clipped.
#[test]
fn a_slit_within_a_section_stays_open() {
    for (x, is_open) in [(1.0, true), (5.0, false)] {
        let slit = [[x, 1.0], [x + 1.0, 1.0], [x + 2.0, 1.0], [x + 1.0, 1.0]];
        let short = [[x, 2.0], [x + 1.0, 2.0], [x + 2.0, 2.0]];
        for slit in [&slit[..], &short[..]] {
            for length in [None, Some(0.5)] {
                let mut shape = Shape::default();
                shape.add(square(0.0, 0.0, 4.0).to_vec());
                shape.add(slit.to_vec());
                let mesh = run(&shape, length).unwrap();
                let ids = [4, 5, 6, 7];
                let is_across = |t: &[u32; 3]| t.iter().all(|v| ids.contains(v));
                assert_eq!(!mesh.triangles.iter().any(is_across), is_open, "{slit:?}");
                assert!((covered(&shape, &mesh) - 16.0).abs() < 1e-9);
            }
        }
    }
}

#[test]
fn touching_loops_give_no_overlap() {
    let outer = square(0.0, 0.0, 4.0);
    let shapes: [(&str, Vec<Vec<[f64; 2]>>); 7] = [
        (
            "a hole at a corner",
            vec![outer.into(), hole(square(0.0, 0.0, 1.0)).into()],
        ),
        (
            "a hole that touches an edge",
            vec![outer.into(), vec![[2.0, 0.0], [1.0, 1.0], [3.0, 1.0]]],
        ),
        (
            "a hole along an edge",
            vec![outer.into(), hole(square(1.0, 0.0, 2.0)).into()],
        ),
        (
            "islands with a common edge",
            vec![outer.into(), square(4.0, 0.0, 4.0).into()],
        ),
        (
            "islands that meet at a corner",
            vec![outer.into(), square(4.0, 4.0, 1.0).into()],
        ),
        (
            "holes that meet at a corner",
            vec![
                outer.into(),
                hole(square(1.0, 1.0, 1.0)).into(),
                hole(square(2.0, 2.0, 1.0)).into(),
            ],
        ),
        (
            "an island that fills its hole",
            vec![
                outer.into(),
                hole(square(1.0, 1.0, 2.0)).into(),
                square(1.0, 1.0, 2.0).into(),
            ],
        ),
    ];
    for (name, loops) in shapes {
        let mut shape = Shape::default();
        for points in loops {
            shape.add(points);
        }
        for length in [None, Some(0.3)] {
            let mesh = run(&shape, length).expect(name);
            check_any(&shape, &mesh);
            let (sum, area) = (covered(&shape, &mesh), shape.area());
            assert!((sum - area).abs() < 1e-3 * area, "{name}: {sum} for {area}");
            assert_eq!(
                (
                    mesh.report.separated_loops,
                    mesh.report.self_intersecting_loops
                ),
                (0, 0),
                "{name}"
            );
        }
    }
}

/// The loop has a slit without width, which stays, and duplicate points.
#[test]
fn duplicate_points_are_clipped_beside_a_slit() {
    let mut shape = Shape::default();
    shape.add([
        [0.0, 0.0],
        [2.0, 0.0],
        [2.0, 0.0],
        [2.0, 1.0],
        [2.0, 0.0],
        [4.0, 0.0],
        [4.0, 4.0],
        [0.0, 4.0],
        [0.0, 4.0],
        [0.0, 4.0],
    ]);
    let mesh = run(&shape, Some(0.25)).expect("valid loops");
    check_any(&shape, &mesh);
    assert!((covered(&shape, &mesh) - 16.0).abs() < 1e-9, "no overlap");
    assert_eq!(mesh.report.clipped_corners, 3, "{:?}", mesh.report);
    assert!(mesh.steiner_points.len() > 200, "refined as any other");
}

#[test]
fn a_self_crossing_loop_is_split_at_the_crossing() {
    // A figure eight, whose lobes have opposite orientations.
    let n = 200;
    let mut shape = Shape::default();
    shape.add((0..n).map(|i| {
        let a = (f64::from(i) + 0.25) * TAU / f64::from(n);
        [2.0 * a.sin(), (2.0 * a).sin()]
    }));
    let lobes: f64 = 2.0 * 4.0 / 3.0;
    for length in [None, Some(0.06)] {
        let mesh = run(&shape, length).expect("valid loops");
        check_any(&shape, &mesh);
        let sum = covered(&shape, &mesh);
        // The analytic area of both lobes.
        assert!((sum - 2.0 * lobes).abs() < 0.01 * lobes, "{sum}");
        assert_eq!(
            mesh.report.self_intersecting_loops, 1,
            "only the crossing itself"
        );
        assert!(
            length.is_none() || mesh.steiner_points.len() > 800,
            "both lobes are refined"
        );
    }
}

#[test]
fn clockwise_loops_give_clockwise_triangles() {
    for length in [None, Some(0.1)] {
        let mut shape = Shape::default();
        shape.add(circle(60, 1.0));
        let forward = run(&shape, length).expect("valid loops");
        shape.loops[0].reverse();
        let mesh = run(&shape, length).expect("valid loops");
        check_any(&shape, &mesh);
        assert_eq!(mesh.triangles.len(), forward.triangles.len(), "as many");
        let backward = |&t: &[u32; 3]| polygon_area(&corners(&shape, &mesh, t)) < 0.0;
        assert!(
            mesh.triangles.iter().all(backward),
            "every triangle has the loop's orientation"
        );
    }
}

/// Bounds on angles and edges of fine meshes of a smooth rim with even and uneven edges.
#[test]
fn smooth_rims_get_good_triangles() {
    for (n, uneven, z) in [
        (280, 0.6, 1.0),
        (280, 0.6, 1.5),
        (280, 0.6, 2.0),
        (280, 0.0, 1.0),
        (112, 0.6, 1.0),
    ] {
        let n = f64::from(n);
        let points: Vec<[f64; 2]> = (0..)
            .map(f64::from)
            .take_while(|i| *i < n)
            .map(|i| (i + uneven * (1.7 * i).sin() * 0.5) * TAU / n)
            .map(|a| {
                let r = 1.0 + 0.2 * (3.0 * a).cos();
                [r * a.cos(), r * a.sin()]
            })
            .collect();
        let distance = |p: [f64; 2], q: [f64; 2]| (p[0] - q[0]).hypot(p[1] - q[1]);
        let mean = (0..points.len())
            .map(|i| distance(points[i], points[(i + 1) % points.len()]))
            .sum::<f64>()
            / n;
        let length = z * mean;
        let mut shape = Shape::default();
        shape.add(points);
        let mesh = run(&shape, Some(length)).expect("valid loops");
        check_clean(&shape, &mesh);
        let rim = shape.points.len();
        let (mut angles, mut edges) = (Vec::new(), Vec::new());
        for &t in &mesh.triangles {
            let p = corners(&shape, &mesh, t);
            let sides = [0, 1, 2].map(|i| distance(p[i], p[(i + 1) % 3]));
            let angle = |i: usize| {
                let (a, b, c) = (sides[i], sides[(i + 1) % 3], sides[(i + 2) % 3]);
                ((b * b + c * c - a * a) / (2.0 * b * c))
                    .acos()
                    .to_degrees()
            };
            angles.push(angle(0).min(angle(1)).min(angle(2)));
            for i in 0..3 {
                let (v, w) = (t[i] as usize, t[(i + 1) % 3] as usize);
                if v < w && w >= rim {
                    edges.push(sides[i] / length);
                }
            }
        }
        angles.sort_unstable_by(f64::total_cmp);
        let count = angles.len();
        let mean = edges.iter().sum::<f64>() / edges.len() as f64;
        let longest = edges.iter().copied().fold(0.0, f64::max);
        let name = format!("{n} {uneven} {z}");
        assert!(angles[0] >= 20.0, "{name}: smallest {}", angles[0]);
        assert!(
            angles[count / 20] >= 30.0,
            "{name}: 5 percent {}",
            angles[count / 20]
        );
        assert!(
            angles[count / 2] >= 45.0,
            "{name}: median {}",
            angles[count / 2]
        );
        assert!((0.85..=1.15).contains(&mean), "{name}: mean {mean}");
        assert!(longest <= 1.8, "{name}: longest {longest}");
    }
}

#[test]
fn random_tangles_terminate() {
    let mut state = 1u32;
    let mut random = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1 << 24)
    };
    let mut shape = Shape::default();
    shape.add((0..1500).map(|_| [random(), random()]).collect::<Vec<_>>());
    shape.add(
        (0..1500)
            .map(|_| [random(), (8.0 * random()).floor()])
            .collect::<Vec<_>>(),
    );
    let mesh = run(&shape, Some(0.05)).expect("valid loops");
    check_any(&shape, &mesh);
}

#[test]
fn bad_input_is_an_error() {
    let points = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [f64::NAN, 0.0]];
    let run_with = |loops: &[Vec<u32>], length: Option<f64>, max_triangles: usize| {
        let section = Section {
            points: &points,
            loops,
        };
        let params = SectionMeshParams {
            size: length.map_or(SectionMeshSize::Any, SectionMeshSize::Uniform),
            max_triangles,
            grading: 0.0,
            ..SectionMeshParams::default()
        };
        triangulate_section(
            &section,
            &params,
            |_, _| false,
            &mut SectionMeshScratch::default(),
        )
        .map(|c| c.triangles.len())
    };
    let good = [vec![0, 1, 2]];
    assert_eq!(run_with(&good, None, 1), Ok(1));
    assert_eq!(run_with(&[], None, 1), Ok(0));
    assert_eq!(
        run_with(&[vec![0, 1]], None, 9),
        Err(RefineError::LoopTooShort {
            index: 0,
            points: 2
        })
    );
    assert_eq!(
        run_with(&[vec![0, 1, 4]], None, 9),
        Err(RefineError::UnknownPoint { index: 0, point: 4 })
    );
    assert_eq!(
        run_with(&[vec![0, 1, 0]], None, 9),
        Err(RefineError::RepeatedPoint { index: 0, point: 0 })
    );
    assert_eq!(
        run_with(&[vec![0, 1, 3]], None, 9),
        Err(RefineError::NonFinite { vertex: 3 })
    );
    for length in [0.0, -1.0] {
        assert_eq!(
            run_with(&good, Some(length), 9),
            Err(RefineError::NonPositiveLength { length })
        );
    }
    assert!(run_with(&good, Some(f64::NAN), 9).is_err());
    for length in [1e-2, 1e-5, 1e-12, 1e-300] {
        assert_eq!(
            run_with(&good, Some(length), 1000),
            Err(RefineError::TooManyTriangles { limit: 1000 })
        );
    }
    assert!(run_with(&good, Some(0.1), 1000).is_ok_and(|n| n > 50));
    assert_eq!(run_with(&good, Some(1e300), 1), Ok(1));
}

#[test]
fn graded_lattices_keep_the_limit() {
    let points = circle(200, 1.0);
    let section = Section {
        points: &points,
        loops: &[(0..200).collect()],
    };
    let params = SectionMeshParams {
        size: SectionMeshSize::Uniform(0.01),
        max_triangles: 30_000,
        grading: 1e-6,
        ..SectionMeshParams::default()
    };
    let mut scratch = SectionMeshScratch::default();
    let found = triangulate_section(&section, &params, |_, _| false, &mut scratch);
    let limit = params.max_triangles;
    assert_eq!(found, Err(RefineError::TooManyTriangles { limit }));
}
