//! Bodies as implicit functions: negative inside, approximately the distance near the surface.
//!
//! Ellipsoids and tubes are joined by a polynomial smooth minimum, which is exact away from the
//! joint. Only sums, products, quotients and square roots are used, so values are the same on every
//! machine.

use crate::ellipsoid::Ellipsoid;
use crate::tube::Tube;
use incise_mesh::Vec3;

/// Upper bound of the gradient's length without the relief; above 1 in ellipsoids.
///
/// Too small a bound would miss parts of the surface; a larger one only costs samples.
const STEEPEST: f64 = 1.3;

/// A value of an implicit function with its gradient.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    pub(super) value: f64,
    pub(super) gradient: Vec3,
}

/// A body: parts joined in order, and a fine relief on top.
#[derive(Debug)]
pub(super) struct Body {
    parts: Vec<Part>,
    /// Added to the distance; negative values raise the surface.
    relief: fn(Vec3) -> f64,
    /// Largest absolute value of the relief.
    relief_height: f64,
}

/// The parts of a body that affect values inside a ball.
#[derive(Debug)]
pub(super) struct Neighborhood<'a> {
    /// `None` if the surface is not near.
    parts: Vec<&'a Part>,
    relief: fn(Vec3) -> f64,
    middle: f64,
}

#[derive(Debug)]
struct Part {
    primitive: Primitive,
    /// Distance over which the part blends with the earlier ones.
    blend: f64,
    /// Whether the part is subtracted.
    carved: bool,
    /// Whether the part is repeated at negated x.
    mirrored: bool,
}

/// The shape of a part.
#[derive(Debug)]
pub(super) enum Primitive {
    /// An ellipsoid.
    Ellipsoid(Ellipsoid),
    /// A tube along a curve.
    Tube(Tube),
}

impl Body {
    pub(super) fn new() -> Self {
        Self {
            parts: Vec::new(),
            relief: |_| 0.0,
            relief_height: 0.0,
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

    pub(super) fn with_relief(mut self, relief: fn(Vec3) -> f64, height: f64) -> Self {
        self.relief = relief;
        self.relief_height = height;
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

    /// Returns the parts that affect values within `radius` of `middle`.
    pub(super) fn near(&self, middle: Vec3, radius: f64) -> Neighborhood<'_> {
        let slack = STEEPEST * radius;
        let mut out = Sample {
            value: f64::INFINITY,
            gradient: Vec3::zeros(),
        };
        let mut parts = Vec::new();
        for part in &self.parts {
            if part.lower_bound(middle) > out.value + part.blend + 2.0 * slack {
                continue;
            }
            let own = part.sample(middle);
            let ahead = if part.carved { -out.value } else { out.value };
            if own.value <= ahead + part.blend + 2.0 * slack {
                parts.push(part);
            }
            out = part.join(out, own);
        }
        if out.value.abs() > slack + self.relief_height {
            parts.clear();
        }
        Neighborhood {
            parts,
            relief: self.relief,
            middle: out.value,
        }
    }

    pub(super) fn sample(&self, p: Vec3) -> Sample {
        /// Step of the finite difference for the relief's gradient.
        const STEP: f64 = 1e-5;
        let mut out = joined(&self.parts, p);
        let relief = (self.relief)(p);
        out.value += relief;
        let forward = Vec3::from_fn(|k, _| {
            let mut q = p;
            q[k] += STEP;
            (self.relief)(q)
        });
        out.gradient += forward.add_scalar(-relief) / STEP;
        out
    }

    /// Moves `p` along the gradient to the surface and returns the outward unit normal too.
    ///
    /// Takes `steps` steps of at most `limit` each.
    pub(super) fn project(&self, mut p: Vec3, steps: usize, limit: f64) -> (Vec3, Vec3) {
        let mut normal = Vec3::zeros();
        for _ in 0..steps {
            let Sample { value, gradient } = self.sample(p);
            let slope = gradient.norm();
            if slope == 0.0 {
                break;
            }
            normal = gradient / slope;
            p -= normal * (value / slope).clamp(-limit, limit);
        }
        (p, normal)
    }

    /// Returns a bounding box, without the swelling of joints and of the relief.
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

impl Neighborhood<'_> {
    /// Returns the value at `p`, or one of the same sign if the surface is not near.
    pub(super) fn value(&self, p: Vec3) -> f64 {
        if self.parts.is_empty() {
            self.middle
        } else {
            joined(self.parts.iter().copied(), p).value + (self.relief)(p)
        }
    }
}

fn joined<'a>(parts: impl IntoIterator<Item = &'a Part>, p: Vec3) -> Sample {
    let mut out = Sample {
        value: f64::INFINITY,
        gradient: Vec3::zeros(),
    };
    for part in parts {
        // Parts too far to blend change nothing; testing them first saves expensive tubes.
        if part.lower_bound(p) <= out.value + part.blend {
            out = part.join(out, part.sample(p));
        }
    }
    out
}

impl Part {
    fn sample(&self, mut p: Vec3) -> Sample {
        if !self.mirrored || p.x >= 0.0 {
            return self.primitive.sample(p);
        }
        p.x = -p.x;
        let mut out = self.primitive.sample(p);
        out.gradient.x = -out.gradient.x;
        out
    }

    /// Returns a lower bound of the value; minus infinity if a bound is as expensive.
    fn lower_bound(&self, p: Vec3) -> f64 {
        match &self.primitive {
            Primitive::Tube(tube) if !self.carved => {
                let x = if self.mirrored { p.x.abs() } else { p.x };
                tube.lower_bound(Vec3::new(x, p.y, p.z))
            }
            _ => f64::NEG_INFINITY,
        }
    }

    /// Joins the part, whose sample is `own`, to the earlier parts.
    fn join(&self, before: Sample, own: Sample) -> Sample {
        if self.carved {
            before.negated().smooth_min(own, self.blend).negated()
        } else {
            before.smooth_min(own, self.blend)
        }
    }
}

/// Returns an axis-aligned ellipsoid.
pub(super) fn ellipsoid(center: [f64; 3], radii: [f64; 3]) -> Primitive {
    tilted_ellipsoid(center, radii, [0.0, 1.0, 0.0])
}

/// Returns a tilted ellipsoid, see [`Ellipsoid::new`].
pub(super) fn tilted_ellipsoid(center: [f64; 3], radii: [f64; 3], up: [f64; 3]) -> Primitive {
    Primitive::Ellipsoid(Ellipsoid::new(center.into(), radii.into(), up.into()))
}

/// Returns a round tube, see [`Tube::new`].
pub(super) fn tube(stations: &[[f64; 4]]) -> Primitive {
    Primitive::Tube(Tube::new(stations))
}

impl Primitive {
    fn sample(&self, p: Vec3) -> Sample {
        match self {
            Self::Ellipsoid(ellipsoid) => ellipsoid.sample(p),
            Self::Tube(tube) => tube.sample(p),
        }
    }

    fn bounds(&self) -> (Vec3, Vec3) {
        match self {
            Self::Ellipsoid(ellipsoid) => ellipsoid.bounds(),
            Self::Tube(tube) => tube.bounds(),
        }
    }
}

impl Sample {
    fn negated(self) -> Self {
        Self {
            value: -self.value,
            gradient: -self.gradient,
        }
    }

    /// Returns the smooth minimum, rounded over the distance `blend`.
    fn smooth_min(self, other: Self, blend: f64) -> Self {
        let (low, high) = if self.value < other.value {
            (self, other)
        } else {
            (other, self)
        };
        let near = (blend - (high.value - low.value)).max(0.0);
        let share = near / (2.0 * blend);
        Self {
            value: low.value - near * share / 2.0,
            gradient: low.gradient * (1.0 - share) + high.gradient * share,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_distant_part_has_no_effect() {
        let ball = || ellipsoid([0.0; 3], [1.0; 3]);
        let alone = Body::new().with(ball(), 0.1);
        let joined = Body::new()
            .with(ball(), 0.1)
            .with_pair(tube(&[[3.0, 0.0, 0.0, 0.1], [4.0, 0.0, 0.0, 0.1]]), 0.1);
        let p = Vec3::new(0.4, 0.8, 0.1);
        assert_eq!(alone.sample(p).value, joined.sample(p).value);
        assert!((joined.sample(Vec3::new(-3.5, 0.3, 0.0)).value - 0.2).abs() < 1e-12);
    }

    #[test]
    fn gradient_matches_finite_differences() {
        let body = Body::new()
            .with(ellipsoid([0.0; 3], [1.0, 0.6, 0.8]), 0.1)
            .with_pair(
                tilted_ellipsoid([0.7, 0.5, 0.0], [0.2, 0.6, 0.3], [1.0, 1.0, 0.2]),
                0.3,
            )
            .without_pair(ellipsoid([0.5, 0.3, 0.7], [0.3; 3]), 0.2)
            .with_relief(|p| 0.1 * p.x * p.y, 1.0);
        for p in [
            [0.5, 0.4, 0.1],
            [-0.6, 0.3, 0.5],
            [-0.9, 0.9, -0.2],
            [0.3, -0.6, 0.2],
        ] {
            let (p, h) = (Vec3::from(p), 1e-5);
            let gradient = body.sample(p).gradient;
            for k in 0..3 {
                let step = Vec3::from_fn(|i, _| if i == k { h } else { 0.0 });
                let slope = (body.sample(p + step).value - body.sample(p - step).value) / (2.0 * h);
                assert!((slope - gradient[k]).abs() < 1e-4, "{slope} {gradient}");
            }
        }
    }

    #[test]
    fn a_neighborhood_gives_the_same_values() {
        let body = Body::new()
            .with(ellipsoid([0.0; 3], [1.0, 0.6, 0.8]), 0.1)
            .with_pair(tube(&[[0.9, 0.0, 0.0, 0.2], [1.5, 0.5, 0.0, 0.1]]), 0.2)
            .without_pair(ellipsoid([0.5, 0.3, 0.7], [0.3; 3]), 0.2)
            .with_relief(|p| 0.05 * bounded(p.y), 0.05);
        let (mut near, mut far) = (0, 0);
        for i in 0..1000 {
            let middle =
                Vec3::from([i / 100, i / 10 % 10, i % 10].map(|c| f64::from(c) * 0.4 - 1.8));
            let here = body.near(middle, 0.2);
            let p = middle + Vec3::new(0.1, -0.15, 0.05);
            if here.parts.is_empty() {
                far += 1;
                assert_eq!(here.value(p) < 0.0, body.sample(p).value < 0.0, "{p}");
            } else {
                near += 1;
                assert_eq!(here.value(p), body.sample(p).value, "{p}");
            }
        }
        assert!(near > 50 && far > 500, "{near} {far}");
    }

    fn bounded(t: f64) -> f64 {
        2.0 * t / (1.0 + t * t)
    }

    #[test]
    fn projection_lands_on_the_surface() {
        let body = Body::new().with(ellipsoid([0.0; 3], [1.0, 0.5, 0.7]), 0.1);
        let (p, normal) = body.project(Vec3::new(0.8, 0.4, -0.2), 4, 0.5);
        assert!(body.sample(p).value.abs() < 1e-6);
        assert!((normal.norm() - 1.0).abs() < 1e-12);
        assert!(normal.dot(&p) > 0.0);
    }
}
