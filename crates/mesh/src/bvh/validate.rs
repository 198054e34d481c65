//! Validation of a BVH.

use super::{Bvh, LEAF_SIZE, MAX_HEIGHT, NONE, Node, union};
use crate::{Aabb, Surface, TriangleId};

/// A broken invariant of a [`Bvh`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("{rule} does not hold at node {node}")]
#[non_exhaustive]
pub struct InvalidBvh {
    /// The broken rule.
    pub rule: &'static str,
    /// The node at which it is broken.
    pub node: usize,
}

/// The elements visited by the validation.
struct Seen {
    pairs: Vec<bool>,
    blocks: Vec<bool>,
    triangles: usize,
}

impl Bvh {
    /// Checks all invariants. O(n).
    ///
    /// Every triangle is in one leaf with its vertices. Every box is the exact bounding box of its
    /// content. Parents and children refer to each other, the height is limited, and every slot is
    /// either used or free.
    ///
    /// # Errors
    /// The first broken rule and its node.
    pub fn validate(&self, surface: &Surface) -> Result<(), InvalidBvh> {
        let check = |holds, rule, node| holds_at(holds, rule, node);
        let slots = self.nodes.len();
        let even = self.samples.len() == slots && 2 * self.parents.len() == slots;
        check(even, "every pair has a parent and samples", slots)?;
        let even = self.leaves.len() == self.blocks.len();
        check(even, "every block has a leaf", slots)?;
        let even = self.places.len() == surface.topology().triangle_slots();
        check(even, "every triangle slot has a place", slots)?;
        let mut seen = Seen {
            pairs: vec![false; self.parents.len()],
            blocks: vec![false; self.blocks.len()],
            triangles: 0,
        };
        if slots > 0 {
            seen.pairs[0] = true;
            self.validate_node(surface, 0, MAX_HEIGHT, &mut seen)?;
        }
        let rule = "every triangle is in one leaf";
        check(
            seen.triangles == surface.topology().triangle_count(),
            rule,
            slots,
        )?;
        let placed = self.places.iter().filter(|&&place| place != NONE).count();
        check(placed == seen.triangles, rule, slots)?;
        let once = free_once(&self.free_pairs, &mut seen.pairs);
        check(once, "every pair is in use or free", slots)?;
        let once = free_once(&self.free_blocks, &mut seen.blocks);
        check(once, "every block is in use or free", slots)
    }

    /// Checks a subtree and returns its box, height and first block.
    fn validate_node(
        &self,
        surface: &Surface,
        at: u32,
        room: usize,
        seen: &mut Seen,
    ) -> Result<(Aabb, u8, u32), InvalidBvh> {
        let check = |holds, rule| holds_at(holds, rule, at as usize);
        let node = &self.nodes[at as usize];
        check(!node.touched, "nothing is left to be fitted")?;
        check(node.height as usize <= room, "no tree is too high")?;
        let (bounds, height, sample) = if node.is_leaf() {
            self.validate_leaf(surface, at, node, seen)?;
            (self.leaf_bounds(surface, node), 0, node.index)
        } else {
            let pair = node.index as usize / 2;
            let known = self.parents.get(pair) == Some(&at) && node.index.is_multiple_of(2);
            check(known, "children know their parent")?;
            let new = !std::mem::replace(&mut seen.pairs[pair], true);
            check(new, "a pair has one parent")?;
            let mut child = |i| self.validate_node(surface, node.index + i, room - 1, seen);
            let (left, right) = (child(0)?, child(1)?);
            let below = [0, 1].map(|i| self.nodes[(node.index + i) as usize].has_pieces);
            let known = node.has_pieces || !below.contains(&true);
            check(known, "nodes of several pieces are at the top")?;
            let height = left.1.max(right.1) + 1;
            (union(&left.0, &right.0), height, left.2)
        };
        check(node.height == height, "a node knows its height")?;
        let sampled = self.samples[at as usize] == sample;
        check(sampled, "a node's sample is its first block")?;
        check(node.bounds == bounds, "a box fits what it holds")?;
        Ok((bounds, height, sample))
    }

    fn validate_leaf(
        &self,
        surface: &Surface,
        at: u32,
        node: &Node,
        seen: &mut Seen,
    ) -> Result<(), InvalidBvh> {
        let check = |holds, rule| holds_at(holds, rule, at as usize);
        let index = node.index as usize;
        let known = self.leaves.get(index) == Some(&at);
        check(known, "a block knows its leaf")?;
        let new = !std::mem::replace(&mut seen.blocks[index], true);
        check(new, "a block has one leaf")?;
        let count = node.count as usize;
        check((1..=LEAF_SIZE).contains(&count), "a leaf has triangles")?;
        for k in 0..count {
            let t: TriangleId = self.blocks[index].triangles[k];
            let alive = surface.topology().is_triangle(t);
            check(alive, "a leaf's triangles are the surface's")?;
            let corners = self.blocks[index].corners[k] == surface.topology().triangle(t);
            check(corners, "a leaf knows the vertices of its triangles")?;
            let place = self.places[t.index()] as usize == LEAF_SIZE * index + k;
            check(place, "a triangle's place is where it stands")?;
        }
        seen.triangles += count;
        Ok(())
    }
}

/// Returns whether free slots are unseen, unique and complete.
fn free_once(free: &[u32], seen: &mut [bool]) -> bool {
    let new = |&i: &u32| {
        seen.get_mut(i as usize)
            .is_some_and(|slot| !std::mem::replace(slot, true))
    };
    free.iter().all(new) && seen.iter().all(|&slot| slot)
}

fn holds_at(holds: bool, rule: &'static str, node: usize) -> Result<(), InvalidBvh> {
    if holds {
        Ok(())
    } else {
        Err(InvalidBvh { rule, node })
    }
}
