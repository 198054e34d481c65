//! Fairing: moves the new vertices of a patch to minimum thin-plate energy.
//!
//! The energy is the sum of squared Laplacians at the patch and its rim, with the surface fixed:
//! Botsch and Sorkine, "On Linear Variational Surface Deformation Methods", 2008, section 3. The
//! Laplacians at the rim include the adjacent vertices of the surface, so the patch meets it
//! without a crease.
//!
//! The normal equations are factored once for positions and rest positions.

use super::HolePatch;
use super::envelope::{Envelope, Row};
use super::rim::{Rim, RimNeighborhood};
use super::subdivision::flip_to_delaunay_again;
use incise_mesh::geometry::area_vector;
use incise_mesh::{Surface, Vec3, VertexId, index_u32};
use rustc_hash::FxHashMap;

/// Number of times that a patch is faired.
const FAIRING_PASSES: usize = 2;

/// Number of right-hand sides: the coordinates of positions and of rest positions.
const SIDES: usize = 6;

/// Lower bound of cotangent weights; negative ones could move vertices far away.
const MIN_WEIGHT: f64 = 0.02;

/// Upper bound of cotangent weights; in a needle they would fix its ends together.
const MAX_WEIGHT: f64 = 50.0;

/// The patch and the surface's triangles at its rim. Vertices of the patch come first.
struct Neighborhood {
    points: Vec<Vec3>,
    rest: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

/// An edge, its weight and its number of triangles.
#[derive(Clone, Copy)]
struct WeightedEdge {
    ends: [u32; 2],
    weight: f64,
    triangles: u32,
}

/// Moves the patch's inner vertices and returns whether it did.
///
/// A patch stays as it is if the system is singular in 64 bits, or if a vertex would move farther
/// from the rim's center than twice its radius.
pub(super) fn fair(
    patch: &mut HolePatch,
    surface: &Surface,
    rim: &Rim,
    around: &RimNeighborhood,
    has_edge: &impl Fn(u32, u32) -> bool,
) -> bool {
    let before = patch.clone();
    // Weights belong to the current shape, so a second pass is closer to the minimum.
    for _ in 0..FAIRING_PASSES {
        if !minimize_energy(patch, surface, rim, around) || exceeds_rim(patch) {
            *patch = before;
            return false;
        }
        flip_to_delaunay_again(patch, has_edge);
    }
    true
}

/// Returns whether a vertex is farther from the rim's center than twice the rim's radius.
fn exceeds_rim(patch: &HolePatch) -> bool {
    let rim = &patch.points[..patch.rim];
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^53 vertices")]
    let middle = rim.iter().sum::<Vec3>() / rim.len() as f64;
    let reach = |points: &[Vec3]| {
        let distances = points.iter().map(|p| (p - middle).norm());
        distances.fold(0.0, f64::max)
    };
    reach(&patch.points) > 2.0 * reach(rim)
}

/// Minimizes the energy once; returns false if the system has no finite solution.
fn minimize_energy(
    patch: &mut HolePatch,
    surface: &Surface,
    rim: &Rim,
    around: &RimNeighborhood,
) -> bool {
    let unknowns = patch.inner.len();
    let near = Neighborhood::new(patch, surface, rim, around);
    let rows = near.rows(patch.points.len());
    // Relative to a vertex of the rim, so that a distant origin costs no digits.
    let (at, rest) = (near.points[0], near.rest[0]);
    let known = |v: u32| {
        let (p, q) = (near.points[v as usize] - at, near.rest[v as usize] - rest);
        [p.x, p.y, p.z, q.x, q.y, q.z]
    };
    let first = index_u32(patch.rim);
    let last = first + index_u32(unknowns);
    let unknown = |v: u32| (first..last).contains(&v).then(|| v - first);
    let mut inner: Vec<Row> = Vec::with_capacity(rows.len());
    let mut right = vec![[0.0; SIDES]; unknowns];
    for row in &rows {
        let mut offset = [0.0; SIDES];
        for &(v, weight) in row.iter().filter(|entry| unknown(entry.0).is_none()) {
            for (sum, x) in offset.iter_mut().zip(known(v)) {
                *sum += weight * x;
            }
        }
        let own = row.iter().filter_map(|&(v, w)| Some((unknown(v)?, w)));
        let own: Row = own.collect();
        for &(i, a) in &own {
            for (sum, x) in right[i as usize].iter_mut().zip(offset) {
                *sum -= a * x;
            }
        }
        inner.push(own);
    }
    let Some(factor) = Envelope::of_normal_equations(unknowns, &inner).factor() else {
        return false;
    };
    let solution = factor.solve(&right);
    if !solution.iter().flatten().all(|x| x.is_finite()) {
        return false;
    }
    for (&[x, y, z, u, v, w], i) in solution.iter().zip(patch.rim..) {
        patch.points[i] = at + Vec3::new(x, y, z);
        patch.rest[i] = rest + Vec3::new(u, v, w);
    }
    true
}

impl Neighborhood {
    fn new(patch: &HolePatch, surface: &Surface, rim: &Rim, around: &RimNeighborhood) -> Self {
        let topology = surface.topology();
        let mut out = Self {
            points: patch.points.clone(),
            rest: patch.rest.clone(),
            triangles: patch.triangles.clone(),
        };
        let mut number: FxHashMap<VertexId, u32> = rim.vertices.iter().copied().zip(0..).collect();
        let mut triangles: Vec<_> = (rim.vertices.iter())
            .flat_map(|&v| around.corners(v))
            .map(|h| h.triangle())
            .collect();
        triangles.sort_unstable();
        triangles.dedup();
        for t in triangles {
            let corners = topology.triangle(t).map(|v| {
                *number.entry(v).or_insert_with(|| {
                    out.points.push(surface.position(v));
                    out.rest.push(surface.rest_position(v));
                    index_u32(out.points.len() - 1)
                })
            });
            out.triangles.push(corners);
        }
        out
    }

    /// Returns the Laplacians of those of the first `count` vertices that are not on a boundary.
    ///
    /// A Laplacian is a list of vertices and coefficients, each divided by the square root of its
    /// vertex's area.
    fn rows(&self, count: usize) -> Vec<Row> {
        let mut areas = vec![0.0; self.points.len()];
        let mut sides: Vec<([u32; 2], f64)> = Vec::with_capacity(3 * self.triangles.len());
        for &[a, b, c] in &self.triangles {
            let area = area_vector([a, b, c].map(|v| self.points[v as usize])).norm();
            for [a, b, c] in [[a, b, c], [b, c, a], [c, a, b]] {
                let [p, q, r] = [a, b, c].map(|v| self.points[v as usize]);
                sides.push(([a.min(b), a.max(b)], (p - r).dot(&(q - r)) / area));
                areas[c as usize] += area / 6.0;
            }
        }
        sides.sort_by_key(|side| side.0);
        let edges: Vec<WeightedEdge> = sides
            .chunk_by(|x, y| x.0 == y.0)
            .map(|same| {
                let weight = same.iter().map(|side| side.1).sum::<f64>() / 2.0;
                WeightedEdge {
                    ends: same[0].0,
                    // The comparison is false for NaN, where a triangle has no area.
                    weight: if weight > MIN_WEIGHT {
                        weight.min(MAX_WEIGHT)
                    } else {
                        MIN_WEIGHT
                    },
                    triangles: index_u32(same.len()),
                }
            })
            .collect();
        let total: f64 = areas.iter().sum();
        #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^53 vertices")]
        let mean = total / areas.len() as f64;
        let mut rows: Vec<Row> = vec![Vec::new(); count];
        let mut closed = vec![true; count];
        for edge in &edges {
            let [a, b] = edge.ends;
            for (v, other) in [(a, b), (b, a)] {
                if let Some(row) = rows.get_mut(v as usize) {
                    row.push((other, edge.weight));
                    closed[v as usize] &= edge.triangles == 2;
                }
            }
        }
        for (v, row) in (0..).zip(&mut rows) {
            let scale = (areas[v as usize] / mean).max(1e-3).sqrt().recip();
            let sum: f64 = row.iter().map(|entry| entry.1).sum();
            row.push((v, -sum));
            row.iter_mut().for_each(|entry| entry.1 *= scale);
        }
        let mut closed = closed.iter();
        rows.retain(|_| closed.next() == Some(&true));
        rows
    }
}
