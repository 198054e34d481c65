//! Which constraints an edge has: what the paper's Algorithm A1 finds by scanning. One record an edge,
//! found from its half-edges, so that an edit costs a few looks into arrays for each.

use crate::constraints::{BendingSet, ConstraintSet, Slot, StretchSet, room_beside};
use crate::patches::Patches;
use crate::rest;
use incise_mesh::{EdgeKey, HalfEdge, Surface, Topology, TriangleId, VertexId};

/// No record, no place.
const NONE: u32 = u32::MAX;

/// The number of an edge's record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct EdgeId(u32);

impl EdgeId {
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
    const NOWHERE: Self = Self {
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
    /// Whether the edit at hand has it on a list already.
    is_touched: bool,
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
    /// The record of every half-edge, shape [triangle slots, 3]; [`NONE`] where there is no triangle.
    of_half_edge: Vec<[u32; 3]>,
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
        let edges = self.of_half_edge.get(h.triangle().index())?;
        let edge = edges[h.index() % 3];
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
        self.of_half_edge.resize(triangle_slots, [NONE; 3]);
    }

    /// Makes room for edits.
    pub(crate) fn reserve(&mut self) {
        let triangles = room_beside(self.corners.len());
        self.corners.reserve(triangles);
        self.of_half_edge.reserve(triangles);
        self.records.reserve(room_beside(self.records.len()));
    }

    /// Notes a triangle of the surface at its three edges. Those that were there before go to `touched`
    /// and new ones to `fresh`, each once.
    pub(crate) fn add_triangle(
        &mut self,
        t: TriangleId,
        topology: &Topology,
        touched: &mut Vec<EdgeId>,
        fresh: &mut Vec<EdgeId>,
    ) {
        let corners = topology.triangle(t);
        self.corners[t.index()] = corners;
        for (k, h) in t.half_edges().into_iter().enumerate() {
            let twin = topology.twin(h);
            let beside = (!twin.is_null()).then(|| self.of(twin)).flatten();
            let edge = beside.unwrap_or_else(|| {
                let edge = self.new_record();
                fresh.push(edge);
                edge
            });
            self.of_half_edge[t.index()][k] = edge.0;
            let side = usize::from(corners[k] > corners[(k + 1) % 3]);
            self.record_mut(edge).sides[side] = h;
            self.touch(edge, touched);
        }
    }

    /// Forgets a triangle at its three edges, which go to `touched`.
    pub(crate) fn remove_triangle(&mut self, t: TriangleId, touched: &mut Vec<EdgeId>) {
        self.corners[t.index()] = [VertexId::NULL; 3];
        for h in t.half_edges() {
            if let Some(edge) = self.of(h) {
                let sides = &mut self.record_mut(edge).sides;
                sides
                    .iter_mut()
                    .filter(|side| **side == h)
                    .for_each(|side| {
                        *side = HalfEdge::NULL;
                    });
                self.touch(edge, touched);
            }
        }
        self.of_half_edge[t.index()] = [NONE; 3];
    }

    fn new_record(&mut self) -> EdgeId {
        let record = EdgeRecord {
            sides: [HalfEdge::NULL; 2],
            stretch: Place::NOWHERE,
            bending: Place::NOWHERE,
            // Its constraints come in any case.
            is_touched: true,
        };
        if let Some(edge) = self.free.pop() {
            self.records[edge as usize] = record;
            return EdgeId(edge);
        }
        self.records.push(record);
        let edge = u32::try_from(self.records.len() - 1);
        EdgeId(edge.expect("half-edges have 32-bit ids"))
    }

    fn touch(&mut self, edge: EdgeId, touched: &mut Vec<EdgeId>) {
        let is_touched = &mut self.record_mut(edge).is_touched;
        if !std::mem::replace(is_touched, true) {
            touched.push(edge);
        }
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
        let record = *self.leave_list(edge);
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

    /// An edge that is on no list any more.
    #[inline]
    pub(crate) fn leave_list(&mut self, edge: EdgeId) -> &EdgeRecord {
        let record = self.record_mut(edge);
        record.is_touched = false;
        record
    }

    pub(crate) fn set_stretch(&mut self, edge: EdgeId, place: Place) {
        self.record_mut(edge).stretch = place;
    }

    pub(crate) fn set_bending(&mut self, edge: EdgeId, place: Place) {
        self.record_mut(edge).bending = place;
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
        let [a, b] = ends;
        Some((ends, rest::length(surface, EdgeKey::new(a, b))))
    }

    fn bending_wanted(&self, surface: &Surface) -> Option<([VertexId; 4], f32)> {
        let vertices = self.hinge(surface.topology())?;
        Some((vertices, rest::angle(surface, vertices)))
    }
}
