//! Constraints follow an edit: the paper's Algorithm A1 by edge key, and its counterpart for what came.

use crate::edges::{Lists, Sets};
use crate::error::ConstraintError;
use crate::inherit::{Heritage, settle};
use crate::plan::Pin;
use crate::solver::Solver;
use incise_mesh::{Origin, Surface, TopologyDelta, VertexId};

/// What following an edit needs, kept from edit to edit for its memory.
#[derive(Debug, Default)]
pub(crate) struct Following {
    lists: Lists,
    heritage: Heritage,
    restored: Vec<VertexId>,
}

/// What became of a vertex that went, for when it comes back.
#[derive(Debug, Clone, Copy)]
pub(crate) struct DroppedPin {
    vertex: VertexId,
    /// Where its pin held it \[m\]; none where it had none.
    target: Option<[f32; 3]>,
}

impl Clone for Following {
    /// Scratch memory is not worth copying.
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl Solver {
    /// Follows an edit of the surface. Edges that are no more lose their constraints, new ones get
    /// theirs with rest values from rest positions, colors are updated in place; what the edit did not
    /// touch keeps its constraints. New vertices get their velocity from their origin. Within each piece
    /// that was touched, the corners of changed triangles share the mass that they and the removed
    /// vertices had, by rest area. O(k log k) for k changed triangles.
    ///
    /// The vertices concerned of what was one piece before the edit keep their mass, their center of
    /// mass, their momentum and their angular momentum about any fixed point, to rounding. For the
    /// center, shares are tilted; for the momenta, those that are not pinned move as a rigid body on top
    /// of how they move. Where the new vertices do not reach around the old center, as after the removal
    /// of a corner, angular momentum is kept about the center of mass only: a body that flies straight on
    /// does so after any edit. Vertices on a line take no spin about it, a single one takes none. Nobody
    /// is moved along, or about any axis, by more than four times the highest speed that there was, so
    /// kinetic energy stays bounded: no speed is more than twelve times that one.
    ///
    /// The delta of an undo is followed like any other, but that of an edit that made vertices gives, before anything
    /// has moved, masses and velocities back to the bit, as the undo does with the surface. Else restored vertices get their velocity from those
    /// that moved in their place, and slots that the surface no longer has are given up. Pins that went
    /// with their vertices come back with them, to hold them where they did. They are kept for that as long as the
    /// solver is; those of vertices that an edit had made are not, since nothing brings these back.
    ///
    /// Unlike [`Solver::new`] this accepts edges without rest length: a cut may pass through any point.
    ///
    /// # Errors
    /// [`ConstraintError`] when the delta does not fit to the solver or the surface, or a new vertex is
    /// not finite; nothing is changed then.
    pub fn apply_delta(
        &mut self,
        surface: &mut Surface,
        delta: &TopologyDelta,
    ) -> Result<(), ConstraintError> {
        self.check_delta(surface, delta)?;
        // An undo gives slots up, whose vertices leave mass and constraints behind first.
        let (had, slots) = (self.mass.len(), surface.topology().vertex_slots());
        self.resize_vertices(slots.max(had));
        self.update_constraints(surface, delta);
        self.drop_struts(surface);
        self.interpolate_velocities(delta);
        self.restore_pins(delta);
        let mut heritage = std::mem::take(&mut self.following.heritage);
        settle(&mut heritage, self, surface, delta);
        self.drop_pins(surface, delta);
        self.resize_vertices(slots);
        self.note_vertices(&heritage.concerned.vertices, delta);
        self.following.heritage = heritage;
        // New slots that no triangle uses must be known, too, to whoever steps all of them.
        (had..slots).for_each(|i| self.changes.vertex(VertexId::from_index(i)));
        self.update_volumes(surface);
        self.contacts.clear();
        self.plan.invalidate();
        self.tethers.invalidate();
        Ok(())
    }

    /// Makes room for so many vertices, or gives up what is beyond.
    fn resize_vertices(&mut self, slots: usize) {
        self.mass.resize(slots, 0.0);
        self.velocities.resize(slots, [0.0; 4]);
        self.stretch.resize_vertices(slots);
        if let Some(bending) = &mut self.bending {
            bending.resize_vertices(slots);
        }
        if let Some(struts) = &mut self.struts {
            struts.resize_vertices(slots);
        }
        if let Some(patches) = &mut self.patches {
            patches.resize_vertices(slots);
        }
    }

    /// Drops the pins of vertices that went. Those that may come back are kept: all but the ones that an undo takes
    /// away, which is what tells where they were.
    fn drop_pins(&mut self, surface: &Surface, delta: &TopologyDelta) {
        let (pins, stays) = (self.pins.len(), self.dropped_pins.len());
        let for_good = !delta.removed_from.is_empty();
        if !for_good {
            // Of a slot that is used again the newest entry is that of the vertex that went last, pinned or not.
            for i in 0..stays {
                let vertex = self.dropped_pins[i].vertex;
                let is_new = |entry: &DroppedPin| entry.vertex != vertex;
                let went = delta.vertices_removed.binary_search(&vertex).is_ok();
                if went
                    && self
                        .pins
                        .binary_search_by_key(&vertex, |pin| pin.vertex)
                        .is_err()
                    && self.dropped_pins[stays..].iter().all(is_new)
                {
                    let target = None;
                    self.dropped_pins.push(DroppedPin { vertex, target });
                }
            }
        }
        let dropped = &mut self.dropped_pins;
        self.pins.retain(|&Pin { vertex, target }| {
            let stays = !surface.topology().outgoing(vertex).is_null();
            if !stays && !for_good {
                let target = Some(target);
                dropped.push(DroppedPin { vertex, target });
            }
            stays
        });
        if self.pins.len() < pins {
            self.changes.pins();
        }
    }

    /// Pins the vertices again that come back and were pinned when they went.
    fn restore_pins(&mut self, delta: &TopologyDelta) {
        if self.dropped_pins.is_empty() {
            return;
        }
        let restored = &mut self.following.restored;
        restored.clear();
        let added = delta.vertices_added.iter();
        let back = added.filter(|added| matches!(added.origin, Origin::Restored { .. }));
        restored.extend(back.map(|added| added.vertex));
        restored.sort_unstable();
        for i in (0..self.dropped_pins.len()).rev() {
            let DroppedPin { vertex, target } = self.dropped_pins[i];
            let Ok(at) = restored.binary_search(&vertex) else {
                continue;
            };
            restored.remove(at);
            self.dropped_pins.remove(i);
            let place = self.pins.binary_search_by_key(&vertex, |pin| pin.vertex);
            if let (Some(target), Err(place)) = (target, place) {
                self.pins.insert(place, Pin { vertex, target });
                self.changes.pins();
            }
        }
    }

    fn check_delta(&self, surface: &Surface, delta: &TopologyDelta) -> Result<(), ConstraintError> {
        for &(triangle, corners) in &delta.triangles_removed {
            if !self.edges.has_triangle(triangle, corners) {
                return Err(ConstraintError::DeltaMismatch { triangle });
            }
        }
        for &triangle in &delta.triangles_added {
            if !surface.topology().is_triangle(triangle) {
                return Err(ConstraintError::DeltaUnknownTriangle { triangle });
            }
        }
        for vertex in delta.vertices_added.iter().map(|added| added.vertex) {
            let i = vertex.index();
            let (Some(p), Some(rest)) = (surface.positions.get(i), surface.rest.get(i)) else {
                return Err(ConstraintError::UnknownVertex { vertex });
            };
            if !p[..3].iter().chain(rest).all(|c| c.is_finite()) {
                return Err(ConstraintError::NonFinitePosition { vertex });
            }
        }
        Ok(())
    }

    /// Notes whose mass, velocity or position the edit may have set: the corners of all triangles that
    /// came or went, and the vertices that did.
    fn note_vertices(&mut self, concerned: &[VertexId], delta: &TopologyDelta) {
        for &v in concerned.iter().chain(&delta.vertices_removed) {
            if v.index() < self.mass.len() {
                self.changes.vertex(v);
            }
        }
    }

    fn update_constraints(&mut self, surface: &Surface, delta: &TopologyDelta) {
        let topology = surface.topology();
        let lists = &mut self.following.lists;
        lists.clear();
        for &(t, _) in &delta.triangles_removed {
            self.edges.remove_triangle(t, lists);
        }
        let slots = topology.triangle_slots();
        self.edges.resize_triangles(slots);
        for &t in &delta.triangles_added {
            self.edges.add_triangle(t, topology, lists);
        }
        let mut sets = Sets {
            stretch: &mut self.stretch,
            bending: self.bending.as_mut(),
            patches: self.patches.as_mut(),
        };
        let touched = &mut lists.touched;
        touched.retain(|&edge| self.edges.drop_stale(edge, surface, &mut sets));
        let bends = sets.bending.is_some();
        if let Some(patches) = &mut sets.patches {
            patches.leave(surface, delta);
            patches.join(surface, delta, lists.edges(), &self.edges, bends);
        }
        self.edges.add_missing(lists, surface, &mut sets);
    }

    #[expect(
        clippy::cast_possible_truncation,
        reason = "an interpolated velocity is rounded once to storage"
    )]
    fn interpolate_velocities(&mut self, delta: &TopologyDelta) {
        for added in &delta.vertices_added {
            let velocity = added
                .origin
                .interpolate(|v| self.velocities.get(v.index()).copied().unwrap_or_default());
            self.velocities[added.vertex.index()] = velocity.map(|c| c as f32);
        }
    }
}
