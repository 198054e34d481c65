//! Quality of a section mesh: angles, and edge lengths relative to their targets.

use super::target_length::{RIM_WINDOW, graded_length, rim_length_at};
use super::{Section, SectionMesh, SectionMeshParams, SectionMeshSize};
use incise_mesh::Vec3;
use incise_mesh::geometry::corner_angles;
use std::ops::RangeInclusive;

/// Maximum length of an inner edge relative to its target.
const MAX_RATIO: f64 = 1.8;
/// Allowed mean of inner edge lengths relative to their targets.
const MEAN_RATIO: RangeInclusive<f64> = 0.85..=1.15;

/// Angles and relative edge lengths of a section mesh.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct SectionMeshQuality {
    /// Minimum angle of each triangle \[degrees\], ascending.
    pub angles: Vec<f64>,
    /// Minimum interior angle of the loops \[degrees\], an upper bound of the minimum angle.
    pub rim_angle: f64,
    /// Lengths of inner edges relative to their targets, ascending.
    ///
    /// The target of an edge is the mean of its ends' targets, see
    /// [`SectionMeshParams::size`](super::SectionMeshParams::size). Empty for
    /// [`SectionMeshSize::Any`].
    pub edges: Vec<f64>,
    /// Inner edges longer than 1.8 times their targets.
    pub long_edges: Vec<[u32; 2]>,
}

impl SectionMeshQuality {
    /// Returns whether the mean relative edge is 0.85 to 1.15 and no edge exceeds 1.8.
    #[must_use]
    pub fn is_size_met(&self) -> bool {
        self.edges.is_empty()
            || self.long_edges.is_empty() && MEAN_RATIO.contains(&self.mean_edge())
    }

    /// Returns the mean relative length of inner edges; 0 without inner edges.
    #[must_use]
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^53 edges")]
    pub fn mean_edge(&self) -> f64 {
        if self.edges.is_empty() {
            return 0.0;
        }
        self.edges.iter().sum::<f64>() / self.edges.len() as f64
    }
}

impl SectionMesh {
    /// Measures a mesh of `section` that was made with `params`.
    ///
    /// Meant for reports and tests: time is O(n) for each round of target propagation.
    #[must_use]
    pub fn quality(
        &self,
        section: &Section<'_>,
        params: &SectionMeshParams<'_>,
    ) -> SectionMeshQuality {
        let n = section.points.len();
        let at = |v: u32| match self.steiner_points.get((v as usize).wrapping_sub(n)) {
            Some(inner) => inner.position,
            None => section.points[v as usize],
        };
        let place = |v: u32| Vec3::new(at(v)[0], at(v)[1], 0.0);
        let smallest = |t: [Vec3; 3]| corner_angles(t).into_iter().fold(f64::MAX, f64::min);
        let angles = self.triangles.iter();
        let mut quality = SectionMeshQuality {
            angles: angles
                .map(|t| smallest(t.map(place)).to_degrees())
                .collect(),
            rim_angle: 360.0,
            ..SectionMeshQuality::default()
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
                // Every inner edge occurs twice, once in each direction.
                if a > b || follows(a, b) || follows(b, a) {
                    continue;
                }
                let [ta, tb] = [a, b].map(|v| targets.get(v as usize));
                let Some((ta, tb)) = ta.zip(tb) else { continue };
                let ratio = (place(b) - place(a)).norm() / (0.5 * ta + 0.5 * tb);
                quality.edges.push(ratio);
                if ratio > MAX_RATIO {
                    quality.long_edges.push([a, b]);
                }
            }
        }
        quality.edges.sort_unstable_by(f64::total_cmp);
        quality
    }

    /// Returns the target length at each vertex; empty for [`SectionMeshSize::Any`].
    ///
    /// A target is limited by the edges of the rim nearby, with growth by distance.
    fn targets(
        &self,
        section: &Section<'_>,
        params: &SectionMeshParams<'_>,
        place: impl Fn(u32) -> Vec3,
    ) -> Vec<f64> {
        let n = section.points.len();
        let size = params.size;
        let asked = |p: usize| match size {
            SectionMeshSize::Any => f64::INFINITY,
            SectionMeshSize::Uniform(length) => length,
            SectionMeshSize::Local(lengths) => lengths.get(p).copied().unwrap_or(f64::INFINITY),
        };
        if size == SectionMeshSize::Any {
            return Vec::new();
        }
        let mut far: Vec<f64> = (0..n).map(asked).collect();
        far.extend(self.steiner_points.iter().map(|inner| {
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
                let own = rim_length_at(|k| {
                    length((i + points.len() * RIM_WINDOW + k - RIM_WINDOW) % points.len())
                });
                near[p as usize] = far[p as usize].min(own);
            }
        }
        // Propagate along edges until no target decreases.
        let mut changed = true;
        while changed {
            changed = false;
            for &[a, b, c] in &self.triangles {
                for [v, w] in [[a, b], [b, a], [b, c], [c, b], [c, a], [a, c]] {
                    let way = (place(w) - place(v)).norm();
                    let grown =
                        graded_length(near[v as usize], far[w as usize], way, params.grading);
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
