//! Blades: cutting edges with an optional face that bodies collide with, and their access by id.

use crate::body::BodyId;
use crate::contacts::BladeFace;
use crate::error::SceneError;
use crate::frame::inflated;
use crate::scene::{Scene, SceneNumber};
use incise_cut::{CutError, Incision, Sweep};
use std::fmt;

/// The id of a blade in one scene. Shown as the blade's index.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct BladeId {
    pub(crate) scene: SceneNumber,
    pub(crate) index: usize,
}

impl fmt::Display for BladeId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.index.fmt(f)
    }
}

incise_params::choices! {
    /// Whether a blade may end inside a body.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum BladeMode {
        /// Cuts as far as the blade moves and goes on from there in later frames.
        ///
        /// The walls of an incision belong to one piece: contacts between them need
        /// [`crate::ContactParams::self_collision`]. They coincide at rest, so that the minimum
        /// distance between them is zero.
        Progressive = "progressive",
        /// Cuts full slices: a sweep that ends inside a body is refused.
        FullSlices = "full-slices",
    }
}

/// A cutting edge with its pose in this and the previous frame.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Blade {
    edge: [[f32; 3]; 2],
    previous_edge: [[f32; 3]; 2],
    /// The edge and the face vector of the last contact detection with a face.
    previous_face: Option<([[f32; 3]; 2], [f32; 3])>,
    /// The vector from the edge to the blade's back \[m\], see [`Scene::set_blade_face`].
    pub face: Option<[f32; 3]>,
    /// The only piece that the blade cuts; `None` cuts all pieces.
    pub only_piece: Option<u32>,
    /// Whether the blade may end inside a body.
    pub mode: BladeMode,
}

impl Blade {
    const fn new(edge: [[f32; 3]; 2]) -> Self {
        Self {
            edge,
            previous_edge: edge,
            previous_face: None,
            face: None,
            only_piece: None,
            mode: BladeMode::Progressive,
        }
    }

    /// Checks an edge, as [`Scene::move_blade`] does.
    ///
    /// # Errors
    /// [`SceneError::BladeNotFinite`].
    pub fn check_edge(edge: &[[f32; 3]; 2]) -> Result<(), SceneError> {
        let value = edge.as_flattened().iter().find(|c| !c.is_finite());
        value.map_or(Ok(()), |&value| Err(SceneError::BladeNotFinite { value }))
    }

    /// Returns the start and the end of the edge \[m\].
    #[must_use]
    pub const fn edge(&self) -> [[f32; 3]; 2] {
        self.edge
    }

    /// Returns the sweep since the last frame; `None` without motion across the edge.
    ///
    /// # Errors
    /// [`CutError::SweepNotFinite`] when a pose is not finite.
    pub(crate) fn sweep(&self) -> Result<Option<Sweep>, CutError> {
        match Sweep::new(self.previous_edge, self.edge) {
            Ok(sweep) => Ok(Some(sweep)),
            Err(CutError::BladeDegenerate) => Ok(None),
            Err(error) => Err(error),
        }
    }

    /// Returns the edge in the last frame \[m\].
    pub(crate) const fn previous_edge(&self) -> [[f32; 3]; 2] {
        self.previous_edge
    }

    /// Ends the sweep: the next one starts at the present pose.
    pub(crate) fn end_sweep(&mut self) {
        self.previous_edge = self.edge;
    }

    /// Returns the face with its motion; `None` without a face, or for one of no area.
    fn moving_face(&self) -> Option<BladeFace> {
        let pose = (self.edge, self.face?);
        BladeFace::new([self.previous_face.unwrap_or(pose), pose])
    }
}

impl Scene {
    /// Adds a blade with its edge from start to end \[m\].
    ///
    /// The sweeps of an edge that is not finite fail, see [`Blade::check_edge`].
    pub fn add_blade(&mut self, edge: [[f32; 3]; 2]) -> BladeId {
        self.blades.push(Blade::new(edge));
        self.blade_id(self.blades.len() - 1)
    }

    pub(crate) const fn blade_id(&self, index: usize) -> BladeId {
        BladeId {
            scene: self.number,
            index,
        }
    }

    /// Returns a blade.
    ///
    /// # Errors
    /// [`SceneError::UnknownBlade`].
    pub fn blade(&self, id: BladeId) -> Result<&Blade, SceneError> {
        let blade = self.blades.get(id.index);
        let blade = blade.filter(|_| id.scene == self.number);
        blade.ok_or(SceneError::UnknownBlade { blade: id })
    }

    fn blade_mut(&mut self, id: BladeId) -> Result<&mut Blade, SceneError> {
        let blade = self.blades.get_mut(id.index);
        let blade = blade.filter(|_| id.scene == self.number);
        blade.ok_or(SceneError::UnknownBlade { blade: id })
    }

    /// Returns the ids of all blades in the order in which they were added.
    pub fn blades(&self) -> impl Iterator<Item = BladeId> + use<> {
        let scene = self.number;
        (0..self.blades.len()).map(move |index| BladeId { scene, index })
    }

    /// Restricts a blade to one piece of the bodies; `None` cuts all pieces.
    ///
    /// # Errors
    /// [`SceneError::UnknownBlade`].
    pub fn set_blade_piece(
        &mut self,
        id: BladeId,
        only_piece: Option<u32>,
    ) -> Result<(), SceneError> {
        self.blade_mut(id)?.only_piece = only_piece;
        Ok(())
    }

    /// Sets whether a blade may end inside a body. Ends its incisions.
    ///
    /// # Errors
    /// [`SceneError::UnknownBlade`].
    pub fn set_blade_mode(&mut self, id: BladeId, mode: BladeMode) -> Result<(), SceneError> {
        self.blade_mut(id)?.mode = mode;
        self.end_incisions(id);
        Ok(())
    }

    /// Returns the incision of a progressive blade in a body; none before its first cut.
    ///
    /// # Errors
    /// [`SceneError::UnknownBlade`] and [`SceneError::UnknownBody`].
    pub fn incision(&self, blade: BladeId, body: BodyId) -> Result<Option<&Incision>, SceneError> {
        self.blade(blade)?;
        Ok(self.body(body)?.incision(blade.index))
    }

    fn end_incisions(&mut self, id: BladeId) {
        for body in self.bodies.iter_mut().flatten() {
            body.end_incision(id.index);
        }
    }

    /// Gives a blade a face: the parallelogram from its edge to its back.
    ///
    /// `face` is the vector from the edge to the back \[m\]. With [`crate::SceneParams::contacts`]
    /// bodies collide with the face from both sides, and a moving face pushes them. Its motion
    /// along itself causes no friction. `None`, the default, is an edge without a face.
    ///
    /// # Errors
    /// [`SceneError::UnknownBlade`], and [`SceneError::BladeFaceNotFinite`] for a NaN or infinite
    /// component; the face is then unchanged.
    pub fn set_blade_face(
        &mut self,
        id: BladeId,
        face: Option<[f32; 3]>,
    ) -> Result<(), SceneError> {
        let blade = self.blade_mut(id)?;
        if face.is_some_and(|to_back| to_back.iter().any(|c| !c.is_finite())) {
            return Err(SceneError::BladeFaceNotFinite { blade: id });
        }
        blade.face = face;
        Ok(())
    }

    /// Moves a blade; the next frame cuts along its sweep.
    ///
    /// # Errors
    /// [`SceneError::UnknownBlade`] and [`SceneError::BladeNotFinite`]; the blade stays then.
    pub fn move_blade(&mut self, id: BladeId, edge: [[f32; 3]; 2]) -> Result<(), SceneError> {
        let blade = self.blade_mut(id)?;
        Blade::check_edge(&edge)?;
        blade.edge = edge;
        Ok(())
    }

    /// Moves a blade without cutting. Ends its incisions.
    ///
    /// # Errors
    /// [`SceneError::UnknownBlade`] and [`SceneError::BladeNotFinite`]; the blade stays then.
    pub fn teleport_blade(&mut self, id: BladeId, edge: [[f32; 3]; 2]) -> Result<(), SceneError> {
        let blade = self.blade_mut(id)?;
        Blade::check_edge(&edge)?;
        blade.edge = edge;
        blade.previous_edge = edge;
        blade.previous_face = None;
        self.end_incisions(id);
        Ok(())
    }

    /// Collects the blade faces of the frame; wakes bodies near faces that changed or moved.
    ///
    /// Without [`crate::SceneParams::contacts`] there are none.
    pub(crate) fn update_blade_faces(&mut self) {
        self.previous_blade_faces.clone_from(&self.blade_faces);
        self.blade_faces.clear();
        if self.params.contacts.is_some() {
            self.blade_faces
                .extend(self.blades.iter().filter_map(Blade::moving_face));
        }
        for blade in &mut self.blades {
            blade.previous_face = blade.face.map(|face| (blade.edge, face));
        }
        let is_still = |face: &BladeFace| !face.moves();
        if self.blade_faces == self.previous_blade_faces && self.blade_faces.iter().all(is_still) {
            return;
        }
        for face in self.blade_faces.iter().chain(&self.previous_blade_faces) {
            // A body that rests on a face is up to a contact thickness away from it.
            let bounds = inflated(face.bounds());
            for i in 0..self.bodies.len() {
                if self.sleep.is_asleep(i) && !self.sleep.is_far(i, &bounds) {
                    self.sleep.wake(i);
                }
            }
        }
    }
}
