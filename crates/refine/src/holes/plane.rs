//! Rims that lie in a plane.

use super::rim::unit;
use super::{Filling, HoleError, Inner};
use crate::cover::{Cover, CoverParams, CoverScratch, CoverSize, Section, cover};
use crate::patch::RefineError;
use incise_mesh::Vec3;

/// How far from its plane a rim may be, as a part of its mean edge.
const THIN: f64 = 0.01;

/// A rim whose area vector is no longer than this part of the squares of its points' distances from the middle turns
/// around nothing, as a figure of eight does: its vector says nothing of its plane.
const FLAT: f64 = 1e-9;

/// The plane of a rim.
pub(super) struct Plane {
    pub(super) normal: Vec3,
    u: Vec3,
    v: Vec3,
    middle: Vec3,
}

impl Plane {
    /// The plane in which the rim through `points` lies, if it does: its normal is along the rim's area
    /// vector.
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^53 vertices")]
    pub(super) fn of(points: &[Vec3], mean_edge: f64) -> Option<Self> {
        let n = points.len();
        let middle = points.iter().sum::<Vec3>() / n as f64;
        let area: Vec3 = (0..n)
            .map(|i| (points[i] - middle).cross(&(points[(i + 1) % n] - middle)))
            .sum();
        let turns = area.norm()
            > FLAT
                * points
                    .iter()
                    .map(|p| (p - middle).norm_squared())
                    .sum::<f64>();
        let normal = if turns {
            unit(area)
        } else {
            spread(points, middle)
        };
        let is_far = |p: &Vec3| (p - middle).dot(&normal).abs() > THIN * mean_edge;
        if normal == Vec3::zeros() || points.iter().any(is_far) {
            return None;
        }
        let axis = normal.iamin();
        let u = unit(normal.cross(&Vec3::ith(axis, 1.0)));
        Some(Self {
            normal,
            u,
            v: normal.cross(&u),
            middle,
        })
    }

    fn flatten(&self, p: &Vec3) -> [f64; 2] {
        let d = p - self.middle;
        [d.dot(&self.u), d.dot(&self.v)]
    }
}

/// The normal of the widest triangle on the middle of points: the farthest point and the one farthest off the line to
/// it. Zero on a line.
fn spread(points: &[Vec3], middle: Vec3) -> Vec3 {
    let from_middle = || points.iter().map(|p| p - middle);
    let farther = |a: Vec3, b: Vec3| if b.norm() > a.norm() { b } else { a };
    let farthest = from_middle().fold(Vec3::zeros(), farther);
    let off = |p: Vec3| farthest.cross(&p);
    let widest = from_middle().map(off).fold(Vec3::zeros(), farther);
    if widest.norm() > FLAT * farthest.norm_squared() {
        unit(widest)
    } else {
        Vec3::zeros()
    }
}

/// Covers a rim in a plane with triangles of the sizes \[m\] that there are at its vertices; tells
/// whether it could, which is not where the rim crosses itself. `joined` says which edges the surface has
/// already.
///
/// # Errors
/// [`HoleError::TooManyTriangles`] and what [`cover`] refuses.
pub(super) fn fill(
    filling: &mut Filling,
    plane: &Plane,
    sizes: &[f64],
    limit: usize,
    joined: &impl Fn(u32, u32) -> bool,
) -> Result<bool, HoleError> {
    let points: Vec<[f64; 2]> = filling.points.iter().map(|p| plane.flatten(p)).collect();
    let Some(cover) = cover_loop(&points, sizes, limit, joined)? else {
        return Ok(false);
    };
    for inner in cover.inner {
        filling.push(Inner {
            parents: inner.parents,
            weights: inner.weights,
        });
    }
    filling.triangles = cover.triangles;
    Ok(true)
}

/// Covers a loop in the plane; `None` if it touches or crosses itself.
///
/// # Errors
/// As [`fill`].
pub(super) fn cover_loop(
    points: &[[f64; 2]],
    sizes: &[f64],
    limit: usize,
    joined: &impl Fn(u32, u32) -> bool,
) -> Result<Option<Cover>, HoleError> {
    let loops = [(0u32..).take(points.len()).collect()];
    let section = Section {
        points,
        loops: &loops,
        crease: false,
    };
    let params = CoverParams {
        size: CoverSize::Local(sizes),
        max_triangles: limit,
        ..CoverParams::default()
    };
    match cover(&section, &params, joined, &mut CoverScratch::default()) {
        Ok(cover) => Ok((cover.report.discs + cover.report.apart == 0).then_some(cover)),
        Err(RefineError::TooManyTriangles { limit }) => Err(HoleError::TooManyTriangles { limit }),
        Err(error) => Err(HoleError::Plane(error)),
    }
}
