//! The end of an edit: updates outgoing half-edges, frees unused vertices, builds the delta.

use super::log::Log;
use super::relatives::restored;
use super::{Edit, Undo};
use crate::delta::{AddedVertex, TopologyDelta, VertexOrigin};
use crate::history::Step;
use crate::ids::{HalfEdge, TriangleId, VertexId};
use crate::topology::Topology;
use std::cell::OnceCell;

/// A triangle slot whose corners changed; null corners mean no triangle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Change {
    pub(super) triangle: TriangleId,
    pub(super) before: [VertexId; 3],
    pub(super) now: [VertexId; 3],
}

impl Edit<'_> {
    /// Applies the edit and returns the change and its undo record. O(k log k) for k changes.
    ///
    /// Vertices that no triangle uses are removed.
    #[must_use = "the delta is what solvers and search trees follow"]
    pub fn finish(mut self) -> (TopologyDelta, Undo) {
        self.open = false;
        let changes = changes(&self.log, &self.surface.topology);
        // Vertices unused before this edit: new ones, and old ones without triangles.
        let mut idle: Vec<VertexId> = self.log.outgoing.places().map(VertexId).collect();
        let mut made: Vec<VertexId> = self.vertices.iter().map(|entry| entry.0).collect();
        idle.sort_unstable();
        made.sort_unstable();
        let unused = self.set_outgoing(&changes, &made, &idle);
        let is_made = |v: &VertexId| made.binary_search(v).is_ok();
        let was_idle = |v: &VertexId| is_made(v) || idle.binary_search(v).is_ok();
        let vertices_removed: Vec<VertexId> =
            unused.iter().copied().filter(|v| !was_idle(v)).collect();
        let free = unused.iter().rev().filter(|v| is_made(v) || !was_idle(v));
        self.surface.topology.free_vertices.extend(free);
        self.clear(unused.iter().copied().filter(is_made));
        self.surface.history.step(Step::Finish, 0);

        let surface = &*self.surface;
        let held = |c: &&Change| !c.before[0].is_null();
        let holds = |c: &&Change| !c.now[0].is_null();
        let removed = changes.iter().filter(held);
        let added = changes.iter().filter(holds);
        let delta = TopologyDelta {
            triangles_removed: removed.map(|c| (c.triangle, c.before)).collect(),
            triangles_added: added.map(|c| c.triangle).collect(),
            vertices_removed,
            removed_positions: Vec::new(),
            vertices_added: self.vertices_added(&made, &idle),
            pieces_added: (self.pieces.iter().copied())
                .filter(|&(piece, _)| surface.pieces.count(piece) > 0)
                .collect(),
            pieces_removed: self.pieces_removed(&changes),
        };
        let restored = restored(surface, &delta, &changes);
        let log = std::mem::take(&mut self.log);
        let undo = Undo::new(surface, log, delta.clone(), restored);
        (delta, undo)
    }

    /// Clears the data of created vertices that stayed unused, because solvers step all slots.
    fn clear(&mut self, wasted: impl Iterator<Item = VertexId>) {
        let (positions, rest) = (self.log.positions.before(), self.log.rest.before());
        let surface = &mut *self.surface;
        for v in wasted {
            let position = old_value(&positions, v).unwrap_or_default();
            let place = old_value(&rest, v).unwrap_or_default();
            (self.log.positions).set(&mut surface.positions, v.0, position);
            self.log.rest.set(&mut surface.rest, v.0, place);
        }
    }

    /// Sets the outgoing half-edge of every vertex that is new or has lost a triangle.
    ///
    /// Returns the unused vertices, ascending.
    fn set_outgoing(
        &mut self,
        changes: &[Change],
        made: &[VertexId],
        idle: &[VertexId],
    ) -> Vec<VertexId> {
        let topology = &mut self.surface.topology;
        let lost = changes.iter().flat_map(|c| c.before);
        let others = made.iter().chain(idle).copied();
        let mut without = Vec::new();
        for v in lost.chain(others).filter(|v| !v.is_null()) {
            let h = topology.outgoing(v);
            if h.is_null() {
                without.push(v);
            } else if topology.origin(h) != v {
                let outgoing = &mut topology.outgoing;
                self.log.outgoing.set(outgoing, v.0, HalfEdge::NULL);
                without.push(v);
            }
        }
        // A surviving fan borders a removed triangle or has a changed twin.
        let new = changes.iter().filter(|c| !c.now[0].is_null());
        let turned = self.log.twin.places().map(HalfEdge);
        let near =
            (new.flat_map(|c| c.triangle.half_edges())).chain(turned.flat_map(|h| [h, h.next()]));
        for h in near {
            let v = topology.origin(h);
            if !v.is_null() && topology.outgoing(v).is_null() {
                self.log.outgoing.set(&mut topology.outgoing, v.0, h);
            }
        }
        without.retain(|&v| topology.outgoing(v).is_null());
        without.sort_unstable();
        without.dedup();
        if self.has_lost_boundary(changes, &without) {
            self.find_other_fans();
            let topology = &self.surface.topology;
            without.retain(|&v| topology.outgoing(v).is_null());
        }
        without
    }

    /// Returns whether a vertex without triangles nearby was on a boundary before the edit.
    ///
    /// Such a vertex may have another fan, which the edit did not touch. `without` is ascending.
    fn has_lost_boundary(&self, changes: &[Change], without: &[VertexId]) -> bool {
        if without.is_empty() {
            return false;
        }
        // Sides of removed triangles at these vertices, with their twins before the edit.
        let mut sides = Vec::new();
        for change in changes {
            for (h, v) in change.triangle.half_edges().into_iter().zip(change.before) {
                if !v.is_null() && without.binary_search(&v).is_ok() {
                    sides.extend([(h, None), (h.prev(), None)]);
                }
            }
        }
        sides.sort_unstable_by_key(|side| side.0);
        sides.dedup_by_key(|side| side.0);
        for (h, twin) in self.log.twin.overwrites() {
            if let Ok(at) = sides.binary_search_by_key(&HalfEdge(h), |side| side.0) {
                sides[at].1.get_or_insert(twin);
            }
        }
        let topology = &self.surface.topology;
        let mut twins = sides
            .into_iter()
            .map(|(h, twin)| twin.unwrap_or_else(|| topology.twin(h)));
        twins.any(HalfEdge::is_null)
    }

    /// Sets the outgoing half-edges of vertices that have none but have a fan. O(n).
    ///
    /// Nothing leads from one fan of a boundary vertex to its others. Each starts at a boundary.
    fn find_other_fans(&mut self) {
        let topology = &mut self.surface.topology;
        for i in 0..topology.twin.len() {
            let v = topology.origin[i];
            if topology.twin[i].is_null() && !v.is_null() && topology.outgoing[v.index()].is_null()
            {
                let h = HalfEdge::from_index(i);
                self.log.outgoing.set(&mut topology.outgoing, v.0, h);
            }
        }
    }

    /// Returns the vertices that are used now but were not before, with the piece of one triangle.
    fn vertices_added(&self, made: &[VertexId], idle: &[VertexId]) -> Vec<AddedVertex> {
        let surface = &*self.surface;
        let own = idle.iter().filter(|v| made.binary_search(v).is_err());
        // A vertex that existed without triangles keeps its own data.
        let own = own.map(|&v| {
            let (parents, weights) = ([v; 3], [1.0, 0.0, 0.0]);
            (v, VertexOrigin::Restored { parents, weights })
        });
        let by_id = OnceCell::new();
        let mut added = Vec::with_capacity(self.vertices.len());
        for (vertex, origin) in own.chain(self.vertices.iter().copied()) {
            let h = surface.topology.outgoing(vertex);
            if !h.is_null() {
                let piece = surface.piece(h.triangle());
                let origin = origin.with_parents(|v| self.used_parent(&by_id, made, v));
                added.push(AddedVertex {
                    vertex,
                    origin,
                    piece,
                });
            }
        }
        added
    }

    /// Returns a parent, or if it is a created vertex without triangles its nearest parent that is
    /// none.
    ///
    /// `by_id` keeps the created vertices in the order of `made`, once needed.
    fn used_parent(
        &self,
        by_id: &OnceCell<Vec<VertexOrigin>>,
        made: &[VertexId],
        mut parent: VertexId,
    ) -> VertexId {
        while self.surface.topology.outgoing(parent).is_null()
            && let Ok(place) = made.binary_search(&parent)
        {
            let origins = by_id.get_or_init(|| {
                let mut created = self.vertices.clone();
                created.sort_by_key(|entry| entry.0);
                created.into_iter().map(|entry| entry.1).collect()
            });
            let weights = origins[place].weights();
            let [first, ..] = weights;
            let nearest = (weights.into_iter()).fold(first, |m, p| if p.1 > m.1 { p } else { m });
            parent = nearest.0;
        }
        parent
    }

    /// Returns the pieces that lost their last triangle, ascending.
    fn pieces_removed(&self, changes: &[Change]) -> Vec<u32> {
        let surface = &*self.surface;
        let held = changes.iter().filter(|c| !c.before[0].is_null());
        let bound = self.log.piece_bound();
        let is_gone = |piece: u32| piece < bound && surface.pieces.count(piece) == 0;
        // A quick test first: the triangles of a piece come in runs.
        let kept = held.clone().map(|c| surface.piece[c.triangle.index()]);
        let mut last = None;
        let mut runs = (self.log.left_pieces().chain(kept))
            .filter(|&piece| last.replace(piece) != Some(piece));
        if !runs.any(is_gone) {
            return Vec::new();
        }
        let before = self.log.pieces_before();
        let moved = |t: TriangleId| before.binary_search_by_key(&t.0, |entry| entry.0).ok();
        let change = |t: u32| changes.binary_search_by_key(&t, |c| c.triangle.0).ok();
        let stayed = held
            .filter(|c| moved(c.triangle).is_none())
            .map(|c| surface.piece[c.triangle.index()]);
        let left = before.iter().filter(|&&(t, _)| match change(t) {
            Some(at) => !changes[at].before[0].is_null(),
            None => surface.topology.is_triangle(TriangleId(t)),
        });
        let mut pieces: Vec<u32> = stayed.chain(left.map(|entry| entry.1)).collect();
        pieces.sort_unstable();
        pieces.dedup();
        pieces.retain(|&piece| is_gone(piece));
        pieces
    }
}

/// Returns the triangle slots whose corners changed, ascending.
fn changes(log: &Log, topology: &Topology) -> Vec<Change> {
    let before = log.origin.before();
    let old = before.chunk_by(|a, b| a.0 / 3 == b.0 / 3).map(|corners| {
        let triangle = HalfEdge(corners[0].0).triangle();
        let now = topology.triangle(triangle);
        let mut before = now;
        for &(h, v) in corners {
            before[h as usize % 3] = v;
        }
        Change {
            triangle,
            before,
            now,
        }
    });
    let new = (log.piece.len()..topology.triangle_slots()).map(|t| {
        let triangle = TriangleId::from_index(t);
        Change {
            triangle,
            before: [VertexId::NULL; 3],
            now: topology.triangle(triangle),
        }
    });
    old.chain(new).filter(|c| c.before != c.now).collect()
}

/// Returns the value of a slot before the edit; none for a new slot.
fn old_value<T: Copy>(before: &[(u32, T)], v: VertexId) -> Option<T> {
    let at = before.binary_search_by_key(&v.0, |entry| entry.0).ok()?;
    Some(before[at].1)
}
