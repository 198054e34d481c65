//! Rest positions of new vertices: where the lattice maps them to where they are.

use super::Interior;
use incise_lattice::NO_COPY;
use incise_mesh::{Surface, TopologyDelta, Vec3, VertexOrigin};
use nalgebra::Matrix3;

/// Maximum number of steps of Newton's method.
const MAX_STEPS: usize = 16;

/// Distance from the target at which Newton's method ends [cells].
///
/// The two walls of an incision coincide, and must do so at rest. They start from different
/// guesses. Rounding to 24 bits makes them equal if both have converged to many more digits.
const CONVERGED: f64 = 1e-12;

/// Distance beyond its cell up to which a point is in it [cells].
const OUTSIDE: f64 = 1e-3;

impl Interior {
    /// Sets the rest positions of the vertices that an edit added.
    ///
    /// A cut interpolates them between those of their parents. The lattice maps a straight line to
    /// a curve, so that such a vertex would jump from where it was cut. The cells of the parents
    /// before the edit are asked, and the vertex gets the rest position that one of them maps to
    /// its place. Vertices that an undo restores keep theirs.
    pub(crate) fn set_rest_positions(&self, surface: &mut Surface, delta: &TopologyDelta) {
        // Parents that are new themselves have the copy that was found for them.
        let mut copies = self.lattice.vertex_copies.clone();
        copies.resize(surface.positions().len(), NO_COPY);
        let mut candidates = Vec::new();
        for added in &delta.vertices_added {
            if matches!(added.origin, VertexOrigin::Restored { .. }) {
                continue;
            }
            let parents = added.origin.weights().into_iter();
            candidates.clear();
            candidates.extend(
                parents
                    .filter_map(|(parent, _)| copies.get(parent.index()).copied())
                    .filter(|&copy| self.lattice.is_copy(copy)),
            );
            candidates.sort_unstable();
            candidates.dedup();
            let v = added.vertex;
            let target = surface.position(v);
            let rest = surface.rest_position(v);
            let mut best: Option<(u32, Vec3, f64)> = None;
            for &copy in &candidates {
                let Some(at) = self.rest_of(copy, target, rest) else {
                    continue;
                };
                let outside = self.outside(copy, at);
                if best.is_none_or(|best| outside < best.2) {
                    best = Some((copy, at, outside));
                }
                // The others can only be as good.
                if outside <= 0.0 {
                    break;
                }
            }
            if let Some((copy, at, _)) = best {
                copies[v.index()] = copy;
                #[expect(clippy::cast_possible_truncation, reason = "rounded to storage")]
                let at = [at.x as f32, at.y as f32, at.z as f32];
                surface.rest_positions_mut()[v.index()] = at;
            }
        }
    }

    /// Returns the rest position that a copy maps to `target` \[m\], from a guess.
    fn rest_of(&self, copy: u32, target: Vec3, guess: Vec3) -> Option<Vec3> {
        let nodes = &self.lattice.nodes[copy as usize];
        let grid = &self.lattice.grid;
        let (cell, size) = (
            grid.cell(self.lattice.cells[copy as usize]),
            grid.cell_size(),
        );
        let x = nodes.map(|node| {
            let [x, y, z, _] = self.positions[node as usize];
            Vec3::new(x.into(), y.into(), z.into())
        });
        let corner = grid.corner(cell, 0);
        let mut at = guess;
        for _ in 0..MAX_STEPS {
            let weights = grid.weights(cell, at);
            let image = x[0]
                + (x.iter().zip(weights))
                    .map(|(x_i, b)| (x_i - x[0]) * b)
                    .sum::<Vec3>();
            let off = target - image;
            if off.norm() <= CONVERGED * size {
                return Some(at);
            }
            let place = (at - corner) / size;
            let mut gradient = Matrix3::zeros();
            for (i, x_i) in x.iter().enumerate() {
                let part = |k: usize| {
                    if i >> k & 1 == 1 {
                        place[k]
                    } else {
                        1.0 - place[k]
                    }
                };
                let slope = |k: usize| if i >> k & 1 == 1 { 1.0 } else { -1.0 };
                let g = Vec3::new(
                    slope(0) * part(1) * part(2),
                    part(0) * slope(1) * part(2),
                    part(0) * part(1) * slope(2),
                );
                gradient += x_i * g.transpose();
            }
            at += gradient.try_inverse()? * off * size;
        }
        None
    }

    /// Returns how far a rest position is outside of a copy's cell [cells].
    fn outside(&self, copy: u32, at: Vec3) -> f64 {
        let grid = &self.lattice.grid;
        let low = grid.corner(grid.cell(self.lattice.cells[copy as usize]), 0);
        let place = (at - low) / grid.cell_size();
        let beyond = place.iter().map(|p| (-p).max(p - 1.0)).fold(0.0, f64::max);
        (beyond - OUTSIDE).max(0.0)
    }
}
