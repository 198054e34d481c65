//! Table of the constraints of every edge, for edits.
//!
//! The paper's Algorithm A1 finds the constraints of deleted edges by scanning. Here every
//! half-edge has the index of its edge's record, so an edit costs a few array accesses per changed
//! edge.

#[cfg(feature = "serde")]
mod load;

use crate::constraints::batches::{BendingSet, ConstraintSet, Slot, StretchSet, edit_reserve};
use crate::constraints::rest;
use crate::patches::{Home, Patches};
use incise_mesh::{HalfEdge, Surface, Topology, TriangleId, VertexId, index_u32};

/// No record, or no slot.
const NONE: u32 = u32::MAX;

/// Index of an edge's record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct EdgeId(u32);

impl EdgeId {
    /// For constraints that belong to no edge.
    pub(crate) const NONE: Self = Self(NONE);
    #[cfg(test)]
    pub(crate) const TEST: Self = Self(0);
}

/// An optional [`Slot`] in 8 bytes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PackedSlot {
    color: u32,
    index: u32,
}

impl PackedSlot {
    pub(crate) const NONE: Self = Self {
        color: NONE,
        index: NONE,
    };

    pub(crate) fn new(slot: Slot) -> Self {
        Self {
            color: index_u32(slot.color),
            index: index_u32(slot.index),
        }
    }

    fn slot(self) -> Option<Slot> {
        (self.color != NONE).then_some(Slot {
            color: self.color as usize,
            index: self.index as usize,
        })
    }
}

/// Triangles and constraints of one edge.
#[derive(Debug, Clone, Copy)]
pub(crate) struct EdgeRecord {
    /// The half-edge from the smaller vertex id to the larger one, and the one back; null where
    /// there is none.
    sides: [HalfEdge; 2],
    stretch: PackedSlot,
    bending: PackedSlot,
    /// Index in [`EdgeLists::added`], [`CHANGED`] in the other list, [`NONE`] in no list.
    list_index: u32,
}

/// See [`EdgeRecord::list_index`].
const CHANGED: u32 = u32::MAX - 1;

/// Edges that are affected by an edit, each once.
#[derive(Debug, Default)]
pub(crate) struct EdgeLists {
    /// Edges from before the edit with added or removed triangles.
    pub(crate) changed: Vec<EdgeId>,
    /// New edges.
    pub(crate) added: Vec<NewEdge>,
    /// With patches, the home of the largest constraint of every edge: changed edges, then new
    /// ones.
    pub(crate) homes: Vec<Home>,
}

impl EdgeLists {
    pub(crate) fn clear(&mut self) {
        self.changed.clear();
        self.added.clear();
    }

    /// Returns the number of edges.
    pub(crate) fn len(&self) -> usize {
        self.changed.len() + self.added.len()
    }

    /// Returns the vertices of the largest constraint of every edge: with bending a hinge, if there
    /// is one, otherwise both ends. Edges are numbered as in [`Self::homes`].
    pub(crate) fn stencils<'a>(
        &'a self,
        edges: &'a EdgeTable,
        topology: &'a Topology,
        bends: bool,
    ) -> impl Iterator<Item = (u32, [VertexId; 4])> + 'a {
        let changed = (0..).zip(&self.changed);
        let changed =
            changed.filter_map(move |(i, &edge)| Some((i, edges.stencil(edge, topology, bends)?)));
        let added = (index_u32(self.changed.len())..).zip(&self.added);
        let added = added.map(move |(i, new)| {
            let [low, high, ..] = new.vertices;
            if bends && new.is_hinge() {
                (i, new.vertices)
            } else {
                (i, [low, high, high, high])
            }
        });
        changed.chain(added)
    }
}

/// A new edge with its vertices.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NewEdge {
    pub(crate) edge: EdgeId,
    /// Both ends, the smaller id first, then the opposite vertices as in [`BendingSet`]; null
    /// without a triangle.
    pub(crate) vertices: [VertexId; 4],
}

impl NewEdge {
    /// Returns true if there is a triangle on both sides.
    #[inline]
    pub(crate) fn is_hinge(&self) -> bool {
        let [_, _, up, down] = self.vertices;
        !(up.is_null() || down.is_null())
    }
}

/// The constraint sets of edges, and the patches that determine their layers.
#[derive(Debug)]
pub(crate) struct Sets<'a> {
    pub(crate) stretch: &'a mut StretchSet,
    pub(crate) bending: Option<&'a mut BendingSet>,
    pub(crate) patches: Option<&'a mut Patches>,
}

/// One record per edge.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct EdgeTable {
    /// Corners of every triangle, shape [triangle slots]; null for unused slots.
    #[cfg_attr(feature = "serde", serde(skip))]
    corners: Vec<[VertexId; 3]>,
    /// Record index of every half-edge, shape [3 x triangle slots]; [`NONE`] for unused slots.
    of_half_edge: Vec<u32>,
    #[cfg_attr(feature = "serde", serde(skip))]
    records: Vec<EdgeRecord>,
    /// Unused records.
    free: Vec<u32>,
}

impl EdgeTable {
    /// Returns the number of edges.
    pub(crate) fn len(&self) -> usize {
        self.records.len() - self.free.len()
    }

    /// Returns the edge of a half-edge in the table.
    pub(crate) fn of(&self, h: HalfEdge) -> Option<EdgeId> {
        let edge = *self.of_half_edge.get(h.index())?;
        (edge != NONE).then_some(EdgeId(edge))
    }

    pub(crate) fn record(&self, edge: EdgeId) -> &EdgeRecord {
        &self.records[edge.0 as usize]
    }

    fn record_mut(&mut self, edge: EdgeId) -> &mut EdgeRecord {
        &mut self.records[edge.0 as usize]
    }

    /// Returns the vertices of an edge's constraints: its ends, and with bending the opposite ones.
    pub(crate) fn stencil(
        &self,
        edge: EdgeId,
        topology: &Topology,
        bends: bool,
    ) -> Option<[VertexId; 4]> {
        let record = self.record(edge);
        let [low, high] = record.ends(topology)?;
        match record.hinge(topology) {
            Some(hinge) if bends => Some(hinge),
            _ => Some([low, high, high, high]),
        }
    }

    /// Returns true if the triangle is in the table with these corners.
    pub(crate) fn has_triangle(&self, t: TriangleId, [a, b, c]: [VertexId; 3]) -> bool {
        let known = self.corners.get(t.index());
        known.is_some_and(|known| [[a, b, c], [b, c, a], [c, a, b]].contains(known))
    }

    /// Adds unused triangle slots, or removes the last ones.
    pub(crate) fn resize_triangles(&mut self, triangle_slots: usize) {
        self.corners.resize(triangle_slots, [VertexId::NULL; 3]);
        self.of_half_edge.resize(3 * triangle_slots, NONE);
    }

    /// Allocates room for edits.
    pub(crate) fn reserve(&mut self) {
        let triangles = edit_reserve(self.corners.len());
        self.corners.reserve(triangles);
        self.of_half_edge.reserve(3 * triangles);
        self.records.reserve(edit_reserve(self.records.len()));
    }

    /// Adds a triangle of the surface to its three edges and lists them.
    #[inline]
    pub(crate) fn add_triangle(
        &mut self,
        t: TriangleId,
        topology: &Topology,
        lists: &mut EdgeLists,
    ) {
        let corners @ [a, b, c] = topology.triangle(t);
        self.corners[t.index()] = corners;
        let rotations = [[a, b, c], [b, c, a], [c, a, b]];
        for (h, [from, to, opposite]) in t.half_edges().into_iter().zip(rotations) {
            // The null half-edge has no edge.
            let edge = self.of(topology.twin(h));
            let side = usize::from(from > to);
            let edge = edge.unwrap_or_else(|| self.new_record(lists, from.min(to), from.max(to)));
            self.of_half_edge[h.index()] = edge.0;
            let record = self.record_mut(edge);
            record.sides[side] = h;
            match lists.added.get_mut(record.list_index as usize) {
                Some(new) => new.vertices[2 + side] = opposite,
                None => record.list_as_changed(edge, &mut lists.changed),
            }
        }
    }

    /// Removes a triangle from its three edges and lists them.
    pub(crate) fn remove_triangle(&mut self, t: TriangleId, lists: &mut EdgeLists) {
        self.corners[t.index()] = [VertexId::NULL; 3];
        for h in t.half_edges() {
            if let Some(edge) = self.of(h) {
                self.of_half_edge[h.index()] = NONE;
                let record = self.record_mut(edge);
                for side in &mut record.sides {
                    if *side == h {
                        *side = HalfEdge::NULL;
                    }
                }
                record.list_as_changed(edge, &mut lists.changed);
            }
        }
    }

    /// Creates the record of a new edge.
    #[inline]
    fn new_record(&mut self, lists: &mut EdgeLists, low: VertexId, high: VertexId) -> EdgeId {
        let record = EdgeRecord {
            sides: [HalfEdge::NULL; 2],
            stretch: PackedSlot::NONE,
            bending: PackedSlot::NONE,
            list_index: index_u32(lists.added.len()),
        };
        let edge = if let Some(edge) = self.free.pop() {
            self.records[edge as usize] = record;
            EdgeId(edge)
        } else {
            self.records.push(record);
            EdgeId(index_u32(self.records.len() - 1))
        };
        let vertices = [low, high, VertexId::NULL, VertexId::NULL];
        lists.added.push(NewEdge { edge, vertices });
        edge
    }

    /// Removes outdated constraints of a changed edge, and the record of an edge without triangles.
    ///
    /// Returns true if the edge still exists.
    pub(crate) fn drop_stale(
        &mut self,
        edge: EdgeId,
        surface: &Surface,
        sets: &mut Sets<'_>,
    ) -> bool {
        let patches = &mut sets.patches;
        let record = self.record_mut(edge);
        record.list_index = NONE;
        let record = *record;
        if let Some(slot) = record.stretch()
            && record.expected_stretch(surface) != Some(sets.stretch.at(slot))
        {
            self.remove_constraint(edge, slot, sets.stretch, patches, |r| &mut r.stretch);
        }
        if let (Some(bending), Some(slot)) = (&mut sets.bending, record.bending())
            && record.expected_bending(surface) != Some(bending.at(slot))
        {
            self.remove_constraint(edge, slot, bending, patches, |r| &mut r.bending);
        }
        let exists = record.sides.iter().any(|h| !h.is_null());
        if !exists {
            self.free.push(edge.0);
        }
        exists
    }

    /// Sets the slots of an edge's constraints and takes it off the lists.
    #[inline]
    pub(crate) fn set_slots(
        &mut self,
        edge: EdgeId,
        stretch: Option<PackedSlot>,
        bending: Option<PackedSlot>,
    ) {
        let record = self.record_mut(edge);
        record.list_index = NONE;
        record.stretch = stretch.unwrap_or(record.stretch);
        record.bending = bending.unwrap_or(record.bending);
    }

    fn remove_constraint<const N: usize>(
        &mut self,
        edge: EdgeId,
        slot: Slot,
        set: &mut ConstraintSet<N>,
        patches: &mut Option<&mut Patches>,
        field: impl Fn(&mut EdgeRecord) -> &mut PackedSlot,
    ) {
        *field(self.record_mut(edge)) = PackedSlot::NONE;
        if let Some(patches) = patches {
            patches.mark_loss(slot.layer(), &set.at(slot).0);
        }
        if let Some(moved) = set.remove(slot) {
            *field(self.record_mut(moved)) = PackedSlot::new(slot);
        }
    }
}

impl EdgeRecord {
    fn list_as_changed(&mut self, edge: EdgeId, changed: &mut Vec<EdgeId>) {
        if std::mem::replace(&mut self.list_index, CHANGED) != CHANGED {
            changed.push(edge);
        }
    }

    /// Returns the slot of the stretch constraint.
    pub(crate) fn stretch(&self) -> Option<Slot> {
        self.stretch.slot()
    }

    /// Returns the slot of the bending constraint.
    pub(crate) fn bending(&self) -> Option<Slot> {
        self.bending.slot()
    }

    /// Returns both ends, the smaller id first.
    pub(crate) fn ends(&self, topology: &Topology) -> Option<[VertexId; 2]> {
        let [up, down] = self.sides;
        if !up.is_null() {
            Some([topology.origin(up), topology.target(up)])
        } else if !down.is_null() {
            Some([topology.target(down), topology.origin(down)])
        } else {
            None
        }
    }

    /// Returns ends and opposite vertices of an edge between two triangles.
    #[inline]
    pub(crate) fn hinge(&self, topology: &Topology) -> Option<[VertexId; 4]> {
        let [up, down] = self.sides;
        if up.is_null() || down.is_null() {
            return None;
        }
        let opposite = |h: HalfEdge| topology.origin(h.prev());
        Some([
            topology.origin(up),
            topology.target(up),
            opposite(up),
            opposite(down),
        ])
    }

    /// Returns the stretch constraint that the edge should have.
    pub(crate) fn expected_stretch(&self, surface: &Surface) -> Option<([VertexId; 2], f32)> {
        let ends = self.ends(surface.topology())?;
        Some((ends, rest::length(surface, ends)))
    }

    /// Returns the bending constraint that the edge should have.
    pub(crate) fn expected_bending(&self, surface: &Surface) -> Option<([VertexId; 4], f32)> {
        let vertices = self.hinge(surface.topology())?;
        Some((vertices, rest::angle(surface, vertices)))
    }
}
