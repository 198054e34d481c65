//! The exact order of two points along a segment, each in a plane of its own.
//!
//! Along p + t (q - p), a plane through a with normal n is crossed at t = n.(p - a) / n.(p - q).
//! The difference of two such ratios is evaluated in 64 bits with an error bound, and where that
//! does not decide, in integers: a coordinate is a multiple of 2^-149.

use incise_mesh::Vec3;
use num_bigint::{BigInt, Sign};
use std::cmp::Ordering;

/// The plane of a triangle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plane(pub(super) [Vec3; 3]);

/// Compares the parameters at which the segment from p to q crosses two planes.
///
/// It crosses both. Ties are broken by moving both planes by `direction` times (e, e^2, e^3) for an
/// infinitesimal e. Equal only if the planes coincide.
pub(super) fn compare_along(segment: [Vec3; 2], planes: [&Plane; 2], direction: f64) -> Ordering {
    let [(a, da), (b, db)] = planes.map(|plane| ratio(segment, plane));
    let error = |x: Bounded, y: Bounded| {
        x.value.abs() * y.error + y.value.abs() * x.error + x.error * y.error
    };
    let (left, right) = (a.value * db.value, b.value * da.value);
    let bound = error(a, db) + error(b, da) + (left.abs() + right.abs()) * 4.0 * f64::EPSILON;
    let is_certain = (left - right).abs() > bound
        && da.value.abs() > da.error
        && db.value.abs() > db.error
        && (left - right).is_finite();
    if !is_certain {
        return compare_exactly(segment, planes, direction);
    }
    let order = left.total_cmp(&right);
    if (da.value < 0.0) == (db.value < 0.0) {
        order
    } else {
        order.reverse()
    }
}

/// A rounded number and a bound of its error.
#[derive(Debug, Clone, Copy)]
struct Bounded {
    value: f64,
    error: f64,
}

/// Returns n.(p - a) and n.(p - q) of a plane.
fn ratio([p, q]: [Vec3; 2], Plane([a, b, c]): &Plane) -> (Bounded, Bounded) {
    let (u, v) = (b - a, c - a);
    let normal = u.cross(&v);
    // Differences of f32 numbers may be rounded once, products and sums a few times.
    let size = Vec3::new(
        u.y.abs() * v.z.abs() + u.z.abs() * v.y.abs(),
        u.z.abs() * v.x.abs() + u.x.abs() * v.z.abs(),
        u.x.abs() * v.y.abs() + u.y.abs() * v.x.abs(),
    );
    let dot = |w: Vec3| Bounded {
        value: normal.dot(&w),
        error: 16.0 * f64::EPSILON * size.dot(&w.abs()),
    };
    (dot(p - a), dot(p - q))
}

fn compare_exactly(segment: [Vec3; 2], planes: [&Plane; 2], direction: f64) -> Ordering {
    let [p, q] = segment.map(integers);
    let [(na, ha, da), (nb, hb, db)] = planes.map(|Plane(corners)| {
        let [a, b, c] = corners.map(integers);
        let normal = cross(&minus(&b, &a), &minus(&c, &a));
        let height = dot(&normal, &minus(&p, &a));
        let depth = dot(&normal, &minus(&p, &q));
        (normal, height, depth)
    });
    let depths = da.sign() * db.sign();
    let order = |difference: BigInt| match difference.sign() * depths {
        Sign::Minus => Ordering::Less,
        Sign::NoSign => Ordering::Equal,
        Sign::Plus => Ordering::Greater,
    };
    // A plane that moves by d crosses at n.(p - a - d) / n.(p - q).
    let moved = (0..3).map(|k| {
        let change = &nb[k] * &da - &na[k] * &db;
        if direction < 0.0 { -change } else { change }
    });
    std::iter::once(&ha * &db - &hb * &da)
        .chain(moved)
        .map(order)
        .find(|order| order.is_ne())
        .unwrap_or(Ordering::Equal)
}

/// Returns the coordinates of a point in units of 2^-149.
fn integers(p: Vec3) -> [BigInt; 3] {
    [p.x, p.y, p.z].map(|x| {
        let bits = x.to_bits();
        let (mantissa, exponent) = (bits & ((1 << 52) - 1), (bits >> 52) & 0x7ff);
        // Widened f32 numbers are normal or zero, and multiples of 2^-149.
        if exponent == 0 {
            return BigInt::ZERO;
        }
        let shift = i64::try_from(exponent).unwrap_or_default() - 1023 - 52 + 149;
        let whole = BigInt::from(mantissa | 1 << 52);
        let whole = if shift < 0 {
            whole >> shift.unsigned_abs()
        } else {
            whole << shift.unsigned_abs()
        };
        if x < 0.0 { -whole } else { whole }
    })
}

fn minus(a: &[BigInt; 3], b: &[BigInt; 3]) -> [BigInt; 3] {
    [0, 1, 2].map(|k| &a[k] - &b[k])
}

fn cross(a: &[BigInt; 3], b: &[BigInt; 3]) -> [BigInt; 3] {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| &a[i] * &b[j] - &a[j] * &b[i])
}

fn dot(a: &[BigInt; 3], b: &[BigInt; 3]) -> BigInt {
    (0..3).map(|k| &a[k] * &b[k]).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn point(range: std::ops::Range<i16>) -> impl Strategy<Value = Vec3> {
        prop::array::uniform3(range).prop_map(|p| Vec3::from(p.map(f64::from)))
    }

    proptest! {
        /// The order along a segment on a lattice equals that of moved planes, and reverses with
        /// the segment.
        #[test]
        fn ties_are_those_of_moved_planes(
            segment in prop::array::uniform2(point(-2..3)),
            first in prop::array::uniform3(point(-2..3)),
            second in prop::array::uniform3(point(-2..3)),
        ) {
            let crosses = |t: &[Vec3; 3]| {
                let normal = (t[1] - t[0]).cross(&(t[2] - t[0]));
                normal.dot(&(segment[1] - segment[0])) != 0.0
            };
            prop_assume!(crosses(&first) && crosses(&second));
            let d = Vec3::new(1.0 / 64.0, 1.0 / 16384.0, 1.0 / 16_777_216.0);
            for direction in [1.0, -1.0] {
                let flush = [Plane(first), Plane(second)];
                let moved = flush.map(|Plane(t)| Plane(t.map(|p| p + d * direction)));
                let order = compare_along(segment, [&flush[0], &flush[1]], direction);
                prop_assert_eq!(order, compare_along(segment, [&moved[0], &moved[1]], direction));
                prop_assert_eq!(
                    order.reverse(),
                    compare_along(segment, [&flush[1], &flush[0]], direction)
                );
                let [p, q] = segment;
                prop_assert_eq!(
                    order.reverse(),
                    compare_along([q, p], [&flush[0], &flush[1]], direction)
                );
            }
        }
    }

    #[test]
    fn numbers_of_any_size_are_exact() {
        let tiny = f64::from(f32::from_bits(1));
        for (x, expected) in [
            (tiny, BigInt::from(1)),
            (-3.0 * tiny, BigInt::from(-3)),
            (1.0, BigInt::from(1) << 149),
            (
                f64::from(f32::MAX),
                BigInt::from((1 << 24) - 1) << (149 + 104),
            ),
        ] {
            assert_eq!(integers(Vec3::new(x, 0.0, -x))[0], expected);
        }
    }
}
