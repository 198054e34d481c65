//! A bounding volume hierarchy (BVH) over the triangles of a surface, with local updates after
//! cuts.
//!
//! Nodes are in one array, two siblings side by side (a pair), the root alone in pair 0. A leaf has
//! a block of up to four triangles: ids and vertices in one cache line, so a refit reads only
//! blocks and positions. `places` has the position of each triangle. Freed pairs and blocks are
//! reused.
//!
//! [`Bvh::update`] removes the affected leaves and all nodes above them, and builds new nodes over
//! the remaining subtrees and the new triangles. Order and splits of the old tree are kept, with
//! three exceptions. Every piece gets its own subtree, because pieces move apart. New triangles go
//! to the leaf of a neighbor. Caps, which have no neighbors, become one subtree, placed beside
//! nodes of their size. Boxes stay as tight as before, and heights near those of a fresh tree.
//! [`Bvh::refit`] joins the subtrees of pieces by place.
//!
//! Existing crates were considered. obvhs 0.4 and the BVH of parry3d 0.31 can refit, and insert and
//! remove single triangles with a walk to the root and rotations for each. Neither can splice
//! subtrees, separate pieces, or keep leaves of several triangles through an edit. obvhs also sizes
//! its traversal stack by an estimated depth, and both bring a second vector library.

mod assemble;
mod build;
mod cast;
#[cfg(feature = "serde")]
mod load;
mod morton;
mod motion_bounds;
mod nearest;
mod pieces;
mod query;
mod reach;
mod refit;
#[cfg(test)]
mod tests;
mod update;
mod validate;
mod winding;

use crate::ids::index_u32;
pub use cast::RayHit;
pub(crate) use morton::sort_along_curve;
pub use motion_bounds::MotionBounds;
pub use nearest::NearestPoint;
pub(crate) use query::Slab;
pub use reach::MovingPoint;
pub use refit::SurfaceEdits;
pub use validate::InvalidBvh;

use crate::{Aabb, Surface, TriangleId, VertexId};

/// Maximum number of triangles in a leaf: their ids and vertices fill a cache line.
const LEAF_SIZE: usize = 4;

/// Maximum height, which bounds the traversal stack.
///
/// A fresh tree has at most 31 levels. An update that would exceed the maximum rebuilds the tree.
const MAX_HEIGHT: usize = 64;

/// The null place and the null node.
const NONE: u32 = u32::MAX;

/// A bounding volume hierarchy over the triangles of a surface.
///
/// With the feature `serde`, `finish_load` must follow its `Deserialize`.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Bvh {
    /// The root, an unused node, and the children pair by pair.
    nodes: Vec<Node>,
    /// A block below each node, which determines the node's piece.
    #[cfg_attr(feature = "serde", serde(skip))]
    samples: Vec<u32>,
    /// Parent node of each pair; 0 for pair 0.
    #[cfg_attr(feature = "serde", serde(skip))]
    parents: Vec<u32>,
    free_pairs: Vec<u32>,
    blocks: Vec<Block>,
    /// Leaf node of each block.
    #[cfg_attr(feature = "serde", serde(skip))]
    leaves: Vec<u32>,
    free_blocks: Vec<u32>,
    /// Place of each triangle slot: `LEAF_SIZE * block + entry`.
    #[cfg_attr(feature = "serde", serde(skip))]
    places: Vec<u32>,
    /// Whether a box was fitted to a position that is not finite.
    #[cfg_attr(feature = "serde", serde(skip))]
    has_nonfinite: bool,
    #[cfg_attr(feature = "serde", serde(skip))]
    scratch: update::Scratch,
}

/// A bounding box and its content.
#[derive(Debug, Clone, Copy, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Node {
    #[cfg_attr(feature = "serde", serde(skip))]
    bounds: Aabb,
    /// Block of a leaf, or left child of an inner node; the right child follows it.
    index: u32,
    /// Number of levels below; 0 for a leaf.
    #[cfg_attr(feature = "serde", serde(skip))]
    height: u8,
    /// Number of triangles of a leaf.
    count: u8,
    /// Whether something below has changed since the box was fitted.
    #[cfg_attr(feature = "serde", serde(skip))]
    touched: bool,
    /// Whether it joins subtrees of different pieces.
    has_pieces: bool,
}

impl Node {
    const fn is_leaf(&self) -> bool {
        self.height == 0
    }
}

/// The triangles of a leaf with their vertices.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Block {
    triangles: [TriangleId; LEAF_SIZE],
    #[cfg_attr(feature = "serde", serde(skip))]
    corners: [[VertexId; 3]; LEAF_SIZE],
}

/// A detached subtree: its top node and that node's sample.
#[derive(Debug, Clone, Copy, Default)]
struct Part {
    node: Node,
    sample: u32,
}

impl Bvh {
    /// Returns the bounding box of all triangles.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.nodes.first().map_or_else(Aabb::default, |n| n.bounds)
    }

    /// Returns whether all positions were finite when the boxes were fitted. O(1).
    ///
    /// A position that is not finite is in no box, so queries miss its triangles. Once false, this
    /// stays false until a full refit or rebuild. Coordinates beyond 1e37 may make it false, too.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        !self.has_nonfinite
    }

    /// Returns the number of levels below the root; 0 for a single leaf or an empty BVH.
    #[must_use]
    pub fn height(&self) -> u8 {
        self.nodes.first().map_or(0, |n| n.height)
    }

    /// Returns the parent of `node`, which must not be the root.
    fn parent(&self, node: u32) -> u32 {
        self.parents[node as usize / 2]
    }

    /// Attaches a subtree at a node's place.
    fn put(&mut self, at: u32, part: Part) {
        self.nodes[at as usize] = part.node;
        self.samples[at as usize] = part.sample;
        if part.node.is_leaf() {
            self.leaves[part.node.index as usize] = at;
        } else {
            self.parents[part.node.index as usize / 2] = at;
        }
    }

    /// Allocates a pair and returns its left node.
    fn new_pair(&mut self) -> u32 {
        if let Some(pair) = self.free_pairs.pop() {
            return 2 * pair;
        }
        let left = index_u32(self.nodes.len());
        self.nodes.extend([Node::default(); 2]);
        self.samples.extend([NONE; 2]);
        self.parents.push(NONE);
        left
    }

    /// Allocates a block.
    fn new_block(&mut self) -> u32 {
        if let Some(block) = self.free_blocks.pop() {
            return block;
        }
        self.blocks.push(Block {
            triangles: [TriangleId::NULL; LEAF_SIZE],
            corners: [[VertexId::NULL; 3]; LEAF_SIZE],
        });
        self.leaves.push(NONE);
        index_u32(self.blocks.len() - 1)
    }

    /// Creates a leaf of up to four triangles.
    fn leaf(&mut self, surface: &Surface, triangles: impl Iterator<Item = TriangleId>) -> Part {
        let block = self.new_block();
        let mut node = Node {
            index: block,
            ..Node::default()
        };
        for t in triangles {
            self.add_to_leaf(&mut node, t, surface.topology().triangle(t));
        }
        node.bounds = self.fit_leaf(surface, &node);
        Part {
            node,
            sample: block,
        }
    }

    /// Appends a triangle to a leaf.
    fn add_to_leaf(&mut self, leaf: &mut Node, t: TriangleId, corners: [VertexId; 3]) {
        let (block, k) = (leaf.index as usize, leaf.count as usize);
        self.blocks[block].triangles[k] = t;
        self.blocks[block].corners[k] = corners;
        self.places[t.index()] = index_u32(LEAF_SIZE * block + k);
        leaf.count += 1;
    }

    /// Joins two subtrees under one node, whose children are stored at `pair`.
    fn join(&mut self, pair: u32, left: Part, right: Part) -> Part {
        self.put(pair, left);
        self.put(pair + 1, right);
        Part {
            node: Node {
                bounds: union(&left.node.bounds, &right.node.bounds),
                index: pair,
                height: left.node.height.max(right.node.height) + 1,
                has_pieces: left.node.has_pieces || right.node.has_pieces,
                ..Node::default()
            },
            sample: left.sample,
        }
    }

    /// Returns the box around a leaf's triangles; records positions that are not finite.
    fn fit_leaf(&mut self, surface: &Surface, leaf: &Node) -> Aabb {
        let corners = &self.blocks[leaf.index as usize].corners[..leaf.count as usize];
        // Boxes drop NaN. One vector sum is cheaper than a comparison of each coordinate.
        let mut sum = [0.0; 4];
        for &v in corners.as_flattened() {
            let position = surface.positions[v.index()];
            sum = std::array::from_fn(|k| sum[k] + position[k]);
        }
        self.has_nonfinite |= !sum[..3].iter().all(|x| x.is_finite());
        self.leaf_bounds(surface, leaf)
    }

    /// Returns the bounding box of a leaf's triangles at their current positions.
    fn leaf_bounds(&self, surface: &Surface, leaf: &Node) -> Aabb {
        let corners = &self.blocks[leaf.index as usize].corners[..leaf.count as usize];
        vertex_bounds(surface, corners.as_flattened())
    }
}

/// Returns the bounding box of a triangle.
pub(crate) fn triangle_bounds(surface: &Surface, corners: [VertexId; 3]) -> Aabb {
    vertex_bounds(surface, &corners)
}

/// Returns the bounding box of vertices.
#[inline]
fn vertex_bounds(surface: &Surface, vertices: &[VertexId]) -> Aabb {
    // All four components of a position, so that each comparison is one vector instruction.
    let (mut min, mut max) = ([f32::INFINITY; 4], [f32::NEG_INFINITY; 4]);
    for v in vertices {
        let position = surface.positions[v.index()];
        min = std::array::from_fn(|k| least(min[k], position[k]));
        max = std::array::from_fn(|k| most(max[k], position[k]));
    }
    Aabb {
        min: [min[0], min[1], min[2]],
        max: [max[0], max[1], max[2]],
    }
}

/// Returns the bounding box of two boxes.
fn union(a: &Aabb, b: &Aabb) -> Aabb {
    Aabb {
        min: std::array::from_fn(|k| least(a.min[k], b.min[k])),
        max: std::array::from_fn(|k| most(a.max[k], b.max[k])),
    }
}

// Plain comparisons compile to one instruction each. They ignore NaN, because boxes start empty; a
// tree over non-finite positions need not bound them.
fn least(x: f32, y: f32) -> f32 {
    if y < x { y } else { x }
}

fn most(x: f32, y: f32) -> f32 {
    if y > x { y } else { x }
}

/// Returns the squared diagonal of a box, the measure of its size; NaN for an empty box.
fn size(b: &Aabb) -> f32 {
    (0..3)
        .map(|k| (b.max[k] - b.min[k]) * (b.max[k] - b.min[k]))
        .sum()
}
