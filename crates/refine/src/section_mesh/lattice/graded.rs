//! Graded lattices: the points of nested lattices of spacing L, 2 L, 4 L and so on.
//!
//! Every point of the finest lattice gets a target length. It starts from the rim and grows from
//! point to point, in one sweep over the rows upward and one downward. A point stays if it belongs
//! to the lattice whose spacing fits its target. Between two lattices, the Delaunay triangulation
//! halves triangles, which gives angles of 30 degrees before smoothing.

use super::{CLEARANCE, Lattice, Span, count};
use crate::section_mesh::loop_triangulation::LoopTriangulation;
use crate::section_mesh::target_length::TargetLengths;
use incise_mesh::index_u32;

/// Smallest target for a spacing, relative to it; the largest is twice as large.
///
/// Spacings are then 0.83 to 1.67 targets; refinement splits edges beyond 1.5 targets.
const MIN_TARGET: f64 = 0.6;
/// Maximum number of points of the finest lattice: for each corner of a loop, and in addition.
const MAX_POINTS_PER_CORNER: usize = 32;
const MAX_POINTS: usize = 1 << 14;
/// Maximum clearance of coarse points, relative to the finest spacing.
const MAX_REACH: f64 = 5.0;
/// Mean distance of two points relative to that along the lattice's edges between them.
const MEAN_DETOUR: f64 = 0.95;

impl Lattice {
    /// Places points inside the loops at distances that follow the targets.
    ///
    /// `length` is the spacing of the finest lattice, or smaller. `rim` are the targets of the
    /// corners, limited by the edges of the rim. No points result in sections that are too thin.
    pub(crate) fn fill_graded(
        &mut self,
        triangulation: &LoopTriangulation,
        targets: &TargetLengths,
        rim: &[f64],
        length: f64,
    ) {
        self.clear();
        let most = MAX_POINTS_PER_CORNER * rim.len() + MAX_POINTS;
        self.length = length.max(shortest_spacing(triangulation, most));
        self.height = self.length * 0.75f64.sqrt();
        self.base = triangulation.low;
        if !self.rasterize(triangulation, 2 * most) {
            return;
        }
        self.collect_spans();
        self.read_far_targets(triangulation, targets);
        self.seed_sizes(triangulation, targets, rim);
        self.grow_sizes(targets);
        self.select();
        self.number_kept();
        let sizes = self.sizes.iter().zip(&self.dropped);
        let kept = sizes.filter(|&(_, dropped)| !dropped);
        self.targets.extend(kept.map(|(&size, _)| size));
        self.assign_to_band();
    }

    /// Interpolates the targets far from the rim.
    fn read_far_targets(&mut self, triangulation: &LoopTriangulation, targets: &TargetLengths) {
        let target = |v: u32| targets.at(triangulation.corner_of[v as usize]);
        self.far.clear();
        for &(_, run) in &self.order {
            let run = self.runs[run as usize];
            let [left, right] = run.sides.map(|side| side.interpolate(target));
            let width = run.sides[1].x - run.sides[0].x;
            let slope = if width > 0.0 {
                (right - left) / width
            } else {
                0.0
            };
            for column in run.columns[0]..run.columns[1] {
                let way = self.x(run.row, column) - run.sides[0].x;
                self.far.push(left + slope * way);
            }
        }
    }

    /// Sets the targets of points beside the rim, and their distances from it.
    fn seed_sizes(
        &mut self,
        triangulation: &LoopTriangulation,
        targets: &TargetLengths,
        rim: &[f64],
    ) {
        // Without grading, targets are at most the interpolated ones.
        self.sizes.clear();
        if targets.grading > 0.0 {
            self.sizes.resize(self.far.len(), f64::INFINITY);
        } else {
            self.sizes.extend_from_slice(&self.far);
        }
        self.distances.clear();
        self.distances.resize(self.far.len(), f64::INFINITY);
        for (v, &w) in (0u32..).zip(&triangulation.next) {
            let near = [v, w].map(|v| rim[v as usize]);
            let far = [v, w].map(|v| targets.at(triangulation.corner_of[v as usize]));
            // Every point with a neighbor outside is closer than L to an edge.
            let clearance = CLEARANCE * self.spacing(far[0].max(far[1]));
            let reach = clearance.clamp(self.length, MAX_REACH * self.length);
            self.near_edge(triangulation, v, reach, |lattice, at| {
                let near = near[0] + at.along * (near[1] - near[0]);
                let far = lattice.far[at.point];
                let size = &mut lattice.sizes[at.point];
                *size = size.min(targets.graded(near, far, at.distance.sqrt()));
                let distance = &mut lattice.distances[at.point];
                *distance = distance.min(at.distance);
            });
        }
    }

    /// Limits the target of each point by those of its neighbors, grown by their distance.
    fn grow_sizes(&mut self, targets: &TargetLengths) {
        let rows = self.rows.len() - 1;
        for row in 0..rows {
            if row > 0 {
                self.grow_row(targets, row, row - 1);
            }
            for i in self.rows[row]..self.rows[row + 1] {
                let points = self.points_of(self.spans[i]);
                for point in points.start + 1..points.end {
                    self.grow_along(targets, point - 1, point);
                }
            }
        }
        for row in (0..rows).rev() {
            if row + 1 < rows {
                self.grow_row(targets, row, row + 1);
            }
            for i in self.rows[row]..self.rows[row + 1] {
                let points = self.points_of(self.spans[i]);
                for point in (points.start + 1..points.end).rev() {
                    self.grow_along(targets, point, point - 1);
                }
            }
        }
    }

    /// Limits the targets of a row by those of the row below or above.
    fn grow_row(&mut self, targets: &TargetLengths, row: usize, from: usize) {
        // The left neighbor of column i is column i in an odd row, i - 1 in an even row.
        let number = self.first_row + i64::try_from(row).unwrap_or(0);
        let shift = number.rem_euclid(2) - 1;
        let mut start = self.rows[from];
        for i in self.rows[row]..self.rows[row + 1] {
            let own = self.spans[i];
            while start < self.rows[from + 1]
                && self.spans[start].columns[1] <= own.columns[0] + shift
            {
                start += 1;
            }
            for j in start..self.rows[from + 1] {
                let other = self.spans[j];
                if other.columns[0] > own.columns[1] + shift {
                    break;
                }
                for shift in [shift, shift + 1] {
                    let low = own.columns[0].max(other.columns[0] - shift);
                    let high = own.columns[1].min(other.columns[1] - shift);
                    let to = own.first as usize + offset(own.columns[0], low);
                    let near = other.first as usize + offset(other.columns[0], low + shift);
                    for k in 0..offset(low, high) {
                        self.grow(targets, near + k, to + k);
                    }
                }
            }
        }
    }

    /// Limits the target of a point by that of a neighbor.
    #[inline]
    fn grow(&mut self, targets: &TargetLengths, from: usize, to: usize) {
        let way = MEAN_DETOUR * self.length;
        let grown = targets.graded(self.sizes[from], self.far[to], way);
        self.sizes[to] = self.sizes[to].min(grown);
    }

    /// [`Self::grow`] within a row, where a target waits for that of the neighbor.
    ///
    /// Targets grow with the distance, so a larger neighbor is skipped.
    #[inline]
    fn grow_along(&mut self, targets: &TargetLengths, from: usize, to: usize) {
        if self.sizes[from] < self.sizes[to] {
            self.grow(targets, from, to);
        }
    }

    /// Drops points that are not in the lattice of their spacing, or too close to a loop.
    fn select(&mut self) {
        for row in 0..self.rows.len() - 1 {
            let number = self.first_row + i64::try_from(row).unwrap_or(0);
            for i in self.rows[row]..self.rows[row + 1] {
                let span = self.spans[i];
                for (column, point) in (span.columns[0]..).zip(self.points_of(span)) {
                    let spacing = self.spacing_in_lattice(number, column, self.sizes[point]);
                    self.dropped[point] = spacing.is_none_or(|spacing| {
                        let clearance = CLEARANCE * spacing;
                        self.distances[point] < clearance * clearance
                    });
                }
            }
        }
    }

    /// Returns the spacing for a target.
    #[inline]
    fn spacing(&self, target: f64) -> f64 {
        let mut spacing = self.length;
        while target >= 2.0 * MIN_TARGET * spacing && spacing < f64::MAX {
            spacing *= 2.0;
        }
        spacing
    }

    /// Returns [`Self::spacing`] if a point belongs to the lattice with that spacing.
    #[inline]
    fn spacing_in_lattice(&self, mut row: i64, mut column: i64, target: f64) -> Option<f64> {
        let mut spacing = self.length;
        while target >= 2.0 * MIN_TARGET * spacing && spacing < f64::MAX {
            let shift = (row >> 1) & 1;
            if row & 1 != 0 || (column - shift) & 1 != 0 {
                return None;
            }
            (row, column) = (row >> 1, (column - shift) >> 1);
            spacing *= 2.0;
        }
        Some(spacing)
    }

    fn points_of(&self, span: Span) -> std::ops::Range<usize> {
        let first = span.first as usize;
        first..first + offset(span.columns[0], span.columns[1])
    }
}

/// Returns the distance of two columns, 0 if the second is before the first.
fn offset(from: i64, to: i64) -> usize {
    usize::try_from(to - from).unwrap_or(0)
}

/// Returns a spacing at which the loops contain about `most` points.
fn shortest_spacing(triangulation: &LoopTriangulation, most: usize) -> f64 {
    let edges = (triangulation.next.iter()).zip(&triangulation.cdt.points);
    let doubled: f64 = edges
        .map(|(&w, p)| {
            let q = triangulation.cdt.point(w);
            p[0] * q[1] - p[1] * q[0]
        })
        .sum();
    // A point has the area of two equilateral triangles.
    let points = count(i64::from(index_u32(most)));
    (0.5 * doubled / (points * 0.75f64.sqrt())).max(0.0).sqrt()
}
