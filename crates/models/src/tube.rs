//! Tubes of varying radius along smooth curves, as implicit functions.

use crate::implicit::Sample;
use incise_mesh::Vec3;
use nalgebra::Vector4;

/// Number of straight pieces of a span in the first search for the closest point.
const PIECES: usize = 3;
/// Number of Newton steps from there.
const REFINEMENTS: usize = 3;

/// A tube along a Catmull-Rom spline, which interpolates the radius like a coordinate.
#[derive(Debug)]
pub(super) struct Tube {
    /// Polynomials of x, y, z and radius in the parameter from 0 to 1, constant term first.
    spans: Vec<[Vector4<f64>; 4]>,
    pieces: Vec<Piece>,
    /// Relative height of five ridges along the tube.
    ridges: f64,
    /// Center of a bounding sphere.
    center: Vec3,
    reach: f64,
}

/// A chord of the curve, with the radius at its start and its change.
#[derive(Debug)]
struct Piece {
    start: Vec3,
    chord: Vec3,
    inverse_square: f64,
    radius: f64,
    radius_change: f64,
}

impl Tube {
    /// Returns a tube through at least two `stations`, each x, y, z and radius.
    pub(super) fn new(stations: &[[f64; 4]]) -> Self {
        let at = |i: usize| Vector4::from(stations[i.min(stations.len() - 1)]);
        let spans: Vec<_> = (0..stations.len() - 1)
            .map(|i| {
                let [p0, p1, p2, p3] = [at(i.saturating_sub(1)), at(i), at(i + 1), at(i + 2)];
                [
                    p1,
                    (p2 - p0) * 0.5,
                    (p0 * 2.0 - p1 * 5.0 + p2 * 4.0 - p3) * 0.5,
                    (p1 * 3.0 - p0 - p2 * 3.0 + p3) * 0.5,
                ]
            })
            .collect();
        let mut tube = Self {
            spans,
            pieces: Vec::new(),
            ridges: 0.0,
            center: Vec3::zeros(),
            reach: 0.0,
        };
        let knots: Vec<_> = (0..=tube.spans.len() * PIECES)
            .map(|i| tube.curve(i as f64 / PIECES as f64)[0])
            .collect();
        tube.pieces = knots
            .windows(2)
            .map(|ends| {
                let step = ends[1] - ends[0];
                Piece {
                    start: ends[0].xyz(),
                    chord: step.xyz(),
                    inverse_square: 1.0 / step.xyz().norm_squared(),
                    radius: ends[0].w,
                    radius_change: step.w,
                }
            })
            .collect();
        tube.center = knots.iter().map(|k| k.xyz()).sum::<Vec3>() / knots.len() as f64;
        tube.reach = knots
            .iter()
            .map(|k| (k.xyz() - tube.center).norm() + k.w)
            .fold(0.0, f64::max);
        tube
    }

    /// Adds five ridges of relative height `ridges`.
    ///
    /// The curve must lie in a plane z = const. One ridge is on its left, seen from +z.
    pub(super) fn with_ridges(mut self, ridges: f64) -> Self {
        self.reach *= 1.0 + ridges;
        self.ridges = ridges;
        self
    }

    /// Returns a cheap lower bound of the value at `p`.
    pub(super) fn lower_bound(&self, p: Vec3) -> f64 {
        (p - self.center).norm() - self.reach
    }

    pub(super) fn sample(&self, p: Vec3) -> Sample {
        let last = self.spans.len() as f64;
        let mut u = self.first_guess(p);
        let mut speed = 1.0;
        for _ in 0..REFINEMENTS {
            let [at, velocity, acceleration] = self.curve(u).map(|c| c.xyz());
            let square = velocity.norm_squared();
            // Beyond the center of curvature, Newton's method would find a maximum. Use the part of
            // the derivative that is always positive instead.
            speed = square - (p - at).dot(&acceleration);
            if speed < 0.25 * square {
                speed = square;
            }
            u = (u + (p - at).dot(&velocity) / speed).clamp(0.0, last);
        }
        let [at, velocity, _] = self.curve(u);
        let (axis, radius) = (at.xyz(), at.w);
        let out = p - axis;
        let distance = out.norm();
        let mut gradient = out / distance.max(f64::MIN_POSITIVE);
        let mut relative = 1.0;
        if self.ridges > 0.0 {
            let left = Vec3::new(-velocity.y, velocity.x, 0.0).normalize();
            let (c, s) = (out.dot(&left), out.z);
            let length = (c * c + s * s).sqrt().max(f64::MIN_POSITIVE);
            let (c, s) = (c / length, s / length);
            // Cosine and sine of five times the angle around the curve, as polynomials.
            let (c2, s2) = (c * c, s * s);
            let cos5 = c * (c2 * c2 - 10.0 * c2 * s2 + 5.0 * s2 * s2);
            let sin5 = s * (5.0 * c2 * c2 - 10.0 * c2 * s2 + s2 * s2);
            relative += self.ridges * cos5;
            let turn = (Vec3::z() * c - left * s) / length;
            gradient += turn * (5.0 * radius * self.ridges * sin5);
        }
        if u > 0.0 && u < last {
            gradient -= velocity.xyz() * (relative * velocity.w / speed);
        }
        let value = distance - radius * relative;
        Sample { value, gradient }
    }

    /// Returns a bounding box.
    pub(super) fn bounds(&self) -> (Vec3, Vec3) {
        let mut low = Vec3::repeat(f64::INFINITY);
        let mut high = -low;
        for piece in &self.pieces {
            for t in [0.0, 1.0] {
                let p = piece.start + piece.chord * t;
                let radius = piece.radius + piece.radius_change * t;
                let r = Vec3::repeat(radius * (1.0 + self.ridges));
                low = low.inf(&(p - r));
                high = high.sup(&(p + r));
            }
        }
        (low, high)
    }

    /// Returns the parameter of the closest point on the straight pieces.
    fn first_guess(&self, p: Vec3) -> f64 {
        let (mut best, mut guess) = (f64::INFINITY, 0.0);
        for (i, piece) in self.pieces.iter().enumerate() {
            let from = p - piece.start;
            let t = (from.dot(&piece.chord) * piece.inverse_square).clamp(0.0, 1.0);
            let value = (from - piece.chord * t).norm() - piece.radius - piece.radius_change * t;
            if value < best {
                best = value;
                guess = (i as f64 + t) / PIECES as f64;
            }
        }
        guess
    }

    /// Returns the curve's point with the radius, and its first and second derivatives.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "the parameter lies between 0 and the number of spans"
    )]
    fn curve(&self, u: f64) -> [Vector4<f64>; 3] {
        let span = (u as usize).min(self.spans.len() - 1);
        let t = u - span as f64;
        let [a, b, c, d] = &self.spans[span];
        [
            a + (b + (c + d * t) * t) * t,
            b + (c * 2.0 + d * (3.0 * t)) * t,
            c * 2.0 + d * (6.0 * t),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STATIONS: [[f64; 4]; 4] = [
        [0.0, 0.0, 0.0, 0.2],
        [1.0, 0.5, 0.0, 0.1],
        [2.0, 0.4, 0.0, 0.3],
        [2.5, 1.0, 0.0, 0.2],
    ];

    #[test]
    fn a_tube_passes_through_its_stations() {
        let tube = Tube::new(&STATIONS);
        for [x, y, z, radius] in STATIONS {
            assert!((tube.sample(Vec3::new(x, y, z)).value + radius).abs() < 1e-12);
        }
        let beyond = tube.sample(Vec3::new(-0.3, -0.15, 0.0));
        assert!((beyond.value + 0.2 - 0.1125_f64.sqrt()).abs() < 1e-3);
    }

    #[test]
    fn gradient_matches_finite_differences() {
        for tube in [Tube::new(&STATIONS), Tube::new(&STATIONS).with_ridges(0.1)] {
            for p in [[0.4, 0.6, 0.1], [1.4, 0.3, -0.3], [2.2, 0.9, 0.2]] {
                let (p, h) = (Vec3::from(p), 1e-5);
                let gradient = tube.sample(p).gradient;
                for k in 0..3 {
                    let step = Vec3::from_fn(|i, _| if i == k { h } else { 0.0 });
                    let slope =
                        (tube.sample(p + step).value - tube.sample(p - step).value) / (2.0 * h);
                    assert!((slope - gradient[k]).abs() < 1e-4, "{slope} {gradient}");
                }
            }
        }
    }
}
