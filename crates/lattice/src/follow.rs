//! The stages by which a lattice follows an edit of its surface.
//!
//! A lattice is built by the same stages, as if an edit had added all triangles.

use crate::body::Body;
use crate::cell::NONE;
use crate::change::LatticeChange;
use crate::lattice::{Lattice, State};
use crate::work::Work;
use incise_mesh::{Surface, TopologyDelta, TriangleId, VertexId};

impl Lattice {
    /// Follows an edit of the surface, and writes the change of the lattice.
    ///
    /// Call it after each edit, in order. Only cells that hold removed or added triangles are
    /// solved. Copies and nodes elsewhere keep their numbers; small parts up to two cells away may
    /// get another copy. The lattice is then the same as one built from nothing, up to numbers and
    /// rounding. A surface that was edited unseen gives a wrong lattice, without a panic.
    pub fn follow(&mut self, surface: &Surface, delta: &TopologyDelta, change: &mut LatticeChange) {
        let grid = self.grid;
        let body = Body::new(surface, &grid);
        change.clear();
        change.work.prepare(&body);
        if delta.is_empty() {
            return;
        }
        let (removed, added) = (&delta.triangles_removed, &delta.triangles_added);
        self.update(&body, removed, added, Some(delta), change);
        for &v in &delta.vertices_removed {
            if self.vertex_copies.get(v.index()).is_some() && is_free(surface, v) {
                self.vertex_copies[v.index()] = NONE;
                self.vertex_weights[v.index()] = [0.0; 8];
            }
        }
    }

    /// Follows the addition of all triangles.
    pub(crate) fn add_all(&mut self, surface: &Surface) {
        let grid = self.grid;
        let body = Body::new(surface, &grid);
        let mut change = LatticeChange::default();
        change.work.prepare(&body);
        let added: Vec<TriangleId> = surface.topology().triangles().collect();
        // With room for the vertices of cuts, so that the first one moves no array.
        let slots = surface.topology().vertex_slots();
        self.vertex_copies.reserve(slots + slots / 4);
        self.vertex_weights.reserve(slots + slots / 4);
        self.update(&body, &[], &added, None, &mut change);
    }

    /// Removes and adds triangles, and updates parts, copies, nodes and vertices, in this order.
    fn update(
        &mut self,
        body: &Body<'_>,
        removed: &[(TriangleId, [VertexId; 3])],
        added: &[TriangleId],
        delta: Option<&TopologyDelta>,
        change: &mut LatticeChange,
    ) {
        let slots = body.surface.topology().vertex_slots();
        self.vertex_copies.resize(slots, NONE);
        self.vertex_weights.resize(slots, [0.0; 8]);
        let mut work = std::mem::take(&mut change.work);
        let state = &mut self.state;
        let (content, touched) = (&mut state.content, &mut work.touched);
        content.update(body, removed, added, &mut work.content, touched);
        if let Some(delta) = delta {
            content.touch_pieces(body, delta, touched);
        }
        state.solve(body, &mut work);
        state.link(body, &work);
        self.find_parents(&work);
        self.state.settle(body, &mut work);
        self.update_copies(&work, change);
        self.update_moments(&work, change);
        self.update_nodes(&work, change);
        self.embed(body, &mut work, change);
        let parts = &mut self.state.parts;
        parts.forget_old_copies(&work.parts);
        parts.forget_old_copies(&work.clusters.members);
        parts.free(&work.old_parts);
        change.work = work;
    }
}

impl State {
    /// Solves the touched cells, and those that spans now pass into or no longer do.
    fn solve(&mut self, body: &Body<'_>, work: &mut Work) {
        let mut next = 0;
        while let Some(&cell) = work.touched.members.get(next) {
            next += 1;
            work.solve_touched(body, self, cell);
            for axis in 0..3 {
                let [below, above] = [2 * axis, 2 * axis + 1].map(|face| work.solver.inside[face]);
                let own = &mut self.content.inside[cell as usize][axis];
                if *own != below {
                    *own = below;
                    if let Some(lower) = body.grid.beside(cell, 2 * axis) {
                        work.touched.insert(lower);
                    }
                }
                if let Some(upper) = body.grid.beside(cell, 2 * axis + 1)
                    && self.content.inside[upper as usize][axis] != above
                {
                    work.touched.insert(upper);
                }
            }
        }
        work.sort();
    }

    /// Links the parts that meet in faces of touched cells.
    fn link(&mut self, body: &Body<'_>, work: &Work) {
        for solved in &work.solved {
            for face in 0..6 {
                let Some(beside) = body.grid.beside(solved.cell, face) else {
                    continue;
                };
                // A face between two touched cells belongs to the lower one.
                if face % 2 == 1 {
                    self.link_across(body, [solved.cell, beside], face / 2);
                } else if !work.touched.contains(beside) {
                    self.link_across(body, [beside, solved.cell], face / 2);
                }
            }
        }
    }

    /// Links the parts that meet in the face between two cells, the lower one first.
    fn link_across(&mut self, body: &Body<'_>, cells: [u32; 2], axis: usize) {
        let (content, parts) = (&self.content, &mut self.parts);
        let [Some(low), Some(high)] = cells.map(|cell| parts.of_cell(cell).next()) else {
            return;
        };
        let [lows, highs] = cells.map(|cell| self.divided.get(&cell));
        let (listed, face) = match [lows, highs] {
            [None, None] => {
                let [a, b] = cells.map(|cell| content.triangles(cell));
                let fewer = if a.len() < b.len() { a } else { b };
                let mut triangles = fewer.iter().map(|&t| TriangleId(t));
                let meets = content.inside[cells[1] as usize][axis] != 0
                    || triangles.any(|t| content.meets_face(body, t, cells, axis));
                if meets {
                    parts.link(low, high, axis);
                }
                return;
            }
            [Some(own), _] => (own, 2 * axis + 1),
            [None, Some(own)] => (own, 2 * axis),
        };
        let low_spans = lows.map(|own| own.passing(2 * axis + 1));
        let high_spans = highs.map(|own| own.passing(2 * axis));
        let count = [low_spans, high_spans]
            .into_iter()
            .flatten()
            .map(<[u32]>::len)
            .min();
        for i in 0..count.unwrap_or(0) {
            let low = low_spans.map_or(low, |own| own[i]);
            let high = high_spans.map_or(high, |own| own[i]);
            parts.link(low, high, axis);
        }
        for t in listed.crossing(face) {
            let low = lows.map_or(Some(low), |own| own.part_of(t));
            let high = highs.map_or(Some(high), |own| own.part_of(t));
            let (Some(low), Some(high)) = (low, high) else {
                continue;
            };
            if !parts.are_linked(low, high) && content.meets_face(body, t, cells, axis) {
                parts.link(low, high, axis);
            }
        }
    }

    /// Finds the carriers of small parts near touched cells.
    fn settle(&mut self, body: &Body<'_>, work: &mut Work) {
        let parts = &mut self.parts;
        for solved in &work.solved {
            work.near.insert(solved.cell);
            for beside in (0..6).filter_map(|face| body.grid.beside(solved.cell, face)) {
                work.near.insert(beside);
            }
        }
        let near = work
            .near
            .members
            .iter()
            .flat_map(|&cell| parts.of_cell(cell));
        work.clusters.find(parts, near);
        // New parts have no old carrier.
        let is_new =
            |parts: &crate::parts::Parts, part: u32| work.touched.contains(parts.get(part).cell);
        let mut old_carriers = Vec::new();
        for &part in &work.clusters.members {
            let old = if is_new(parts, part) {
                NONE
            } else {
                parts.get(part).carrier
            };
            if old != NONE {
                parts.get_mut(part).old_copy = parts.carrying_copy(part);
            }
            old_carriers.push(old);
        }
        work.clusters.settle(parts);
        for (&part, old) in work.clusters.members.iter().zip(old_carriers) {
            let carrier = parts.get(part).carrier;
            if carrier != old {
                work.carriers.push(carrier);
                work.carriers.extend((old != NONE).then_some(old));
                work.moved.push(part);
            }
        }
        for solved in &work.solved {
            let own = &work.parts[solved.parts.clone()];
            work.carriers
                .extend(own.iter().filter(|&&part| !parts.get(part).is_small));
            for &part in &work.old_parts[solved.old_parts.clone()] {
                work.carriers.push(parts.get(part).carrier);
            }
        }
        work.carriers.retain(|&part| parts.get(part).is_live);
        work.carriers
            .sort_unstable_by_key(|&part| parts.order(part));
        work.carriers.dedup();
    }
}

/// Returns whether a vertex slot is free.
fn is_free(surface: &Surface, v: VertexId) -> bool {
    let topology = surface.topology();
    v.index() >= topology.vertex_slots() || topology.outgoing(v).is_null()
}
