//! Completes a loaded BVH, of which a file has the order of nodes and leaves.
//!
//! The order depends on the history of cuts, and it decides the order of query results. Boxes and
//! the inverse tables follow from it.

use super::{Bvh, InvalidBvh, LEAF_SIZE, MAX_HEIGHT, NONE};
use crate::Surface;
use crate::ids::index_u32;

impl Bvh {
    /// Completes a BVH that was read with serde and fits it to its surface, which must be valid.
    ///
    /// O(n).
    ///
    /// # Errors
    /// [`InvalidBvh`] if it is not a BVH of the surface.
    pub fn finish_load(&mut self, surface: &Surface) -> Result<(), InvalidBvh> {
        let slots = self.nodes.len();
        self.samples = vec![NONE; slots];
        self.parents = vec![NONE; slots / 2];
        self.leaves = vec![NONE; self.blocks.len()];
        self.places = vec![NONE; surface.topology().triangle_slots()];
        if slots > 0 {
            self.link_nodes(surface)?;
            self.fit(surface, 0, true);
        }
        self.validate(surface)
    }

    /// Sets heights, samples and inverse tables of all nodes below the root.
    fn link_nodes(&mut self, surface: &Surface) -> Result<(), InvalidBvh> {
        let broken = |rule, node: u32| InvalidBvh {
            rule,
            node: node as usize,
        };
        if !self.nodes.len().is_multiple_of(2) {
            return Err(broken("nodes come in pairs", 0));
        }
        self.parents[0] = 0;
        // Parents before children; the depth limits all loops below.
        let mut order: Vec<(u32, usize)> = vec![(0, 0)];
        let mut next = 0;
        while let Some(&(at, depth)) = order.get(next) {
            next += 1;
            let node = self.nodes[at as usize];
            if node.count > 0 {
                self.link_leaf(surface, at)?;
                continue;
            }
            let parent = self.parents.get_mut(node.index as usize / 2);
            match parent.filter(|parent| **parent == NONE && node.index.is_multiple_of(2)) {
                Some(parent) if depth < MAX_HEIGHT => *parent = at,
                _ => return Err(broken("children are a pair of their own", at)),
            }
            order.extend([(node.index, depth + 1), (node.index + 1, depth + 1)]);
        }
        for &(at, _) in order.iter().rev() {
            let node = self.nodes[at as usize];
            let (height, sample) = if node.count > 0 {
                (0, node.index)
            } else {
                let [left, right] = [0, 1].map(|i| self.nodes[(node.index + i) as usize].height);
                (left.max(right) + 1, self.samples[node.index as usize])
            };
            self.nodes[at as usize].height = height;
            self.samples[at as usize] = sample;
        }
        Ok(())
    }

    /// Sets the vertices of a leaf's block and the places of its triangles.
    fn link_leaf(&mut self, surface: &Surface, at: u32) -> Result<(), InvalidBvh> {
        let broken = |rule| InvalidBvh {
            rule,
            node: at as usize,
        };
        let node = self.nodes[at as usize];
        let (block, count) = (node.index as usize, node.count as usize);
        let leaf = self.leaves.get_mut(block).filter(|leaf| **leaf == NONE);
        let leaf = leaf.ok_or(broken("a leaf has a block of its own"))?;
        *leaf = at;
        if count > LEAF_SIZE {
            return Err(broken("a leaf has at most four triangles"));
        }
        for k in 0..count {
            let t = self.blocks[block].triangles[k];
            let place = self.places.get_mut(t.index());
            let place = place.filter(|place| **place == NONE && surface.topology().is_triangle(t));
            let place = place.ok_or(broken("every triangle is in one leaf"))?;
            *place = index_u32(LEAF_SIZE * block + k);
            self.blocks[block].corners[k] = surface.topology().triangle(t);
        }
        Ok(())
    }
}
