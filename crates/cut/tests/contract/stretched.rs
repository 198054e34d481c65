//! A thousand progressive steps through a body that is stretched, sheared and turned meanwhile.

use crate::common::{check, params};
use incise_cut::{CutOutcome, Cutter, Incision};
use incise_mesh::geometry::to_f32;
use incise_mesh::{Surface, TriangleId, Vec3, VertexId, cube_sphere};

/// Steps of all strokes.
const STEPS: u16 = 1000;
/// Steps of a stroke.
const STEPS_OF_STROKE: u16 = 125;
/// Length along x, relative to rest.
const STRETCH: f64 = 3.0;
/// Steps that may be refused, all where later strokes cross earlier slits or run along them.
const MAX_REFUSED: u32 = 1;

/// Moves every vertex to its place in a stretched, sheared and turned body.
///
/// So the walls of all slits coincide.
fn deform(body: &mut Surface, time: f64) {
    let (sin, cos) = (0.3 * time).sin_cos();
    let shear = 0.4 * (0.7 * time).sin();
    let vertices: Vec<VertexId> = body.topology().vertices().collect();
    for v in vertices {
        let rest = body.rest_position(v);
        let p = Vec3::new(STRETCH * rest.x, rest.y + shear * rest.x, rest.z);
        let turned = Vec3::new(cos * p.x - sin * p.y, sin * p.x + cos * p.y, p.z);
        let weight = body.positions()[v.index()][3];
        let [x, y, z] = to_f32(turned);
        body.positions_mut()[v.index()] = [x, y, z, weight];
    }
}

/// Asserts that the new walls are mirror images, and so without rest volume.
fn assert_walls_mirror(body: &Surface, outcome: &CutOutcome) {
    let (below, above) = outcome.cap.split_at(outcome.cap.len() / 2);
    assert_eq!(below.len(), above.len(), "two walls");
    let volume = |t: TriangleId| {
        let [a, b, c] = (body.topology().triangle(t)).map(|v| body.rest_position(v));
        a.dot(&b.cross(&c))
    };
    for (&a, &b) in below.iter().zip(above) {
        let corners = |t: TriangleId| body.topology().triangle(t);
        let ([a0, b0, c0], [a1, c1, b1]) = (corners(a), corners(b));
        for (v, w) in [(a0, a1), (b0, b1), (c0, c1)] {
            assert_eq!(body.rest_position(v), body.rest_position(w), "{v} and {w}");
        }
        assert_eq!(volume(a) + volume(b), 0.0, "the volume of {a} and {b}");
    }
}

#[test]
fn a_thousand_steps_through_a_stretched_body() {
    let mut seed = 1u64;
    let mut random = move || {
        seed = seed
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        f32::from(u16::try_from(seed >> 48).unwrap()) / 32_768.0 - 1.0
    };
    let mut body = cube_sphere(5, 0.5);
    assert_eq!(body.topology().triangle_count(), 300);
    let mut cutter = Cutter::new(&body);
    let mut incision = Incision::default();
    let (mut cuts, mut refused) = (0, 0);
    let [mut from, mut motion, mut edge] = [[0.0; 3]; 3];
    let volume = body.rest_volume_of(body.topology().triangles());
    for step in 0..STEPS {
        deform(&mut body, f64::from(step) / 100.0);
        cutter.refit(&body);
        let s = f32::from(step % STEPS_OF_STROKE) / f32::from(STEPS_OF_STROKE - 1);
        if step.is_multiple_of(STEPS_OF_STROKE) {
            incision = Incision::default();
            let bounds = body.bounds();
            let size = [0, 1, 2].map(|k| bounds.max[k] - bounds.min[k]);
            let mut vector = |scale: f32| [0, 1, 2].map(|k| scale * size[k] * random());
            (from, motion, edge) = (vector(0.3), vector(0.8), vector(0.7));
        }
        let at = |k: usize, end: f32| from[k] + motion[k] * (2.0 * s - 1.0) + edge[k] * end;
        let pose = [-1.0, 1.0].map(|end| [0, 1, 2].map(|k| at(k, end)));
        let before = body.rest_volume_of(body.topology().triangles());
        match cutter.advance(&mut body, &mut incision, &pose, &params(0.0)) {
            Ok(outcome) if outcome.is_miss() => continue,
            Ok(outcome) => {
                cuts += 1;
                assert_walls_mirror(&body, &outcome);
            }
            Err(error) => {
                assert!(step >= STEPS_OF_STROKE, "step {step}: {error}");
                refused += 1;
                incision.restart(&pose);
            }
        }
        check(&body);
        let now = body.rest_volume_of(body.topology().triangles());
        assert!(
            (now / before - 1.0).abs() < 1e-6,
            "step {step}: {before} became {now}"
        );
    }
    cutter.bvh().validate(&body).unwrap();
    let now = body.rest_volume_of(body.topology().triangles());
    assert!((now / volume - 1.0).abs() < 1e-6, "{volume} became {now}");
    assert!(cuts > 70, "{cuts} steps cut");
    assert!(refused <= MAX_REFUSED, "{refused} steps are refused");
}
