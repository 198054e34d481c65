//! The scene: what it holds and how it is set up.

use crate::blade::{Blade, BladeId};
use crate::body::{Body, BodyId};
use crate::error::SceneError;
use crate::params::SceneParams;
use crate::stats::FrameStats;
use incise_cut::{CutError, CutOutcome};
use incise_mesh::Surface;
use incise_pbd_gpu::Material;

/// A cut that could not be done. The body is as it was.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Refusal {
    /// Which body.
    pub body: BodyId,
    /// Why.
    pub error: CutError,
}

/// Bodies, blades and how they are stepped.
#[derive(Debug, Clone, Default)]
pub struct Scene {
    /// How frames are stepped; may change between frames.
    pub params: SceneParams,
    pub(crate) bodies: Vec<Body>,
    pub(crate) blades: Vec<Blade>,
    pub(crate) stats: FrameStats,
    pub(crate) refusals: Vec<Refusal>,
    pub(crate) outcomes: Vec<(BodyId, CutOutcome)>,
}

impl Scene {
    /// An empty scene.
    #[must_use]
    pub fn new(params: SceneParams) -> Self {
        Self {
            params,
            ..Self::default()
        }
    }

    /// Adds a body at rest.
    ///
    /// # Errors
    /// [`SceneError::Constraint`] when the surface or the material cannot be simulated.
    pub fn add_body(
        &mut self,
        surface: Surface,
        material: &Material,
    ) -> Result<BodyId, SceneError> {
        self.bodies.push(Body::new(surface, material)?);
        Ok(BodyId(self.bodies.len() - 1))
    }

    /// Adds a blade with its edge from start to end \[m\].
    pub fn add_blade(&mut self, edge: [[f32; 3]; 2]) -> BladeId {
        self.blades.push(Blade::new(edge));
        BladeId(self.blades.len() - 1)
    }

    /// A body.
    ///
    /// # Panics
    /// When the id is another scene's.
    #[must_use]
    pub fn body(&self, id: BodyId) -> &Body {
        &self.bodies[id.0]
    }

    /// A body, to pin vertices and set velocities.
    ///
    /// # Panics
    /// When the id is another scene's.
    pub fn body_mut(&mut self, id: BodyId) -> &mut Body {
        &mut self.bodies[id.0]
    }

    /// A blade.
    ///
    /// # Panics
    /// When the id is another scene's.
    #[must_use]
    pub fn blade(&self, id: BladeId) -> &Blade {
        &self.blades[id.0]
    }

    /// Restricts a blade to one piece of the bodies, or frees it.
    ///
    /// # Panics
    /// When the id is another scene's.
    pub fn set_blade_piece(&mut self, id: BladeId, only_piece: Option<u32>) {
        self.blades[id.0].only_piece = only_piece;
    }

    /// Moves a blade: the next frame cuts along the way.
    ///
    /// # Panics
    /// When the id is another scene's.
    pub fn move_blade(&mut self, id: BladeId, edge: [[f32; 3]; 2]) {
        self.blades[id.0].move_to(edge);
    }

    /// Puts a blade elsewhere without cutting.
    ///
    /// # Panics
    /// When the id is another scene's.
    pub fn jump_blade(&mut self, id: BladeId, edge: [[f32; 3]; 2]) {
        self.blades[id.0].jump_to(edge);
    }

    /// What the last frame did.
    #[must_use]
    pub fn stats(&self) -> &FrameStats {
        &self.stats
    }

    /// Cuts that the last frame could not do, for example because a sweep ended inside a body.
    #[must_use]
    pub fn refusals(&self) -> &[Refusal] {
        &self.refusals
    }

    /// Cuts that the last frame did.
    #[must_use]
    pub fn outcomes(&self) -> &[(BodyId, CutOutcome)] {
        &self.outcomes
    }
}
