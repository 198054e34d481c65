//! [`MotionBounds`]: a 4-wide BVH with the displacements of a frame.
//!
//! Boxes are stored as a structure of arrays, so that SIMD instructions test four at once: the
//! grandchildren of a node, or the triangles of a leaf.

use super::{Bvh, LEAF_SIZE, NONE, most, triangle_bounds, union};
use crate::ids::index_u32;
use crate::{Aabb, Surface, TriangleId};

/// Number of boxes that are tested at once.
pub(super) const LANES: usize = LEAF_SIZE;

/// Boxes, displacements and pieces of the triangles below each node of a BVH.
#[derive(Debug, Clone, Default)]
pub struct MotionBounds {
    /// The root, `None` without triangles.
    pub(super) root: Option<Child>,
    /// Bounds of the root.
    pub(super) all: Motion,
    /// Children of nodes and of their children.
    pub(super) quads: Vec<Quad>,
    /// By block: its triangles.
    pub(super) leaves: Vec<Lanes>,
    /// By node: the piece of all triangles below it; [`NONE`] for several pieces.
    pieces: Vec<u32>,
}

/// The motion of triangles.
#[derive(Debug, Clone, Copy)]
pub(super) struct Motion {
    pub(super) bounds: Aabb,
    /// Maximum displacement of the vertices along each axis, in either direction \[m\].
    pub(super) displacement: [f32; 3],
    /// Piece of all triangles; [`NONE`] for several pieces.
    pub(super) piece: u32,
}

impl Default for Motion {
    fn default() -> Self {
        Self {
            bounds: Aabb::default(),
            displacement: [0.0; 3],
            piece: NONE,
        }
    }
}

impl Motion {
    fn of_triangle(surface: &Surface, t: TriangleId, displacements: &[[f32; 3]]) -> Self {
        let corners = surface.topology().triangle(t);
        let displacements = corners.map(|v| displacements[v.index()].map(f32::abs));
        Self {
            bounds: triangle_bounds(surface, corners),
            displacement: displacements.into_iter().fold([0.0; 3], greatest),
            piece: surface.piece(t),
        }
    }

    fn union(&self, other: &Self) -> Self {
        Self {
            bounds: union(&self.bounds, &other.bounds),
            displacement: greatest(self.displacement, other.displacement),
            piece: if self.piece == other.piece {
                self.piece
            } else {
                NONE
            },
        }
    }
}

/// Returns the greater of two values along each axis; a NaN in `b` is ignored.
fn greatest(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [0, 1, 2].map(|k| most(a[k], b[k]))
}

/// A node below which a search may descend: the index of a quad, or the block of a leaf.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Child(u32);

impl Child {
    const NONE: Self = Self(NONE);

    /// Creates the reference to a leaf.
    fn leaf(block: u32) -> Self {
        Self(2 * block + 1)
    }

    /// Creates the reference to a quad.
    fn quad(index: usize) -> Self {
        Self(2 * index_u32(index))
    }

    /// Returns the quad or leaf.
    pub(super) fn target(self) -> Target {
        let index = self.0 as usize / 2;
        if self.0 % 2 == 1 {
            Target::Leaf(index)
        } else {
            Target::Quad(index)
        }
    }
}

/// A [`Child`], decoded.
pub(super) enum Target {
    /// Index of a quad.
    Quad(usize),
    /// Block of a leaf.
    Leaf(usize),
}

/// A node of the 4-wide BVH.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
pub(super) struct Quad {
    pub(super) lanes: Lanes,
    pub(super) children: [Child; LANES],
}

/// The motions of four nodes or triangles, by axis and lane; bounds by corner first.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lanes {
    pub(super) bounds: [[[f32; LANES]; 3]; 2],
    /// Maximum displacement in either direction \[m\].
    pub(super) displacement: [[f32; LANES]; 3],
    pub(super) pieces: [u32; LANES],
}

impl Lanes {
    const NOTHING: Self = Self {
        bounds: [[[f32::INFINITY; LANES]; 3], [[f32::NEG_INFINITY; LANES]; 3]],
        displacement: [[0.0; LANES]; 3],
        pieces: [NONE; LANES],
    };

    /// Sets one lane.
    pub(super) fn set(&mut self, lane: usize, motion: &Motion) {
        let Motion {
            bounds,
            displacement,
            ..
        } = motion;
        for (k, &c) in displacement.iter().enumerate() {
            self.bounds[0][k][lane] = bounds.min[k];
            self.bounds[1][k][lane] = bounds.max[k];
            self.displacement[k][lane] = c;
        }
        self.pieces[lane] = motion.piece;
    }

    /// Returns the maximum displacement of one lane along each axis \[m\].
    pub(super) fn displacement(&self, lane: usize) -> [f32; 3] {
        self.displacement.map(|c| c[lane])
    }
}

impl MotionBounds {
    /// Computes the bounds of a BVH's nodes from the displacements of vertex slots in the frame, at
    /// their present velocities \[m\]. O(n).
    ///
    /// Valid until vertices move or the BVH is updated or rebuilt.
    pub fn find(&mut self, bvh: &Bvh, surface: &Surface, displacements: &[[f32; 3]]) {
        self.quads.clear();
        self.leaves.resize(bvh.blocks.len(), Lanes::NOTHING);
        self.pieces.resize(bvh.nodes.len(), NONE);
        (self.root, self.all) = if bvh.nodes.is_empty() {
            (None, Motion::default())
        } else {
            let (root, all) = self.find_below(bvh, surface, displacements, 0);
            (Some(root), all)
        };
    }

    /// Returns the capacity, in quads, leaves and nodes.
    #[must_use]
    pub fn capacity(&self) -> usize {
        self.quads.capacity() + self.leaves.capacity() + self.pieces.capacity()
    }

    /// Returns the piece of all triangles below a node, `None` for several pieces.
    #[inline]
    pub(super) fn piece_below(&self, node: u32) -> Option<u32> {
        let piece = self.pieces[node as usize];
        (piece != NONE).then_some(piece)
    }

    /// Computes the bounds of a node and of all nodes below it.
    fn find_below(
        &mut self,
        bvh: &Bvh,
        surface: &Surface,
        displacements: &[[f32; 3]],
        at: u32,
    ) -> (Child, Motion) {
        let node = &bvh.nodes[at as usize];
        let found = if node.is_leaf() {
            (
                Child::leaf(node.index),
                self.find_leaf(bvh, surface, displacements, node.index, node.count),
            )
        } else {
            // In the order of a traversal.
            let index = self.quads.len();
            let mut quad = Quad {
                lanes: Lanes::NOTHING,
                children: [Child::NONE; LANES],
            };
            self.quads.push(quad);
            let mut lane = 0;
            let mut add = |bounds: &mut Self, at| {
                let (child, motion) = bounds.find_below(bvh, surface, displacements, at);
                quad.lanes.set(lane, &motion);
                quad.children[lane] = child;
                lane += 1;
                motion
            };
            let [left, right] = [node.index, node.index + 1].map(|child| {
                let below = &bvh.nodes[child as usize];
                if below.is_leaf() {
                    return add(self, child);
                }
                let both = add(self, below.index).union(&add(self, below.index + 1));
                self.pieces[child as usize] = both.piece;
                both
            });
            self.quads[index] = quad;
            (Child::quad(index), left.union(&right))
        };
        self.pieces[at as usize] = found.1.piece;
        found
    }

    /// Computes the bounds of the triangles of a leaf.
    fn find_leaf(
        &mut self,
        bvh: &Bvh,
        surface: &Surface,
        displacements: &[[f32; 3]],
        block: u32,
        count: u8,
    ) -> Motion {
        let triangles = &bvh.blocks[block as usize].triangles[..count as usize];
        let mut lanes = Lanes::NOTHING;
        let each = triangles.iter().enumerate().map(|(lane, &t)| {
            let motion = Motion::of_triangle(surface, t, displacements);
            lanes.set(lane, &motion);
            motion
        });
        let all = each.reduce(|a, b| a.union(&b)).unwrap_or_default();
        self.leaves[block as usize] = lanes;
        all
    }
}
