//! Vertices that are held: by a pointer, or by pins.

use super::Session;
use incise_mesh::VertexId;
use incise_scene::SceneError;

/// How fast a held vertex follows, in diagonals of the body a frame: a pointer may jump, and what is pulled along would burst.
const FASTEST: f32 = 0.04;

/// A vertex that a pointer holds.
#[derive(Debug, Clone, Copy)]
pub(super) struct Grip {
    vertex: VertexId,
    /// Where it is pulled to \[m\].
    wanted: [f32; 3],
    /// Where it is held now \[m\].
    at: [f32; 3],
    /// Whether it was pinned before.
    is_pinned: bool,
}

impl Session {
    /// The vertex that is held.
    #[must_use]
    pub fn held_vertex(&self) -> Option<VertexId> {
        self.grip.map(|grip| grip.vertex)
    }

    /// Whether the surface has such a vertex still.
    fn has(&self, v: VertexId) -> bool {
        let topology = self.surface().topology();
        v.index() < topology.vertex_slots() && topology.vertices().any(|u| u == v)
    }

    pub(super) fn grab(&mut self, vertex: VertexId) -> Result<(), SceneError> {
        self.release()?;
        self.scene.read(self.body)?;
        if !self.has(vertex) {
            return Ok(());
        }
        let is_pinned = self.is_pinned(vertex);
        let (solver, surface) = self.scene.edit(self.body)?.solver_mut();
        solver.pin(surface, vertex)?;
        let [x, y, z, _] = surface.positions[vertex.index()];
        let at = [x, y, z];
        self.grip = Some(Grip {
            vertex,
            wanted: at,
            at,
            is_pinned,
        });
        Ok(())
    }

    pub(super) fn drag(&mut self, to: [f32; 3]) {
        if let Some(grip) = &mut self.grip
            && to.iter().all(|x| x.is_finite())
        {
            grip.wanted = to;
        }
    }

    /// Pulls the held vertex a frame farther. A cut may have taken it.
    pub(super) fn follow_grip(&mut self) -> Result<(), SceneError> {
        let Some(mut grip) = self.grip else {
            return Ok(());
        };
        if !self.is_pinned(grip.vertex) {
            self.grip = None;
            return Ok(());
        }
        let way = [0, 1, 2].map(|k| grip.wanted[k] - grip.at[k]);
        let length = way.iter().map(|c| c * c).sum::<f32>().sqrt();
        let most = FASTEST * self.diagonal;
        let share = if length > most { most / length } else { 1.0 };
        grip.at = [0, 1, 2].map(|k| grip.at[k] + share * way[k]);
        if share == 1.0 {
            grip.at = grip.wanted;
        }
        self.grip = Some(grip);
        self.scene.set_pin_target(self.body, grip.vertex, grip.at)
    }

    pub(super) fn release(&mut self) -> Result<(), SceneError> {
        let Some(grip) = self.grip.take() else {
            return Ok(());
        };
        if grip.is_pinned || !self.is_pinned(grip.vertex) {
            return Ok(());
        }
        let (solver, surface) = self.scene.edit(self.body)?.solver_mut();
        Ok(solver.unpin(surface, grip.vertex)?)
    }

    pub(super) fn pin(&mut self, vertex: VertexId) -> Result<(), SceneError> {
        self.scene.read(self.body)?;
        if !self.has(vertex) {
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
        self.grip = None;
        let (solver, surface) = self.scene.edit(self.body)?.solver_mut();
        while let Some(pin) = solver.pins().last().copied() {
            solver.unpin(surface, pin.vertex)?;
        }
        Ok(())
    }

    fn is_pinned(&self, v: VertexId) -> bool {
        let pins = self.scene.body(self.body).solver().pins();
        pins.binary_search_by_key(&v, |pin| pin.vertex).is_ok()
    }

    /// Where vertices are pinned \[m\], the held one too.
    pub fn pins(&self) -> impl Iterator<Item = (VertexId, [f32; 3])> + '_ {
        let pins = self.scene.body(self.body).solver().pins();
        pins.iter().map(|pin| (pin.vertex, pin.target))
    }
}
