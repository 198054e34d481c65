//! [`BladeFace`]: a moving parallelogram between a blade's edge and back, and its contacts.
//!
//! `blade.rs` creates the faces of a frame, the narrow phase finds their contacts.

use super::outside::outward_normal;
use incise_mesh::geometry::to_f64;
use incise_mesh::{Aabb, Surface, Vec3, VertexId};
use incise_pbd_gpu::Contact;

/// Rate at which a gap below the thickness opens, relative to the missing gap [1/s].
///
/// The speed is that of at most one thickness of penetration.
const SEPARATION_RATE: f64 = 5.0;

/// Mean distance of a vertex' neighbors from the face that decides its side [thicknesses].
const SIDE_TOLERANCE: f64 = 0.1;

/// Minimum cosine between a vertex normal and the face for the normal to decide the side.
const MIN_COSINE: f64 = 0.1;

/// A parallelogram from a blade's edge to its back, and its motion in the last frame.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct BladeFace {
    pub(super) previous: Pose,
    pub(super) current: Pose,
}

/// The pose of a parallelogram.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Pose {
    /// The start of the edge \[m\].
    pub(super) origin: Vec3,
    /// The vectors along the edge and from the edge to the back \[m\].
    pub(super) sides: [Vec3; 2],
    /// Unit normal.
    pub(super) normal: Vec3,
}

impl Pose {
    /// Creates a pose from an edge and the vector to the back \[m\].
    ///
    /// Returns `None` for a parallelogram without area or with coordinates that are not finite.
    fn new([start, end]: [[f32; 3]; 2], to_back: [f32; 3]) -> Option<Self> {
        let origin = to_f64(start);
        let sides = [to_f64(end) - origin, to_f64(to_back)];
        let normal = sides[0].cross(&sides[1]).try_normalize(0.0)?;
        let is_finite = origin.iter().chain(&normal).all(|c| c.is_finite());
        is_finite.then_some(Self {
            origin,
            sides,
            normal,
        })
    }

    /// Returns the signed distance of a point from the plane \[m\].
    fn height(&self, p: Vec3) -> f64 {
        self.normal.dot(&(p - self.origin))
    }

    /// Returns whether a point projects into the parallelogram grown by `margin` \[m\].
    fn is_beside(&self, p: Vec3, margin: f64) -> bool {
        let offset = p - self.origin;
        let [a, b] = self.sides;
        // Distances from opposite sides, along the normals of the other ones.
        let [across_a, across_b] = [b.cross(&self.normal), a.cross(&self.normal)];
        [(a, across_a), (b, across_b)].iter().all(|(side, across)| {
            let across = across.try_normalize(0.0).unwrap_or_default();
            let (at, end) = (offset.dot(&across), side.dot(&across));
            at >= end.min(0.0) - margin && at <= end.max(0.0) + margin
        })
    }
}

impl BladeFace {
    /// Creates a face from its previous and current edge and vector to the back \[m\].
    ///
    /// Returns `None` if either has no area. The normal keeps its side even if the ends of the
    /// edge change places.
    pub(crate) fn new(poses: [([[f32; 3]; 2], [f32; 3]); 2]) -> Option<Self> {
        let [previous, current] = poses.map(|(edge, to_back)| Pose::new(edge, to_back));
        let (previous, mut current) = (previous?, current?);
        if previous.normal.dot(&current.normal) < 0.0 {
            current.normal = -current.normal;
        }
        Some(Self { previous, current })
    }

    /// Returns whether the face moved in the last frame.
    pub(crate) fn moves(&self) -> bool {
        self.previous != self.current
    }

    /// Returns the box around the previous and the current pose.
    #[expect(
        clippy::cast_possible_truncation,
        reason = "the boxes that this one is compared with are grown by more than its rounding"
    )]
    pub(crate) fn bounds(&self) -> Aabb {
        let mut bounds = Aabb::default();
        for Pose {
            origin,
            sides: [a, b],
            ..
        } in [self.previous, self.current]
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

    /// Returns the contact of a vertex that may move by `displacement` \[m\] within the frame.
    ///
    /// A vertex stays on its side of the face. Within a thickness of it, where both sides of a cut
    /// start, the side is that of its neighbors, or else the one opposite to its outward normal.
    pub(super) fn contact(
        &self,
        (surface, vertex): (&Surface, VertexId),
        displacement: f64,
        thickness: f64,
        dt: f64,
    ) -> Option<Contact> {
        let at = surface.position(vertex);
        let (from, to) = (self.previous.height(at), self.current.height(at));
        let is_reached = from.abs().min(to.abs()) <= displacement || from * to < 0.0;
        let is_beside = |pose: &Pose| pose.is_beside(at, thickness);
        if !is_reached || !(is_beside(&self.previous) || is_beside(&self.current)) {
            return None;
        }
        let mut side = if from < 0.0 { -1.0 } else { 1.0 };
        if from.abs() <= thickness {
            let neighbors = neighbor_mean(surface, vertex, |p| self.previous.height(p));
            let outward = outward_normal(surface, vertex).try_normalize(0.0);
            let cosine = outward.unwrap_or_default().dot(&self.previous.normal);
            if neighbors.abs() > SIDE_TOLERANCE * thickness {
                side = neighbors.signum();
            } else if cosine.abs() >= MIN_COSINE {
                side = -cosine.signum();
            }
        }
        let normal = self.current.normal * side;
        let gap = (side * from).min(thickness);
        let missing = (thickness - gap).min(2.0 * thickness);
        // Of the previous plane, along the current normal.
        let height = normal.dot(&at) - side * from;
        let gap_rate = SEPARATION_RATE * missing + side * (from - to) / dt;
        Some(contact(vertex, normal, height + gap, gap_rate))
    }
}

/// Returns the mean of a function of position over the neighbors of a vertex.
fn neighbor_mean(surface: &Surface, v: VertexId, of: impl Fn(Vec3) -> f64) -> f64 {
    let topology = surface.topology();
    let fan = topology.outgoing_fan(v);
    let (sum, count) = fan.fold((0.0, 0.0), |(sum, count), h| {
        (sum + of(surface.position(topology.target(h))), count + 1.0)
    });
    sum / count
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "the solver stores contacts in 32 bits"
)]
fn contact(vertex: VertexId, normal: Vec3, height: f64, gap_rate: f64) -> Contact {
    let normal = [0, 1, 2].map(|k: usize| normal[k] as f32);
    Contact {
        gap_rate: gap_rate as f32,
        ..Contact::plane(vertex, normal, height as f32)
    }
}
