//! Bending constraint: the angle between two triangles as the solver's kernel defines it.

use super::measure::{Blocks, Kind, Measure, Slope, clamp_12};
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::{PI, TAU};

/// Smallest doubled area of a triangle with a normal, relative to its squared edges; the solver's
/// limit.
const FLAT: f64 = 1e-5;

/// Returns the signed angle at the edge from the first to the second point, with its derivatives.
///
/// The angle \[rad\] is 0 for a flat hinge and positive for a convex one; none where a triangle has
/// no normal. The third point belongs to the triangle that runs along the edge, the fourth to the
/// one that runs against it.
///
/// With `e`, `a` and `b` from the first point to the others, `n = e x a` and `m = b x e`, the
/// gradients by `a` and `b` are `-|e| n / |n|^2` and `-|e| m / |m|^2` (Bridson et al. 2003). The
/// gradient by `e` is minus their sum, weighted by the feet of `a` and `b` on the edge. The Hessian
/// is the derivative of these gradients.
#[must_use]
pub fn hinge(points: &[Vector3<f64>; 4]) -> Option<Measure<4>> {
    let laid = Laid::of(points)?;
    let Laid {
        e,
        a,
        b,
        n,
        m,
        square,
        length,
        s,
        t,
        by_a,
        by_b,
        ..
    } = laid;
    let (p, q) = (n / n.norm_squared(), m / m.norm_squared());

    // Rows: by_e, by_a, by_b. Columns: changes of e, a, b.
    let along = (e / length).transpose();
    let (turn_p, turn_q) = (inverted(&n) * -length, inverted(&m) * -length);
    let (cross_e, cross_a, cross_b) = (e.cross_matrix(), a.cross_matrix(), b.cross_matrix());
    // dn = e x da - a x de, dm = b x de - e x db.
    let by_a_de = -p * along - turn_p * cross_a;
    let by_a_da = turn_p * cross_e;
    let by_b_de = -q * along + turn_q * cross_b;
    let by_b_db = -turn_q * cross_e;
    let (s_de, s_da) = ((a - e * (2.0 * s)) / square, e / square);
    let t_de = (b - e * (2.0 * t)) / square;
    let by_e_de =
        -(by_a * s_de.transpose() + by_a_de * s) - (by_b * t_de.transpose() + by_b_de * t);
    let by_e_da = -(by_a * s_da.transpose() + by_a_da * s);
    let by_e_db = -(by_b * s_da.transpose() + by_b_db * t);
    let zero = Matrix3::zeros();
    let inner = [
        [by_e_de, by_e_da, by_e_db],
        [by_e_da.transpose(), by_a_da, zero],
        [by_e_db.transpose(), zero, by_b_db],
    ];
    let Slope { value, gradient } = laid.slope();
    Some(Measure {
        value,
        gradient,
        hessian: with_origin(&inner),
    })
}

/// A hinge relative to its first point.
struct Laid {
    e: Vector3<f64>,
    a: Vector3<f64>,
    b: Vector3<f64>,
    n: Vector3<f64>,
    m: Vector3<f64>,
    square: f64,
    length: f64,
    /// Feet of `a` and `b` on the edge, as shares of it.
    s: f64,
    t: f64,
    by_a: Vector3<f64>,
    by_b: Vector3<f64>,
}

impl Laid {
    fn of(points: &[Vector3<f64>; 4]) -> Option<Self> {
        let [e, a, b] = [1, 2, 3].map(|i: usize| points[i] - points[0]);
        let (n, m) = (e.cross(&a), b.cross(&e));
        let square = e.norm_squared();
        let flat = |normal: &Vector3<f64>, side: &Vector3<f64>| {
            normal.norm() <= FLAT * (square + side.norm_squared())
        };
        if flat(&n, &a) || flat(&m, &b) {
            return None;
        }
        let length = square.sqrt();
        Some(Self {
            e,
            a,
            b,
            n,
            m,
            square,
            length,
            s: a.dot(&e) / square,
            t: b.dot(&e) / square,
            by_a: n * (-length / n.norm_squared()),
            by_b: m * (-length / m.norm_squared()),
        })
    }

    fn slope(&self) -> Slope<4> {
        let Self { by_a, by_b, .. } = self;
        let by_e = -(by_a * self.s + by_b * self.t);
        let value = (-self.length * self.a.dot(&self.m)).atan2(self.n.dot(&self.m));
        Slope {
            value,
            gradient: [-(by_e + by_a + by_b), by_e, *by_a, *by_b],
        }
    }
}

/// Returns the derivative of `n / |n|^2` by `n`.
fn inverted(n: &Vector3<f64>) -> Matrix3<f64> {
    let square = n.norm_squared();
    (Matrix3::identity() - n * n.transpose() * (2.0 / square)) / square
}

/// Expands second derivatives by differences to the first point to all four points, exactly
/// symmetric.
fn with_origin(inner: &[[Matrix3<f64>; 3]; 3]) -> Blocks<4> {
    let mut out = [[Matrix3::zeros(); 4]; 4];
    for (i, row) in inner.iter().enumerate() {
        for j in 0..3 {
            let block = (row[j] + inner[j][i].transpose()) * 0.5;
            out[i + 1][j + 1] = block;
            out[0][j + 1] -= block;
            out[i + 1][0] -= block;
            out[0][0] += block;
        }
    }
    out
}

/// The hinge constraint.
pub(super) struct Hinge;

impl Kind<4> for Hinge {
    fn measure(points: &[Vector3<f64>; 4]) -> Option<Measure<4>> {
        hinge(points)
    }

    fn slope(points: &[Vector3<f64>; 4]) -> Option<Slope<4>> {
        Laid::of(points).map(|laid| laid.slope())
    }

    /// Returns the difference modulo a full turn.
    fn error(value: f64, rest: f64) -> f64 {
        let turn = value - rest;
        if turn > PI {
            turn - TAU
        } else if turn <= -PI {
            turn + TAU
        } else {
            turn
        }
    }

    fn clamp(hessian: &mut Blocks<4>) {
        clamp_12(hessian);
    }
}
