//! Detects curves that only touch the surface, so that no piece without volume is cut off.
//!
//! Everything that such a curve would cut off lies exactly on the sweep, as the lowest vertex, edge
//! or face of a body that stands on the plane. Only the tie rule puts it on the other side.

use super::node::{Node, On};
use super::signs::Signs;
use incise_mesh::{Surface, VertexId};

/// Scratch memory of the search for vertices on the sweep.
#[derive(Debug, Clone, Default)]
pub(crate) struct Touch {
    /// Visited vertices, one bit each.
    seen: Vec<u64>,
    on_sweep: Vec<VertexId>,
}

impl Touch {
    /// Returns whether a closed curve only touches the surface.
    ///
    /// O(1) unless it runs along vertices that are exactly on the sweep.
    pub(crate) fn is_touch(&mut self, surface: &Surface, signs: &Signs, nodes: &[Node]) -> bool {
        let Some(On::Edge { plane, .. }) = nodes.first().map(|node| node.on) else {
            return false;
        };
        self.seen.clear();
        self.on_sweep.clear();
        for node in nodes {
            match tie(surface, signs, node) {
                Some(v) => self.add(v),
                None => return false,
            }
        }
        let mut at = 0;
        while let Some(&v) = self.on_sweep.get(at) {
            at += 1;
            for h in surface.topology().outgoing_fan(v) {
                let w = surface.topology().target(h);
                let p = surface.position(w);
                if signs.is_on(plane, p) {
                    self.add(w);
                } else if signs.is_above(plane, p) == signs.tie_is_above(plane) {
                    return false;
                }
            }
        }
        true
    }

    fn add(&mut self, v: VertexId) {
        let (word, bit) = (v.index() / 64, 1 << (v.index() % 64));
        self.seen.resize(self.seen.len().max(word + 1), 0);
        if self.seen[word] & bit == 0 {
            self.seen[word] |= bit;
            self.on_sweep.push(v);
        }
    }
}

/// Returns the end of a node's edge that is exactly on the sweep and on its side by a tie.
fn tie(surface: &Surface, signs: &Signs, node: &Node) -> Option<VertexId> {
    match node.on {
        On::Edge {
            plane, ends, rises, ..
        } => {
            let end = ends[usize::from(rises == signs.tie_is_above(plane))];
            signs.is_on(plane, surface.position(end)).then_some(end)
        }
        On::Face { .. } => None,
    }
}
