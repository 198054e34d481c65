//! Planar rims: fits a plane and triangulates the rim in it as a section.

use super::rim::unit;
use super::{HolePatch, NewVertex};
use crate::error::HoleError;
use crate::error::RefineError;
use crate::section_mesh::{
    Section, SectionMesh, SectionMeshParams, SectionMeshScratch, SectionMeshSize,
    triangulate_section,
};
use incise_mesh::Vec3;

/// Maximum distance of a planar rim from its plane, relative to its mean edge.
const MAX_DISTANCE: f64 = 0.01;

/// Minimum length of a rim's area vector, relative to the sum of squared distances from its center.
///
/// A rim with a shorter one, such as a figure of eight, encloses no area, so its area vector does
/// not determine its plane.
const MIN_AREA: f64 = 1e-9;

/// The plane of a rim.
pub(super) struct Plane {
    pub(super) normal: Vec3,
    u: Vec3,
    v: Vec3,
    middle: Vec3,
}

impl Plane {
    /// Returns the plane of the rim through `points`, with its normal along the area vector.
    ///
    /// `None` if the rim is not planar.
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^53 vertices")]
    pub(super) fn fit(points: &[Vec3], mean_edge: f64) -> Option<Self> {
        let n = points.len();
        let middle = points.iter().sum::<Vec3>() / n as f64;
        let area: Vec3 = (0..n)
            .map(|i| (points[i] - middle).cross(&(points[(i + 1) % n] - middle)))
            .sum();
        let turns = area.norm()
            > MIN_AREA
                * points
                    .iter()
                    .map(|p| (p - middle).norm_squared())
                    .sum::<f64>();
        let normal = if turns {
            unit(area)
        } else {
            widest_triangle_normal(points, middle)
        };
        let is_far = |p: &Vec3| (p - middle).dot(&normal).abs() > MAX_DISTANCE * mean_edge;
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

    /// Returns the coordinates of a point in the plane.
    fn project(&self, p: &Vec3) -> [f64; 2] {
        let d = p - self.middle;
        [d.dot(&self.u), d.dot(&self.v)]
    }
}

/// Returns the normal of the widest triangle at the center of points; zero for collinear points.
///
/// Its corners are the center, the farthest point and the point farthest from the line of both.
fn widest_triangle_normal(points: &[Vec3], middle: Vec3) -> Vec3 {
    let from_middle = || points.iter().map(|p| p - middle);
    let farther = |a: Vec3, b: Vec3| if b.norm() > a.norm() { b } else { a };
    let farthest = from_middle().fold(Vec3::zeros(), farther);
    let off = |p: Vec3| farthest.cross(&p);
    let widest = from_middle().map(off).fold(Vec3::zeros(), farther);
    if widest.norm() > MIN_AREA * farthest.norm_squared() {
        unit(widest)
    } else {
        Vec3::zeros()
    }
}

/// Triangulates a planar rim with the target sizes \[m\] at its vertices.
///
/// Returns false for a rim that crosses itself. `has_edge` returns whether the surface already has
/// an edge between two rim vertices.
///
/// # Errors
/// [`HoleError::TooManyTriangles`] and [`HoleError::Planar`].
pub(super) fn fill(
    patch: &mut HolePatch,
    plane: &Plane,
    sizes: &[f64],
    limit: usize,
    has_edge: &impl Fn(u32, u32) -> bool,
) -> Result<bool, HoleError> {
    let points: Vec<[f64; 2]> = patch.points.iter().map(|p| plane.project(p)).collect();
    let Some(mesh) = triangulate_loop(&points, sizes, limit, has_edge)? else {
        return Ok(false);
    };
    for inner in mesh.steiner_points {
        patch.push(NewVertex {
            parents: inner.parents,
            weights: inner.weights,
        });
    }
    patch.triangles = mesh.triangles;
    Ok(true)
}

/// Triangulates a loop in the plane; `None` if it touches or crosses itself.
///
/// # Errors
/// The same as [`fill`].
pub(super) fn triangulate_loop(
    points: &[[f64; 2]],
    sizes: &[f64],
    limit: usize,
    has_edge: &impl Fn(u32, u32) -> bool,
) -> Result<Option<SectionMesh>, HoleError> {
    let loops = [(0u32..).take(points.len()).collect()];
    let section = Section {
        points,
        loops: &loops,
    };
    let params = SectionMeshParams {
        size: SectionMeshSize::Local(sizes),
        max_triangles: limit,
        grading: 0.0,
        ..SectionMeshParams::default()
    };
    match triangulate_section(
        &section,
        &params,
        has_edge,
        &mut SectionMeshScratch::default(),
    ) {
        Ok(mesh) => Ok(
            (mesh.report.self_intersecting_loops + mesh.report.separated_loops == 0)
                .then_some(mesh),
        ),
        Err(RefineError::TooManyTriangles { limit }) => Err(HoleError::TooManyTriangles { limit }),
        Err(error) => Err(HoleError::Planar(error)),
    }
}
