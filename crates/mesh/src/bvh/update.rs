//! Local update of a BVH after a cut: affected nodes are removed, [`super::assemble`] joins the
//! rest.

use super::{Bvh, LEAF_SIZE, MAX_HEIGHT, NONE, Part, morton, size, triangle_bounds, union};
use crate::{Aabb, Surface, TopologyDelta, TriangleId};

/// Place of a new triangle without a leaf yet.
const PENDING: u32 = NONE - 1;
/// Place of a new triangle that goes to a neighbor's leaf.
const HOMED: u32 = NONE - 2;
/// Maximum distance, in triangles, of a new triangle from the old one whose leaf it joins.
///
/// Split triangles and the rim of a cap are that close.
const REACH: usize = 3;
/// Maximum number of batches of a piece: enough to attach parts of a cap beside near leaves.
const BATCHES: usize = 64;
/// Number of levels below an untouched node in which triangles of another piece are searched.
const LOOK: u32 = 3;
/// Maximum height above a perfect tree before the tree is rebalanced.
const SLACK: u8 = 8;

/// A part of the tree to be joined again.
#[derive(Debug, Clone, Copy)]
pub(super) struct Item {
    pub(super) piece: u32,
    pub(super) path: Path,
    pub(super) part: Part,
}

/// The path from the root to an item of the old tree, one bit for each turn, from the top.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Path {
    pub(super) code: u64,
    pub(super) len: u8,
}

/// Scratch memory of an update.
#[derive(Debug, Clone, Default)]
pub(super) struct Scratch {
    pub(super) curve: morton::Curve,
    pub(super) sorted: Vec<TriangleId>,
    /// New triangles by the block that they join.
    homes: Vec<(u32, TriangleId)>,
    /// New triangles that join no block, by piece.
    rest: Vec<(u32, TriangleId)>,
    /// The same along a Morton curve in each piece.
    along: Vec<TriangleId>,
    /// Batches of neighboring new triangles of one piece, beside nodes of their size.
    batches: Vec<Item>,
    stack: Vec<(u32, Path)>,
    /// Pieces that were split and their parts, ascending.
    split: Vec<u32>,
    /// Triangles of leaves to be created, by piece.
    loose: Vec<(u32, TriangleId)>,
    /// Items to be created from a range of `loose`.
    runs: Vec<(usize, usize, usize)>,
    pub(super) items: Vec<Item>,
    pub(super) joints: super::assemble::Joints,
    pub(super) pieces: super::pieces::Pieces,
}

impl Bvh {
    /// Updates the BVH after an edit. O(k log n) for k triangles removed and added.
    ///
    /// Rebuilds only if they are half of all triangles. The BVH must have been fitted before. Boxes
    /// of other triangles are not refitted, see [`Self::refit_moved`].
    pub fn update(&mut self, surface: &Surface, delta: &TopologyDelta) {
        let changed = delta.triangles_removed.len() + delta.triangles_added.len();
        if changed == 0 {
            return;
        }
        if self.nodes.is_empty() || 2 * changed > surface.topology().triangle_count() {
            self.rebuild(surface);
            return;
        }
        for &(t, _) in &delta.triangles_removed {
            self.remove(t);
        }
        self.follow(surface, &delta.triangles_added, &delta.pieces_added);
    }

    /// Adds triangles, in ascending order, and removes touched nodes.
    pub(super) fn follow(
        &mut self,
        surface: &Surface,
        added: &[TriangleId],
        pieces_added: &[(u32, u32)],
    ) {
        let mut scratch = std::mem::take(&mut self.scratch);
        self.places
            .resize(surface.topology().triangle_slots(), NONE);
        self.find_homes(surface, added, &mut scratch);
        self.find_batches(surface, added, &mut scratch);
        let perfect = surface.topology().triangle_count().ilog2();
        let room = u8::try_from(perfect).map_or(u8::MAX, |levels| levels + SLACK);
        scratch.split.clear();
        let split = pieces_added.iter();
        (scratch.split).extend(split.flat_map(|&(new, parent)| [new, parent]));
        scratch.split.sort_unstable();
        self.take_apart(surface, room - SLACK / 2, &mut scratch);
        self.make_leaves(surface, &mut scratch);
        let root = self.assemble(room, &scratch.items, &mut scratch.joints);
        self.put(0, root);
        self.scratch = scratch;
        if root.node.height as usize > MAX_HEIGHT {
            self.rebuild(surface);
        }
    }

    /// Returns the leaf of a triangle, if it has one.
    pub(super) fn leaf_of(&self, t: TriangleId) -> Option<u32> {
        let place = self.places.get(t.index()).copied().unwrap_or(NONE);
        (place < HOMED).then(|| self.leaves[place as usize / LEAF_SIZE])
    }

    /// Removes a triangle from its leaf; the last triangle of the leaf takes its place.
    pub(super) fn remove(&mut self, t: TriangleId) {
        let Some(leaf) = self.leaf_of(t) else { return };
        self.touch(leaf);
        let place = std::mem::replace(&mut self.places[t.index()], NONE);
        let node = &mut self.nodes[leaf as usize];
        node.count -= 1;
        let (last, k) = (node.count as usize, place as usize % LEAF_SIZE);
        if k != last {
            let block = &mut self.blocks[node.index as usize];
            block.triangles[k] = block.triangles[last];
            block.corners[k] = block.corners[last];
            self.places[block.triangles[k].index()] = place;
        }
    }

    /// Assigns new triangles to the leaves of near old ones, unless they are too large.
    fn find_homes(&mut self, surface: &Surface, added: &[TriangleId], scratch: &mut Scratch) {
        let topology = surface.topology();
        let neighbors = |t: TriangleId| {
            let twins = t.half_edges().into_iter().map(|h| topology.twin(h));
            twins.filter(|h| !h.is_null()).map(|h| h.triangle())
        };
        let homes = &mut scratch.homes;
        homes.clear();
        for &t in added {
            if self.places[t.index()] == NONE {
                self.places[t.index()] = PENDING;
            }
        }
        for &t in added {
            if self.places[t.index()] == PENDING
                && let Some(block) = neighbors(t)
                    .filter_map(|u| self.leaf_of(u))
                    .map(|leaf| self.nodes[leaf as usize].index)
                    .find(|&block| self.suits(surface, block, t))
            {
                self.places[t.index()] = HOMED;
                homes.push((block, t));
            }
        }
        let mut from = 0;
        for _ in 1..REACH {
            let to = homes.len();
            for i in from..to {
                let (block, t) = homes[i];
                for u in neighbors(t) {
                    if self.places[u.index()] == PENDING && self.suits(surface, block, u) {
                        self.places[u.index()] = HOMED;
                        homes.push((block, u));
                    }
                }
            }
            from = to;
        }
        homes.sort_unstable();
        for i in 0..homes.len() {
            if i == 0 || homes[i].0 != homes[i - 1].0 {
                self.touch(self.leaves[homes[i].0 as usize]);
            }
        }
    }

    /// Returns whether a triangle is small enough for a leaf.
    fn suits(&self, surface: &Surface, block: u32, t: TriangleId) -> bool {
        let leaf = &self.nodes[self.leaves[block as usize] as usize];
        let corners = surface.topology().triangle(t);
        size(&triangle_bounds(surface, corners)) <= size(&leaf.bounds)
    }

    /// Builds subtrees of batches of the remaining new triangles along a curve, and finds siblings
    /// of their size.
    fn find_batches(&mut self, surface: &Surface, added: &[TriangleId], scratch: &mut Scratch) {
        let Scratch {
            curve,
            rest,
            along,
            batches,
            ..
        } = scratch;
        rest.clear();
        along.clear();
        batches.clear();
        let pending = added.iter().filter(|t| self.places[t.index()] == PENDING);
        rest.extend(pending.map(|&t| (surface.piece(t), t)));
        // Ids ascend already, so a stable sort finds one run for each piece.
        rest.sort();
        for of_piece in rest.chunk_by(|x, y| x.0 == y.0) {
            let first = along.len();
            along.extend(of_piece.iter().map(|&(_, t)| t));
            curve.sort(surface, &mut along[first..]);
            let length = of_piece.len().div_ceil(BATCHES);
            for batch in along[first..].chunks(length) {
                let part = self.plant(surface, batch);
                let (beside, path) = self.spot(&part.node.bounds);
                if beside != 0 {
                    self.touch(self.parent(beside));
                }
                let piece = of_piece[0].0;
                batches.push(Item { piece, path, part });
            }
        }
    }

    /// Returns the sibling node for something with box `bounds`, and the path behind its content.
    ///
    /// Descends where the box grows least, while nodes are at least as large.
    fn spot(&self, bounds: &Aabb) -> (u32, Path) {
        let (mut at, mut path) = (0, Path::default());
        loop {
            let node = &self.nodes[at as usize];
            let children = [node.index, node.index + 1];
            let growth = |child: u32| {
                let old = &self.nodes[child as usize].bounds;
                size(&union(old, bounds)) - size(old)
            };
            let turn = usize::from(!node.is_leaf() && growth(children[1]) < growth(children[0]));
            let child = children[turn];
            if node.is_leaf() || size(&self.nodes[child as usize].bounds) < size(bounds) {
                let all = u64::MAX.checked_shr(u32::from(path.len)).unwrap_or(0);
                path.code |= all;
                return (at, path);
            }
            path = path.child(turn);
            at = child;
        }
    }

    /// Removes touched nodes, and nodes above height `limit`.
    ///
    /// Untouched subtrees below become items; triangles of touched leaves and new ones become
    /// loose. Near a cut, nodes with triangles of several pieces are removed as well, because they
    /// would span the gap.
    fn take_apart(&mut self, surface: &Surface, limit: u8, scratch: &mut Scratch) {
        let Scratch {
            homes,
            stack,
            split,
            loose,
            runs,
            items,
            ..
        } = scratch;
        loose.clear();
        runs.clear();
        items.clear();
        stack.clear();
        stack.push((0, Path::default()));
        while let Some((at, path)) = stack.pop() {
            let node = self.nodes[at as usize];
            let sample = self.samples[at as usize];
            let is_whole = !node.touched && (node.is_leaf() || node.height <= limit);
            // The sample of a touched node may be gone.
            let piece = is_whole.then(|| surface.piece(self.blocks[sample as usize].triangles[0]));
            let is_mixed = |piece: u32| {
                split.binary_search(&piece).is_ok() && self.has_others(surface, at, piece, LOOK)
            };
            if let Some(piece) = piece.filter(|&piece| !is_mixed(piece)) {
                items.push(Item {
                    piece,
                    path,
                    part: Part { node, sample },
                });
            } else if node.is_leaf() {
                let block = node.index;
                let from = loose.len();
                let own = &self.blocks[block as usize].triangles[..node.count as usize];
                let first = homes.partition_point(|home| home.0 < block);
                let new = homes[first..].iter().take_while(|home| home.0 == block);
                let all = own.iter().copied().chain(new.map(|home| home.1));
                loose.extend(all.map(|t| (surface.piece(t), t)));
                loose[from..].sort_unstable();
                self.free_blocks.push(block);
                for_pieces(loose, from, loose.len(), |piece, from, to| {
                    runs.push((items.len(), from, to));
                    items.push(Item::to_be(piece, path));
                });
            } else {
                self.free_pairs.push(node.index / 2);
                stack.push((node.index + 1, path.child(1)));
                stack.push((node.index, path.child(0)));
            }
        }
    }

    /// Returns whether a node has triangles of other pieces.
    ///
    /// Looks at leaves a few levels below and at samples of higher nodes only.
    fn has_others(&self, surface: &Surface, at: u32, piece: u32, levels: u32) -> bool {
        let node = &self.nodes[at as usize];
        let is_other = |&t: &TriangleId| surface.piece(t) != piece;
        if node.is_leaf() {
            let block = &self.blocks[node.index as usize];
            return block.triangles[..node.count as usize].iter().any(is_other);
        }
        if levels == 0 {
            let sample = self.samples[at as usize] as usize;
            return is_other(&self.blocks[sample].triangles[0]);
        }
        [node.index, node.index + 1]
            .into_iter()
            .any(|child| self.has_others(surface, child, piece, levels - 1))
    }

    /// Creates the parts of loose triangles, and adds the batches to the items.
    fn make_leaves(&mut self, surface: &Surface, scratch: &mut Scratch) {
        let sorted = &mut scratch.sorted;
        for &(item, from, to) in &scratch.runs {
            sorted.clear();
            sorted.extend(scratch.loose[from..to].iter().map(|&(_, t)| t));
            if sorted.len() > LEAF_SIZE {
                scratch.curve.sort(surface, sorted);
            }
            scratch.items[item].part = self.plant(surface, sorted);
        }
        scratch.items.extend_from_slice(&scratch.batches);
    }
}

/// Calls `with` for each range of one piece.
fn for_pieces(
    loose: &[(u32, TriangleId)],
    mut from: usize,
    to: usize,
    mut with: impl FnMut(u32, usize, usize),
) {
    for run in loose[from..to].chunk_by(|x, y| x.0 == y.0) {
        with(run[0].0, from, from + run.len());
        from += run.len();
    }
}

impl Item {
    fn to_be(piece: u32, path: Path) -> Self {
        Self {
            piece,
            path,
            part: Part::default(),
        }
    }
}

impl Path {
    /// Returns the path one level further down, to the left (0) or right.
    fn child(self, turn: usize) -> Self {
        let bit = (1_u64 << 63).checked_shr(u32::from(self.len)).unwrap_or(0);
        Self {
            code: self.code | if turn == 0 { 0 } else { bit },
            len: self.len + 1,
        }
    }

    /// Returns the number of common turns of two paths.
    pub(super) fn shared(self, other: Self) -> u8 {
        let same = u8::try_from((self.code ^ other.code).leading_zeros()).unwrap_or(u8::MAX);
        same.min(self.len).min(other.len)
    }
}
