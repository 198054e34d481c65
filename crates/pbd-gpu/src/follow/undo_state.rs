//! Masses, positions and velocities before an edit, which an undo restores bit for bit.
//!
//! The transfer of mass preserves sums, but only to rounding. An undo that transferred mass again
//! would leave other masses than before the edit, and the same cut would then differ.

use crate::follow::affected::Affected;
use crate::particles::Particles;
use incise_mesh::{Surface, TopologyDelta, VertexId};

/// Maximum depth of the undo stack.
const MAX_DEPTH: usize = 64;

/// Bits of position \[m\], mass \[kg\] and velocity [m/s] of a vertex.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct VertexState {
    vertex: VertexId,
    position: [u32; 3],
    mass: u32,
    velocity: [u32; 4],
}

/// The affected vertices of an edit before and after it, each ascending by vertex.
#[derive(Debug, Clone, Default)]
struct UndoState {
    before: Vec<VertexState>,
    after: Vec<VertexState>,
}

/// States of the last edits, newest last, as long as no vertex has moved since.
#[derive(Debug, Clone, Default)]
pub(crate) struct UndoStack(Vec<UndoState>);

impl UndoStack {
    /// Returns the allocated size in elements.
    pub(crate) fn capacity(&self) -> usize {
        let state = |state: &UndoState| state.before.capacity() + state.after.capacity();
        self.0.iter().map(state).sum()
    }

    /// Records the affected vertices before an edit.
    pub(crate) fn record_before(
        &mut self,
        particles: &Particles,
        surface: &Surface,
        delta: &TopologyDelta,
        affected: &Affected,
    ) {
        let is_current =
            |s: &VertexState| state_of(particles, surface, delta, s.vertex) == Some(*s);
        let last = self.0.last();
        if last.is_some_and(|last| !last.after.iter().all(is_current)) {
            self.0.clear();
        }
        let before = states_of(particles, surface, delta, affected.existing_before());
        let after = Vec::new();
        if self.0.len() == MAX_DEPTH {
            self.0.remove(0);
        }
        self.0.push(UndoState { before, after });
    }

    /// Records the affected vertices after the edit.
    pub(crate) fn record_after(
        &mut self,
        particles: &Particles,
        surface: &Surface,
        delta: &TopologyDelta,
        affected: &Affected,
    ) {
        let after = states_of(particles, surface, delta, affected.existing_after());
        if let Some(last) = self.0.last_mut() {
            last.after = after;
        }
    }

    /// Restores the state before the last edit if `delta` undoes it and nothing has changed since.
    ///
    /// Returns true if it did.
    pub(crate) fn restore(
        &mut self,
        particles: &mut Particles,
        surface: &mut Surface,
        delta: &TopologyDelta,
        affected: &Affected,
    ) -> bool {
        let now = states_of(particles, surface, delta, affected.existing_before());
        let mut existing = affected.existing_after().to_vec();
        existing.sort_unstable();
        let Some(UndoState { before, after }) = self.0.pop() else {
            return false;
        };
        let is_same = before.iter().map(|s| s.vertex).eq(existing);
        if now != after || !is_same {
            self.0.clear();
            return false;
        }
        for state in before {
            let v = state.vertex;
            particles.mass[v.index()] = f32::from_bits(state.mass);
            particles.velocities[v.index()] = state.velocity.map(f32::from_bits);
            surface.positions_mut()[v.index()][3] = particles.inverse_mass(v);
        }
        true
    }
}

/// Returns the states of vertices, ascending by vertex.
fn states_of(
    particles: &Particles,
    surface: &Surface,
    delta: &TopologyDelta,
    vertices: &[VertexId],
) -> Vec<VertexState> {
    let states = vertices
        .iter()
        .filter_map(|&v| state_of(particles, surface, delta, v));
    let mut states: Vec<VertexState> = states.collect();
    states.sort_unstable_by_key(|s| s.vertex);
    states
}

fn state_of(
    particles: &Particles,
    surface: &Surface,
    delta: &TopologyDelta,
    v: VertexId,
) -> Option<VertexState> {
    let current = surface
        .positions()
        .get(v.index())
        .map(|&[x, y, z, _]| [x, y, z]);
    let position = delta.removed_position(v).or(current)?;
    Some(VertexState {
        vertex: v,
        position: position.map(f32::to_bits),
        mass: particles.mass.get(v.index())?.to_bits(),
        velocity: particles.velocities.get(v.index())?.map(f32::to_bits),
    })
}
