//! Bodies as implicit functions: negative inside, about the distance to the surface near it.
//!
//! Ellipsoids and tubes are joined by a polynomial smooth minimum, which is exact away from the joint.
//! Everything is sums, products, quotients and square roots, so values are the same on every machine.

use crate::geometry::Vec3;
use nalgebra::Matrix3;

/// Half the length of the step for the gradient's differences.
const GRADIENT_STEP: f64 = 1e-5;

/// A body: parts joined in order, and a fine relief on top.
#[derive(Debug)]
pub(super) struct Body {
    parts: Vec<Part>,
    /// Added to the distance: negative values swell the surface.
    relief: fn(Vec3) -> f64,
}

#[derive(Debug)]
struct Part {
    primitive: Primitive,
    /// Over which distance the part flows into the ones before it.
    blend: f64,
    /// Taken away instead of added.
    carved: bool,
    /// Also there with x negated.
    mirrored: bool,
}

/// What bodies are made of.
#[derive(Debug)]
pub(super) enum Primitive {
    /// An ellipsoid with radii along the rows of `frame`.
    Ellipsoid {
        /// The middle.
        center: Vec3,
        /// Half the length of each axis.
        radii: Vec3,
        /// Unit axes as rows.
        frame: Matrix3<f64>,
    },
    /// A tube of varying radius along a curve.
    Tube {
        /// Points of the curve with the radius there.
        knots: Vec<Knot>,
        /// Relative height of five ridges along it.
        ridges: f64,
        /// The middle of a ball around it.
        center: Vec3,
        /// The radius of that ball.
        reach: f64,
    },
}

/// A point of a tube's curve.
#[derive(Debug, Clone, Copy)]
pub(super) struct Knot {
    point: Vec3,
    radius: f64,
    /// Unit vector in the plane z = const across the curve, from which ridges count.
    side: Vec3,
}

impl Body {
    pub(super) fn new() -> Self {
        Self {
            parts: Vec::new(),
            relief: |_| 0.0,
        }
    }

    pub(super) fn with(self, primitive: Primitive, blend: f64) -> Self {
        self.with_part(primitive, blend, false, false)
    }

    pub(super) fn with_pair(self, primitive: Primitive, blend: f64) -> Self {
        self.with_part(primitive, blend, false, true)
    }

    pub(super) fn without_pair(self, primitive: Primitive, blend: f64) -> Self {
        self.with_part(primitive, blend, true, true)
    }

    pub(super) fn with_relief(mut self, relief: fn(Vec3) -> f64) -> Self {
        self.relief = relief;
        self
    }

    fn with_part(mut self, primitive: Primitive, blend: f64, carved: bool, mirrored: bool) -> Self {
        self.parts.push(Part {
            primitive,
            blend,
            carved,
            mirrored,
        });
        self
    }

    /// The value at `p`.
    pub(super) fn value(&self, p: Vec3) -> f64 {
        let mirrored = Vec3::new(p.x.abs(), p.y, p.z);
        let mut value = f64::INFINITY;
        for part in &self.parts {
            let p = if part.mirrored { mirrored } else { p };
            // What is too far to blend changes nothing; tubes are costly enough to ask first.
            if !part.carved && part.primitive.lower_bound(p) > value + part.blend {
                continue;
            }
            let own = part.primitive.value(p);
            value = if part.carved {
                -smooth_min(-value, own, part.blend)
            } else {
                smooth_min(value, own, part.blend)
            };
        }
        value + (self.relief)(p)
    }

    /// The gradient at `p`, from differences along the diagonals of a cube.
    pub(super) fn gradient(&self, p: Vec3) -> Vec3 {
        let mut sum = Vec3::zeros();
        for d in [
            Vec3::new(1.0, -1.0, -1.0),
            Vec3::new(-1.0, -1.0, 1.0),
            Vec3::new(-1.0, 1.0, -1.0),
            Vec3::new(1.0, 1.0, 1.0),
        ] {
            sum += d * self.value(p + d * GRADIENT_STEP);
        }
        sum / (4.0 * GRADIENT_STEP)
    }

    /// Moves `p` to the surface along the gradient, at most `limit` a step, and returns the outward
    /// unit normal there too.
    pub(super) fn project(&self, mut p: Vec3, limit: f64) -> (Vec3, Vec3) {
        const STEPS: usize = 3;
        const CLOSE_ENOUGH: f64 = 1e-6;
        let mut normal = Vec3::zeros();
        for _ in 0..STEPS {
            let (value, gradient) = (self.value(p), self.gradient(p));
            let slope = gradient.norm();
            if slope == 0.0 {
                break;
            }
            normal = gradient / slope;
            p -= normal * (value / slope).clamp(-limit, limit);
            if value.abs() < CLOSE_ENOUGH {
                break;
            }
        }
        (p, normal)
    }

    /// A box around the body, without the swelling at joints and of the relief.
    pub(super) fn bounds(&self) -> (Vec3, Vec3) {
        let mut low = Vec3::repeat(f64::INFINITY);
        let mut high = -low;
        for part in self.parts.iter().filter(|part| !part.carved) {
            let (mut a, mut b) = part.primitive.bounds();
            if part.mirrored {
                let x = b.x.abs().max(a.x.abs());
                (a.x, b.x) = (-x, x);
            }
            low = low.inf(&a);
            high = high.sup(&b);
        }
        (low, high)
    }
}

/// An ellipsoid along the axes.
pub(super) fn ellipsoid(center: [f64; 3], radii: [f64; 3]) -> Primitive {
    tilted_ellipsoid(center, radii, [0.0, 1.0, 0.0])
}

/// An ellipsoid whose second axis points along `up`; its third stays as close to z as it can.
pub(super) fn tilted_ellipsoid(center: [f64; 3], radii: [f64; 3], up: [f64; 3]) -> Primitive {
    let up = Vec3::from(up).normalize();
    let right = up.cross(&Vec3::z()).normalize();
    let front = right.cross(&up);
    Primitive::Ellipsoid {
        center: center.into(),
        radii: radii.into(),
        frame: Matrix3::from_rows(&[right.transpose(), up.transpose(), front.transpose()]),
    }
}

/// A round tube along a smooth curve through `stations`, each x, y, z and the radius there.
pub(super) fn tube(stations: &[[f64; 4]]) -> Primitive {
    ridged_tube(stations, 0.0)
}

/// A tube with five ridges of relative height `ridges`; its curve lies in a plane z = const.
pub(super) fn ridged_tube(stations: &[[f64; 4]], ridges: f64) -> Primitive {
    const STEPS: u32 = 6;
    let at = |i: usize| nalgebra::Vector4::from(stations[i.min(stations.len() - 1)]);
    let mut knots: Vec<Knot> = Vec::new();
    for i in 0..stations.len() - 1 {
        let [p0, p1, p2, p3] = [at(i.saturating_sub(1)), at(i), at(i + 1), at(i + 2)];
        let steps = if i + 2 == stations.len() {
            STEPS + 1
        } else {
            STEPS
        };
        for t in (0..steps).map(|k| f64::from(k) / f64::from(STEPS)) {
            // Catmull-Rom: through every station, its tangent along the line between its neighbors.
            let (a, b) = (p2 - p0, (p0 * 2.0 - p1 * 5.0 + p2 * 4.0 - p3) * t);
            let c = (p1 * 3.0 - p0 - p2 * 3.0 + p3) * (t * t);
            let q = p1 + (a + b + c) * (t / 2.0);
            let d = a + b * 2.0 + c * 3.0;
            let across = Vec3::new(-d.y, d.x, 0.0);
            knots.push(Knot {
                point: q.xyz(),
                radius: q.w,
                side: across / across.norm().max(f64::MIN_POSITIVE),
            });
        }
    }
    let center = knots.iter().map(|k| k.point).sum::<Vec3>() / knots.len() as f64;
    let reach = knots
        .iter()
        .map(|k| (k.point - center).norm() + k.radius * (1.0 + ridges))
        .fold(0.0, f64::max);
    Primitive::Tube {
        knots,
        ridges,
        center,
        reach,
    }
}

impl Primitive {
    fn value(&self, p: Vec3) -> f64 {
        match self {
            Self::Ellipsoid {
                center,
                radii,
                frame,
            } => {
                // Exact to first order at the surface, after I. Quilez.
                let q = (frame * (p - center)).component_div(radii);
                let (level, slope) = (q.norm(), q.component_div(radii).norm());
                if slope == 0.0 {
                    -radii.min()
                } else {
                    level * (level - 1.0) / slope
                }
            }
            Self::Tube { knots, ridges, .. } => knots
                .windows(2)
                .map(|pair| tube_piece(pair[0], pair[1], *ridges, p))
                .fold(f64::INFINITY, f64::min),
        }
    }

    /// Not more than the value; cheap.
    fn lower_bound(&self, p: Vec3) -> f64 {
        match self {
            Self::Ellipsoid { .. } => f64::NEG_INFINITY,
            Self::Tube { center, reach, .. } => (p - center).norm() - reach,
        }
    }

    fn bounds(&self) -> (Vec3, Vec3) {
        match self {
            Self::Ellipsoid {
                center,
                radii,
                frame,
            } => {
                let half = Vec3::from_fn(|i, _| frame.column(i).component_mul(radii).norm());
                (center - half, center + half)
            }
            Self::Tube { knots, ridges, .. } => {
                let mut low = Vec3::repeat(f64::INFINITY);
                let mut high = -low;
                for k in knots {
                    let r = Vec3::repeat(k.radius * (1.0 + ridges));
                    low = low.inf(&(k.point - r));
                    high = high.sup(&(k.point + r));
                }
                (low, high)
            }
        }
    }
}

fn tube_piece(a: Knot, b: Knot, ridges: f64, p: Vec3) -> f64 {
    let along = b.point - a.point;
    let t = ((p - a.point).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
    let out = p - (a.point + along * t);
    let mut radius = a.radius + (b.radius - a.radius) * t;
    if ridges > 0.0 {
        let c = out.dot(&(a.side + (b.side - a.side) * t));
        let s = out.z;
        let length = (c * c + s * s).sqrt();
        if length > 0.0 {
            // The cosine of five times the angle, as a polynomial.
            let (c, s) = (c / length, s / length);
            let (c2, s2) = (c * c, s * s);
            radius *= 1.0 + ridges * c * (c2 * c2 - 10.0 * c2 * s2 + 5.0 * s2 * s2);
        }
    }
    out.norm() - radius
}

/// The smaller value, rounded off over the distance `blend` where both are alike.
fn smooth_min(a: f64, b: f64, blend: f64) -> f64 {
    let near = (blend - (a - b).abs()).max(0.0);
    a.min(b) - near * near / (4.0 * blend)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tilted_ellipsoid_has_its_axis_where_it_should() {
        let e = tilted_ellipsoid([1.0, 0.0, 0.0], [0.5, 2.0, 0.25], [3.0, 4.0, 0.0]);
        for (p, expected) in [([2.2, 1.6, 0.0], 0.0), ([1.0, 0.0, 0.25], 0.0)] {
            assert!((e.value(p.into()) - expected).abs() < 1e-12);
        }
        assert!((e.value([1.0 + 1.8, 2.4, 0.0].into()) - 1.0).abs() < 1e-12);
        assert_eq!(e.value([1.0, 0.0, 0.0].into()), -0.25);
    }

    #[test]
    fn a_tube_passes_through_its_stations() {
        let t = tube(&[[0.0, 0.0, 0.0, 0.2], [1.0, 0.5, 0.0, 0.1], [2.0, 0.0, 0.5, 0.3]]);
        assert!((t.value([1.0, 0.5, 0.0].into()) + 0.1).abs() < 1e-12);
        assert!((t.value([2.0, 0.0, 0.5].into()) + 0.3).abs() < 1e-12);
    }

    #[test]
    fn a_far_part_changes_nothing() {
        let ball = || ellipsoid([0.0; 3], [1.0; 3]);
        let alone = Body::new().with(ball(), 0.1);
        let joined = Body::new()
            .with(ball(), 0.1)
            .with_pair(tube(&[[3.0, 0.0, 0.0, 0.1], [4.0, 0.0, 0.0, 0.1]]), 0.1);
        let p = Vec3::new(0.4, 0.8, 0.1);
        assert_eq!(alone.value(p), joined.value(p));
        assert!((joined.value(Vec3::new(-3.5, 0.3, 0.0)) - 0.2).abs() < 1e-12);
    }

    #[test]
    fn projection_lands_on_the_surface() {
        let body = Body::new().with(ellipsoid([0.0; 3], [1.0, 0.5, 0.7]), 0.1);
        let (p, normal) = body.project(Vec3::new(0.8, 0.4, -0.2), 0.5);
        assert!(body.value(p).abs() < 1e-6);
        assert!((normal.norm() - 1.0).abs() < 1e-12);
        assert!(normal.dot(&p) > 0.0);
    }
}
