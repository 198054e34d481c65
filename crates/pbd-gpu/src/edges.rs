//! Which constraints an edge has, by edge key: what the paper's Algorithm A1 finds by scanning.

use crate::constraints::{BendingSet, ConstraintSet, Slot, StretchSet};
use crate::patches::Patches;
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

/// The constraints of a body and what decides on their layers.
#[derive(Debug)]
pub(crate) struct Sets<'a> {
    pub(crate) stretch: &'a mut StretchSet,
    pub(crate) bending: Option<&'a mut BendingSet>,
    pub(crate) patches: Option<&'a mut Patches>,
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

    /// The vertices that the constraints of an edge tie together: its ends, and those across it if it
    /// bends.
    pub(crate) fn tie(&self, key: EdgeKey, bends: bool) -> Option<[VertexId; 4]> {
        let record = self.get(key).filter(|record| record.has_triangle())?;
        let ([low, high], [left, right]) = (key.vertices(), record.opposite);
        let bends = bends && record.is_interior();
        Some(if bends {
            [low, high, left, right]
        } else {
            [low, high, high, high]
        })
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
    pub(crate) fn drop_stale(&mut self, key: EdgeKey, surface: &Surface, sets: &mut Sets<'_>) {
        let patches = &mut sets.patches;
        let Some(&record) = self.records.get(&key) else {
            return;
        };
        if let Some(slot) = record.stretch
            && record.stretch_wanted(key, surface) != Some(sets.stretch.at(slot))
        {
            self.forget(key, slot, sets.stretch, patches, |r| &mut r.stretch);
        }
        if let (Some(bending), Some(slot)) = (&mut sets.bending, record.bending)
            && record.bending_wanted(key, surface) != Some(bending.at(slot))
        {
            self.forget(key, slot, bending, patches, |r| &mut r.bending);
        }
        if !record.has_triangle() {
            self.records.remove(&key);
        }
    }

    /// Adds the constraints that an edge should have and has not.
    pub(crate) fn add_missing(&mut self, key: EdgeKey, surface: &Surface, sets: &mut Sets<'_>) {
        let patches = &mut sets.patches;
        let Some(record) = self.records.get_mut(&key) else {
            return;
        };
        if record.stretch.is_none() {
            let wanted = record.stretch_wanted(key, surface);
            record.stretch = wanted.map(|wanted| insert(sets.stretch, patches, wanted));
        }
        if let Some(bending) = &mut sets.bending
            && record.bending.is_none()
        {
            let wanted = record.bending_wanted(key, surface);
            record.bending = wanted.map(|wanted| insert(bending, patches, wanted));
        }
    }

    fn forget<const N: usize>(
        &mut self,
        key: EdgeKey,
        slot: Slot,
        set: &mut ConstraintSet<N>,
        patches: &mut Option<&mut Patches>,
        field: impl Fn(&mut EdgeRecord) -> &mut Option<Slot>,
    ) {
        if let Some(record) = self.records.get_mut(&key) {
            *field(record) = None;
        }
        if let Some(patches) = patches {
            patches.touch(slot.layer(), &set.at(slot).0);
        }
        if let Some(moved) = set.remove(slot)
            && let Some(record) = self.records.get_mut(&moved)
        {
            *field(record) = Some(slot);
        }
    }
}

/// Inserts a constraint into the layer of its vertices.
fn insert<const N: usize>(
    set: &mut ConstraintSet<N>,
    patches: &mut Option<&mut Patches>,
    (vertices, rest): ([VertexId; N], f32),
) -> Slot {
    let layer = patches.as_ref().map_or(0, |p| p.layer_of(&vertices));
    let slot = set.insert_in(layer, vertices, rest);
    if let Some(patches) = patches {
        patches.touch(slot.layer(), &vertices);
    }
    slot
}

impl EdgeRecord {
    fn has_triangle(&self) -> bool {
        self.opposite.iter().any(|v| !v.is_null())
    }

    fn is_interior(&self) -> bool {
        self.opposite.iter().all(|v| !v.is_null())
    }

    fn stretch_wanted(&self, key: EdgeKey, surface: &Surface) -> Option<([VertexId; 2], f32)> {
        self.has_triangle()
            .then(|| (key.vertices(), rest::length(surface, key)))
    }

    fn bending_wanted(&self, key: EdgeKey, surface: &Surface) -> Option<([VertexId; 4], f32)> {
        let ([low, high], [left, right]) = (key.vertices(), self.opposite);
        let vertices = [low, high, left, right];
        self.is_interior()
            .then(|| (vertices, rest::angle(surface, vertices)))
    }
}
