//! The points of the next sweep: where it begins at the tip, and where it ends on the blade.

use super::closing::Closing;
use super::lead::MIN_MOTION;
use super::line::{bends, point_at};
use super::map::BladeMap;
use super::piercings::{is_pierced, pierced_at};
use super::rise::{max_rise, outward};
use super::{Incision, TipPoint};
use incise_mesh::{Surface, TriangleId, Vec3, VertexId};

/// Displacement of the sweep beyond the ends of a tip [local edge lengths].
///
/// The point beside the tip is displaced twice as far. So the sweep widens by 50 degrees in the
/// smallest step, of half an edge, and by less in larger ones.
pub(super) const WIDENING: f64 = 0.3;
/// Its maximum [distance to the next point of the sweep].
///
/// Twice this is below a half, so that points beside two ends keep their order.
pub(super) const MAX_WIDENING: f64 = 0.2;

/// Maximum gap between walls that the tip crosses at one point [local edge lengths].
const MAX_GAP: f64 = 1e-3;

/// Distance up to which a bend of the blade is one with the tip, or none [local edge lengths].
const MAX_TIP_DISTANCE: f64 = 1e-3;

/// Minimum distance of a point of the sweep from the surface, along the blade [local edge lengths].
const CLEARANCE: f64 = 0.1;
/// Its maximum [motion of the blade].
const MAX_CLEARANCE: f64 = 0.5;

/// How far the next sweep extends beyond the ends of a tip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Extent {
    /// Its rise from the surface [local edge lengths]; at 0 it goes back to the blade's last pose.
    pub(crate) rise: f64,
    /// Whether it ends there. Else it goes on to the ends of the blade.
    pub(crate) is_bounded: bool,
}

/// A point of the blade in both poses of the next sweep, in the shape in which that cuts.
#[derive(Debug, Clone, Copy)]
pub(super) struct Column {
    /// Its parameter on the blade now, see [`TipPoint::parameter`].
    pub(super) parameter: f64,
    /// Its position before the step and after it \[m\].
    pub(super) previous: Vec3,
    pub(super) current: Vec3,
    /// Displacement of the current position from the blade \[m\].
    offset: Vec3,
    /// The incoming and the outgoing vertex of the tip, or null. They differ across two coincident
    /// walls.
    pub(super) vertex: VertexId,
    pub(super) begins: VertexId,
    /// Whether an edge of the tip joins it to the next column.
    pub(super) is_joined: bool,
    /// Whether the next part of the tip began at the same parameter, across a gap that has opened.
    meets_next: bool,
    /// Whether it is a vertex of the tip that keeps its place in this step.
    stands: bool,
    /// The vertex at which it ends where the cut is closed, or null.
    pub(super) closes: VertexId,
}

impl Column {
    /// Makes a column off the tip.
    fn outside(parameter: f64, previous: Vec3, current: Vec3) -> Self {
        Self {
            parameter,
            previous,
            current,
            offset: Vec3::zeros(),
            vertex: VertexId::NULL,
            begins: VertexId::NULL,
            is_joined: false,
            meets_next: false,
            stands: false,
            closes: VertexId::NULL,
        }
    }

    /// Makes a column from a vertex of the tip to one at which the cut is closed.
    pub(super) fn closing(surface: &Surface, parameter: f64, ends: [VertexId; 2]) -> Self {
        let [previous, current] = ends.map(|v| surface.position(v));
        Self {
            vertex: ends[0],
            begins: ends[0],
            is_joined: true,
            closes: ends[1],
            ..Self::outside(parameter, previous, current)
        }
    }

    /// Returns the column at another parameter.
    fn moved(self, parameter: f64, poses: &Poses<'_>) -> Self {
        Self {
            parameter,
            current: poses.current(parameter) + self.offset,
            ..self
        }
    }

    pub(super) fn is_tip(&self) -> bool {
        !self.vertex.is_null()
    }

    /// Returns whether the tip goes on to the next column.
    fn goes_on(&self) -> bool {
        self.is_joined || self.meets_next
    }
}

/// The blade in its last and in its new pose, and the map to the shape in which it cuts.
#[derive(Debug, Clone, Copy)]
pub(super) struct Poses<'a> {
    pub(super) map: &'a BladeMap,
    /// The tip, with parameters of the new pose.
    pub(super) tip: &'a [TipPoint],
    /// By vertex of the tip, whether it keeps its place, and the displacement of its next position
    /// from the blade \[m\].
    pub(super) stands: &'a [bool],
    pub(super) offsets: &'a [Vec3],
    pub(super) last: &'a [[f32; 3]],
    pub(super) new: &'a [[f32; 3]],
}

impl Poses<'_> {
    /// Returns the point at a parameter in the last pose \[m\].
    fn previous(&self, parameter: f64) -> Vec3 {
        self.map.at(parameter, point_at(self.last, parameter))
    }

    /// Returns the point at a parameter in the new pose \[m\].
    pub(super) fn current(&self, parameter: f64) -> Vec3 {
        self.map.at(parameter, point_at(self.new, parameter))
    }
}

impl Incision {
    /// Returns the parameters of the blade's ends and of the points where it bends in its last pose
    /// or in a new one.
    pub(super) fn bends(&self, new: &[[f32; 3]]) -> Vec<f64> {
        bends([&self.pose, new], MAX_TIP_DISTANCE * self.local)
    }

    /// Returns the points of the next sweep: those of the tip, and those of the blade outside.
    ///
    /// Beside an end of the tip, the sweep widens and rises from the surface. Otherwise the line
    /// from there to the blade's last pose could cross the surface once more. And a body is often
    /// symmetric, so that the same point of the blade enters and leaves it.
    pub(super) fn columns(
        &self,
        surface: &Surface,
        poses: &Poses<'_>,
        extent: Extent,
        closing: Option<&Closing>,
    ) -> Vec<Column> {
        let mut columns = self.points_outside(poses);
        columns.extend(match closing {
            Some(closing) => closing.columns(surface, poses.tip),
            None => self.points_of_tip(surface, poses),
        });
        columns.extend(poses.map.corners.parameters.iter().map(|&parameter| {
            let [previous, current] = [poses.previous(parameter), poses.current(parameter)];
            Column::outside(parameter, previous, current)
        }));
        columns.sort_by(|a, b| a.parameter.total_cmp(&b.parameter));
        without_idle(&mut columns);
        let mut out = Vec::with_capacity(columns.len() + 4);
        for (i, &column) in columns.iter().enumerate() {
            let before = i.checked_sub(1).map(|i| columns[i]);
            let after = columns.get(i + 1).copied();
            let mut own = column;
            let moves = column.is_tip() && !column.stands;
            let is_first = moves && !before.is_some_and(|before| before.goes_on());
            let is_last = moves && !column.goes_on();
            let mut risen = |beyond: Column| {
                let [a, b] = [column, beyond].map(|c| c.current);
                let local = self.local;
                let part = (WIDENING * local / (b - a).norm()).min(MAX_WIDENING);
                let step = (beyond.parameter - column.parameter) * part;
                // The tip of a sheet, a single vertex, has both sides.
                if column.closes.is_null() && is_first != is_last {
                    own = column.moved(column.parameter + step, poses);
                }
                let direction = outward(surface, column, a - b, a);
                let height = extent.rise * local.min(max_rise(column, beyond, direction));
                let previous = if height > 0.0 {
                    column.previous + direction * height
                } else {
                    poses.previous(column.parameter + step)
                };
                let risen = Column {
                    offset: column.offset,
                    ..Column::outside(0.0, previous, previous)
                };
                risen.moved(column.parameter + 2.0 * step, poses)
            };
            out.extend(before.filter(|_| is_first).map(&mut risen));
            let risen = after.filter(|_| is_last).map(risen);
            out.push(own);
            out.extend(risen);
        }
        if extent.is_bounded {
            bound(&mut out, poses.map.corners.outer);
        }
        out
    }

    /// Returns columns at the bends of the blade that are not in the body.
    fn points_outside(&self, poses: &Poses<'_>) -> Vec<Column> {
        let mut columns = Vec::new();
        for parameter in self.bends(poses.new) {
            let is_covered = poses.tip.windows(2).any(|pair| {
                pair[0].is_joined
                    && pair[0].parameter <= parameter
                    && parameter <= pair[1].parameter
            });
            let point = point_at(&self.pose, parameter);
            let is_at_tip = self.tip.iter().any(|tip| {
                let distance = (point_at(&self.pose, tip.parameter) - point).norm();
                distance <= MAX_TIP_DISTANCE * self.local
            });
            if !is_covered && !is_at_tip {
                let [previous, mut current] = [poses.previous(parameter), poses.current(parameter)];
                // As for vertices of a tip.
                if !self.is_inside() && (current - previous).norm() < MIN_MOTION * self.local {
                    current = previous;
                }
                columns.push(Column::outside(parameter, previous, current));
            }
        }
        columns
    }

    /// Returns columns at the vertices of the tip; one for two across coincident walls.
    fn points_of_tip(&self, surface: &Surface, poses: &Poses<'_>) -> Vec<Column> {
        let mut columns: Vec<Column> = Vec::new();
        for (i, point) in poses.tip.iter().enumerate() {
            let previous = surface.position(point.vertex);
            if let (Some(last), Some(before)) = (columns.last_mut(), i.checked_sub(1))
                && poses.tip[before].meets_next
                && (previous - last.previous).norm() <= MAX_GAP * self.local
            {
                last.begins = point.vertex;
                last.is_joined = point.is_joined;
                last.meets_next = point.meets_next;
                last.stands &= poses.stands[i];
                continue;
            }
            let offset = poses.offsets[i];
            columns.push(Column {
                parameter: point.parameter,
                previous,
                current: poses.current(point.parameter) + offset,
                offset,
                vertex: point.vertex,
                begins: point.vertex,
                is_joined: point.is_joined,
                meets_next: point.meets_next,
                stands: poses.stands[i],
                closes: VertexId::NULL,
            });
        }
        for column in columns.iter_mut().filter(|column| column.stands) {
            column.current = column.previous;
        }
        columns
    }
}

/// Removes the columns beyond those beside the tip, or for a blade without a tip beyond its outer
/// corners.
fn bound(columns: &mut Vec<Column>, [first, last]: [Option<f64>; 2]) {
    let tip = |column: &Column| column.is_tip();
    let (low, high) = match (columns.iter().position(tip), columns.iter().rposition(tip)) {
        (Some(first), Some(last)) => (first.saturating_sub(1), last + 1),
        _ => {
            let before = |c: &Column| first.is_some_and(|first| c.parameter < first);
            let until = |c: &Column| last.is_none_or(|last| c.parameter <= last);
            let low = columns.partition_point(before);
            (low, columns.partition_point(until).saturating_sub(1))
        }
    };
    columns.truncate(high + 1);
    columns.drain(..low.min(columns.len()));
}

/// Removes columns from which the tip does not go on: vertices that stand beside others that do,
/// and points outside beside an end that stands.
fn without_idle(columns: &mut Vec<Column>) {
    for i in 1..columns.len() {
        let are_both = columns[i - 1].stands && columns[i].stands;
        columns[i - 1].is_joined &= !are_both;
        columns[i - 1].meets_next &= !are_both;
    }
    let moves = |column: Option<&Column>| column.is_some_and(|c| c.is_tip() && !c.stands);
    let is_used = |i: usize| {
        let before = i.checked_sub(1).map(|i| &columns[i]);
        let (own, after) = (&columns[i], columns.get(i + 1));
        if !own.stands {
            // A blade without a tip moves as a whole.
            return own.is_tip() || ![before, after].into_iter().flatten().any(|c| c.stands);
        }
        (before.is_some_and(Column::goes_on) && moves(before)) || (own.goes_on() && moves(after))
    };
    let used: Vec<bool> = (0..columns.len()).map(is_used).collect();
    let mut used = used.into_iter();
    columns.retain(|_| used.next().unwrap_or_default());
}

/// Returns whether a vertex is on the boundary of a sheet.
pub(super) fn is_at_boundary(surface: &Surface, vertex: VertexId) -> bool {
    let first = surface.topology().outgoing_fan(vertex).next();
    first.is_some_and(|h| surface.topology().twin(h).is_null())
}

/// Moves the points of the next sweep along the blade, away from where that pierces the surface.
///
/// There the sweep's curves end. A point close to an end would leave a tip that turns back.
/// `near` has all triangles that the blade may pierce, `bends` its parameters where it bends.
pub(super) fn spread(
    columns: &mut [Column],
    surface: &Surface,
    near: &[TriangleId],
    poses: &Poses<'_>,
    bends: &[f64],
) {
    let piercings = front_piercings(columns, surface, near);
    for (i, &[parameter, clearance]) in piercings.iter().enumerate() {
        let others = [i.checked_sub(1), Some(i + 1)].into_iter().flatten();
        let others = others.filter_map(|j| piercings.get(j));
        let room = others.map(|other| (other[0] - parameter).abs() / 2.0);
        let to_bend = bends.iter().map(|bend| (bend - parameter).abs());
        let reach = room.chain(to_bend).fold(3.0 * clearance, f64::min);
        for column in columns.iter_mut().filter(|column| !column.stands) {
            let distance = column.parameter - parameter;
            if distance.abs() < reach {
                let moved = (reach + 2.0 * distance.abs()) / 3.0;
                *column = column.moved(parameter + moved.copysign(distance), poses);
            }
        }
    }
}

/// Returns the parameters at which the blade pierces the surface, ascending, with clearances.
fn front_piercings(columns: &[Column], surface: &Surface, near: &[TriangleId]) -> Vec<[f64; 2]> {
    let mut found = Vec::new();
    for pair in columns.windows(2) {
        let (p, q) = (pair[0].current, pair[1].current);
        let [from, to] = [0, 1].map(|k| pair[k].parameter);
        for corners in near.iter().map(|&t| surface.triangle_positions(t)) {
            if let Some(part) = pierced_at(corners, p, q) {
                let [a, b, c] = corners;
                let mean = ((b - a).norm() + (c - b).norm() + (a - c).norm()) / 3.0;
                let nearest = if part < 0.5 { &pair[0] } else { &pair[1] };
                let motion = (nearest.current - nearest.previous).norm();
                let clearance = (CLEARANCE * mean).min(MAX_CLEARANCE * motion);
                let speed = (to - from) / (q - p).norm();
                found.push([from + (to - from) * part, clearance * speed]);
            }
        }
    }
    found.sort_by(|a, b| a[0].total_cmp(&b[0]));
    // Two walls that coincide are pierced at one point.
    found.dedup_by(|next, kept| {
        let is_same = next[0] - kept[0] <= MAX_GAP * next[1].max(kept[1]);
        kept[1] = if is_same {
            kept[1].min(next[1])
        } else {
            kept[1]
        };
        is_same
    });
    found
}

/// Returns whether the front of the tip's moving vertices, and beside them, pierces the surface.
///
/// `near` has all triangles that it may pierce.
pub(super) fn is_inside(columns: &[Column], surface: &Surface, near: &[TriangleId]) -> bool {
    let moves = |column: &Column| column.is_tip() && !column.stands;
    let mut front = (columns.windows(2)).filter(|pair| pair.iter().any(moves));
    front.any(|pair| is_pierced(&[pair[0].current, pair[1].current], surface, near))
}
