use super::*;
use crate::constraints::batches::Batch;
use crate::kernels::particle_state::on_arrays;
use crate::material::Stiffness;
use crate::step::sweep::sweep;
use incise_mesh::geometry::to_f64;
use incise_mesh::{Vec3, VertexId};

/// The angle another way: between the normals, positive where the fourth point is behind the first
/// triangle.
fn angle(p: [Vec3; 4]) -> f64 {
    let e = p[1] - p[0];
    let (n2, n3) = (e.cross(&(p[2] - p[0])), (p[3] - p[0]).cross(&e));
    let unsigned = n2.cross(&n3).norm().atan2(n2.dot(&n3));
    if n2.dot(&(p[3] - p[0])) > 0.0 {
        -unsigned
    } else {
        unsigned
    }
}

/// A skew hinge with opening angle `theta`, edges of about `scale`.
fn hinge(theta: f64, scale: f64) -> [[f32; 4]; 4] {
    let wing = |along: f64, out: f64, turn: f64| {
        let (sin, cos) = turn.sin_cos();
        Vec3::new(along, out * cos, out * sin)
    };
    let points = [
        Vec3::zeros(),
        Vec3::new(1.1, 0.0, 0.0),
        wing(0.3, 0.9, 0.0),
        wing(0.7, -1.2, theta),
    ];
    let tilt = nalgebra::Rotation3::from_euler_angles(0.4, 1.1, -0.3);
    points.map(|p| {
        let [x, y, z] = incise_mesh::geometry::to_f32(tilt * p * scale);
        [x, y, z, 1.0]
    })
}

fn batch(rest: f32) -> Batch<4> {
    Batch {
        vertices: vec![[0, 1, 2, 3].map(VertexId)],
        rest: vec![rest],
        edges: Vec::new(),
        lambda: Vec::new(),
    }
}

fn points(x: &[[f32; 4]; 4]) -> [Vec3; 4] {
    x.map(|[x, y, z, _]| to_f64([x, y, z]))
}

const FOLDED: f64 = std::f64::consts::PI - 2e-3;
const RIGID: Stiffness = Stiffness::Pbd(1.0);

#[test]
#[expect(
    clippy::cast_possible_truncation,
    reason = "the rest angle is stored in f32"
)]
fn corrections_run_along_the_gradients() {
    for scale in [1.0, 0.05, 1e-3] {
        for theta in [0.0, 1e-3, -1e-3, 0.7, -1.5, 2.5, FOLDED, -FOLDED] {
            let x = hinge(theta, scale);
            let p = points(&x);
            let asked = 0.08;
            let mut d = [[0.0; 4]; 4];
            let mut constraint = batch((angle(p) - asked) as f32);
            on_arrays(&x, &mut d, |p| {
                sweep::<Bending, 4>(
                    p,
                    constraint.part(RIGID.projection(1, 0.01).accumulates_lambda),
                    RIGID.projection(1, 0.01),
                )
            });
            // d_i = -C g_i / sum |g|^2, so g_i = -C d_i / sum |d|^2.
            let square: f64 = d.iter().flatten().map(|&c| f64::from(c).powi(2)).sum();
            let mut largest = 0.0_f64;
            let mut worst = 0.0_f64;
            for (i, d) in d.iter().enumerate() {
                for k in 0..3 {
                    let step = 1e-5 * scale;
                    let moved = |by: f64| {
                        let mut p = p;
                        p[i][k] += by;
                        angle(p)
                    };
                    let mut change = moved(step) - moved(-step);
                    change -= std::f64::consts::TAU * (change / std::f64::consts::TAU).round();
                    let difference = change / (2.0 * step);
                    let gradient = -asked * f64::from(d[k]) / square;
                    largest = largest.max(difference.abs());
                    worst = worst.max((gradient - difference).abs());
                }
            }
            assert!(
                worst < 1e-3 * largest,
                "off by {worst} of {largest} at angle {theta}, scale {scale}"
            );
            for k in 0..3 {
                let sum: f32 = d.iter().map(|d| d[k]).sum();
                let most = d.iter().map(|d| d[k].abs()).fold(0.0, f32::max);
                assert!(sum.abs() <= 1e-5 * most, "momentum {sum} of {most}");
            }
        }
    }
}

#[test]
fn projections_end_at_the_rest_angle() {
    for (start, rest) in [(0.3, 1.2), (2.0, -1.0), (-2.9, 2.9), (0.0, 3.0)] {
        let x = hinge(start, 0.1);
        let mut d = [[0.0; 4]; 4];
        let mut constraint = batch(rest);
        for _ in 0..60 {
            on_arrays(&x, &mut d, |p| {
                sweep::<Bending, 4>(
                    p,
                    constraint.part(RIGID.projection(1, 0.01).accumulates_lambda),
                    RIGID.projection(1, 0.01),
                )
            });
        }
        let mut moved = x;
        for (x, d) in moved.iter_mut().zip(d) {
            for k in 0..3 {
                x[k] += d[k];
            }
        }
        let end = angle(points(&moved));
        assert!(
            (end - f64::from(rest)).abs() < 1e-4,
            "{start} went to {end}, not {rest}"
        );
    }
}

/// By how much one projection turns a hinge of 1 m that is `off` by so much, of which the substep
/// has added `added`, beside edges of that `alpha` \[rad\].
fn turned(off: f64, added: f64, alpha: f32, stiffness: Stiffness, h: f32) -> f64 {
    let (start, rest) = (0.9, 0.9 - off);
    let (x, moved) = (hinge(start - added, 1.0), hinge(start, 1.0));
    let mut d = [[0.0; 4]; 4];
    for (d, (x, moved)) in d.iter_mut().zip(x.iter().zip(&moved)) {
        *d = std::array::from_fn(|k| if k < 3 { moved[k] - x[k] } else { 0.0 });
    }
    let projection = stiffness.projection(1, h).beside_edges(alpha);
    #[expect(clippy::cast_possible_truncation, reason = "stored in f32")]
    let mut constraint = batch(rest as f32);
    on_arrays(&x, &mut d, |p| {
        sweep::<Bending, 4>(
            p,
            constraint.part(projection.accumulates_lambda),
            projection,
        )
    });
    let mut end = points(&x);
    for (p, d) in end.iter_mut().zip(d) {
        *p += to_f64([d[0], d[1], d[2]]);
    }
    start - angle(end)
}

#[test]
fn old_errors_come_back_slowly_beside_soft_edges_only() {
    let (h, old) = (1e-3, 0.03);
    let limit = f64::from(RECOVERY * h);
    // Four vertices of 1 kg beside limp edges: as much less as the square of their frequency is
    // below the bound's.
    let slowest = LIMP / HOLD * RECOVERY * RECOVERY;
    let limp = |alpha: f32| f64::from(4.0 / (alpha * h * h) / slowest);
    for (alpha, expected) in [
        (0.0, old),
        (1e-3, old),
        (1e4, limit),
        (1e6, limit * limp(1e6)),
    ] {
        let found = turned(old, 0.0, alpha, RIGID, h);
        assert!(
            (found / expected - 1.0).abs() < 0.03,
            "{found} of {expected}, edges of {alpha}"
        );
    }
    // A compliance gets what it asks for beside edges that are stiffer than the hinge, and less
    // beside softer ones.
    let soft = Stiffness::Compliance(1e-3);
    let [free, stiffer, softer] = [0.0, 10.0, 1e4].map(|alpha| turned(old, 0.0, alpha, soft, h));
    assert_eq!(free, stiffer, "the pull of a compliance");
    assert!(free > 0.0 && free < limit, "{free} is below the bound");
    assert!(softer < 0.2 * free, "{softer} of {free}");
}

#[test]
fn what_a_substep_adds_is_taken_back_at_once() {
    for alpha in [0.0, 1e9] {
        let found = turned(0.03, 0.03, alpha, RIGID, 1e-4);
        assert!(
            (found / 0.03 - 1.0).abs() < 0.05,
            "{found}, edges of {alpha}"
        );
    }
}

#[test]
fn degenerate_triangles_take_no_part() {
    let o = [0.0, 0.0, 0.0, 1.0];
    let [a, b, c] = [
        [1.0, 0.0, 0.0, 1.0],
        [0.0, 1.0, 0.0, 1.0],
        [2.0, 0.0, 0.0, 1.0],
    ];
    let sliver = [0.5, 1e-7, 0.0, 1.0];
    for x in [
        [o; 4],
        [o, a, c, b],
        [o, a, b, c],
        [o, o, a, b],
        [o, a, b, sliver],
    ] {
        let mut d = [[0.0; 4]; 4];
        on_arrays(&x, &mut d, |p| {
            sweep::<Bending, 4>(
                p,
                batch(1.0).part(RIGID.projection(1, 0.01).accumulates_lambda),
                RIGID.projection(1, 0.01),
            )
        });
        assert_eq!(d, [[0.0; 4]; 4], "{x:?}");
    }
}
