//! Which constraints an edge has: what the paper's Algorithm A1 finds by scanning. One record an edge,
//! found from its half-edges, so that an edit costs a few looks into arrays for each.

use crate::constraints::{BendingSet, ConstraintSet, Slot, StretchSet, room_beside};
use crate::patches::Patches;
use crate::rest;
use incise_mesh::{HalfEdge, Surface, Topology, TriangleId, VertexId};

/// No record, no place.
const NONE: u32 = u32::MAX;

/// The number of an edge's record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct EdgeId(u32);

impl EdgeId {
    /// Of a constraint that is no edge's.
    pub(crate) const NONE: Self = Self(NONE);
    #[cfg(test)]
    pub(crate) const TEST: Self = Self(0);
}

/// Where a constraint stands, in 8 bytes; or nowhere.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place {
    color: u32,
    index: u32,
}

impl Place {
    pub(crate) const NOWHERE: Self = Self {
        color: NONE,
        index: NONE,
    };

    pub(crate) fn at(slot: Slot) -> Self {
        let narrow = |n: usize| u32::try_from(n).expect("constraints have 32-bit numbers");
        Self {
            color: narrow(slot.color),
            index: narrow(slot.index),
        }
    }

    fn slot(self) -> Option<Slot> {
        (self.color != NONE).then_some(Slot {
            color: self.color as usize,
            index: self.index as usize,
        })
    }
}

/// What is known of one edge.
#[derive(Debug, Clone, Copy)]
pub(crate) struct EdgeRecord {
    /// The half-edge from the smaller vertex id to the larger one, and the one back; null where there is
    /// none.
    sides: [HalfEdge; 2],
    stretch: Place,
    bending: Place,
    /// Its number on the list of edges that the edit at hand made, [`TOUCHED`] on the other list,
    /// [`NONE`] on no list.
    listed: u32,
}

/// See [`EdgeRecord::listed`].
const TOUCHED: u32 = u32::MAX - 1;

/// Edges that an edit concerns, each once.
#[derive(Debug, Default)]
pub(crate) struct Lists {
    /// Those that were there before and whose triangles came or went.
    pub(crate) touched: Vec<EdgeId>,
    /// Those that came.
    pub(crate) fresh: Vec<Fresh>,
}

impl Lists {
    pub(crate) fn clear(&mut self) {
        self.touched.clear();
        self.fresh.clear();
    }

    /// All edges, those that came last.
    pub(crate) fn edges(&self) -> impl Iterator<Item = EdgeId> {
        let fresh = self.fresh.iter().map(|fresh| fresh.edge);
        self.touched.iter().copied().chain(fresh)
    }
}

/// An edge that came, as its triangles tell it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Fresh {
    pub(crate) edge: EdgeId,
    /// Both ends, the smaller id first, then the vertices across, as in
    /// [`BendingSet`]; null where there is no triangle.
    pub(crate) vertices: [VertexId; 4],
}

/// The constraints of a body and what decides on their layers.
#[derive(Debug)]
pub(crate) struct Sets<'a> {
    pub(crate) stretch: &'a mut StretchSet,
    pub(crate) bending: Option<&'a mut BendingSet>,
    pub(crate) patches: Option<&'a mut Patches>,
}

/// One record an edge.
#[derive(Debug, Clone, Default)]
pub(crate) struct EdgeTable {
    /// The corners of every triangle, shape [triangle slots]; null where there is none.
    corners: Vec<[VertexId; 3]>,
    /// The record of every half-edge, shape [3 x triangle slots]; [`NONE`] where there is no triangle.
    of_half_edge: Vec<u32>,
    records: Vec<EdgeRecord>,
    /// Records that are not in use.
    free: Vec<u32>,
}

impl EdgeTable {
    pub(crate) fn len(&self) -> usize {
        self.records.len() - self.free.len()
    }

    /// The edge of a half-edge, if it is known.
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

    /// The vertices that the constraints of an edge tie together: its ends, and those across it if it
    /// bends.
    pub(crate) fn tie(
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

    /// Whether the triangle is known.
    pub(crate) fn has_triangle(&self, t: TriangleId, [a, b, c]: [VertexId; 3]) -> bool {
        let known = self.corners.get(t.index());
        known.is_some_and(|known| [[a, b, c], [b, c, a], [c, a, b]].contains(known))
    }

    /// Makes room for triangles, or gives up what is beyond.
    pub(crate) fn resize_triangles(&mut self, triangle_slots: usize) {
        self.corners.resize(triangle_slots, [VertexId::NULL; 3]);
        self.of_half_edge.resize(3 * triangle_slots, NONE);
    }

    /// Makes room for edits.
    pub(crate) fn reserve(&mut self) {
        let triangles = room_beside(self.corners.len());
        self.corners.reserve(triangles);
        self.of_half_edge.reserve(3 * triangles);
        self.records.reserve(room_beside(self.records.len()));
    }

    /// Notes a triangle of the surface at its three edges, which go to the lists.
    #[inline]
    pub(crate) fn add_triangle(&mut self, t: TriangleId, topology: &Topology, lists: &mut Lists) {
        let corners @ [a, b, c] = topology.triangle(t);
        self.corners[t.index()] = corners;
        let around = [[a, b, c], [b, c, a], [c, a, b]];
        for (h, [from, to, across]) in t.half_edges().into_iter().zip(around) {
            // The null half-edge has no edge.
            let edge = self.of(topology.twin(h));
            let side = usize::from(from > to);
            let edge = edge.unwrap_or_else(|| self.new_record(lists, from.min(to), from.max(to)));
            self.of_half_edge[h.index()] = edge.0;
            let record = self.record_mut(edge);
            record.sides[side] = h;
            match lists.fresh.get_mut(record.listed as usize) {
                Some(fresh) => fresh.vertices[2 + side] = across,
                None => record.touch(edge, &mut lists.touched),
            }
        }
    }

    /// Forgets a triangle at its three edges, which go to the lists.
    pub(crate) fn remove_triangle(&mut self, t: TriangleId, lists: &mut Lists) {
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
                record.touch(edge, &mut lists.touched);
            }
        }
    }

    /// A record for an edge that comes.
    #[inline]
    fn new_record(&mut self, lists: &mut Lists, low: VertexId, high: VertexId) -> EdgeId {
        let narrow = |n: usize| u32::try_from(n).expect("half-edges have 32-bit ids");
        let record = EdgeRecord {
            sides: [HalfEdge::NULL; 2],
            stretch: Place::NOWHERE,
            bending: Place::NOWHERE,
            listed: narrow(lists.fresh.len()),
        };
        let edge = if let Some(edge) = self.free.pop() {
            self.records[edge as usize] = record;
            EdgeId(edge)
        } else {
            self.records.push(record);
            EdgeId(narrow(self.records.len() - 1))
        };
        let vertices = [low, high, VertexId::NULL, VertexId::NULL];
        lists.fresh.push(Fresh { edge, vertices });
        edge
    }

    /// Removes constraints of a touched edge that its triangles and rest positions do not ask for, and
    /// the record of an edge without triangles. Returns whether the edge is still there.
    pub(crate) fn drop_stale(
        &mut self,
        edge: EdgeId,
        surface: &Surface,
        sets: &mut Sets<'_>,
    ) -> bool {
        let patches = &mut sets.patches;
        let record = self.record_mut(edge);
        record.listed = NONE;
        let record = *record;
        if let Some(slot) = record.stretch()
            && record.stretch_wanted(surface) != Some(sets.stretch.at(slot))
        {
            self.forget(edge, slot, sets.stretch, patches, |r| &mut r.stretch);
        }
        if let (Some(bending), Some(slot)) = (&mut sets.bending, record.bending())
            && record.bending_wanted(surface) != Some(bending.at(slot))
        {
            self.forget(edge, slot, bending, patches, |r| &mut r.bending);
        }
        let is_there = record.sides.iter().any(|h| !h.is_null());
        if !is_there {
            self.free.push(edge.0);
        }
        is_there
    }

    /// Notes where the constraints of an edge came to stand. It is on no list any more.
    #[inline]
    pub(crate) fn set_places(
        &mut self,
        edge: EdgeId,
        stretch: Option<Place>,
        bending: Option<Place>,
    ) {
        let record = self.record_mut(edge);
        record.listed = NONE;
        record.stretch = stretch.unwrap_or(record.stretch);
        record.bending = bending.unwrap_or(record.bending);
    }

    fn forget<const N: usize>(
        &mut self,
        edge: EdgeId,
        slot: Slot,
        set: &mut ConstraintSet<N>,
        patches: &mut Option<&mut Patches>,
        field: impl Fn(&mut EdgeRecord) -> &mut Place,
    ) {
        *field(self.record_mut(edge)) = Place::NOWHERE;
        if let Some(patches) = patches {
            patches.touch(slot.layer(), &set.at(slot).0);
        }
        if let Some(moved) = set.remove(slot) {
            *field(self.record_mut(moved)) = Place::at(slot);
        }
    }
}

impl EdgeRecord {
    fn touch(&mut self, edge: EdgeId, touched: &mut Vec<EdgeId>) {
        if std::mem::replace(&mut self.listed, TOUCHED) != TOUCHED {
            touched.push(edge);
        }
    }

    /// Where the stretch constraint stands.
    pub(crate) fn stretch(&self) -> Option<Slot> {
        self.stretch.slot()
    }

    /// Where the bending constraint stands.
    pub(crate) fn bending(&self) -> Option<Slot> {
        self.bending.slot()
    }

    /// Both ends, the smaller id first.
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

    /// Both ends and the vertices across, of an edge between two triangles.
    #[inline]
    pub(crate) fn hinge(&self, topology: &Topology) -> Option<[VertexId; 4]> {
        let [up, down] = self.sides;
        if up.is_null() || down.is_null() {
            return None;
        }
        let across = |h: HalfEdge| topology.origin(h.prev());
        Some([
            topology.origin(up),
            topology.target(up),
            across(up),
            across(down),
        ])
    }

    pub(crate) fn stretch_wanted(&self, surface: &Surface) -> Option<([VertexId; 2], f32)> {
        let ends = self.ends(surface.topology())?;
        Some((ends, rest::length(surface, ends)))
    }

    pub(crate) fn bending_wanted(&self, surface: &Surface) -> Option<([VertexId; 4], f32)> {
        let vertices = self.hinge(surface.topology())?;
        Some((vertices, rest::angle(surface, vertices)))
    }
}
