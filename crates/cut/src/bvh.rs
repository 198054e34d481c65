//! A bounding volume hierarchy over the triangles of a surface.
//!
//! Nodes stand in one array, each parent before its children and the right child last: a node's
//! left child follows it, `right` says where its right child is. A leaf has a range of `order`.

mod build;
mod query;
mod refit;
mod validate;

pub use validate::InvalidBvh;

use incise_mesh::{Aabb, TriangleId};

/// The most triangles in a leaf. Four keeps the tree small and a leaf's test within one cache line of ids.
const LEAF_SIZE: usize = 4;

/// A search tree over triangles by their boxes.
#[derive(Debug, Clone, Default)]
pub struct Bvh {
    nodes: Vec<Node>,
    order: Vec<TriangleId>,
}

/// A box and what is in it.
#[derive(Debug, Clone, Copy)]
struct Node {
    bounds: Aabb,
    /// For a leaf the first of its triangles in `order`, else the right child.
    index: u32,
    /// How many triangles a leaf has; 0 marks an inner node.
    count: u32,
}
