//! The points of the next sweep: where it begins at the tip, and where it ends on the blade.

use super::Incision;
use incise_mesh::geometry::{area_vector, to_f64};
use incise_mesh::{Aabb, Bvh, Surface, TriangleId, Vec3, VertexId};

/// Displacement of the sweep beyond the ends of a tip [local edge lengths].
const WIDENING: f64 = 0.3;
/// Its maximum [distance to the next point of the sweep].
const MAX_WIDENING: f64 = 0.2;

/// Maximum rise of the sweep from an end of a tip [distance to the next point of the sweep].
///
/// Below a half, so that points between two parts of a tip keep their order.
const MAX_RISE: f64 = 0.3;

/// Maximum gap between walls that the tip crosses at one point [local edge lengths].
const MAX_GAP: f64 = 1e-3;

/// Maximum distance of a point of the blade from the tip that takes its place [local edge lengths].
const MAX_TIP_DISTANCE: f64 = 1e-3;

/// Minimum distance of a point of the sweep from the surface, along the blade [local edge lengths].
const CLEARANCE: f64 = 0.1;
/// Its maximum [motion of the blade].
const MAX_CLEARANCE: f64 = 0.5;

/// A point of the blade in both poses of the next sweep.
#[derive(Debug, Clone, Copy)]
pub(super) struct Column {
    /// Its parameter on the blade now, see [`TipPoint::parameter`].
    pub(super) parameter: f64,
    /// Its position before the step \[m\].
    pub(super) previous: Vec3,
    /// The incoming and the outgoing vertex of the tip, or null. They differ across two coincident
    /// walls.
    pub(super) vertex: VertexId,
    pub(super) begins: VertexId,
    /// Whether an edge of the tip joins it to the next column.
    pub(super) is_joined: bool,
    /// Whether the next part of the tip began at the same parameter, across a gap that has opened.
    meets_next: bool,
}

impl Column {
    /// Makes a column off the tip.
    fn outside(parameter: f64, previous: Vec3) -> Self {
        Self {
            parameter,
            previous,
            vertex: VertexId::NULL,
            begins: VertexId::NULL,
            is_joined: false,
            meets_next: false,
        }
    }
}

impl Incision {
    /// Returns the points of the next sweep: those of the tip, and those of the blade outside.
    ///
    /// Beside an end of the tip, the sweep widens and rises from the surface. Otherwise the line
    /// from there to the blade's last pose could cross the surface once more. And a body is often
    /// symmetric, so that the same point of the blade enters and leaves it. The sweep rises by up
    /// to `rise` local edge lengths; if that is 0, it goes back to the blade's last pose.
    pub(super) fn columns(&self, surface: &Surface, blade: &[[f32; 3]], rise: f64) -> Vec<Column> {
        let mut columns: Vec<Column> = Vec::new();
        for (i, point) in self.pose.iter().enumerate() {
            #[expect(clippy::cast_precision_loss, reason = "few points")]
            let parameter = i as f64;
            let is_covered = self.tip.windows(2).any(|pair| {
                pair[0].is_joined
                    && pair[0].parameter <= parameter
                    && parameter <= pair[1].parameter
            });
            let is_at_tip = self.tip.iter().any(|tip| {
                let distance = (point_at(&self.pose, tip.parameter) - to_f64(*point)).norm();
                distance <= MAX_TIP_DISTANCE * self.local
            });
            if !is_covered && !is_at_tip {
                columns.push(Column::outside(parameter, to_f64(*point)));
            }
        }
        for (i, point) in self.tip.iter().enumerate() {
            let previous = surface.position(point.vertex);
            if let (Some(last), Some(before)) = (columns.last_mut(), i.checked_sub(1))
                && self.tip[before].meets_next
                && (previous - last.previous).norm() <= MAX_GAP * self.local
            {
                last.begins = point.vertex;
                last.is_joined = point.is_joined;
                last.meets_next = point.meets_next;
                continue;
            }
            columns.push(Column {
                parameter: point.parameter,
                previous,
                vertex: point.vertex,
                begins: point.vertex,
                is_joined: point.is_joined,
                meets_next: point.meets_next,
            });
        }
        columns.sort_by(|a, b| a.parameter.total_cmp(&b.parameter));
        let mut out = Vec::with_capacity(columns.len() + 4);
        for (i, &column) in columns.iter().enumerate() {
            let is_tip = !column.vertex.is_null();
            let before = i.checked_sub(1).map(|i| columns[i]);
            let after = columns.get(i + 1).copied();
            let mut own = column;
            let mut risen = |beyond: Column| {
                let [a, b] = [column, beyond].map(|c| point_at(blade, c.parameter));
                let local = self.local;
                let part = (WIDENING * local / (b - a).norm()).min(MAX_WIDENING);
                let step = (beyond.parameter - column.parameter) * part;
                own.parameter = column.parameter + step;
                let room = MAX_RISE * (beyond.previous - column.previous).norm();
                let height = rise * local.min(room);
                let previous = if height > 0.0 {
                    column.previous + outward(surface, column, a - b, a) * height
                } else {
                    point_at(&self.pose, column.parameter + step)
                };
                Column::outside(column.parameter + 2.0 * step, previous)
            };
            let goes_on = |column: Column| column.is_joined || column.meets_next;
            let is_first = is_tip && !before.is_some_and(goes_on);
            let is_last = is_tip && !goes_on(column);
            out.extend(before.filter(|_| is_first).map(&mut risen));
            let risen = after.filter(|_| is_last).map(risen);
            out.push(own);
            out.extend(risen);
        }
        out
    }
}

/// Returns the unit vector half way between the blade and the direction away from the surface at a
/// column, in the plane of the sweep there.
///
/// Straight away from a surface that faces the motion, the sweep would turn back. `along` is the
/// direction of the blade towards the column, `to` the column's next position \[m\]. A sheet has
/// two sides: there the vector is on that from which the blade comes.
fn outward(surface: &Surface, column: Column, along: Vec3, to: Vec3) -> Vec3 {
    let fan = surface.topology().outgoing_fan(column.vertex);
    let normals = fan.map(|h| area_vector(surface.triangle_positions(h.triangle())));
    let normal: Vec3 = normals.sum();
    let is_reversed = is_at_boundary(surface, column.vertex) && normal.dot(&along) > 0.0;
    let normal = if is_reversed { -normal } else { normal };
    let across = along.cross(&(to - column.previous));
    let across = across.try_normalize(0.0).unwrap_or_default();
    let in_plane = normal - across * across.dot(&normal);
    let beyond = in_plane.try_normalize(0.0).unwrap_or_default()
        - along.try_normalize(0.0).unwrap_or_default();
    beyond.try_normalize(0.0).unwrap_or_default()
}

/// Returns whether a vertex is on the boundary of a sheet.
pub(super) fn is_at_boundary(surface: &Surface, vertex: VertexId) -> bool {
    let first = surface.topology().outgoing_fan(vertex).next();
    first.is_some_and(|h| surface.topology().twin(h).is_null())
}

/// Returns the point of a polyline at a parameter \[m\].
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "parameters are between 0 and the number of points"
)]
pub(super) fn point_at(line: &[[f32; 3]], parameter: f64) -> Vec3 {
    let i = (parameter.floor().max(0.0) as usize).min(line.len() - 2);
    #[expect(clippy::cast_precision_loss, reason = "few points")]
    let part = parameter - i as f64;
    let [a, b] = [line[i], line[i + 1]].map(to_f64);
    a + (b - a) * part
}

/// Moves the points of the next sweep along the blade, away from where that pierces the surface.
///
/// There the sweep's curves end. A point close to an end would leave a tip that turns back.
pub(super) fn spread(columns: &mut [Column], surface: &Surface, bvh: &Bvh, blade: &[[f32; 3]]) {
    let piercings = piercings(columns, surface, bvh, blade);
    for (i, &[parameter, clearance]) in piercings.iter().enumerate() {
        let others = [i.checked_sub(1), Some(i + 1)].into_iter().flatten();
        let others = others.filter_map(|j| piercings.get(j));
        let room = others.map(|other| (other[0] - parameter).abs() / 2.0);
        let to_point = (parameter - parameter.round()).abs();
        let reach = room.fold(to_point, f64::min).min(3.0 * clearance);
        for column in &mut *columns {
            let distance = column.parameter - parameter;
            if distance.abs() < reach {
                let moved = (reach + 2.0 * distance.abs()) / 3.0;
                column.parameter = parameter + moved.copysign(distance);
            }
        }
    }
}

/// Returns the parameters at which the blade pierces the surface, ascending, with clearances.
fn piercings(
    columns: &[Column],
    surface: &Surface,
    bvh: &Bvh,
    blade: &[[f32; 3]],
) -> Vec<[f64; 2]> {
    let mut candidates: Vec<TriangleId> = Vec::new();
    let mut found = Vec::new();
    for (i, ends) in blade.windows(2).enumerate() {
        let (p, q) = (to_f64(ends[0]), to_f64(ends[1]));
        candidates.clear();
        bvh.traverse(surface, |bounds| touches(bounds, p, q), &mut candidates);
        for corners in candidates.iter().map(|&t| surface.triangle_positions(t)) {
            let [a, b, c] = corners;
            let normal = area_vector(corners);
            let [from, to] = [p, q].map(|x| normal.dot(&(x - a)));
            let part = from / (from - to);
            let at = p + (q - p) * part;
            let is_inside = |(u, v): (Vec3, Vec3)| normal.dot(&area_vector([u, v, at])) >= 0.0;
            if (from < 0.0) != (to < 0.0) && [(a, b), (b, c), (c, a)].into_iter().all(is_inside) {
                let mean = ((b - a).norm() + (c - b).norm() + (a - c).norm()) / 3.0;
                #[expect(clippy::cast_precision_loss, reason = "few points")]
                let parameter = i as f64 + part;
                let nearest = |c: &&Column| (c.parameter - parameter).abs();
                let column = columns
                    .iter()
                    .min_by(|a, b| nearest(a).total_cmp(&nearest(b)));
                let motion =
                    column.map_or(0.0, |c| (point_at(blade, c.parameter) - c.previous).norm());
                let clearance = (CLEARANCE * mean).min(MAX_CLEARANCE * motion);
                found.push([parameter, clearance / (q - p).norm()]);
            }
        }
    }
    found.sort_by(|a, b| a[0].total_cmp(&b[0]));
    found
}

/// Returns whether the line from `p` to `q` may touch a box, up to rounding.
fn touches(bounds: &Aabb, p: Vec3, q: Vec3) -> bool {
    let (mut first, mut last) = (0.0, 1.0);
    for k in 0..3 {
        let [low, high] = [bounds.min[k], bounds.max[k]].map(f64::from);
        let along = q[k] - p[k];
        if along == 0.0 {
            if p[k] < low || p[k] > high {
                return false;
            }
            continue;
        }
        let [s, t] = [low, high].map(|bound| (bound - p[k]) / along);
        first = s.min(t).max(first);
        last = s.max(t).min(last);
    }
    first <= last
}
