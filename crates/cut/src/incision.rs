//! [`Incision`]: a blade's pose and the tip at which its cut goes on in the next frame.

use crate::error::CutError;
use crate::intersection::facets::Weld;
use crate::sweep::Sweep;
use incise_mesh::geometry::{area_vector, to_f32, to_f64};
use incise_mesh::{HalfEdge, Surface, Vec3, VertexId};

/// Motion of the blade after which the cut goes on [local edge lengths].
///
/// Smaller steps add up, so that walls do not get triangles far smaller than the surface's.
const MIN_STEP: f64 = 0.5;

/// Distance from its path within which the blade moves back in its own slit [local edge lengths].
const PATH_WIDTH: f64 = 0.25;

/// Displacement of the sweep beyond the ends of a tip [local edge lengths].
const WIDENING: f64 = 0.3;
/// Its maximum [distance to the next point of the sweep].
const MAX_WIDENING: f64 = 0.2;

/// A blade that moves through a surface from frame to frame, see [`crate::Cutter::advance`].
///
/// The blade's edge is a polyline. Where its last motion ended inside the body, the incision's tip
/// consists of vertices of the surface. They move with the body, and the next motion starts at
/// their present positions.
///
/// A blade that moves back the way it came cuts nothing until it is at the tip again. Where it
/// leaves that way, it cuts a branch.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Incision {
    pose: Vec<[f32; 3]>,
    tip: Vec<TipPoint>,
    path: Path,
    /// Whether the blade has moved back from the tip.
    is_back: bool,
    sweep: Option<Sweep>,
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

/// A point of the next sweep in both frames.
#[derive(Debug, Clone, Copy)]
struct Column {
    /// Its place on the blade now, see [`TipPoint::place`].
    place: f64,
    /// Its position before the step \[m\].
    previous: Vec3,
    /// The vertex of the tip, or null.
    vertex: VertexId,
    /// Whether an edge of the tip joins it to the next column.
    is_joined: bool,
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

    /// Returns the sweep of the last step that cut.
    #[must_use]
    pub fn sweep(&self) -> Option<&Sweep> {
        self.sweep.as_ref()
    }

    /// Ends the incision where it is; the next motion of the blade starts at `pose` \[m\].
    pub fn restart(&mut self, pose: &[[f32; 3]]) {
        self.pose.clear();
        self.pose.extend_from_slice(pose);
        self.leave();
    }

    /// Ends the incision where it is; the next motion of the blade starts at its last pose.
    fn leave(&mut self) {
        self.tip.clear();
        self.path.clear();
        self.is_back = false;
    }

    /// Sets the pose and the tip after a step.
    pub(crate) fn finish_step(&mut self, pose: &[[f32; 3]], tip: Vec<TipPoint>, sweep: Sweep) {
        if self.tip.is_empty() {
            self.path.start(&self.pose);
        }
        self.pose.clear();
        self.pose.extend_from_slice(pose);
        self.is_back = false;
        if tip.is_empty() {
            self.path.clear();
        } else {
            self.path.push(&tip);
        }
        self.tip = tip;
        self.sweep = Some(sweep);
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
        // A single vertex is the tip of a sheet.
        let joined: Vec<bool> = self.tip.iter().map(|point| point.is_joined).collect();
        let mut i = 0;
        self.tip.retain(|point| {
            i += 1;
            joined[i - 1] || (i > 1 && joined[i - 2]) || is_at_boundary(surface, point.vertex)
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
        if self.is_inside() {
            if !self.has_moved(surface, blade) {
                return Ok(None);
            }
            let lengths = self.tip.iter().map(|end| local_length(surface, end.vertex));
            let width = PATH_WIDTH * lengths.fold(0.0, f64::max);
            if self.path.has(surface, blade, width) {
                self.pose.clear();
                self.pose.extend_from_slice(blade);
                self.is_back = true;
                return Ok(None);
            }
            if self.is_back && !self.passes_tip(surface, blade, width) {
                self.leave();
            }
        }
        let columns = self.columns(surface, blade);
        let previous: Vec<[f32; 3]> = columns.iter().map(|c| to_f32(c.previous)).collect();
        let places: Vec<f64> = columns.iter().map(|c| c.place).collect();
        let current = places.iter().map(|&place| to_f32(point_at(blade, place)));
        let current: Vec<[f32; 3]> = current.collect();
        let sweep = match Sweep::strip(&previous, &current) {
            Err(CutError::BladeDegenerate) => {
                // A blade that moves along its edge leaves its tip.
                self.restart(blade);
                return Ok(None);
            }
            sweep => sweep?,
        };
        let mut weld = Weld::default();
        if self.is_inside() {
            weld.vertices.extend(columns.iter().map(|c| c.vertex));
            let topology = surface.topology();
            let half_edge = |pair: &[Column]| {
                let [a, b] = [pair[0].vertex, pair[1].vertex];
                let found = pair[0].is_joined.then(|| topology.find_half_edge(a, b));
                found.flatten().unwrap_or(HalfEdge::NULL)
            };
            weld.half_edges.extend(columns.windows(2).map(half_edge));
        }
        Ok(Some(Stroke {
            sweep,
            weld,
            places,
        }))
    }

    /// Returns the points of the next sweep: those of the tip, and those of the blade outside.
    ///
    /// Beside an end of the tip, the sweep widens and rises from the surface. Otherwise the line
    /// from there to the blade's last pose could cross the surface once more. And a body is often
    /// symmetric, so that the same place of the blade enters and leaves it.
    fn columns(&self, surface: &Surface, blade: &[[f32; 3]]) -> Vec<Column> {
        let mut columns: Vec<Column> = Vec::new();
        for (i, point) in self.pose.iter().enumerate() {
            #[expect(clippy::cast_precision_loss, reason = "few points")]
            let place = i as f64;
            let is_covered = self
                .tip
                .windows(2)
                .any(|pair| pair[0].is_joined && pair[0].place <= place && place <= pair[1].place);
            if !is_covered {
                columns.push(Column {
                    place,
                    previous: to_f64(*point),
                    vertex: VertexId::NULL,
                    is_joined: false,
                });
            }
        }
        columns.extend(self.tip.iter().map(|point| Column {
            place: point.place,
            previous: surface.position(point.vertex),
            vertex: point.vertex,
            is_joined: point.is_joined,
        }));
        columns.sort_by(|a, b| a.place.total_cmp(&b.place));
        let mut out = Vec::with_capacity(columns.len() + 4);
        for (i, &column) in columns.iter().enumerate() {
            let is_tip = !column.vertex.is_null();
            let before = i.checked_sub(1).map(|i| columns[i]);
            let after = columns.get(i + 1).copied();
            let mut own = column;
            let mut risen = |beyond: Column| {
                let [a, b] = [column, beyond].map(|c| point_at(blade, c.place));
                let local = local_length(surface, column.vertex);
                let part = (WIDENING * local / (b - a).norm()).min(MAX_WIDENING);
                let step = (beyond.place - column.place) * part;
                own.place = column.place + step;
                Column {
                    place: column.place + 2.0 * step,
                    previous: column.previous + outward(surface, column, a - b, a) * local,
                    vertex: VertexId::NULL,
                    is_joined: false,
                }
            };
            let is_first = is_tip && before.is_none_or(|before| !before.is_joined);
            let is_last = is_tip && !column.is_joined;
            out.extend(before.filter(|_| is_first).map(&mut risen));
            let risen = after.filter(|_| is_last).map(risen);
            out.push(own);
            out.extend(risen);
        }
        out
    }

    /// Returns whether the blade is at the tip on its way to a new pose, up to `width` \[m\].
    fn passes_tip(&self, surface: &Surface, blade: &[[f32; 3]], width: f64) -> bool {
        let ends = [self.tip[0], self.tip[self.tip.len() - 1]];
        let off = |pose: &[[f32; 3]]| {
            ends.map(|end| point_at(pose, end.place) - surface.position(end.vertex))
        };
        do_vanish(off(&self.pose), off(blade), 0.0, width)
    }

    /// Returns whether a part of the blade is far enough from the tip for the next step.
    fn has_moved(&self, surface: &Surface, blade: &[[f32; 3]]) -> bool {
        self.tip.iter().any(|point| {
            let motion = point_at(blade, point.place) - surface.position(point.vertex);
            motion.norm() >= MIN_STEP * local_length(surface, point.vertex)
        })
    }
}

/// The way of a blade since it entered the body: the pose before, then the ends of each tip.
#[derive(Debug, Clone, Default, PartialEq)]
struct Path {
    entry: Vec<[f32; 3]>,
    tips: Vec<[TipPoint; 2]>,
}

impl Path {
    fn clear(&mut self) {
        self.entry.clear();
        self.tips.clear();
    }

    fn start(&mut self, pose: &[[f32; 3]]) {
        self.clear();
        self.entry.extend_from_slice(pose);
    }

    fn push(&mut self, tip: &[TipPoint]) {
        self.tips.push([tip[0], tip[tip.len() - 1]]);
    }

    /// Returns whether a blade is on the way or behind its start, up to `width` \[m\].
    fn has(&self, surface: &Surface, blade: &[[f32; 3]], width: f64) -> bool {
        let slots = surface.topology().vertex_slots();
        let Some(first) = self.tips.first() else {
            return false;
        };
        let off = |place: f64, way: Vec3| point_at(blade, place) - way;
        let mut from = first.map(|end| off(end.place, point_at(&self.entry, end.place)));
        let mut earliest = f64::NEG_INFINITY;
        self.tips.iter().any(|tip| {
            if tip.iter().any(|end| end.vertex.index() >= slots) {
                return false;
            }
            // The distances of the tip's ends change linearly along the way.
            let to = tip.map(|end| off(end.place, surface.position(end.vertex)));
            let is_on = do_vanish(from, to, earliest, width);
            (from, earliest) = (to, 0.0);
            is_on
        })
    }
}

/// Returns whether two vectors that change linearly are both at most as long as `width` at a time
/// from `earliest` to 1.
fn do_vanish(from: [Vec3; 2], to: [Vec3; 2], earliest: f64, width: f64) -> bool {
    let change = [0, 1].map(|k| to[k] - from[k]);
    let along: f64 = (0..2).map(|k| change[k].dot(&from[k])).sum();
    let length: f64 = change.iter().map(Vec3::norm_squared).sum();
    let part = (-along / length).clamp(earliest, 1.0);
    (0..2).all(|k| (from[k] + change[k] * part).norm() <= width)
}

/// Returns the unit vector away from the surface at a column, in the plane of the sweep there.
///
/// `along` is the direction of the blade towards the column, `to` the column's next position
/// \[m\]. A sheet has two sides: there the vector is on that from which the blade comes.
fn outward(surface: &Surface, column: Column, along: Vec3, to: Vec3) -> Vec3 {
    let fan = surface.topology().outgoing_fan(column.vertex);
    let normals = fan.map(|h| area_vector(surface.triangle_positions(h.triangle())));
    let normal: Vec3 = normals.sum();
    let is_reversed = is_at_boundary(surface, column.vertex) && normal.dot(&along) > 0.0;
    let normal = if is_reversed { -normal } else { normal };
    let across = along.cross(&(to - column.previous));
    let across = across.try_normalize(0.0).unwrap_or_default();
    let in_plane = normal - across * across.dot(&normal);
    in_plane.try_normalize(0.0).unwrap_or_default()
}

/// Returns whether a vertex is on the boundary of a sheet.
fn is_at_boundary(surface: &Surface, vertex: VertexId) -> bool {
    let first = surface.topology().outgoing_fan(vertex).next();
    first.is_some_and(|h| surface.topology().twin(h).is_null())
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
