//! Assembles parts of an old tree to a new one.
//!
//! Parts keep their order. A range is split where the old tree was split highest, as long as the
//! height limit allows. Otherwise it is split in the middle of the weights, 2 to the power of the
//! heights. That gives nearly minimum height: at most two levels above the logarithm of all
//! weights.

use super::update::Item;
use super::{Bvh, LEAF_SIZE, Part};

/// The order of parts and their splits.
#[derive(Debug, Clone, Default)]
pub(super) struct Joints {
    keys: Vec<(u32, u64, u32)>,
    groups: Vec<Group>,
    /// Items in their new order.
    order: Vec<u32>,
    /// Split level before each item: twice the level of the old node that separated it from the
    /// previous one, plus one inside a piece.
    splits: Vec<u8>,
    /// Sum of the weights before each item.
    sums: Vec<f64>,
}

/// The items of a piece.
#[derive(Debug, Clone, Copy)]
struct Group {
    first_code: u64,
    from: usize,
    to: usize,
    /// Level of the lowest old node that contained all of them.
    level: u8,
}

impl Bvh {
    /// Assembles all items to a tree of at most height `room`, if possible.
    pub(super) fn assemble(&mut self, room: u8, items: &[Item], joints: &mut Joints) -> Part {
        joints.arrange(items);
        self.join_range(room, 0, items.len(), items, joints)
    }

    fn join_range(
        &mut self,
        room: u8,
        from: usize,
        to: usize,
        items: &[Item],
        joints: &Joints,
    ) -> Part {
        if to - from == 1 {
            return items[joints.order[from] as usize].part;
        }
        let at = joints.split(room, from, to, items);
        let pair = self.new_pair();
        let mut left = self.join_range(room.saturating_sub(1), from, at, items, joints);
        let right = self.join_range(room.saturating_sub(1), at, to, items, joints);
        let count = left.node.count + right.node.count;
        let both_leaves = left.node.is_leaf() && right.node.is_leaf();
        let same_piece = joints.splits[at] % 2 == 1;
        if both_leaves && same_piece && count as usize <= LEAF_SIZE {
            self.merge(&mut left, &right);
            self.free_pairs.push(pair / 2);
            return left;
        }
        let mut all = self.join(pair, left, right);
        all.node.has_pieces |= !same_piece;
        all
    }

    /// Merges the triangles of the second leaf into the first.
    fn merge(&mut self, left: &mut Part, right: &Part) {
        let block = self.blocks[right.node.index as usize];
        for k in 0..right.node.count as usize {
            self.add_to_leaf(&mut left.node, block.triangles[k], block.corners[k]);
        }
        left.node.bounds = super::union(&left.node.bounds, &right.node.bounds);
        self.free_blocks.push(right.node.index);
    }
}

impl Joints {
    /// Orders items by piece and, within a piece, by their old place.
    ///
    /// Pieces are ordered by their first place in the old tree.
    fn arrange(&mut self, items: &[Item]) {
        self.keys.clear();
        self.keys.extend(
            (0..)
                .zip(items)
                .map(|(i, item)| (item.piece, item.path.code, i)),
        );
        self.keys.sort_unstable();
        self.groups.clear();
        let item = |key: &(u32, u64, u32)| &items[key.2 as usize];
        let mut from = 0;
        for group in self.keys.chunk_by(|x, y| x.0 == y.0) {
            let inner = group.windows(2).map(|w| shared(item(&w[0]), item(&w[1])));
            self.groups.push(Group {
                first_code: group[0].1,
                from,
                to: from + group.len(),
                level: inner.fold(item(&group[0]).path.len, u8::min),
            });
            from += group.len();
        }
        self.groups.sort_by_key(|group| group.first_code);
        self.order.clear();
        self.splits.clear();
        let mut before: Option<&Group> = None;
        for group in &self.groups {
            let keys = &self.keys[group.from..group.to];
            self.splits.push(before.map_or(0, |before| {
                let between = shared(item(&self.keys[before.from]), item(&keys[0]));
                2 * between.min(before.level).min(group.level)
            }));
            let inner = keys.windows(2).map(|w| shared(item(&w[0]), item(&w[1])));
            self.splits.extend(inner.map(|level| 2 * level + 1));
            self.order.extend(keys.iter().map(|key| key.2));
            before = Some(group);
        }
        self.sums.clear();
        self.sums.push(0.0);
        let mut sum = 0.0;
        for &i in &self.order {
            sum += weight(items[i as usize].part.node.height);
            self.sums.push(sum);
        }
    }

    /// Returns the item before which to split a range.
    fn split(&self, room: u8, from: usize, to: usize, items: &[Item]) -> usize {
        // Splitting in the middle of the weights is at most two levels above their logarithm.
        let most = if room > 3 { weight(room - 3) } else { 0.0 };
        let alone = |i: usize| items[self.order[i] as usize].part.node.height < room;
        let mut best = (true, u8::MAX, f64::INFINITY);
        let mut at = from + 1;
        for i in from + 1..to {
            let (left, right) = (self.sums[i] - self.sums[from], self.sums[to] - self.sums[i]);
            let fits = (left <= most || i == from + 1 && alone(from))
                && (right <= most || i + 1 == to && alone(i));
            let split = if fits { self.splits[i] } else { 0 };
            let here = (!fits, split, (left - right).abs());
            if here < best {
                (best, at) = (here, i);
            }
        }
        at
    }
}

fn shared(a: &Item, b: &Item) -> u8 {
    a.path.shared(b.path)
}

/// Returns 2 to the power of a height, exactly.
fn weight(height: u8) -> f64 {
    f64::from_bits((1023 + u64::from(height)) << 52)
}
