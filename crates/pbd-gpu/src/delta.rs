//! Constraints follow an edit: the paper's Algorithm A1 by edge key, and its counterpart for what came.

use crate::edges::{Lists, Sets};
use crate::error::ConstraintError;
use crate::inherit::{Heritage, settle};
use crate::solver::Solver;
use incise_mesh::{Surface, TopologyDelta, VertexId};

/// What following an edit needs, kept from edit to edit for its memory.
#[derive(Debug, Default)]
pub(crate) struct Following {
    lists: Lists,
    heritage: Heritage,
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
    /// The delta of an undo is followed like any other: restored vertices get their velocity from those
    /// that moved in their place, and slots that the surface no longer has are given up. Pins that went
    /// with their vertices do not come back.
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
        self.interpolate_velocities(delta);
        let mut heritage = std::mem::take(&mut self.following.heritage);
        settle(&mut heritage, self, surface, delta);
        let pins = self.pins.len();
        self.pins
            .retain(|pin| !surface.topology().outgoing(pin.vertex).is_null());
        if self.pins.len() < pins {
            self.changes.pins();
        }
        self.resize_vertices(slots);
        self.note_vertices(&heritage.concerned.vertices, delta);
        self.following.heritage = heritage;
        // New slots that no triangle uses must be known, too, to whoever steps all of them.
        (had..slots).for_each(|i| self.changes.vertex(VertexId::from_index(i)));
        self.plan.invalidate();
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
        if let Some(patches) = &mut self.patches {
            patches.resize_vertices(slots);
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
