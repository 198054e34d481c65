//! How good a cover is: its angles, and its edges over what was asked for.

use super::size::{AROUND, grow, own_length};
use super::{Cover, CoverParams, CoverSize, Section};
use incise_mesh::Vec3;
use incise_mesh::geometry::corner_angles;
use std::ops::RangeInclusive;

/// Inner edges longer than this many targets are listed.
const LONGEST: f64 = 1.8;
/// The mean of inner edges over their targets where the size counts as met.
const MEAN: RangeInclusive<f64> = 0.85..=1.15;

/// Angles and edge lengths of a cover.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CoverQuality {
    /// The smallest angle of each triangle \[degrees\], ascending.
    pub angles: Vec<f64>,
    /// The smallest angle between two edges of a loop that follow each other, on the inner side
    /// \[degrees\]: no triangle there has a larger one.
    pub rim_angle: f64,
    /// The lengths of inner edges over their targets, ascending; a target is the mean of the ends', see
    /// [`CoverParams::size`](super::CoverParams::size).
    /// Empty where any length will do.
    pub edges: Vec<f64>,
    /// The ends of the inner edges longer than 1.8 targets: where the size was not met.
    pub long_edges: Vec<[u32; 2]>,
}

impl CoverQuality {
    /// Whether inner edges are as long as asked: 0.85 to 1.15 targets in the mean, none above 1.8.
    #[must_use]
    pub fn is_size_met(&self) -> bool {
        self.edges.is_empty() || self.long_edges.is_empty() && MEAN.contains(&self.mean_edge())
    }

    /// The mean length of inner edges over their targets; 0 where there are none.
    #[must_use]
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^53 edges")]
    pub fn mean_edge(&self) -> f64 {
        if self.edges.is_empty() {
            return 0.0;
        }
        self.edges.iter().sum::<f64>() / self.edges.len() as f64
    }
}

impl Cover {
    /// Measures a cover of `section` that was made with `params`. Slow: for reports and tests, not for a
    /// frame.
    #[must_use]
    pub fn quality(&self, section: &Section<'_>, params: &CoverParams<'_>) -> CoverQuality {
        let n = section.points.len();
        let at = |v: u32| match self.inner.get((v as usize).wrapping_sub(n)) {
            Some(inner) => inner.at,
            None => section.points[v as usize],
        };
        let place = |v: u32| Vec3::new(at(v)[0], at(v)[1], 0.0);
        let smallest = |t: [Vec3; 3]| corner_angles(t).into_iter().fold(f64::MAX, f64::min);
        let angles = self.triangles.iter();
        let mut quality = CoverQuality {
            angles: angles
                .map(|t| smallest(t.map(place)).to_degrees())
                .collect(),
            rim_angle: 360.0,
            ..CoverQuality::default()
        };
        quality.angles.sort_unstable_by(f64::total_cmp);
        let mut after = vec![u32::MAX; n];
        for points in section.loops {
            for (i, &p) in points.iter().enumerate() {
                let [before, next] = [points.len() - 1, 1].map(|k| points[(i + k) % points.len()]);
                after[p as usize] = next;
                let (u, w) = (place(next) - place(p), place(before) - place(p));
                let angle = (u.x * w.y - u.y * w.x).atan2(u.dot(&w)).to_degrees();
                let angle = if angle < 0.0 { angle + 360.0 } else { angle };
                quality.rim_angle = quality.rim_angle.min(angle);
            }
        }
        let targets = self.targets(section, params, place);
        let follows = |a: u32, b: u32| after.get(a as usize) == Some(&b);
        for &[a, b, c] in &self.triangles {
            for [a, b] in [[a, b], [b, c], [c, a]] {
                // Every inner edge is the side of two triangles, once in each direction.
                if a > b || follows(a, b) || follows(b, a) {
                    continue;
                }
                let [ta, tb] = [a, b].map(|v| targets.get(v as usize));
                let Some((ta, tb)) = ta.zip(tb) else { continue };
                let ratio = (place(b) - place(a)).norm() / (0.5 * ta + 0.5 * tb);
                quality.edges.push(ratio);
                if ratio > LONGEST {
                    quality.long_edges.push([a, b]);
                }
            }
        }
        quality.edges.sort_unstable_by(f64::total_cmp);
        quality
    }

    /// The target at each vertex: what was asked for, but no more than the rim's own edges there and what
    /// that grows to with the distance. Empty where any length will do.
    fn targets(
        &self,
        section: &Section<'_>,
        params: &CoverParams<'_>,
        place: impl Fn(u32) -> Vec3,
    ) -> Vec<f64> {
        let n = section.points.len();
        let size = params.size;
        let asked = |p: usize| match size {
            CoverSize::Any => f64::INFINITY,
            CoverSize::Uniform(length) => length,
            CoverSize::Local(lengths) => lengths.get(p).copied().unwrap_or(f64::INFINITY),
        };
        if size == CoverSize::Any {
            return Vec::new();
        }
        let mut far: Vec<f64> = (0..n).map(asked).collect();
        far.extend(self.inner.iter().map(|inner| {
            let parts = inner.parents.iter().zip(inner.weights);
            parts.map(|(&p, w)| w * asked(p as usize)).sum::<f64>()
        }));
        let mut near = vec![f64::INFINITY; far.len()];
        for points in section.loops {
            let length = |i: usize| {
                let [p, q] = [i, i + 1].map(|i| place(points[i % points.len()]));
                (q - p).norm()
            };
            for (i, &p) in points.iter().enumerate() {
                let own =
                    own_length(|k| length((i + points.len() * AROUND + k - AROUND) % points.len()));
                near[p as usize] = far[p as usize].min(own);
            }
        }
        // Along edges from vertex to vertex until nothing gets less any more.
        let mut changed = true;
        while changed {
            changed = false;
            for &[a, b, c] in &self.triangles {
                for [v, w] in [[a, b], [b, a], [b, c], [c, b], [c, a], [a, c]] {
                    let way = (place(w) - place(v)).norm();
                    let grown = grow(near[v as usize], far[w as usize], way, params.grading);
                    if grown < near[w as usize] {
                        near[w as usize] = grown;
                        changed = true;
                    }
                }
            }
        }
        near
    }
}
