//! A bounding volume hierarchy over the triangles of a surface.
//!
//! Nodes stand in one array, each parent before its children and the right child last: a node's
//! left child follows it, `index` says where its right child is. A leaf has a range of `order` and
//! of `corners`, which stand side by side so that a refit reads them in one sweep.

mod build;
mod query;
mod refit;
mod validate;

pub use validate::InvalidBvh;

use incise_mesh::{Aabb, Surface, TriangleId, VertexId};

/// The most triangles in a leaf. Four keeps the tree small and a leaf's test within one cache line of ids.
const LEAF_SIZE: usize = 4;

/// A search tree over triangles by their boxes.
#[derive(Debug, Clone, Default)]
pub struct Bvh {
    nodes: Vec<Node>,
    order: Vec<TriangleId>,
    /// The vertices of the triangles in `order`.
    corners: Vec<[VertexId; 3]>,
}

/// The box around a triangle.
fn triangle_bounds(surface: &Surface, corners: [VertexId; 3]) -> Aabb {
    let [a, b, c] = corners.map(|v| surface.positions[v.index()]);
    // Plain comparisons: a tree over positions that are not finite need not bound them.
    let least = |x: f32, y: f32| if y < x { y } else { x };
    let most = |x: f32, y: f32| if y > x { y } else { x };
    Aabb {
        min: std::array::from_fn(|k| least(least(a[k], b[k]), c[k])),
        max: std::array::from_fn(|k| most(most(a[k], b[k]), c[k])),
    }
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
