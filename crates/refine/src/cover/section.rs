//! What goes in: checks, scale, and the loops as rings of their own small numbers.

use super::Section;
use super::cdt::{id, orient};
use crate::patch::RefineError;

/// Coordinates below this much of the largest count as zero, so that products of four differences
/// keep all their bits and the predicates stay exact.
const ZERO: f64 = 1.0 / (1u128 << 100) as f64;

/// The loops, scaled to about 1 by a power of two. A corner is a place in a loop; corners are
/// numbered through, loop by loop.
#[derive(Debug, Clone, Default)]
pub(crate) struct Rims {
    /// Scaled position of each corner.
    pub(crate) points: Vec<[f64; 2]>,
    /// The section's point at each corner.
    pub(crate) ids: Vec<u32>,
    /// Corners that are left after [`Rims::clip`], ring after ring.
    pub(crate) ring: Vec<u32>,
    /// Where each ring starts, and the end.
    pub(crate) starts: Vec<usize>,
    /// Scaled = original times this power of two.
    pub(crate) scale: f64,
    /// Positions before any was moved, empty while none was.
    original: Vec<[f64; 2]>,
    /// Whether the triangles were found on moved corners anywhere.
    pub(crate) moved: bool,
    seen: Vec<u64>,
}

impl Rims {
    /// Takes a section in and checks it.
    pub(crate) fn read(&mut self, section: &Section<'_>) -> Result<(), RefineError> {
        self.points.clear();
        self.ids.clear();
        self.ring.clear();
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
            self.starts.push(self.ids.len());
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
                    return Err(RefineError::PointTwice { index, point });
                }
                self.seen[word] |= bit;
                largest = largest.max(at[0].abs()).max(at[1].abs());
                self.points.push(*at);
                self.ids.push(point);
            }
        }
        self.starts.push(self.ids.len());
        self.ring.extend(0..id(self.ids.len()));
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

    pub(crate) fn rings(&self) -> usize {
        self.starts.len() - 1
    }

    pub(crate) fn ring(&self, i: usize) -> &[u32] {
        &self.ring[self.starts[i]..self.starts[i + 1]]
    }

    pub(crate) fn push_ring(&mut self, corners: impl Iterator<Item = u32>) {
        self.ring.extend(corners);
        self.starts.push(self.ring.len());
    }

    /// Keeps the positions as they are now, before the first corner is moved.
    pub(crate) fn remember(&mut self) {
        if self.original.is_empty() {
            self.original.clone_from(&self.points);
        }
        self.moved = true;
    }

    /// Where a corner was before any was moved.
    pub(crate) fn original(&self, corner: u32) -> [f64; 2] {
        self.original[corner as usize]
    }

    /// Puts every corner back.
    pub(crate) fn restore(&mut self) {
        if !self.original.is_empty() {
            self.points.clone_from(&self.original);
        }
    }

    /// Cuts off corners of no area, duplicates and spikes, with a triangle each, until no ring has
    /// any. A cut through a vertex or along an edge of a surface leaves many. Returns how many.
    pub(crate) fn clip(
        &mut self,
        joined: &impl Fn(u32, u32) -> bool,
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
        let clean = (0..self.rings()).all(|i| {
            let ring = self.ring(i);
            let n = ring.len();
            (0..n).all(|k| {
                !flat(
                    &self.points,
                    [ring[k], ring[(k + 1) % n], ring[(k + 2) % n]],
                )
            })
        });
        if clean {
            return 0;
        }
        let mut starts = vec![0];
        let mut ring: Vec<u32> = Vec::with_capacity(self.ring.len());
        for i in 0..self.rings() {
            kept.clear();
            kept.extend_from_slice(self.ring(i));
            // A stack of corners that are good so far; each new one may make the top a spike.
            let mut changed = true;
            while changed && kept.len() > 3 {
                changed = false;
                let mut stack: Vec<u32> = Vec::with_capacity(kept.len());
                let mut left = kept.len();
                for &c in &kept {
                    while let [.., a, b] = stack[..]
                        && left > 3
                        && flat(&self.points, [a, b, c])
                        && !joined(self.ids[a as usize], self.ids[c as usize])
                    {
                        triangles.push([a, b, c]);
                        stack.pop();
                        left -= 1;
                        changed = true;
                    }
                    stack.push(c);
                }
                // The corner where the ring was cut open comes first in the next round.
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
                        flat(&self.points, t)
                            && !joined(self.ids[t[0] as usize], self.ids[t[2] as usize])
                    })
                };
            }
            if let [a, b, c] = kept[..]
                && orient(
                    self.points[a as usize],
                    self.points[b as usize],
                    self.points[c as usize],
                ) == 0.0
            {
                triangles.push([a, b, c]);
                continue;
            }
            ring.extend_from_slice(&kept);
            starts.push(ring.len());
        }
        self.ring = ring;
        self.starts = starts;
        triangles.len() - before
    }
}

/// The power of two that brings `x` to about 1.
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
