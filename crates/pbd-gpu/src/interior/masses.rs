//! Masses of nodes, and the inverse masses of vertices as forces on them see them.

use super::Interior;
use crate::constraints::cells::MIN_FRACTION;
use crate::particles::inverse;
use incise_mesh::{Surface, VertexId, index_u32};

impl Interior {
    /// Distributes a total mass over the nodes by their shares of the volume, and updates what
    /// follows from it.
    ///
    /// No node has less than [`MIN_FRACTION`] of a cell. The others become lighter by as much.
    pub(crate) fn set_masses(&mut self, surface: &mut Surface, total: f64) {
        let sum: f64 = self.lattice.node_volumes.iter().sum();
        let volume = surface.rest_volume_of(surface.topology().triangles());
        // Scanlines miss up to a percent of the volume.
        self.volume_scale = if sum > 0.0 { volume / sum } else { 0.0 };
        self.share_mass(0..index_u32(self.lattice.node_positions.len()), total);
        let all = vec![true; self.positions.len()];
        self.update_weights_of(surface, &all);
    }

    /// Distributes a mass over some nodes.
    #[expect(clippy::cast_possible_truncation, reason = "rounded to storage")]
    pub(super) fn share_mass(&mut self, nodes: impl Iterator<Item = u32> + Clone, total: f64) {
        let size = self.lattice.grid.cell_size();
        let least = MIN_FRACTION * size * size * size;
        let volumes = &self.lattice.node_volumes;
        let share = |node: u32| (self.volume_scale * volumes[node as usize]).max(least);
        let floored: f64 = nodes.clone().map(share).sum();
        let density = total / floored;
        for node in nodes {
            let mass = (density * share(node)) as f32;
            self.mass[node as usize] = mass;
            self.positions[node as usize][3] = inverse(mass);
        }
    }

    /// Updates the inverse masses of cells and vertices after a change of those of some nodes.
    pub(super) fn update_weights_of(&mut self, surface: &mut Surface, is_changed: &[bool]) {
        let positions = &self.positions;
        let inverse_mass = |node: VertexId| positions[node.index()][3];
        let size = self.lattice.grid.cell_size();
        let of_node = |node: VertexId| is_changed[node.index()];
        self.mean_stiff = self.cells.set_weights(inverse_mass, of_node, size);
        (self.cells).sum_forces(&mut self.node_forces, &self.constants, of_node);
        let of_copy = |nodes: &[u32; 8]| {
            let mut nodes = nodes.iter();
            nodes.any(|&node| is_changed.get(node as usize) == Some(&true))
        };
        let copies: Vec<bool> = self.lattice.nodes.iter().map(of_copy).collect();
        let slots = surface.positions().len();
        self.inverse_masses.resize(slots, 0.0);
        for slot in 0..slots {
            let copy = self.lattice.vertex_copies.get(slot);
            let changed = copy.and_then(|&copy| copies.get(copy as usize));
            if changed.copied().unwrap_or(true) {
                let inverse_mass = self.point_inverse_mass(slot);
                self.inverse_masses[slot] = inverse_mass;
                surface.positions_mut()[slot][3] = inverse_mass;
            }
        }
    }

    /// Returns the inverse mass of a vertex as a force on it sees it, `(sum of b sqrt(w))^2`.
    ///
    /// It bounds the response `sum of b^2 w` of the vertex itself, and that of any vertex which a
    /// force on another one moves (Cauchy-Schwarz). With the response alone, pushes of vertices
    /// with common nodes would add up to more than each of them.
    pub(crate) fn point_inverse_mass(&self, slot: usize) -> f32 {
        let Some(nodes) = self.nodes_of(slot) else {
            return 0.0;
        };
        let weights = self.lattice.vertex_weights[slot];
        let terms = nodes.iter().zip(weights);
        let root: f32 = terms
            .map(|(&node, b)| b.abs() * self.positions[node as usize][3].sqrt())
            .sum();
        root * root
    }

    /// Returns the nodes of a vertex slot, if it is used.
    pub(crate) fn nodes_of(&self, slot: usize) -> Option<&[u32; 8]> {
        let copy = *self.lattice.vertex_copies.get(slot)?;
        self.lattice.nodes.get(copy as usize)
    }
}
