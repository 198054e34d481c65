//! Nodes follow positions and velocities that a caller has set for vertices.
//!
//! The lattice takes the affine map of each piece that fits the change best, and then the mean of
//! what is left at the vertices of each node. So a moved, turned or stretched piece is exact.

use super::Interior;
use incise_mesh::{Surface, Vec3, index_u32};
use nalgebra::Matrix3;

/// Regularization of the second moments of a piece, relative to their trace: flat pieces have no
/// derivative along their normal.
const FLAT: f64 = 1e-9;

/// A change of a vector field over a piece: an affine map.
#[derive(Debug, Clone, Copy)]
struct Affine {
    center: Vec3,
    shift: Vec3,
    gradient: Matrix3<f64>,
}

impl Affine {
    fn at(&self, x: Vec3) -> Vec3 {
        self.shift + self.gradient * (x - self.center)
    }
}

impl Interior {
    /// Moves the nodes so that vertices are near their positions in the surface.
    pub(crate) fn adopt_positions(&mut self, surface: &Surface) {
        let targets = surface.positions();
        let change = |interior: &Self, slot: usize| {
            let at = interior.position(slot)?;
            Some(vector(targets[slot]) - Vec3::from(at.map(f64::from)))
        };
        let maps = self.fit(change);
        for (node, map) in maps.iter().enumerate() {
            let Some(map) = map else { continue };
            let x = vector(self.positions[node]);
            add(&mut self.positions[node], map.at(x));
        }
        self.turn(&maps);
        (self.cells).sum_forces(&mut self.node_forces, &self.constants, |_| true);
        self.spread(change, |interior| &mut interior.positions);
    }

    /// Changes the velocities of nodes so that those of vertices are near `targets` [m/s].
    pub(crate) fn adopt_velocities(&mut self, targets: &[[f32; 4]]) {
        let change = |interior: &Self, slot: usize| {
            let at = interior.velocity(slot)?;
            Some(vector(targets[slot]) - Vec3::from(at.map(f64::from)))
        };
        let maps = self.fit(change);
        for (node, map) in maps.iter().enumerate() {
            let Some(map) = map else { continue };
            let x = vector(self.positions[node]);
            add(&mut self.velocities[node], map.at(x));
        }
        self.spread(change, |interior| &mut interior.velocities);
        self.has_new_velocities = false;
    }

    /// Returns the affine map of each node's piece; `None` for nodes without a vertex.
    fn fit(&self, change: impl Fn(&Self, usize) -> Option<Vec3>) -> Vec<Option<Affine>> {
        let count = self.positions.len();
        let mut sets = self.pieces();
        // By piece: count, sums of positions and changes, then their products.
        let mut sums = vec![(0.0, Vec3::zeros(), Vec3::zeros()); count];
        let mut products = vec![(Matrix3::zeros(), Matrix3::zeros()); count];
        let slots = 0..self.lattice.vertex_copies.len();
        let mut vertices = Vec::new();
        for slot in slots {
            if let (Some(nodes), Some(change), Some(at)) =
                (self.nodes_of(slot), change(self, slot), self.position(slot))
            {
                let piece = sets.find(nodes[0]) as usize;
                let at = Vec3::from(at.map(f64::from));
                vertices.push((piece, at, change));
                sums[piece].0 += 1.0;
                sums[piece].1 += at;
                sums[piece].2 += change;
            }
        }
        for &(piece, at, change) in &vertices {
            let (count, center, mean) = sums[piece];
            let arm = at - center / count;
            products[piece].0 += (change - mean / count) * arm.transpose();
            products[piece].1 += arm * arm.transpose();
        }
        let of_node = |node: u32| {
            let piece = sets.find(node) as usize;
            let (count, center, mean) = sums[piece];
            if count == 0.0 {
                return None;
            }
            let (mixed, moments) = products[piece];
            let regular = moments + Matrix3::identity() * (FLAT * moments.trace());
            let inverse = regular.try_inverse().unwrap_or_else(Matrix3::zeros);
            Some(Affine {
                center: center / count,
                shift: mean / count,
                gradient: mixed * inverse,
            })
        };
        (0..index_u32(count)).map(of_node).collect()
    }

    /// Adds to each node the mean of what the vertices near it are off.
    fn spread(
        &mut self,
        change: impl Fn(&Self, usize) -> Option<Vec3>,
        rows: impl Fn(&mut Self) -> &mut Vec<[f32; 4]>,
    ) {
        let mut sums = vec![(Vec3::zeros(), 0.0); self.positions.len()];
        for slot in 0..self.lattice.vertex_copies.len() {
            if let (Some(nodes), Some(change)) = (self.nodes_of(slot), change(self, slot)) {
                for (&node, weight) in nodes.iter().zip(self.lattice.vertex_weights[slot]) {
                    let weight = f64::from(weight.max(0.0));
                    let sum = &mut sums[node as usize];
                    sum.0 += change * weight;
                    sum.1 += weight;
                }
            }
        }
        for (row, (sum, weight)) in rows(self).iter_mut().zip(sums) {
            if weight > 0.0 {
                add(row, sum / weight);
            }
        }
    }

    /// Turns the state of cells with their pieces.
    fn turn(&mut self, maps: &[Option<Affine>]) {
        for copy in 0..index_u32(self.lattice.nodes.len()) {
            let node = self.lattice.nodes[copy as usize][0] as usize;
            let map = maps.get(node).copied().flatten();
            let Some(map) = map.filter(|_| self.lattice.is_copy(copy)) else {
                continue;
            };
            if map.gradient != Matrix3::zeros() {
                let svd = (Matrix3::identity() + map.gradient).svd(true, true);
                if let (Some(u), Some(v)) = (svd.u, svd.v_t) {
                    self.cells.turn(copy, &(u * v));
                }
            }
        }
    }
}

fn vector(row: [f32; 4]) -> Vec3 {
    Vec3::new(row[0].into(), row[1].into(), row[2].into())
}

/// Adds a vector to a row, rounded once.
#[expect(clippy::cast_possible_truncation, reason = "rounded to storage")]
fn add(row: &mut [f32; 4], by: Vec3) {
    for k in 0..3 {
        row[k] = (f64::from(row[k]) + by[k]) as f32;
    }
}
