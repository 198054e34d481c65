//! The flat of a blade: what pieces lie against while the blade is between them.

use super::touch::outward;
use super::{AGAIN, APART};
use incise_mesh::geometry::widen;
use incise_mesh::{Aabb, Surface, Vec3, VertexId};
use incise_pbd_gpu::{Above, Contact};

/// A vertex whose surface looks at a flat by less than this cosine is on the side that it lies on.
const SIDEWAYS: f64 = 0.1;

/// A parallelogram from a blade's edge to its back, and the way that it made in the last frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Flat {
    before: Pose,
    now: Pose,
}

/// Where a flat is.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Pose {
    /// The start of the edge \[m\].
    origin: Vec3,
    /// Along the edge and to the back \[m\].
    sides: [Vec3; 2],
    normal: Vec3,
}

impl Pose {
    /// None without an area, or if it is not finite.
    fn new([start, end]: [[f32; 3]; 2], back: [f32; 3]) -> Option<Self> {
        let origin = widen(start);
        let sides = [widen(end) - origin, widen(back)];
        let normal = sides[0].cross(&sides[1]).try_normalize(0.0)?;
        let is_finite = origin.iter().chain(&normal).all(|c| c.is_finite());
        is_finite.then_some(Self {
            origin,
            sides,
            normal,
        })
    }

    fn height(&self, p: Vec3) -> f64 {
        self.normal.dot(&(p - self.origin))
    }

    /// Whether a point is above or below the parallelogram, or no farther aside than `by` \[m\].
    fn is_beside(&self, p: Vec3, by: f64) -> bool {
        let way = p - self.origin;
        let [a, b] = self.sides;
        // Distances from opposite sides, along the other ones' normals.
        let [across_a, across_b] = [b.cross(&self.normal), a.cross(&self.normal)];
        [(a, across_a), (b, across_b)].iter().all(|(side, across)| {
            let across = across.try_normalize(0.0).unwrap_or_default();
            let (at, end) = (way.dot(&across), side.dot(&across));
            at >= end.min(0.0) - by && at <= end.max(0.0) + by
        })
    }
}

impl Flat {
    /// The flat of a blade that came from one edge and back to others; none if either has no area. Its sides stay
    /// what they were, whichever way its edge is named.
    pub(crate) fn new(poses: [([[f32; 3]; 2], [f32; 3]); 2]) -> Option<Self> {
        let [before, now] = poses.map(|(edge, back)| Pose::new(edge, back));
        let (before, mut now) = (before?, now?);
        if before.normal.dot(&now.normal) < 0.0 {
            now.normal = -now.normal;
        }
        Some(Self { before, now })
    }

    /// Whether it is elsewhere than it was.
    pub(crate) fn moves(&self) -> bool {
        self.before != self.now
    }

    /// The box of where it was and where it is.
    #[expect(
        clippy::cast_possible_truncation,
        reason = "a box may be a rounding too small, as those that it is compared with are grown"
    )]
    pub(crate) fn bounds(&self) -> Aabb {
        let mut bounds = Aabb::default();
        for Pose {
            origin,
            sides: [a, b],
            ..
        } in [self.before, self.now]
        {
            for corner in [origin, origin + a, origin + b, origin + a + b] {
                for k in 0..3 {
                    bounds.min[k] = bounds.min[k].min(corner[k] as f32);
                    bounds.max[k] = bounds.max[k].max(corner[k] as f32);
                }
            }
        }
        bounds
    }

    /// The contact of a vertex at a place that may move so far within the frame \[m\], none if it does not get here. A vertex
    /// stays on the side that it is on; one that is no farther than a thickness off is where the vertices around it are or, since
    /// both lips of a cut begin at the blade, on the side that its surface looks away from.
    pub(super) fn contact(
        &self,
        (surface, vertex): (&Surface, VertexId),
        way: f64,
        thickness: f64,
        dt: f64,
    ) -> Option<Contact> {
        let at = surface.position(vertex);
        let (from, to) = (self.before.height(at), self.now.height(at));
        let gets_there = from.abs().min(to.abs()) <= way || from * to < 0.0;
        let is_beside = |pose: &Pose| pose.is_beside(at, thickness);
        if !gets_there || !(is_beside(&self.before) || is_beside(&self.now)) {
            return None;
        }
        let mut side = if from < 0.0 { -1.0 } else { 1.0 };
        if from.abs() <= thickness {
            let around = mean_around(surface, vertex, |p| self.before.height(p));
            let outward = outward(surface, vertex).try_normalize(0.0);
            let looks = outward.unwrap_or_default().dot(&self.before.normal);
            if around.abs() > AGAIN * thickness {
                side = around.signum();
            } else if looks.abs() >= SIDEWAYS {
                side = -looks.signum();
            }
        }
        let normal = self.now.normal * side;
        let gap = (side * from).min(thickness);
        let missing = (thickness - gap).min(2.0 * thickness);
        Some(contact(
            vertex,
            normal,
            // The plane as it was, along the normal that it has now.
            normal.dot(&at) - side * from,
            gap,
            APART * missing + side * (from - to) / dt,
        ))
    }
}

/// The mean of something over the vertices around one.
fn mean_around(surface: &Surface, v: VertexId, of: impl Fn(Vec3) -> f64) -> f64 {
    let topology = surface.topology();
    let fan = topology.outgoing_fan(v);
    let (sum, count) = fan.fold((0.0, 0.0), |(sum, count), h| {
        (sum + of(surface.position(topology.target(h))), count + 1.0)
    });
    sum / count
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "what was found is rounded once to storage"
)]
fn contact(vertex: VertexId, normal: Vec3, height: f64, gap: f64, rise: f64) -> Contact {
    Contact {
        vertex,
        above: Above::Plane {
            height: height as f32,
        },
        normal: [normal.x as f32, normal.y as f32, normal.z as f32],
        gap: gap as f32,
        rise: rise as f32,
    }
}
