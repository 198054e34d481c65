//! Polygonization of a body by surface nets (Gibson 1998): one vertex for each cell of a grid.

use crate::implicit::Body;
use incise_mesh::Vec3;
use incise_mesh::VertexId;

/// Number of samples along an edge of the blocks that are skipped as a whole.
const BLOCK: usize = 4;
/// Number of cells around the body's box, for the swelling of joints and relief.
const MARGIN: f64 = 6.0;
/// The corners of a cell: bit 0 is x, bit 1 is y, bit 2 is z.
const CORNERS: usize = 8;
/// A bit for every corner.
const ALL_INSIDE: usize = (1 << CORNERS) - 1;

/// Returns a closed manifold around the inside of `body`, sampled at distance `cell`.
///
/// Normals point outward. Every vertex moves one step toward the surface.
pub(super) fn polygonize(body: &Body, cell: f64) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let mut grid = Grid::sample(body, cell);
    let active = grid.make_well_composed();
    let (mut points, cell_vertex) = grid.cell_vertices(&active);
    for p in &mut points {
        *p = body.project(*p, 1, cell).0;
    }
    let mut faces = Vec::new();
    grid.for_each_quad(&active, &cell_vertex, |quad| {
        let [a, b, c, d] = quad;
        let [pa, pb, pc, pd] = quad.map(|v| points[v as usize]);
        if (pc - pa).norm_squared() <= (pd - pb).norm_squared() {
            faces.extend([[a, b, c], [a, c, d]]);
        } else {
            faces.extend([[a, b, d], [b, c, d]]);
        }
    });
    (points, faces)
}

struct Grid {
    origin: Vec3,
    cell: f64,
    /// Number of samples along each axis.
    size: [usize; 3],
    values: Vec<f64>,
}

impl Grid {
    fn sample(body: &Body, cell: f64) -> Self {
        let (low, high) = body.bounds();
        let origin = low - Vec3::repeat(MARGIN * cell);
        let size: [usize; 3] =
            std::array::from_fn(|k| samples_across((high - low)[k] / cell + 2.0 * MARGIN));
        let mut grid = Self {
            origin,
            cell,
            size,
            values: vec![0.0; size.iter().product()],
        };
        let half = (BLOCK as f64 - 1.0) / 2.0;
        // Distance from the center of a block to the farthest neighbor of its samples.
        let beyond = half + 1.0;
        let reach = cell * (beyond * beyond + 2.0 * half * half).sqrt();
        for k in (0..size[2]).step_by(BLOCK) {
            for j in (0..size[1]).step_by(BLOCK) {
                for i in (0..size[0]).step_by(BLOCK) {
                    let middle = grid.point(i, j, k) + Vec3::repeat(half * cell);
                    let near = body.near(middle, reach);
                    grid.fill_block([i, j, k], |p| near.value(p));
                }
            }
        }
        grid
    }

    fn fill_block(&mut self, [i0, j0, k0]: [usize; 3], value: impl Fn(Vec3) -> f64) {
        let end = |first: usize, axis: usize| (first + BLOCK).min(self.size[axis]);
        let (i1, j1, k1) = (end(i0, 0), end(j0, 1), end(k0, 2));
        for k in k0..k1 {
            for j in j0..j1 {
                for i in i0..i1 {
                    let at = self.index(i, j, k);
                    self.values[at] = value(self.point(i, j, k));
                }
            }
        }
    }

    fn point(&self, i: usize, j: usize, k: usize) -> Vec3 {
        self.origin + Vec3::new(i as f64, j as f64, k as f64) * self.cell
    }

    fn index(&self, i: usize, j: usize, k: usize) -> usize {
        (k * self.size[1] + j) * self.size[0] + i
    }

    fn stride(&self, axis: usize) -> usize {
        [1, self.size[0], self.size[0] * self.size[1]][axis]
    }

    /// Returns the offset in `values` from a cell's first corner to each of its corners.
    fn corner_offsets(&self) -> [usize; CORNERS] {
        std::array::from_fn(|c| (0..3).map(|a| (c >> a & 1) * self.stride(a)).sum())
    }

    /// Iterates over the cells by their first corner, in index order.
    fn cells(&self) -> impl Iterator<Item = [usize; 3]> + use<> {
        let [nx, ny, nz] = self.size;
        (0..nz - 1)
            .flat_map(move |k| (0..ny - 1).flat_map(move |j| (0..nx - 1).map(move |i| [i, j, k])))
    }

    fn inside_mask(&self, first: usize, offsets: &[usize; CORNERS]) -> usize {
        (0..CORNERS)
            .filter(|&c| self.values[first + offsets[c]] < 0.0)
            .map(|c| 1 << c)
            .sum()
    }

    /// Makes the grid well-composed and returns the cells with corners on both sides.
    ///
    /// Moves inside samples outside until the inside corners of every cell are connected along its
    /// edges, and the outside corners too. Every cell then has one sheet, and the net is a
    /// manifold. It terminates because the inside only shrinks.
    fn make_well_composed(&mut self) -> Vec<[usize; 3]> {
        let offsets = self.corner_offsets();
        let simple: Vec<bool> = (0..=ALL_INSIDE)
            .map(|mask| hangs_together(mask) && hangs_together(!mask & ALL_INSIDE))
            .collect();
        loop {
            let mut active = Vec::new();
            let mut changed = false;
            for [i, j, k] in self.cells() {
                let first = self.index(i, j, k);
                let mask = self.inside_mask(first, &offsets);
                if mask == 0 || mask == ALL_INSIDE {
                    continue;
                }
                active.push([i, j, k]);
                if !simple[mask] {
                    for c in (0..CORNERS).filter(|c| mask >> c & 1 == 1) {
                        self.values[first + offsets[c]] = self.cell;
                    }
                    changed = true;
                }
            }
            if !changed {
                return active;
            }
        }
    }

    /// Returns a point for every active cell, the mean of its edge crossings, and each cell's point
    /// index.
    fn cell_vertices(&self, active: &[[usize; 3]]) -> (Vec<Vec3>, Vec<u32>) {
        let offsets = self.corner_offsets();
        let mut points = Vec::new();
        let mut cell_vertex = vec![u32::MAX; self.values.len()];
        for &[i, j, k] in active {
            let first = self.index(i, j, k);
            let mask = self.inside_mask(first, &offsets);
            let (mut sum, mut crossings) = (Vec3::zeros(), 0.0);
            for (c, axis) in (0..CORNERS).flat_map(|c| (0..3).map(move |axis| (c, axis))) {
                let d = c | 1 << axis;
                if c == d || (mask >> c & 1) == (mask >> d & 1) {
                    continue;
                }
                let (x, y) = (
                    self.values[first + offsets[c]],
                    self.values[first + offsets[d]],
                );
                let mut corner: Vec3 = Vec3::from_fn(|a, _| (c >> a & 1) as f64);
                corner[axis] = x / (x - y);
                sum += corner;
                crossings += 1.0;
            }
            cell_vertex[first] = VertexId::from_index(points.len()).0;
            points.push(self.point(i, j, k) + sum * (self.cell / crossings));
        }
        (points, cell_vertex)
    }

    /// Calls `emit` with the four cell vertices around every grid edge that crosses the surface.
    ///
    /// They are counterclockwise seen from outside.
    fn for_each_quad(
        &self,
        active: &[[usize; 3]],
        cell_vertex: &[u32],
        mut emit: impl FnMut([u32; 4]),
    ) {
        for &[i, j, k] in active {
            let at = self.index(i, j, k);
            for axis in 0..3 {
                let lower_inside = self.values[at] < 0.0;
                if lower_inside == (self.values[at + self.stride(axis)] < 0.0) {
                    continue;
                }
                let (b, c) = (self.stride((axis + 1) % 3), self.stride((axis + 2) % 3));
                // The margin keeps crossings off the grid's border, so all four cells exist.
                let mut quad = [at - b - c, at - c, at, at - b].map(|cell| cell_vertex[cell]);
                if !lower_inside {
                    quad.reverse();
                }
                emit(quad);
            }
        }
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a body is a few hundred cells wide"
)]
fn samples_across(cells: f64) -> usize {
    cells.ceil() as usize + 1
}

/// Returns whether the marked corners are connected along the cell's edges, or none is marked.
fn hangs_together(mask: usize) -> bool {
    let mut reached = mask & mask.wrapping_neg();
    loop {
        let mut grown = reached;
        for c in (0..CORNERS).filter(|c| reached >> c & 1 == 1) {
            for axis in 0..3 {
                grown |= 1 << (c ^ 1 << axis);
            }
        }
        grown &= mask;
        if grown == reached {
            return reached == mask;
        }
        reached = grown;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::implicit::{ellipsoid, tube};
    use incise_mesh::Surface;
    use incise_mesh::geometry::to_f32;

    fn net(body: &Body, cell: f64) -> Surface {
        let (points, faces) = polygonize(body, cell);
        let positions: Vec<[f32; 3]> = points.into_iter().map(to_f32).collect();
        let surface = Surface::from_triangles(&positions, &faces).unwrap();
        assert!(surface.topology().is_closed());
        surface
    }

    #[test]
    fn a_ball_has_the_volume_of_a_ball() {
        let body = Body::new().with(ellipsoid([0.3, 0.1, -0.2], [1.0; 3]), 0.1);
        let surface = net(&body, 0.05);
        let t = surface.topology();
        assert_eq!(
            t.vertices().count() + t.triangle_count() - t.edges().count(),
            2
        );
        let exact = 4.0 / 3.0 * std::f64::consts::PI;
        assert!((surface.volume() / exact - 1.0).abs() < 2e-3);
    }

    #[test]
    fn bodies_that_almost_touch_stay_manifold() {
        // Two spheres and a tube with gaps smaller than a cell cause cells with two sheets.
        for shift in 0..20 {
            let gap = f64::from(shift) * 0.011;
            let body = Body::new()
                .with(ellipsoid([0.0; 3], [0.5; 3]), 0.001)
                .with(ellipsoid([0.7, 0.71 + gap, 0.03], [0.5; 3]), 0.001)
                .with(
                    tube(&[[-0.6, 0.0, 0.62 + gap, 0.1], [0.6, 0.1, 0.6, 0.1]]),
                    0.001,
                );
            net(&body, 0.083);
        }
    }

    #[test]
    fn corners_across_a_face_do_not_hang_together() {
        assert!(hangs_together(0));
        assert!(hangs_together(0b1111));
        assert!(!hangs_together(0b1001));
        assert!(!hangs_together(0b1000_0001));
    }
}
