//! [`Incision`]: a blade's pose and the tip at which its cut goes on in the next frame.

use crate::error::CutError;
use crate::intersection::facets::Weld;
use crate::sweep::Sweep;
use incise_mesh::geometry::{to_f32, to_f64};
use incise_mesh::{HalfEdge, Surface, Vec3, VertexId};

/// Motion of the blade after which the cut goes on [local edge lengths].
///
/// Smaller steps add up, so that walls do not get triangles far smaller than the surface's.
const MIN_STEP: f64 = 0.5;

/// Displacement of the sweep beyond the ends of a tip [local edge lengths].
const WIDENING: f64 = 0.3;

/// A blade that moves through a surface from frame to frame, see [`crate::Cutter::advance`].
///
/// The blade's edge is a polyline. Where its last motion ended inside the body, the incision's tip
/// consists of vertices of the surface. They move with the body, and the next motion starts at
/// their present positions.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Incision {
    pose: Vec<[f32; 3]>,
    tip: Vec<TipPoint>,
}

/// A vertex of the tip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TipPoint {
    pub(crate) vertex: VertexId,
    /// Its rest position, by which it is recognized \[m\].
    pub(crate) rest: Vec3,
    /// Its place on the blade: the number of a point of the polyline and the part of the way to
    /// the next one.
    pub(crate) place: f64,
    /// Whether an edge of the tip joins it to the next point.
    pub(crate) is_joined: bool,
}

/// The sweep of one step, the tip that it continues, and the places of its points on the blade.
pub(crate) struct Stroke {
    pub(crate) sweep: Sweep,
    pub(crate) weld: Weld,
    pub(crate) places: Vec<f64>,
}

impl Incision {
    /// Returns whether the blade is inside the body.
    #[must_use]
    pub fn is_inside(&self) -> bool {
        !self.tip.is_empty()
    }

    /// Iterates over the vertices of the tip, along the blade.
    pub fn tip(&self) -> impl Iterator<Item = VertexId> + '_ {
        self.tip.iter().map(|point| point.vertex)
    }

    /// Ends the incision where it is; the next motion of the blade starts at `pose` \[m\].
    pub fn restart(&mut self, pose: &[[f32; 3]]) {
        self.pose.clear();
        self.pose.extend_from_slice(pose);
        self.tip.clear();
    }

    /// Sets the pose and the tip after a step.
    pub(crate) fn finish_step(&mut self, pose: &[[f32; 3]], tip: Vec<TipPoint>) {
        self.restart(pose);
        self.tip = tip;
    }

    /// Removes the parts of the tip that other cuts have removed.
    fn check_tip(&mut self, surface: &Surface) {
        let topology = surface.topology();
        self.tip.retain(|point| {
            point.vertex.index() < topology.vertex_slots()
                && !topology.outgoing(point.vertex).is_null()
                && surface.rest_position(point.vertex) == point.rest
        });
        for i in 0..self.tip.len() {
            let next = self.tip.get(i + 1).map(|next| next.vertex);
            let own = self.tip[i].vertex;
            self.tip[i].is_joined &=
                next.is_some_and(|next| topology.find_half_edge(own, next).is_some());
        }
        let joined: Vec<bool> = self.tip.iter().map(|point| point.is_joined).collect();
        let mut i = 0;
        self.tip.retain(|_| {
            i += 1;
            joined[i - 1] || (i > 1 && joined[i - 2])
        });
    }

    /// Returns the sweep from the tip, or from the last pose, to a new pose.
    ///
    /// None for the first pose and for a motion that is too small.
    ///
    /// # Errors
    /// As [`Sweep::strip`].
    pub(crate) fn stroke(
        &mut self,
        surface: &Surface,
        blade: &[[f32; 3]],
    ) -> Result<Option<Stroke>, CutError> {
        if self.pose.len() != blade.len() {
            self.restart(blade);
            // A blade without length or with NaN is reported at once.
            return Sweep::strip(blade, blade)
                .map(|_| None)
                .or_else(|error| match error {
                    CutError::BladeDegenerate => Ok(None),
                    error => Err(error),
                });
        }
        self.check_tip(surface);
        if self.is_inside() && !self.has_moved(surface, blade) {
            return Ok(None);
        }
        let mut points: Vec<(f64, Vec3, VertexId)> = Vec::new();
        for (i, point) in self.pose.iter().enumerate() {
            #[expect(clippy::cast_precision_loss, reason = "few points")]
            let place = i as f64;
            let is_covered = self
                .tip
                .windows(2)
                .any(|pair| pair[0].is_joined && pair[0].place <= place && place <= pair[1].place);
            if !is_covered {
                points.push((place, to_f64(*point), VertexId::NULL));
            }
        }
        let tip = self.tip.iter();
        points.extend(tip.map(|p| (p.place, surface.position(p.vertex), p.vertex)));
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        let previous: Vec<[f32; 3]> = points.iter().map(|p| to_f32(p.1)).collect();
        let mut places: Vec<f64> = points.iter().map(|p| p.0).collect();
        self.widen(surface, blade, &mut places);
        let current = places.iter().map(|&place| to_f32(point_at(blade, place)));
        let current: Vec<[f32; 3]> = current.collect();
        let sweep = match Sweep::strip(&previous, &current) {
            Err(CutError::BladeDegenerate) => return Ok(None),
            sweep => sweep?,
        };
        let vertices: Vec<VertexId> = points.iter().map(|p| p.2).collect();
        let half_edges = vertices.windows(2).map(|pair| {
            let is_pair = |t: &[TipPoint]| t[0].is_joined && [t[0].vertex, t[1].vertex] == *pair;
            let edge = self.tip.windows(2).any(is_pair);
            let found = edge.then(|| surface.topology().find_half_edge(pair[0], pair[1]));
            found.flatten().unwrap_or(HalfEdge::NULL)
        });
        let weld = if self.is_inside() {
            Weld {
                half_edges: half_edges.collect(),
                vertices,
            }
        } else {
            Weld::default()
        };
        Ok(Some(Stroke {
            sweep,
            weld,
            places,
        }))
    }

    /// Moves the places at which the sweep leaves the ends of tips outward.
    ///
    /// The blade often moves along a symmetric body, in which the same place of the blade enters
    /// and leaves the body exactly at points of the sweep.
    fn widen(&self, surface: &Surface, blade: &[[f32; 3]], places: &mut [f64]) {
        let old = places.to_vec();
        for (i, point) in self.tip.iter().enumerate() {
            let is_first = i == 0 || !self.tip[i - 1].is_joined;
            let Some(at) = old.iter().position(|&place| place == point.place) else {
                continue;
            };
            let beyond = if is_first {
                at.checked_sub(1)
            } else {
                Some(at + 1)
            };
            let beyond = beyond.and_then(|k| old.get(k).copied());
            if let Some(beyond) = beyond.filter(|_| is_first || !point.is_joined) {
                let [a, b] = [point.place, beyond].map(|place| point_at(blade, place));
                let part = WIDENING * local_length(surface, point.vertex) / (b - a).norm();
                places[at] += (beyond - point.place) * part.min(0.5);
            }
        }
    }

    /// Returns whether a part of the blade is far enough from the tip for the next step.
    fn has_moved(&self, surface: &Surface, blade: &[[f32; 3]]) -> bool {
        self.tip.iter().any(|point| {
            let motion = point_at(blade, point.place) - surface.position(point.vertex);
            motion.norm() >= MIN_STEP * local_length(surface, point.vertex)
        })
    }
}

/// Returns the mean length of the edges at a vertex \[m\].
fn local_length(surface: &Surface, vertex: VertexId) -> f64 {
    let at = surface.position(vertex);
    let (mut sum, mut count) = (0.0, 0.0);
    for h in surface.topology().outgoing_fan(vertex) {
        sum += (surface.position(surface.topology().target(h)) - at).norm();
        count += 1.0;
    }
    sum / count
}

/// Returns the point of a polyline at a place \[m\].
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "places are between 0 and the number of points"
)]
fn point_at(line: &[[f32; 3]], place: f64) -> Vec3 {
    let i = (place.floor().max(0.0) as usize).min(line.len() - 2);
    #[expect(clippy::cast_precision_loss, reason = "few points")]
    let part = place - i as f64;
    let [a, b] = [line[i], line[i + 1]].map(to_f64);
    a + (b - a) * part
}
