//! Connected components.

use crate::topology::Topology;

impl Topology {
    /// Returns the connected component of every triangle slot, `u32::MAX` for free slots.
    ///
    /// Triangles are connected through edges. Components are numbered in the order of their first
    /// triangles.
    #[must_use]
    pub fn component_labels(&self) -> Vec<u32> {
        let mut labels = vec![u32::MAX; self.triangle_slots()];
        let mut stack = Vec::new();
        let mut next = 0;
        for seed in self.triangles() {
            if labels[seed.index()] != u32::MAX {
                continue;
            }
            labels[seed.index()] = next;
            stack.push(seed);
            while let Some(t) = stack.pop() {
                for twin in t.half_edges().map(|h| self.twin(h)) {
                    if twin.is_null() {
                        continue;
                    }
                    let neighbor = twin.triangle();
                    if labels[neighbor.index()] == u32::MAX {
                        labels[neighbor.index()] = next;
                        stack.push(neighbor);
                    }
                }
            }
            next += 1;
        }
        labels
    }
}
