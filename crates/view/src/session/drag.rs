//! Vertices that the pointer drags, and pinned vertices.

use super::Session;
use incise_mesh::VertexId;
use incise_scene::{Body, SceneError};

/// Maximum speed of a dragged vertex, in diagonals of the body per frame.
///
/// Larger jumps of the pointer would destroy the elements around the vertex.
const MAX_DRAG_SPEED: f32 = 0.04;

/// A vertex that the pointer drags.
#[derive(Debug, Clone, Copy)]
pub(super) struct DraggedVertex {
    vertex: VertexId,
    /// Position of the pointer \[m\].
    target: [f32; 3],
    /// Current position of the pin \[m\].
    at: [f32; 3],
    /// True if the vertex was pinned before the drag.
    was_pinned: bool,
}

impl Session {
    /// Returns the dragged vertex.
    #[must_use]
    pub fn held_vertex(&self) -> Option<VertexId> {
        self.dragged.map(|dragged| dragged.vertex)
    }

    /// Returns true if the vertex exists.
    fn has_vertex(&self, v: VertexId) -> bool {
        let topology = self.surface().topology();
        v.index() < topology.vertex_slots() && topology.vertices().any(|u| u == v)
    }

    pub(super) fn grab(&mut self, vertex: VertexId) -> Result<(), SceneError> {
        self.release()?;
        self.scene.read_back(self.body)?;
        if !self.has_vertex(vertex) {
            return Ok(());
        }
        let is_pinned = self.is_pinned(vertex);
        let (solver, surface) = self.scene.edit(self.body)?.solver_mut();
        solver.pin(surface, vertex)?;
        let [x, y, z, _] = surface.positions()[vertex.index()];
        let at = [x, y, z];
        self.dragged = Some(DraggedVertex {
            vertex,
            target: at,
            at,
            was_pinned: is_pinned,
        });
        Ok(())
    }

    pub(super) fn drag(&mut self, to: [f32; 3]) {
        if let Some(dragged) = &mut self.dragged
            && to.iter().all(|x| x.is_finite())
        {
            dragged.target = to;
        }
    }

    /// Moves the dragged vertex toward its target, or ends the drag if a cut removed the vertex.
    pub(super) fn advance_drag(&mut self) -> Result<(), SceneError> {
        let Some(mut dragged) = self.dragged else {
            return Ok(());
        };
        if !self.is_pinned(dragged.vertex) {
            self.dragged = None;
            return Ok(());
        }
        let way = [0, 1, 2].map(|k| dragged.target[k] - dragged.at[k]);
        let length = way.iter().map(|c| c * c).sum::<f32>().sqrt();
        let most = MAX_DRAG_SPEED * self.diagonal;
        let share = if length > most { most / length } else { 1.0 };
        dragged.at = [0, 1, 2].map(|k| dragged.at[k] + share * way[k]);
        if share == 1.0 {
            dragged.at = dragged.target;
        }
        self.dragged = Some(dragged);
        self.scene
            .set_pin_target(self.body, dragged.vertex, dragged.at)
    }

    pub(super) fn release(&mut self) -> Result<(), SceneError> {
        let Some(dragged) = self.dragged.take() else {
            return Ok(());
        };
        if dragged.was_pinned || !self.is_pinned(dragged.vertex) {
            return Ok(());
        }
        let (solver, surface) = self.scene.edit(self.body)?.solver_mut();
        Ok(solver.unpin(surface, dragged.vertex)?)
    }

    pub(super) fn pin(&mut self, vertex: VertexId) -> Result<(), SceneError> {
        self.scene.read_back(self.body)?;
        if !self.has_vertex(vertex) {
            return Ok(());
        }
        let is_pinned = self.is_pinned(vertex);
        let (solver, surface) = self.scene.edit(self.body)?.solver_mut();
        if is_pinned {
            solver.unpin(surface, vertex)?;
        } else {
            solver.pin(surface, vertex)?;
        }
        Ok(())
    }

    pub(super) fn unpin(&mut self) -> Result<(), SceneError> {
        self.dragged = None;
        let (solver, surface) = self.scene.edit(self.body)?.solver_mut();
        while let Some(pin) = solver.pins().last().copied() {
            solver.unpin(surface, pin.vertex)?;
        }
        Ok(())
    }

    fn is_pinned(&self, v: VertexId) -> bool {
        let is_pinned = |body: &Body| {
            let pins = body.solver().pins();
            pins.binary_search_by_key(&v, |pin| pin.vertex).is_ok()
        };
        self.scene.body(self.body).is_ok_and(is_pinned)
    }

    /// Returns pinned vertices with their target positions \[m\], the dragged vertex included.
    pub fn pins(&self) -> impl Iterator<Item = (VertexId, [f32; 3])> + '_ {
        let body = self.scene.body(self.body).ok().into_iter();
        let pins = body.flat_map(|body| body.solver().pins());
        pins.map(|pin| (pin.vertex, pin.target))
    }
}
