//! Which constraints an edge has, by edge key: what the paper's Algorithm A1 finds by scanning.

use crate::constraints::{BendingSet, ConstraintSet, Slot, StretchSet};
use crate::rest;
use incise_mesh::{EdgeKey, Surface, VertexId};
use rustc_hash::FxHashMap;

/// What is known of one edge.
#[derive(Debug, Clone, Copy)]
pub(crate) struct EdgeRecord {
    /// The third vertex of the triangle that runs from the smaller id to the larger one, and of the
    /// triangle that runs back; null where there is none.
    pub(crate) opposite: [VertexId; 2],
    pub(crate) stretch: Option<Slot>,
    pub(crate) bending: Option<Slot>,
}

/// One record an edge. Never iterated, so the order of hashing shows nowhere.
#[derive(Debug, Clone, Default)]
pub(crate) struct EdgeTable {
    records: FxHashMap<EdgeKey, EdgeRecord>,
}

/// The key of the edge from `a` to `b` and on which side of it a triangle lies that runs so.
pub(crate) fn key_and_side(a: VertexId, b: VertexId) -> (EdgeKey, usize) {
    (EdgeKey::new(a, b), usize::from(a > b))
}

/// The directed edges of a triangle, each with the vertex across.
pub(crate) fn sides([a, b, c]: [VertexId; 3]) -> [(VertexId, VertexId, VertexId); 3] {
    [(a, b, c), (b, c, a), (c, a, b)]
}

impl EdgeTable {
    pub(crate) fn len(&self) -> usize {
        self.records.len()
    }

    pub(crate) fn get(&self, key: EdgeKey) -> Option<&EdgeRecord> {
        self.records.get(&key)
    }

    /// Whether the triangle is known.
    pub(crate) fn has_triangle(&self, corners: [VertexId; 3]) -> bool {
        sides(corners).into_iter().all(|(a, b, across)| {
            let (key, side) = key_and_side(a, b);
            self.get(key).is_some_and(|r| r.opposite[side] == across)
        })
    }

    /// Notes a triangle at its three edges, whose keys go to `touched`.
    pub(crate) fn add_triangle(&mut self, corners: [VertexId; 3], touched: &mut Vec<EdgeKey>) {
        for (a, b, across) in sides(corners) {
            let (key, side) = key_and_side(a, b);
            let record = self.records.entry(key).or_insert(EdgeRecord {
                opposite: [VertexId::NULL; 2],
                stretch: None,
                bending: None,
            });
            record.opposite[side] = across;
            touched.push(key);
        }
    }

    /// Forgets a triangle at its three edges, whose keys go to `touched`.
    pub(crate) fn remove_triangle(&mut self, corners: [VertexId; 3], touched: &mut Vec<EdgeKey>) {
        for (a, b, _) in sides(corners) {
            let (key, side) = key_and_side(a, b);
            if let Some(record) = self.records.get_mut(&key) {
                record.opposite[side] = VertexId::NULL;
            }
            touched.push(key);
        }
    }

    /// Removes constraints of an edge that its triangles and rest positions do not ask for, and the
    /// record of an edge without triangles.
    pub(crate) fn drop_stale(
        &mut self,
        key: EdgeKey,
        surface: &Surface,
        stretch: &mut StretchSet,
        bending: Option<&mut BendingSet>,
    ) {
        let Some(&record) = self.records.get(&key) else {
            return;
        };
        if let Some(slot) = record.stretch
            && record.stretch_wanted(key, surface) != Some(stretch.at(slot))
        {
            self.forget(key, slot, stretch, |r| &mut r.stretch);
        }
        if let (Some(bending), Some(slot)) = (bending, record.bending)
            && record.bending_wanted(key, surface) != Some(bending.at(slot))
        {
            self.forget(key, slot, bending, |r| &mut r.bending);
        }
        if !record.has_triangle() {
            self.records.remove(&key);
        }
    }

    /// Adds the constraints that an edge should have and has not.
    pub(crate) fn add_missing(
        &mut self,
        key: EdgeKey,
        surface: &Surface,
        stretch: &mut StretchSet,
        bending: Option<&mut BendingSet>,
    ) {
        let Some(record) = self.records.get_mut(&key) else {
            return;
        };
        if record.stretch.is_none() {
            let wanted = record.stretch_wanted(key, surface);
            record.stretch = wanted.map(|(vertices, rest)| stretch.insert(vertices, rest));
        }
        if let Some(bending) = bending
            && record.bending.is_none()
        {
            let wanted = record.bending_wanted(key, surface);
            record.bending = wanted.map(|(vertices, rest)| bending.insert(vertices, rest));
        }
    }

    fn forget<const N: usize>(
        &mut self,
        key: EdgeKey,
        slot: Slot,
        set: &mut ConstraintSet<N>,
        field: impl Fn(&mut EdgeRecord) -> &mut Option<Slot>,
    ) {
        if let Some(record) = self.records.get_mut(&key) {
            *field(record) = None;
        }
        if let Some(moved) = set.remove(slot)
            && let Some(record) = self.records.get_mut(&moved)
        {
            *field(record) = Some(slot);
        }
    }
}

impl EdgeRecord {
    fn has_triangle(&self) -> bool {
        self.opposite.iter().any(|v| !v.is_null())
    }

    fn stretch_wanted(&self, key: EdgeKey, surface: &Surface) -> Option<([VertexId; 2], f32)> {
        self.has_triangle()
            .then(|| (key.vertices(), rest::length(surface, key)))
    }

    fn bending_wanted(&self, key: EdgeKey, surface: &Surface) -> Option<([VertexId; 4], f32)> {
        let ([low, high], [left, right]) = (key.vertices(), self.opposite);
        let vertices = [low, high, left, right];
        let interior = !left.is_null() && !right.is_null();
        interior.then(|| (vertices, rest::angle(surface, vertices)))
    }
}
