//! Render buffers that follow a body of a [`Scene`].

use crate::body::BodyId;
use crate::error::SceneError;
use crate::scene::Scene;
use incise_mesh::{RenderBuffers, TopologyDelta};

/// The change that [`Scene::update_render_buffers`] made to buffers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum BufferChange {
    /// Positions, normals and tangents are new. Upload these.
    Motion,
    /// The body was cut, or a cut was undone. Upload everything.
    Topology,
}

impl Scene {
    /// Brings render buffers of a body up to date with its last frame. Reads a GPU body back first.
    ///
    /// Call it after every frame: buffers that follow each cut keep the numbers of vertices away
    /// from it. They are built again after two cuts within a frame, and if a cut was not followed.
    /// A frame without a cut allocates nothing. Edits of UVs and channels between cuts need
    /// [`RenderBuffers::rebuild`].
    ///
    /// # Errors
    /// As [`Scene::read_back`]; the buffers are unchanged then.
    ///
    /// ```
    /// use incise_mesh::{RenderBuffers, RenderParams, icosphere};
    /// use incise_pbd_gpu::Material;
    /// use incise_scene::{BufferChange, Scene, SceneParams};
    ///
    /// let mut scene = Scene::new(SceneParams::default());
    /// let ball = scene.add_body(icosphere(2, 0.5), &Material::default())?;
    /// let surface = scene.body(ball)?.surface();
    /// let mut buffers = RenderBuffers::new(surface, RenderParams::default());
    /// scene.step()?;
    /// let change = scene.update_render_buffers(ball, &mut buffers)?;
    /// assert_eq!(change, BufferChange::Motion);
    /// # Ok::<(), incise_scene::SceneError>(())
    /// ```
    pub fn update_render_buffers(
        &mut self,
        id: BodyId,
        buffers: &mut RenderBuffers,
    ) -> Result<BufferChange, SceneError> {
        self.read_back(id)?;
        let body = self.body(id)?;
        let surface = body.surface();
        if buffers.fingerprint() == surface.fingerprint() {
            buffers.refresh(surface);
            return Ok(BufferChange::Motion);
        }
        match self.only_cut(id) {
            Some(delta) if buffers.fingerprint() == body.version_before_cut() => {
                buffers.update(surface, delta);
            }
            _ => buffers.rebuild(surface),
        }
        Ok(BufferChange::Topology)
    }

    /// Returns the change of a body that was cut once in the last frame.
    fn only_cut(&self, id: BodyId) -> Option<&TopologyDelta> {
        let cuts = self.cuts.iter().filter_map(|result| result.cut.as_ref());
        let mut own = cuts.filter(|(body, _)| *body == id);
        match (own.next(), own.next()) {
            (Some((_, outcome)), None) => Some(&outcome.delta),
            _ => None,
        }
    }
}
