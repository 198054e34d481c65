//! [`SavedBvh`]: the order of a BVH, for files.
//!
//! The order depends on the history of cuts, and it decides the order of query results. Boxes and
//! the inverse tables follow from it.

use super::{Block, Bvh, InvalidBvh, LEAF_SIZE, MAX_HEIGHT, NONE, Node};
use crate::ids::index_u32;
use crate::{Surface, TriangleId, VertexId};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// The nodes and leaves of a [`Bvh`], as they are saved.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct SavedBvh<'a> {
    nodes: Vec<SavedNode>,
    /// Triangles of every block; null beyond those of its leaf.
    blocks: Vec<[TriangleId; LEAF_SIZE]>,
    free_pairs: Cow<'a, [u32]>,
    free_blocks: Cow<'a, [u32]>,
}

/// A node, or zeros for a free one.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
struct SavedNode {
    /// As in [`Node`].
    index: u32,
    /// Number of triangles of a leaf, 0 for an inner node.
    count: u8,
    has_pieces: bool,
}

impl Bvh {
    /// Returns the BVH as plain data for a file.
    #[must_use]
    pub fn to_saved(&self) -> SavedBvh<'_> {
        let mut nodes = vec![SavedNode::default(); self.nodes.len()];
        let mut blocks = vec![[TriangleId::NULL; LEAF_SIZE]; self.blocks.len()];
        let mut stack = Vec::new();
        stack.extend((!self.nodes.is_empty()).then_some(0));
        while let Some(at) = stack.pop() {
            let node = &self.nodes[at as usize];
            nodes[at as usize] = SavedNode {
                index: node.index,
                count: node.count,
                has_pieces: node.has_pieces,
            };
            if node.is_leaf() {
                let (block, count) = (node.index as usize, node.count as usize);
                blocks[block][..count].copy_from_slice(&self.blocks[block].triangles[..count]);
            } else {
                stack.extend([node.index, node.index + 1]);
            }
        }
        SavedBvh {
            nodes,
            blocks,
            free_pairs: (&self.free_pairs).into(),
            free_blocks: (&self.free_blocks).into(),
        }
    }

    /// Returns a saved BVH, fitted to the positions of its surface, which must be valid. O(n).
    ///
    /// # Errors
    /// [`InvalidBvh`] if it is not a BVH of the surface.
    pub fn from_saved(saved: SavedBvh<'_>, surface: &Surface) -> Result<Self, InvalidBvh> {
        let slots = saved.nodes.len();
        let null = Block {
            triangles: [TriangleId::NULL; LEAF_SIZE],
            corners: [[VertexId::NULL; 3]; LEAF_SIZE],
        };
        let mut bvh = Self {
            nodes: vec![Node::default(); slots],
            samples: vec![NONE; slots],
            parents: vec![NONE; slots / 2],
            blocks: vec![null; saved.blocks.len()],
            leaves: vec![NONE; saved.blocks.len()],
            places: vec![NONE; surface.topology().triangle_slots()],
            ..Self::default()
        };
        if slots > 0 {
            bvh.read_nodes(&saved, surface)?;
            bvh.fit(surface, 0, true);
        }
        bvh.free_pairs = saved.free_pairs.into_owned();
        bvh.free_blocks = saved.free_blocks.into_owned();
        bvh.validate(surface)?;
        Ok(bvh)
    }

    /// Sets all nodes and blocks below the root.
    fn read_nodes(&mut self, saved: &SavedBvh<'_>, surface: &Surface) -> Result<(), InvalidBvh> {
        let broken = |rule, node: u32| InvalidBvh {
            rule,
            node: node as usize,
        };
        if !saved.nodes.len().is_multiple_of(2) {
            return Err(broken("nodes come in pairs", 0));
        }
        self.parents[0] = 0;
        // Parents before children; the depth limits all loops below.
        let mut order: Vec<(u32, usize)> = vec![(0, 0)];
        let mut next = 0;
        while let Some(&(at, depth)) = order.get(next) {
            next += 1;
            let node = saved.nodes[at as usize];
            self.nodes[at as usize] = Node {
                index: node.index,
                count: node.count,
                has_pieces: node.has_pieces,
                ..Node::default()
            };
            if node.count > 0 {
                self.read_leaf(saved, surface, at)?;
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

    /// Sets the block of a leaf and the places of its triangles.
    fn read_leaf(
        &mut self,
        saved: &SavedBvh<'_>,
        surface: &Surface,
        at: u32,
    ) -> Result<(), InvalidBvh> {
        let broken = |rule| InvalidBvh {
            rule,
            node: at as usize,
        };
        let node = self.nodes[at as usize];
        let (block, count) = (node.index as usize, node.count as usize);
        let leaf = self.leaves.get_mut(block).filter(|leaf| **leaf == NONE);
        let leaf = leaf.ok_or(broken("a leaf has a block of its own"))?;
        *leaf = at;
        let Some(triangles) = saved.blocks[block].get(..count) else {
            return Err(broken("a leaf has at most four triangles"));
        };
        for (k, &t) in triangles.iter().enumerate() {
            let place = self.places.get_mut(t.index());
            let place = place.filter(|place| **place == NONE && surface.topology().is_triangle(t));
            let place = place.ok_or(broken("every triangle is in one leaf"))?;
            *place = index_u32(LEAF_SIZE * block + k);
            self.blocks[block].triangles[k] = t;
            self.blocks[block].corners[k] = surface.topology().triangle(t);
        }
        Ok(())
    }
}
