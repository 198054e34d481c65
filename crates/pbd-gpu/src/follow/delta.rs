//! Applies the delta of an edit to particles and constraints.
//!
//! Deleted edges lose their constraints as in the paper's Algorithm A1, by lookup instead of a
//! scan.

use crate::constraints::Constraints;
use crate::constraints::edges::{EdgeLists, EdgeTable, Sets};
use crate::error::ConstraintError;
use crate::follow::{FollowState, Scratch};
use crate::mass::share_by_area;
use crate::particles::Particles;
use incise_mesh::{Surface, TopologyDelta, VertexId};
use std::num::NonZeroUsize;

/// Minimum number of new triangles for an update on two threads.
const MIN_SHARED: usize = 1 << 10;

/// Checks that a delta matches the edge table and the surface, and that new vertices are finite.
pub(crate) fn check(
    edges: &EdgeTable,
    surface: &Surface,
    delta: &TopologyDelta,
) -> Result<(), ConstraintError> {
    for &(triangle, corners) in &delta.triangles_removed {
        if !edges.has_triangle(triangle, corners) {
            return Err(ConstraintError::DeltaMismatch { triangle });
        }
    }
    check_added(surface, delta)
}

/// Checks that a delta matches the surface, and that new vertices are finite.
pub(crate) fn check_added(surface: &Surface, delta: &TopologyDelta) -> Result<(), ConstraintError> {
    for &triangle in &delta.triangles_added {
        if !surface.topology().is_triangle(triangle) {
            return Err(ConstraintError::DeltaUnknownTriangle { triangle });
        }
    }
    for vertex in delta.vertices_added.iter().map(|added| added.vertex) {
        let i = vertex.index();
        let (Some(p), Some(rest)) = (surface.positions().get(i), surface.rest_positions().get(i))
        else {
            return Err(ConstraintError::UnknownVertex { vertex });
        };
        if !p[..3].iter().chain(rest).all(|c| c.is_finite()) {
            return Err(ConstraintError::NonFinitePosition { vertex });
        }
    }
    Ok(())
}

impl FollowState {
    /// Updates particles, edge constraints and interior springs after a checked edit.
    ///
    /// The inverse masses in the surface stay, see [`Self::write_inverse_masses`].
    pub(crate) fn apply_delta(
        &mut self,
        particles: &mut Particles,
        constraints: &mut Constraints,
        surface: &Surface,
        delta: &TopologyDelta,
        threads: Option<NonZeroUsize>,
    ) {
        // An undo removes slots. Their vertices pass on mass and constraints before that.
        let (before, slots) = (particles.len(), surface.topology().vertex_slots());
        resize(particles, constraints, slots.max(before));
        let Self {
            undo,
            is_late_undo,
            dropped_pins,
            lost_interior_springs,
            scratch,
            ..
        } = self;
        let Scratch {
            lists,
            mass_transfer,
            restored,
            ..
        } = scratch;
        let mut pins_changed = false;
        let mut update_particles = || {
            interpolate(&mut particles.velocities, delta);
            interpolate(&mut particles.corrections, delta);
            pins_changed = dropped_pins.restore_pins(particles, delta, restored);
            *is_late_undo = mass_transfer.run(particles, undo, surface, delta);
            pins_changed |= dropped_pins.drop_pins(particles, surface, delta);
        };
        let mut update_constraints = || {
            update_edge_constraints(constraints, lists, surface, delta);
            drop_interior_springs(constraints, surface, lost_interior_springs);
        };
        if is_shared(delta, threads) {
            rayon::in_place_scope(|scope| {
                scope.spawn(|_| update_particles());
                update_constraints();
            });
        } else {
            update_constraints();
            update_particles();
        }
        if pins_changed {
            self.log.mark_pins();
        }
        resize(particles, constraints, slots);
        let affected = &self.scratch.mass_transfer.affected.vertices;
        for &v in affected.iter().chain(&delta.vertices_removed) {
            if v.index() < slots {
                self.log.mark_vertex(v);
            }
        }
        // A backend that steps all slots also needs new unused ones.
        (before..slots).for_each(|i| self.log.mark_vertex(VertexId::from_index(i)));
    }

    /// Updates velocities and pins of the vertices of a solid after a checked edit.
    pub(crate) fn apply_solid_delta(
        &mut self,
        particles: &mut Particles,
        surface: &Surface,
        delta: &TopologyDelta,
    ) {
        // The upload to a GPU has no part smaller than the inside of a solid.
        self.log.mark_all();
        let slots = surface.topology().vertex_slots();
        particles.resize(slots.max(particles.len()));
        interpolate(&mut particles.velocities, delta);
        let mut pins_changed =
            (self.dropped_pins).restore_pins(particles, delta, &mut self.scratch.restored);
        pins_changed |= self.dropped_pins.drop_pins(particles, surface, delta);
        if pins_changed {
            self.log.mark_pins();
        }
        for &v in &delta.vertices_removed {
            particles.mass[v.index()] = 0.0;
            particles.velocities[v.index()] = [0.0; 4];
        }
        let changed = &mut self.scratch.changed;
        changed.clear();
        for &t in &delta.triangles_added {
            changed.extend(surface.topology().triangle(t));
        }
        changed.sort_unstable();
        changed.dedup();
        particles.resize(slots);
    }

    /// Updates the masses of the vertices of a solid after [`Self::apply_solid_delta`], once new
    /// vertices have rest positions, given its mass per area [kg/m^2].
    pub(crate) fn share_masses(&self, particles: &mut Particles, surface: &Surface, density: f64) {
        for &v in &self.scratch.changed {
            particles.mass[v.index()] = share_by_area(surface, v, density);
        }
    }

    /// Writes the inverse masses of the vertices that the last edit affected.
    pub(crate) fn write_inverse_masses(&self, particles: &Particles, surface: &mut Surface) {
        let positions = surface.positions_mut();
        for &v in &self.scratch.mass_transfer.affected.vertices {
            // An undo may have removed the slot.
            if let Some(position) = positions.get_mut(v.index()) {
                position[3] = particles.inverse_mass(v);
            }
        }
    }
}

/// Returns whether two threads update a solver after an edit.
fn is_shared(delta: &TopologyDelta, threads: Option<NonZeroUsize>) -> bool {
    delta.triangles_added.len() >= MIN_SHARED
        && threads.is_none_or(|threads| threads.get() > 1)
        && rayon::current_num_threads() > 1
}

/// Removes interior springs whose ends are no longer vertices of one piece, and lists the first
/// vertices of those.
fn drop_interior_springs(
    constraints: &mut Constraints,
    surface: &Surface,
    lost: &mut Vec<VertexId>,
) {
    use crate::constraints::interior_springs::is_inside;
    lost.clear();
    constraints.remove_interior_springs(|ends| !is_inside(surface, ends), lost);
    lost.retain(|&v| !surface.topology().outgoing(v).is_null());
}

/// Sets the number of vertex slots of particles and constraints.
fn resize(particles: &mut Particles, constraints: &mut Constraints, slots: usize) {
    particles.resize(slots);
    constraints.resize_vertices(slots);
}

/// Removes the stretch and bending constraints of deleted edges and adds those of new ones.
fn update_edge_constraints(
    constraints: &mut Constraints,
    lists: &mut EdgeLists,
    surface: &Surface,
    delta: &TopologyDelta,
) {
    let Constraints {
        stretch,
        bending,
        edges,
        patches,
        ..
    } = constraints;
    let topology = surface.topology();
    lists.clear();
    for &(t, _) in &delta.triangles_removed {
        edges.remove_triangle(t, lists);
    }
    edges.resize_triangles(topology.triangle_slots());
    for &t in &delta.triangles_added {
        edges.add_triangle(t, topology, lists);
    }
    let mut sets = Sets {
        stretch,
        bending: bending.as_mut(),
        patches: patches.as_mut(),
    };
    (lists.changed).retain(|&edge| edges.drop_stale(edge, surface, &mut sets));
    let bends = sets.bending.is_some();
    if let Some(patches) = &mut sets.patches {
        patches.remove_vertices(surface, delta);
        patches.add_vertices(surface.topology(), edges, lists, bends);
    }
    edges.add_missing(lists, surface, &mut sets);
}

/// Interpolates the vectors of added vertices.
#[expect(
    clippy::cast_possible_truncation,
    reason = "an interpolated number is rounded once to storage"
)]
fn interpolate(vectors: &mut [[f32; 4]], delta: &TopologyDelta) {
    for added in &delta.vertices_added {
        let vector = added
            .origin
            .interpolate(|v| vectors.get(v.index()).copied().unwrap_or_default());
        vectors[added.vertex.index()] = vector.map(|c| c as f32);
    }
}
