//! Vertices of the surface, interpolated from the nodes.

use super::Interior;
use incise_mesh::Surface;

impl Interior {
    /// Writes the positions and velocities of vertices, shape [vertex slots].
    pub(crate) fn embed(&mut self, surface: &mut Surface, velocities: &mut [[f32; 4]]) {
        let Self {
            lattice,
            positions,
            velocities: of_nodes,
            ..
        } = self;
        let slots = lattice.vertex_copies.iter().zip(&lattice.vertex_weights);
        let vertices = surface.positions_mut().iter_mut().zip(velocities);
        for ((x, v), (&copy, weights)) in vertices.zip(slots) {
            let Some(nodes) = lattice.nodes.get(copy as usize) else {
                continue;
            };
            let inverse_mass = x[3];
            *x = interpolate(positions, nodes, weights);
            x[3] = inverse_mass;
            *v = interpolate(of_nodes, nodes, weights);
            v[3] = 0.0;
        }
        self.note_embedded(surface);
    }

    /// Records that the positions of vertices are as the lattice places them.
    pub(crate) fn note_embedded(&mut self, surface: &Surface) {
        self.embedded = checksum(surface.positions());
    }

    /// Returns whether positions of vertices have been edited since the last record.
    pub(crate) fn is_edited(&self, surface: &Surface) -> bool {
        self.embedded != checksum(surface.positions())
    }

    /// Returns the position of a vertex \[m\].
    pub(crate) fn position(&self, slot: usize) -> Option<[f32; 3]> {
        self.interpolated(&self.positions, slot)
    }

    /// Returns the velocity of a vertex [m/s].
    pub(crate) fn velocity(&self, slot: usize) -> Option<[f32; 3]> {
        self.interpolated(&self.velocities, slot)
    }

    fn interpolated(&self, rows: &[[f32; 4]], slot: usize) -> Option<[f32; 3]> {
        let nodes = self.nodes_of(slot)?;
        let [x, y, z, _] = interpolate(rows, nodes, &self.lattice.vertex_weights[slot]);
        Some([x, y, z])
    }
}

/// Returns the sum of weighted rows of nodes, from the first one, whose digits are not lost.
#[inline(always)]
pub(crate) fn interpolate(rows: &[[f32; 4]], nodes: &[u32; 8], weights: &[f32; 8]) -> [f32; 4] {
    let first = rows[nodes[0] as usize];
    let mut sum = [0.0; 4];
    for (&node, &weight) in nodes.iter().zip(weights).skip(1) {
        let row = rows[node as usize];
        for k in 0..4 {
            sum[k] += weight * (row[k] - first[k]);
        }
    }
    [0, 1, 2, 3].map(|k: usize| first[k] + sum[k])
}

/// Returns a sum of the bits of positions, without those of inverse masses.
fn checksum(positions: &[[f32; 4]]) -> u64 {
    let mut sums = [0_u64; 3];
    for (i, x) in (0_u32..).zip(positions) {
        for (sum, c) in sums.iter_mut().zip(x) {
            let bits = c.to_bits().wrapping_add(i).wrapping_mul(0x9e37_79b1);
            *sum = sum.wrapping_add(u64::from(bits ^ bits >> 15));
        }
    }
    sums[0] ^ sums[1].rotate_left(21) ^ sums[2].rotate_left(42)
}

/// Returns a position in storage, without an inverse mass.
#[expect(clippy::cast_possible_truncation, reason = "rounded to storage")]
pub(super) fn to_row(x: [f64; 3]) -> [f32; 4] {
    [x[0] as f32, x[1] as f32, x[2] as f32, 0.0]
}
