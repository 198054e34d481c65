//! A bounding volume hierarchy over the triangles of a surface, which follows a cut locally.
//!
//! Nodes stand in one array, two children side by side (a pair), the root alone in pair 0. A leaf
//! has a block of up to four triangles: ids and vertices in one cache line, so that a refit reads
//! blocks and positions and nothing else. `places` says where a triangle stands. Pairs and blocks
//! that fall free are used again.
//!
//! [`Bvh::update`] takes the touched leaves and all nodes above them apart, and joins what is left
//! of them anew: the subtrees that nothing touched, one by one, and the new triangles. The order of
//! the old tree is kept and so are its splits, but for three things: every piece gets a subtree of
//! its own, since pieces move apart; new triangles go to the leaf of their neighbor; caps, which
//! have none, come as one subtree where the tree is as large as they are. So boxes stay as tight as
//! those of the tree before, and heights stay near those of a fresh tree.
//!
//! Why not a crate: obvhs 0.4 and the tree of parry3d 0.31 have refits, and both can insert and remove
//! one triangle at a time, each with a walk to the root and a rotation on the way (a cap of 400,000
//! triangles is as many walks); neither splices a subtree, separates pieces or keeps several
//! triangles of a leaf through an edit. obvhs sets its stack aside for a depth that it estimates,
//! and both bring a second vector library with them.

mod assemble;
mod build;
mod cast;
mod morton;
mod nearest;
mod query;
mod refit;
#[cfg(test)]
mod tests;
mod update;
mod validate;

pub use cast::RayHit;
pub use nearest::{NearestPoint, NodeReaches};
pub use validate::InvalidBvh;

use incise_mesh::{Aabb, Surface, TriangleId, VertexId};

/// The most triangles in a leaf: as many as fill a cache line with their ids and vertices.
const LEAF_SIZE: usize = 4;

/// No tree is higher: the most pairs that a query has to come back to. A fresh tree has at most 31
/// levels, and an update that would pass this builds the tree anew.
const MAX_HEIGHT: usize = 64;

/// No place, no node.
const NONE: u32 = u32::MAX;

/// A search tree over triangles by their boxes.
#[derive(Debug, Clone, Default)]
pub struct Bvh {
    /// The root, a gap, and the children of others pair by pair.
    nodes: Vec<Node>,
    /// A block somewhere below each node: a node's piece is that of what it holds.
    samples: Vec<u32>,
    /// The node whose children a pair is; of pair 0, nobody's, 0.
    parents: Vec<u32>,
    free_pairs: Vec<u32>,
    blocks: Vec<Block>,
    /// The leaf of each block.
    leaves: Vec<u32>,
    free_blocks: Vec<u32>,
    /// Where each triangle slot stands: `LEAF_SIZE * block + entry`.
    places: Vec<u32>,
    scratch: update::Scratch,
}

/// A box and what is in it.
#[derive(Debug, Clone, Copy, Default)]
struct Node {
    bounds: Aabb,
    /// The block of a leaf, else the left child; the right one follows it.
    index: u32,
    /// Levels below; 0 for a leaf.
    height: u8,
    /// How many triangles a leaf has.
    count: u8,
    /// Whether something below has changed and the node does not know yet.
    touched: bool,
}

impl Node {
    const fn is_leaf(&self) -> bool {
        self.height == 0
    }
}

/// The triangles of a leaf with their vertices.
#[derive(Debug, Clone, Copy)]
struct Block {
    triangles: [TriangleId; LEAF_SIZE],
    corners: [[VertexId; 3]; LEAF_SIZE],
}

/// A subtree that hangs nowhere: its top node and that node's sample.
#[derive(Debug, Clone, Copy, Default)]
struct Part {
    node: Node,
    sample: u32,
}

impl Bvh {
    /// The box around everything.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.nodes.first().map_or_else(Aabb::default, |n| n.bounds)
    }

    /// The node above `node`, which is not the root.
    fn parent(&self, node: u32) -> u32 {
        self.parents[node as usize / 2]
    }

    /// Hangs a subtree in at a node's place.
    fn put(&mut self, at: u32, part: Part) {
        self.nodes[at as usize] = part.node;
        self.samples[at as usize] = part.sample;
        if part.node.is_leaf() {
            self.leaves[part.node.index as usize] = at;
        } else {
            self.parents[part.node.index as usize / 2] = at;
        }
    }

    /// The left node of a free pair.
    fn new_pair(&mut self) -> u32 {
        if let Some(pair) = self.free_pairs.pop() {
            return 2 * pair;
        }
        let left = id(self.nodes.len());
        self.nodes.extend([Node::default(); 2]);
        self.samples.extend([NONE; 2]);
        self.parents.push(NONE);
        left
    }

    /// A free block.
    fn new_block(&mut self) -> u32 {
        if let Some(block) = self.free_blocks.pop() {
            return block;
        }
        self.blocks.push(Block {
            triangles: [TriangleId::NULL; LEAF_SIZE],
            corners: [[VertexId::NULL; 3]; LEAF_SIZE],
        });
        self.leaves.push(NONE);
        id(self.blocks.len() - 1)
    }

    /// A leaf of up to four triangles.
    fn leaf(&mut self, surface: &Surface, triangles: impl Iterator<Item = TriangleId>) -> Part {
        let block = self.new_block();
        let mut node = Node {
            index: block,
            ..Node::default()
        };
        for t in triangles {
            self.add_to_leaf(&mut node, t, surface.topology().triangle(t));
        }
        node.bounds = self.leaf_bounds(surface, &node);
        Part {
            node,
            sample: block,
        }
    }

    /// Writes a triangle behind those that a leaf has.
    fn add_to_leaf(&mut self, leaf: &mut Node, t: TriangleId, corners: [VertexId; 3]) {
        let (block, k) = (leaf.index as usize, leaf.count as usize);
        self.blocks[block].triangles[k] = t;
        self.blocks[block].corners[k] = corners;
        self.places[t.index()] = id(LEAF_SIZE * block + k);
        leaf.count += 1;
    }

    /// Two subtrees under one node, whose children stand at `pair`.
    fn join(&mut self, pair: u32, left: Part, right: Part) -> Part {
        self.put(pair, left);
        self.put(pair + 1, right);
        Part {
            node: Node {
                bounds: union(&left.node.bounds, &right.node.bounds),
                index: pair,
                height: left.node.height.max(right.node.height) + 1,
                ..Node::default()
            },
            sample: left.sample,
        }
    }

    /// The box around a leaf's triangles where they are now.
    fn leaf_bounds(&self, surface: &Surface, leaf: &Node) -> Aabb {
        let corners = &self.blocks[leaf.index as usize].corners[..leaf.count as usize];
        (corners.iter()).fold(Aabb::default(), |b, &c| {
            union(&b, &triangle_bounds(surface, c))
        })
    }
}

/// The box around a triangle.
fn triangle_bounds(surface: &Surface, corners: [VertexId; 3]) -> Aabb {
    let [a, b, c] = corners.map(|v| surface.positions[v.index()]);
    Aabb {
        min: std::array::from_fn(|k| least(least(a[k], b[k]), c[k])),
        max: std::array::from_fn(|k| most(most(a[k], b[k]), c[k])),
    }
}

/// The box around two.
fn union(a: &Aabb, b: &Aabb) -> Aabb {
    Aabb {
        min: std::array::from_fn(|k| least(a.min[k], b.min[k])),
        max: std::array::from_fn(|k| most(a.max[k], b.max[k])),
    }
}

// Plain comparisons, one instruction each: a tree over positions that are not finite need not bound
// them. Of two numbers one of which is none, the first is kept; boxes begin empty, so they stay numbers.
fn least(x: f32, y: f32) -> f32 {
    if y < x { y } else { x }
}

fn most(x: f32, y: f32) -> f32 {
    if y > x { y } else { x }
}

/// The square of a box's diagonal: what its size is judged by. Of an empty box, not a number.
fn size(b: &Aabb) -> f32 {
    (0..3)
        .map(|k| (b.max[k] - b.min[k]) * (b.max[k] - b.min[k]))
        .sum()
}

fn id(i: usize) -> u32 {
    u32::try_from(i).expect("a tree has fewer than 2^32 triangles and nodes")
}
