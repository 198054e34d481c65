//! Improves triangles on a surface by edge flips and tangential smoothing.

use crate::implicit::Body;
use crate::shell::{Shell, shape_quality};
use incise_mesh::geometry::{Vec3, area_vector};
use incise_mesh::{HalfEdge, VertexId};

const ROUNDS: usize = 6;
/// Maximum flip passes of a round; a pass without flips ends them.
const FLIP_PASSES: usize = 4;
/// Relative step of a vertex toward the center of its neighborhood.
const STEP: f64 = 0.6;
/// Quality above which a move may worsen the worst triangle of a vertex.
const FAIR_QUALITY: f64 = 0.7;
/// Minimum cosine between the normals of an edge's triangles for a flip.
const FLAT_COSINE: f64 = 0.8;

/// Flips and smooths in turn, without changing the genus or the numbers of elements.
///
/// Every vertex ends on the surface of `body` unless that would spoil a triangle.
pub(super) fn relax(shell: &mut Shell, body: &Body) {
    let vertices: Vec<VertexId> = shell.vertices().collect();
    for _ in 0..ROUNDS {
        for _ in 0..FLIP_PASSES {
            if !flip_pass(shell) {
                break;
            }
        }
        for &v in &vertices {
            smooth(shell, body, v);
        }
    }
}

fn flip_pass(shell: &mut Shell) -> bool {
    let edges: Vec<HalfEdge> = shell.edges().collect();
    let mut changed = false;
    for h in edges {
        if improves_by_flip(shell, h) && shell.can_flip(h) {
            shell.flip(h);
            changed = true;
        }
    }
    changed
}

/// Returns whether a flip improves the worse one of the edge's triangles.
///
/// On a flat surface this is nearly the Delaunay criterion.
fn improves_by_flip(shell: &Shell, h: HalfEdge) -> bool {
    let g = shell.twin(h);
    let [a, b, c] = shell.corners(h).map(|v| shell.point(v));
    let d = shell.point(shell.origin(g.prev()));
    let (n, m) = (area_vector([a, b, c]), area_vector([b, a, d]));
    if n.dot(&m) < FLAT_COSINE * n.norm() * m.norm() {
        return false;
    }
    let normal = n + m;
    let worst = |s, t| shape_quality(s, normal).min(shape_quality(t, normal));
    worst([d, c, a], [c, d, b]) > worst([a, b, c], [b, a, d]) + f64::EPSILON
}

/// Moves `v` along the surface toward the area-weighted center of its triangles.
fn smooth(shell: &mut Shell, body: &Body, v: VertexId) {
    let p = shell.point(v);
    let (mut middle, mut total, mut before) = (Vec3::zeros(), 0.0, f64::INFINITY);
    for h in shell.fan(v) {
        let corners = shell.corners(h).map(|c| shell.point(c));
        let vector = area_vector(corners);
        let area = vector.norm();
        middle += corners.iter().sum::<Vec3>() * (area / 3.0);
        total += area;
        before = before.min(shape_quality(corners, vector));
    }
    let reach = total.sqrt();
    for step in [STEP, 0.0] {
        let goal = p + (middle / total - p) * step;
        let (goal, normal) = body.project(goal, 2, reach);
        let after = shell
            .fan(v)
            .map(|h| {
                let [_, b, c] = shell.corners(h).map(|c| shell.point(c));
                shape_quality([goal, b, c], normal)
            })
            .fold(f64::INFINITY, f64::min);
        if after >= before.min(FAIR_QUALITY) {
            shell.points[v.index()] = goal;
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::decimate::decimate;
    use crate::implicit::{ellipsoid, tube};
    use crate::polygonize::polygonize;

    fn worst_quality(shell: &Shell) -> f64 {
        shell
            .edges()
            .flat_map(|h| [h, shell.twin(h)])
            .map(|h| shell.corners(h).map(|v| shell.point(v)))
            .map(|corners| shape_quality(corners, area_vector(corners)))
            .fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn triangles_get_better_and_vertices_end_on_the_surface() {
        let body = Body::new()
            .with(ellipsoid([0.0; 3], [1.0, 0.6, 0.7]), 0.1)
            .with(tube(&[[0.6, 0.3, 0.0, 0.2], [1.3, 0.9, 0.1, 0.12]]), 0.1);
        let (points, faces) = polygonize(&body, 0.08);
        let mut shell = Shell::new(points, &faces);
        decimate(&mut shell, 800);
        let before = worst_quality(&shell);
        relax(&mut shell, &body);
        assert_eq!(shell.live_triangles(), 800);
        assert!(worst_quality(&shell) > before.max(0.5), "{before}");
        for v in shell.vertices() {
            assert!(body.sample(shell.point(v)).value.abs() < 1e-4, "{v}");
        }
    }
}
