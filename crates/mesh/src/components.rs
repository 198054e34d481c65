//! Connected components.

use crate::ids::TriangleId;
use crate::topology::Topology;

impl Topology {
    /// The connected component of every triangle slot, numbered in order of their first triangle;
    /// `u32::MAX` in free slots. Triangles are connected through edges.
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

    /// The triangles connected to `seed` through edges, `seed` first.
    #[must_use]
    pub fn component_of(&self, seed: TriangleId) -> Vec<TriangleId> {
        let mut seen = vec![false; self.triangle_slots()];
        seen[seed.index()] = true;
        let mut out = vec![seed];
        let mut at = 0;
        while at < out.len() {
            for twin in out[at].half_edges().map(|h| self.twin(h)) {
                if !twin.is_null() && !std::mem::replace(&mut seen[twin.triangle().index()], true) {
                    out.push(twin.triangle());
                }
            }
            at += 1;
        }
        out
    }
}
