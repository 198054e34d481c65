//! Masses of nodes, and the inverse masses of vertices as forces on them see them.

use super::Interior;
use crate::particles::inverse;
use incise_mesh::{Surface, VertexId, index_u32};

/// Least mass of a node, relative to the mean mass of the body's nodes at creation.
///
/// The bound of the ratio is a tenth. Masses and their inverses are rounded to 24 bits, each by up
/// to 6e-8, so a floor that exceeds the bound by 1e-5 holds it in storage.
const LEAST_MASS: f64 = 0.100_001;

impl Interior {
    /// Distributes a total mass over the nodes by their shares of the volume, and updates what
    /// follows from it.
    ///
    /// No node has less than [`LEAST_MASS`]. The others become lighter by as much.
    pub(crate) fn set_masses(&mut self, surface: &mut Surface, total: f64) {
        let count = index_u32(self.lattice.node_positions.len().max(1));
        self.least_mass = LEAST_MASS * total / f64::from(count);
        self.share_mass(0..index_u32(self.lattice.node_positions.len()), total);
        let all = vec![true; self.positions.len()];
        self.update_weights_of(surface, &all);
    }

    /// Distributes a mass over some nodes.
    #[expect(clippy::cast_possible_truncation, reason = "rounded to storage")]
    pub(super) fn share_mass(&mut self, nodes: impl Iterator<Item = u32> + Clone, total: f64) {
        let (volumes, least) = (&self.lattice.node_volumes, self.least_mass);
        let volume = |node: u32| volumes[node as usize];
        let sum: f64 = nodes.clone().map(volume).sum();
        let density = if sum > 0.0 { total / sum } else { 0.0 };
        let share = |node: u32| density * volume(node);
        let scale = scale_above(nodes.clone().map(share), least);
        let raised = |node: u32| (scale * share(node)).max(least);
        // Fewer than 1 only where there is not enough for all.
        let part = total / nodes.clone().map(raised).sum::<f64>();
        for node in nodes {
            let mass = (part * raised(node)) as f32;
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
        self.inverse_masses.resize(surface.positions().len(), 0.0);
        for slot in self.slots_of(is_changed) {
            let inverse_mass = self.point_inverse_mass(slot as usize);
            self.inverse_masses[slot as usize] = inverse_mass;
            surface.positions_mut()[slot as usize][3] = inverse_mass;
        }
    }

    /// Returns the vertex slots with a changed node, and the unused ones.
    pub(super) fn slots_of(&self, is_changed: &[bool]) -> Vec<u32> {
        let of_copy = |nodes: &[u32; 8]| {
            let mut nodes = nodes.iter();
            nodes.any(|&node| is_changed.get(node as usize) == Some(&true))
        };
        let copies: Vec<bool> = self.lattice.nodes.iter().map(of_copy).collect();
        let slots = (0..).zip(&self.lattice.vertex_copies);
        let is_changed = |copy: u32| copies.get(copy as usize).copied().unwrap_or(true);
        slots
            .filter(|&(_, &copy)| is_changed(copy))
            .map(|(slot, _)| slot)
            .collect()
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

/// Returns the factor of masses that keeps their sum once each is raised to a least one.
///
/// It is 0 where there is not enough for all.
fn scale_above(masses: impl Iterator<Item = f64> + Clone, least: f64) -> f64 {
    let total: f64 = masses.clone().sum();
    let mut scale = 1.0;
    loop {
        // Raised ones stay raised, so that the factor only falls.
        let (mut free, mut raised) = (0.0, 0.0);
        for mass in masses.clone() {
            match scale * mass > least {
                true => free += mass,
                false => raised += least,
            }
        }
        let next = if free > 0.0 {
            (total - raised).max(0.0) / free
        } else {
            0.0
        };
        if next >= scale {
            return scale;
        }
        scale = next;
    }
}

#[cfg(test)]
mod tests {
    use super::scale_above;

    #[test]
    fn raised_masses_keep_their_sum() {
        let masses = [4.0, 2.0, 1.0, 0.55, 0.05, 0.0];
        let scale = scale_above(masses.into_iter(), 0.5);
        let sum: f64 = masses.iter().map(|v| (scale * v).max(0.5)).sum();
        assert!((sum - 7.6).abs() < 1e-12, "{sum}");
        // The fourth is raised only because the others have become lighter.
        assert!(scale * 0.55 < 0.5);
        assert_eq!(scale_above([1.0, 2.0].into_iter(), 2.0), 0.0);
        assert_eq!(scale_above([1.0, 2.0].into_iter(), 0.5), 1.0);
    }
}
