//! Pins of deleted vertices, which return if an undo restores the vertices.

use crate::particles::{Particles, Pin};
use incise_mesh::{Surface, TopologyDelta, VertexId, VertexOrigin};

/// A deleted vertex and the target of its pin, if it had one.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct DroppedPin {
    vertex: VertexId,
    /// \[m\]
    target: Option<[f32; 3]>,
}

/// The pins of deleted vertices, newest last.
///
/// An entry without target shadows older pins of the same slot.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct DroppedPins(Vec<DroppedPin>);

impl DroppedPins {
    /// Returns whether all targets are finite.
    #[cfg(feature = "serde")]
    pub(crate) fn is_valid(&self) -> bool {
        let targets = self.0.iter().filter_map(|entry| entry.target);
        targets.flatten().all(|c| c.is_finite())
    }

    /// Returns the allocated size in elements.
    pub(crate) fn capacity(&self) -> usize {
        self.0.capacity()
    }

    /// Removes the pins of deleted vertices; returns true if there were any.
    ///
    /// It remembers them unless the edit is an undo: vertices that an undo deletes never return.
    pub(crate) fn drop_pins(
        &mut self,
        particles: &mut Particles,
        surface: &Surface,
        delta: &TopologyDelta,
    ) -> bool {
        let is_undo = !delta.removed_positions.is_empty();
        if !is_undo {
            self.shadow(particles, delta);
        }
        let before = particles.pins.len();
        particles.pins.retain(|&Pin { vertex, target }| {
            let exists = !surface.topology().outgoing(vertex).is_null();
            if !exists && !is_undo {
                let target = Some(target);
                self.0.push(DroppedPin { vertex, target });
            }
            exists
        });
        particles.pins.len() < before
    }

    /// Adds entries for deleted vertices without a pin whose slots have older entries.
    fn shadow(&mut self, particles: &Particles, delta: &TopologyDelta) {
        let older = self.0.len();
        for i in 0..older {
            let vertex = self.0[i].vertex;
            let is_removed = delta.vertices_removed.binary_search(&vertex).is_ok();
            let is_shadowed = self.0[older..].iter().any(|entry| entry.vertex == vertex);
            if is_removed && particles.find_pin(vertex).is_err() && !is_shadowed {
                let target = None;
                self.0.push(DroppedPin { vertex, target });
            }
        }
    }

    /// Pins restored vertices that were pinned when they were deleted; returns true if there are
    /// any.
    pub(crate) fn restore_pins(
        &mut self,
        particles: &mut Particles,
        delta: &TopologyDelta,
        restored: &mut Vec<VertexId>,
    ) -> bool {
        if self.0.is_empty() {
            return false;
        }
        restored.clear();
        let added = delta.vertices_added.iter();
        let back = added.filter(|added| matches!(added.origin, VertexOrigin::Restored { .. }));
        restored.extend(back.map(|added| added.vertex));
        restored.sort_unstable();
        let mut any = false;
        for i in (0..self.0.len()).rev() {
            let DroppedPin { vertex, target } = self.0[i];
            let Ok(at) = restored.binary_search(&vertex) else {
                continue;
            };
            restored.remove(at);
            self.0.remove(i);
            if let (Some(target), Err(index)) = (target, particles.find_pin(vertex)) {
                particles.pins.insert(index, Pin { vertex, target });
                any = true;
            }
        }
        any
    }
}
