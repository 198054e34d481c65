//! Adds the constraints of new edges, and missing ones of changed edges.
//!
//! New edges are processed in blocks. The rest values of a block are computed before its
//! constraints are inserted, so that arithmetic and memory accesses do not wait for each other.

use crate::constraints::batches::ConstraintSet;
use crate::constraints::edges::{EdgeId, EdgeLists, EdgeTable, NewEdge, PackedSlot, Sets};
use crate::constraints::rest;
use crate::patches::{Home, Patches};
use incise_mesh::{Surface, VertexId};

/// Edges per block; a block fits in the L1 cache.
const BLOCK: usize = 64;

impl EdgeTable {
    /// Adds the missing constraints of the listed edges, in the order of the lists.
    pub(crate) fn add_missing(
        &mut self,
        lists: &EdgeLists,
        surface: &Surface,
        sets: &mut Sets<'_>,
    ) {
        // Without patches no edge has a home.
        let home = |i: usize| lists.homes.get(i).copied().unwrap_or(Home::BODY);
        for (i, &edge) in lists.changed.iter().enumerate() {
            self.add_missing_of(edge, home(i), surface, sets);
        }
        let bends = sets.bending.is_some();
        let mut rest = [(0.0, 0.0); BLOCK];
        let mut next = lists.changed.len();
        for block in lists.added.chunks(BLOCK) {
            for (rest, new) in rest.iter_mut().zip(block) {
                *rest = rest_values(new, surface, bends);
            }
            for (new, (length, angle)) in block.iter().zip(rest) {
                let &NewEdge { edge, vertices } = new;
                let [low, high, ..] = vertices;
                let own = home(next);
                next += 1;
                let mut of_ends = own;
                let mut bending = PackedSlot::NONE;
                if let Some(set) = &mut sets.bending
                    && new.is_hinge()
                {
                    of_ends = home_of_ends(own, [low, high], sets.patches.as_deref());
                    bending = insert(set, &mut sets.patches, own, vertices, angle, edge);
                }
                let patches = &mut sets.patches;
                let stretch = insert(sets.stretch, patches, of_ends, [low, high], length, edge);
                self.set_slots(edge, Some(stretch), Some(bending));
            }
        }
    }

    /// Adds the missing constraints of one edge, the largest of which belongs to `home`.
    fn add_missing_of(&mut self, edge: EdgeId, home: Home, surface: &Surface, sets: &mut Sets<'_>) {
        let record = *self.record(edge);
        let (mut stretch, mut bending) = (None, None);
        if record.stretch().is_none()
            && let Some((ends, length)) = record.expected_stretch(surface)
        {
            let home = home_of_ends(home, ends, sets.patches.as_deref());
            let patches = &mut sets.patches;
            stretch = Some(insert(sets.stretch, patches, home, ends, length, edge));
        }
        if let Some(set) = &mut sets.bending
            && record.bending().is_none()
            && let Some((vertices, angle)) = record.expected_bending(surface)
        {
            let patches = &mut sets.patches;
            bending = Some(insert(set, patches, home, vertices, angle, edge));
        }
        self.set_slots(edge, stretch, bending);
    }
}

/// Returns the home of the ends of an edge whose largest constraint belongs to `home`.
#[inline]
fn home_of_ends(home: Home, ends: [VertexId; 2], patches: Option<&Patches>) -> Home {
    match patches {
        Some(patches) if home.layer != 1 => patches.home_of(&ends),
        _ => home,
    }
}

/// Returns the rest length, and with bending the rest angle between two triangles.
#[inline]
fn rest_values(new: &NewEdge, surface: &Surface, bends: bool) -> (f32, f32) {
    let [low, high, ..] = new.vertices;
    if bends && new.is_hinge() {
        rest::length_and_angle(surface, new.vertices)
    } else {
        (rest::length(surface, [low, high]), 0.0)
    }
}

/// Inserts a constraint of an edge into the layer of its home and returns its slot.
#[inline]
fn insert<const N: usize>(
    set: &mut ConstraintSet<N>,
    patches: &mut Option<&mut Patches>,
    home: Home,
    vertices: [VertexId; N],
    rest: f32,
    edge: EdgeId,
) -> PackedSlot {
    let slot = set.insert_in(home.layer as usize, vertices, rest, edge);
    if let Some(patches) = patches
        && slot.layer() == home.layer as usize
    {
        patches.mark_gain(home);
    }
    PackedSlot::new(slot)
}
