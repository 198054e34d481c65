//! Input loops of a section: checked, scaled, and renumbered as corners.

use super::Section;
use super::cdt::orient;
use super::repair_loops::MAX_DISPLACEMENT;
use crate::error::RefineError;
use incise_mesh::index_u32;

/// Scaled coordinates below this become zero.
///
/// Products of four differences then keep all their bits, and the predicates stay exact.
const ZERO: f64 = 1.0 / (1u128 << 100) as f64;

/// The loops of a section, scaled to about 1 by a power of two.
///
/// A corner is a position in a loop; corners are numbered loop by loop.
#[derive(Debug, Clone, Default)]
pub(crate) struct SectionLoops {
    /// Scaled position of each corner.
    pub(crate) points: Vec<[f64; 2]>,
    /// The section's point at each corner.
    pub(crate) point_ids: Vec<u32>,
    /// Corners that remain after [`SectionLoops::clip`], loop after loop.
    pub(crate) corners: Vec<u32>,
    /// Start of each loop in `corners`, and the end of the last.
    pub(crate) starts: Vec<usize>,
    /// Power of two that scales input coordinates.
    pub(crate) scale: f64,
    /// Positions before the first displacement; empty if there was none.
    original: Vec<[f64; 2]>,
    /// Whether corners were displaced to separate touching loops.
    pub(crate) moved: bool,
    /// Bit set of the section's points that a loop uses.
    seen: Vec<u64>,
}

impl SectionLoops {
    /// Reads, checks and scales the loops of a section.
    pub(crate) fn read(&mut self, section: &Section<'_>) -> Result<(), RefineError> {
        self.points.clear();
        self.point_ids.clear();
        self.corners.clear();
        self.starts.clear();
        self.original.clear();
        self.moved = false;
        self.seen.clear();
        self.seen.resize(section.points.len().div_ceil(64), 0);
        let mut largest = 0.0f64;
        for (index, corners) in section.loops.iter().enumerate() {
            if corners.len() < 3 {
                return Err(RefineError::LoopTooShort {
                    index,
                    points: corners.len(),
                });
            }
            self.starts.push(self.point_ids.len());
            for &point in corners {
                let Some(at) = section.points.get(point as usize) else {
                    return Err(RefineError::UnknownPoint { index, point });
                };
                if !(at[0].is_finite() && at[1].is_finite()) {
                    return Err(RefineError::NonFinite {
                        vertex: point as usize,
                    });
                }
                let (word, bit) = (point as usize / 64, 1 << (point % 64));
                if self.seen[word] & bit != 0 {
                    return Err(RefineError::RepeatedPoint { index, point });
                }
                self.seen[word] |= bit;
                largest = largest.max(at[0].abs()).max(at[1].abs());
                self.points.push(*at);
                self.point_ids.push(point);
            }
        }
        self.starts.push(self.point_ids.len());
        self.corners.extend(0..index_u32(self.point_ids.len()));
        self.scale = power_of_two_near(largest);
        for p in &mut self.points {
            for x in p {
                *x *= self.scale;
                if x.abs() < ZERO {
                    *x = 0.0;
                }
            }
        }
        Ok(())
    }

    /// Returns the number of loops, those added by [`Self::push_loop`] included.
    pub(crate) fn loop_count(&self) -> usize {
        self.starts.len() - 1
    }

    /// Returns the remaining corners of a loop.
    pub(crate) fn corners(&self, i: usize) -> &[u32] {
        &self.corners[self.starts[i]..self.starts[i + 1]]
    }

    /// Appends a loop.
    pub(crate) fn push_loop(&mut self, corners: impl Iterator<Item = u32>) {
        self.corners.extend(corners);
        self.starts.push(self.corners.len());
    }

    /// Saves the positions before the first displacement.
    pub(crate) fn remember(&mut self) {
        if self.original.is_empty() {
            self.original.clone_from(&self.points);
        }
        self.moved = true;
    }

    /// Returns the position of a corner before any displacement.
    pub(crate) fn original(&self, corner: u32) -> [f64; 2] {
        self.original[corner as usize]
    }

    /// Undoes all displacements.
    pub(crate) fn restore(&mut self) {
        if !self.original.is_empty() {
            self.points.clone_from(&self.original);
        }
    }

    /// Clips corners without area, which are duplicates and spikes, with one triangle each.
    ///
    /// A cut through a vertex or along an edge of a surface leaves many. Repeats until no loop has
    /// any, and returns the number of triangles. A spike into the section is a slit, which stays:
    /// a triangle across it would join its two sides.
    pub(crate) fn clip(
        &mut self,
        has_edge: &impl Fn(u32, u32) -> bool,
        triangles: &mut Vec<[u32; 3]>,
    ) -> usize {
        let before = triangles.len();
        let mut kept: Vec<u32> = Vec::new();
        let flat = |points: &[[f64; 2]], [a, b, c]: [u32; 3]| {
            let [a, b, c] = [a, b, c].map(|v| points[v as usize]);
            let ahead =
                (a[0] - b[0]) * (c[0] - b[0]) >= 0.0 && (a[1] - b[1]) * (c[1] - b[1]) >= 0.0;
            ahead && orient(a, b, c) == 0.0
        };
        let clean = (0..self.loop_count()).all(|i| {
            let corners = self.corners(i);
            let n = corners.len();
            (0..n).all(|k| {
                !flat(
                    &self.points,
                    [corners[k], corners[(k + 1) % n], corners[(k + 2) % n]],
                )
            })
        });
        if clean {
            return 0;
        }
        let mut ends_slit = vec![false; self.points.len()];
        let extent = |k: usize| {
            let all = || self.points.iter().map(|p| p[k]);
            all().fold(f64::MIN, f64::max) - all().fold(f64::MAX, f64::min)
        };
        let tolerance = MAX_DISPLACEMENT * extent(0).max(extent(1));
        for own in (0..self.loop_count()).map(|i| self.corners(i)) {
            for (k, &corner) in own.iter().enumerate() {
                ends_slit[corner as usize] = self.is_end_of_slit(own, k, tolerance);
            }
        }
        let may_clip = |points: &[[f64; 2]], [a, b, c]: [u32; 3]| {
            let [p, q, r] = [a, b, c].map(|v| points[v as usize]);
            flat(points, [a, b, c]) && (p == q || q == r || !ends_slit[b as usize])
        };
        let mut starts = vec![0];
        let mut corners: Vec<u32> = Vec::with_capacity(self.corners.len());
        for i in 0..self.loop_count() {
            kept.clear();
            kept.extend_from_slice(self.corners(i));
            // A stack of corners without spikes; each new corner may make the top a spike.
            let mut changed = true;
            while changed && kept.len() > 3 {
                changed = false;
                let mut stack: Vec<u32> = Vec::with_capacity(kept.len());
                let mut left = kept.len();
                for &c in &kept {
                    while let [.., a, b] = stack[..]
                        && left > 3
                        && may_clip(&self.points, [a, b, c])
                        && !has_edge(self.point_ids[a as usize], self.point_ids[c as usize])
                    {
                        triangles.push([a, b, c]);
                        stack.pop();
                        left -= 1;
                        changed = true;
                    }
                    stack.push(c);
                }
                // The corner at which the loop was cut open comes first in the next round.
                stack.rotate_left(1);
                kept.clear();
                kept.append(&mut stack);
                changed |= left > 3 && {
                    let n = kept.len();
                    [
                        [kept[n - 2], kept[n - 1], kept[0]],
                        [kept[n - 1], kept[0], kept[1]],
                    ]
                    .into_iter()
                    .any(|t| {
                        may_clip(&self.points, t)
                            && !has_edge(
                                self.point_ids[t[0] as usize],
                                self.point_ids[t[2] as usize],
                            )
                    })
                };
            }
            if let [a, b, c] = kept[..]
                && !kept.iter().any(|&corner| ends_slit[corner as usize])
                && orient(
                    self.points[a as usize],
                    self.points[b as usize],
                    self.points[c as usize],
                ) == 0.0
            {
                triangles.push([a, b, c]);
                continue;
            }
            corners.extend_from_slice(&kept);
            starts.push(corners.len());
        }
        self.corners = corners;
        self.starts = starts;
        triangles.len() - before
    }

    /// Returns the winding number of a loop around a point.
    pub(crate) fn winding(&self, corners: &[u32], point: [f64; 2]) -> i32 {
        let n = corners.len();
        let part = |k: usize| {
            let ends = [corners[k], corners[(k + 1) % n]];
            let [p, q] = ends.map(|corner| self.points[corner as usize]);
            match [p[1] <= point[1], q[1] <= point[1]] {
                [true, false] => i32::from(orient(p, q, point) > 0.0),
                [false, true] => -i32::from(orient(p, q, point) < 0.0),
                _ => 0,
            }
        };
        (0..n).map(part).sum()
    }

    /// Returns the signed area of a loop.
    pub(crate) fn area(&self, corners: &[u32]) -> f64 {
        let n = corners.len();
        let at = |k: usize| self.points[corners[k % n] as usize];
        let [x, y] = at(0);
        let part = |k: usize| {
            let (p, q) = (at(k), at(k + 1));
            (p[0] - x) * (q[1] - y) - (q[0] - x) * (p[1] - y)
        };
        (0..n).map(part).sum::<f64>() / 2.0
    }

    /// Returns whether the inner end of a slit is at corner `k` of a loop.
    ///
    /// It returns on the same way, up to `tolerance`, to a mouth. There the inside is left of both
    /// branches, and the slit leaves between them. A loop without a mouth is a slit if other loops
    /// are around it.
    fn is_end_of_slit(&self, corners: &[u32], k: usize, tolerance: f64) -> bool {
        let n = corners.len();
        let at = |i: usize| self.points[corners[i % n] as usize];
        let (mut back, mut ahead) = (n + k, n + k);
        let mut mouth = at(k);
        let mut inner = None;
        loop {
            let minus_mouth = |p: [f64; 2]| [p[0] - mouth[0], p[1] - mouth[1]];
            let is_at_mouth = |i: usize| {
                let [x, y] = minus_mouth(at(i));
                x.hypot(y) <= tolerance
            };
            while is_at_mouth(back) && ahead - back < n {
                back -= 1;
            }
            while is_at_mouth(ahead) && ahead - back < n {
                ahead += 1;
            }
            if ahead - back >= n {
                // A loop of a slit alone. Around it is a section, or nothing.
                let others = (0..self.loop_count()).map(|i| self.corners(i));
                let others = others.filter(|other| other.as_ptr() != corners.as_ptr());
                let winding: i32 = others.map(|other| self.winding(other, at(k))).sum();
                return inner.is_some() && winding > 0;
            }
            let (p, q) = (at(back), at(ahead));
            let (u, v) = (minus_mouth(p), minus_mouth(q));
            let (a, b) = (u[0].hypot(u[1]), v[0].hypot(v[1]));
            let width = (u[0] * v[1] - u[1] * v[0]).abs() / a.max(b);
            if u[0] * v[0] + u[1] * v[1] > 0.0 && width <= tolerance {
                inner = Some(mouth);
                mouth = if a < b { p } else { q };
                continue;
            }
            let is_left = |a, b| orient(mouth, a, b) > 0.0;
            return inner.is_some_and(|inner| {
                if is_left(q, p) {
                    is_left(q, inner) && is_left(inner, p)
                } else {
                    is_left(q, inner) || is_left(inner, p)
                }
            });
        }
    }
}

/// Returns the power of two that scales `x` to about 1.
fn power_of_two_near(x: f64) -> f64 {
    if x > 0.0 {
        #[expect(
            clippy::cast_possible_truncation,
            reason = "the exponent of a finite number has 11 bits"
        )]
        let exponent = (-x.log2().floor()).clamp(-1022.0, 1022.0) as i32;
        2f64.powi(exponent)
    } else {
        1.0
    }
}
