//! Completes and validates a loaded [`EdgeTable`].
//!
//! A file has the record numbers of half-edges. Triangles and slots of the records follow from the
//! surface and the constraint sets.

use super::{EdgeId, EdgeRecord, EdgeTable, NONE, PackedSlot};
use crate::constraints::batches::{BendingSet, ConstraintSet, Slot, StretchSet};
use crate::constraints::validate::broken;
use crate::error::InvalidConstraints;
use incise_mesh::{EdgeKey, HalfEdge, Topology, TriangleId, VertexId};

const EMPTY: EdgeRecord = EdgeRecord {
    sides: [HalfEdge::NULL; 2],
    stretch: PackedSlot::NONE,
    bending: PackedSlot::NONE,
    list_index: NONE,
};

impl EdgeTable {
    /// Completes a table that was read with serde, for its surface and constraints.
    ///
    /// # Errors
    /// [`InvalidConstraints`] unless every edge has one record, one stretch constraint, and with
    /// bending one bending constraint if there are triangles on both sides.
    pub(crate) fn finish_load(
        &mut self,
        topology: &Topology,
        stretch: &StretchSet,
        bending: Option<&BendingSet>,
    ) -> Result<(), InvalidConstraints> {
        let half_edges = self.of_half_edge.len();
        let used = self.of_half_edge.iter().filter(|&&edge| edge != NONE);
        let last = used.chain(&self.free).max();
        let records = last.map_or(0, |&last| (last as usize).saturating_add(1));
        if half_edges != 3 * topology.triangle_slots() || records > half_edges + self.free.len() {
            return broken("one record per edge", None);
        }
        let corners = (0..topology.triangle_slots()).map(TriangleId::from_index);
        self.corners = corners.map(|t| topology.triangle(t)).collect();
        self.records = vec![EMPTY; records];
        self.set_sides(topology)?;
        self.check_free()?;
        let ends = |record: &EdgeRecord| record.ends(topology);
        self.set_slots_of(stretch, |record| &mut record.stretch, ends)?;
        if let Some(bending) = bending {
            let hinge = |record: &EdgeRecord| record.hinge(topology);
            self.set_slots_of(bending, |record| &mut record.bending, hinge)?;
        }
        for record in &self.records {
            let is_hinge = bending.is_some() && record.hinge(topology).is_some();
            if let Some([a, b]) = record.ends(topology)
                && (record.stretch().is_none() || record.bending().is_some() != is_hinge)
            {
                let edge = EdgeKey::new(a, b);
                return broken("every edge has its constraints", Some(edge));
            }
        }
        Ok(())
    }

    /// Sets the half-edges of all records.
    fn set_sides(&mut self, topology: &Topology) -> Result<(), InvalidConstraints> {
        for (h, &edge) in self.of_half_edge.iter().enumerate() {
            let h = HalfEdge::from_index(h);
            let (from, to) = (topology.origin(h), topology.target(h));
            let record = self.records.get_mut(edge as usize);
            if from.is_null() && edge == NONE {
                continue;
            }
            let (Some(record), false) = (record, from.is_null()) else {
                return broken("every half-edge has a record", None);
            };
            let side = &mut record.sides[usize::from(from > to)];
            if !std::mem::replace(side, h).is_null() {
                let edge = EdgeKey::new(from, to);
                return broken("an edge has two triangles at most", Some(edge));
            }
        }
        for [up, down] in self.records.iter().map(|record| record.sides) {
            let twin = |h: HalfEdge| if h.is_null() { h } else { topology.twin(h) };
            let is_paired = up.is_null() || twin(up) == down;
            if !is_paired || !(down.is_null() || twin(down) == up) {
                return broken("the half-edges of an edge are twins", None);
            }
        }
        Ok(())
    }

    /// Checks that each record without half-edges is free once, and no other one.
    fn check_free(&self) -> Result<(), InvalidConstraints> {
        let mut is_free: Vec<bool> = Vec::with_capacity(self.records.len());
        let unused = |record: &EdgeRecord| record.sides.iter().all(|h| h.is_null());
        is_free.extend(self.records.iter().map(unused));
        let mut found = |&edge: &u32| {
            let slot = is_free.get_mut(edge as usize);
            slot.is_some_and(std::mem::take)
        };
        if self.free.iter().all(&mut found) && !is_free.contains(&true) {
            Ok(())
        } else {
            broken("unused edge records are free once", None)
        }
    }

    /// Sets the slots of the constraints of one kind, which must be those `expected` of records.
    fn set_slots_of<const N: usize>(
        &mut self,
        set: &ConstraintSet<N>,
        field: impl Fn(&mut EdgeRecord) -> &mut PackedSlot,
        expected: impl Fn(&EdgeRecord) -> Option<[VertexId; N]>,
    ) -> Result<(), InvalidConstraints> {
        for (color, batch) in set.numbered() {
            let constraints = batch.vertices().iter().zip(batch.edges());
            for (index, (&vertices, &EdgeId(edge))) in constraints.enumerate() {
                let key = Some(EdgeKey::new(vertices[0], vertices[1]));
                let record = self.records.get_mut(edge as usize);
                let Some(record) = record.filter(|record| expected(record) == Some(vertices))
                else {
                    return broken("constraints are those of their edges", key);
                };
                let slot = field(record);
                if slot.slot().is_some() {
                    return broken("an edge has one constraint of a kind", key);
                }
                *slot = PackedSlot::new(Slot { color, index });
            }
        }
        Ok(())
    }
}
