//! Saving and loading of scenes, see [`Scene::save`] and [`Scene::load`].
//!
//! A file has everything that later frames depend on. Scratch memory, the results of the last frame
//! and what follows from other parts, such as boxes and color masks, are made again. The file
//! format is that of [`incise_mesh::FORMAT_VERSION`].

use crate::blade::Blade;
use crate::body::{Body, BodyId, SavedBody};
use crate::contacts::{BladeFace, ContactDetection, SavedContacts, SavedFace};
use crate::error::SceneError;
use crate::islands::{HeldContact, Islands};
use crate::params::SceneParams;
use crate::scene::Scene;
use crate::sleep::{SavedSleep, Sleep};
use incise_cut::CutError;
use incise_mesh::{ArchiveError, FileKind, InvalidBvh, read_archive, write_archive};
use incise_pbd_gpu::{Collider, InvalidSolver};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// An error of saving a scene.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SaveError {
    /// A body cannot be read back, or was edited in a way that a frame refuses.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A body cannot be saved, for example one with positions that are not finite.
    #[error("body {body}: {error}")]
    Body {
        /// The body.
        body: BodyId,
        /// The reason.
        error: ArchiveError,
    },
    /// The scene cannot be written.
    #[error(transparent)]
    Archive(#[from] ArchiveError),
}

/// An error of loading a scene.
///
/// `index` is the number of the body in the order in which bodies were added, removed ones
/// included.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LoadError {
    /// The file is not one of a scene, or is damaged.
    #[error(transparent)]
    Archive(#[from] ArchiveError),
    /// The surface of a body is invalid.
    #[error("body {index}: {error}")]
    Surface {
        /// The body.
        index: usize,
        /// The reason.
        error: ArchiveError,
    },
    /// The solver of a body is invalid.
    #[error("body {index}: {error}")]
    Solver {
        /// The body.
        index: usize,
        /// The reason.
        error: InvalidSolver,
    },
    /// The BVH of a body is invalid.
    #[error("body {index}: {error}")]
    Bvh {
        /// The body.
        index: usize,
        /// The broken rule.
        error: InvalidBvh,
    },
    /// An incision in a body is invalid.
    #[error("an incision in body {index}: {error}")]
    Incision {
        /// The body.
        index: usize,
        /// The reason.
        error: CutError,
    },
    /// An array does not fit the bodies and blades of the scene.
    #[error("the saved {array} do not fit the bodies and blades of the scene")]
    Array {
        /// The array.
        array: &'static str,
    },
}

/// A [`Scene`], as it is saved.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct SavedScene<'a> {
    /// Whether the parameters need the feature `global`.
    needs_global: bool,
    params: SceneParams,
    colliders: Cow<'a, [Collider]>,
    previous_colliders: Cow<'a, [Collider]>,
    blade_faces: Vec<SavedFace>,
    blades: Cow<'a, [Blade]>,
    bodies: Vec<Option<SavedBody<'a>>>,
    sleep: SavedSleep<'a>,
    contacts: SavedContacts,
    held: Vec<HeldContact>,
}

impl Scene {
    /// Saves the scene as a file. Reads GPU bodies back first.
    ///
    /// The results of the last frame, [`Scene::stats`], [`Scene::cuts`] and
    /// [`Scene::failed_cuts`], are not saved.
    ///
    /// # Errors
    /// [`SaveError`]. The scene is unchanged then, except that bodies may have been read back.
    pub fn save(&mut self) -> Result<Vec<u8>, SaveError> {
        let ids: Vec<BodyId> = self.bodies().collect();
        for id in ids {
            self.read_back(id)?;
        }
        self.validate_edits()?;
        let mut bodies = Vec::with_capacity(self.bodies.len());
        for (i, body) in self.bodies.iter().enumerate() {
            let saved = body.as_ref().map(|body| body.to_saved()).transpose();
            let body = self.body_id(i);
            bodies.push(saved.map_err(|error| SaveError::Body { body, error })?);
        }
        #[cfg(feature = "global")]
        let needs_global = self.params.solver.scheme == incise_pbd_gpu::Scheme::Global;
        #[cfg(not(feature = "global"))]
        let needs_global = false;
        let saved = SavedScene {
            needs_global,
            params: self.params,
            colliders: (&self.colliders).into(),
            previous_colliders: (&self.previous_colliders).into(),
            blade_faces: self
                .blade_faces
                .iter()
                .map(|face| face.to_saved())
                .collect(),
            blades: (&self.blades).into(),
            bodies,
            sleep: self.sleep.to_saved(),
            contacts: self.detection.to_saved(),
            held: self.islands.to_saved(&self.bodies),
        };
        Ok(write_archive(FileKind::Scene, &saved)?)
    }

    /// Loads a scene of [`Scene::save`].
    ///
    /// Its frames give the same bits as those of the saved scene, on any number of threads. Those
    /// of [`Scheme::Global`](incise_pbd_gpu::Scheme) do so on CPUs with the same instruction set.
    /// The scene is on the CPU. Its ids are those of [`Scene::bodies`] and [`Scene::blades`], in
    /// the order of the saved scene; ids of the saved scene are unknown to it.
    ///
    /// # Errors
    /// [`LoadError`], also [`ArchiveError::MissingFeature`] for a scene with the global step in a
    /// build without it.
    pub fn load(bytes: &[u8]) -> Result<Self, LoadError> {
        let archive = read_archive(FileKind::Scene, bytes)?;
        if !cfg!(feature = "global") && archive.first()? {
            return Err(ArchiveError::MissingFeature { feature: "global" }.into());
        }
        let saved: SavedScene<'_> = archive.content()?;
        let count = saved.bodies.len();
        let invalid = |array| LoadError::Array { array };
        let is_finite =
            |blade: &Blade| blade.face.is_none_or(|to| to.iter().all(|c| c.is_finite()));
        if !saved.blades.iter().all(is_finite) {
            return Err(invalid("blade faces"));
        }
        let mut scene = Self::new(saved.params);
        for (index, body) in saved.bodies.into_iter().enumerate() {
            let at = (index, saved.blades.len());
            let body = body.map(|body| Body::from_saved(body, at)).transpose()?;
            scene.bodies.push(body.map(Box::new));
        }
        scene.colliders = saved.colliders.into_owned();
        scene.previous_colliders = saved.previous_colliders.into_owned();
        scene.blade_faces = saved
            .blade_faces
            .into_iter()
            .map(BladeFace::from_saved)
            .collect();
        scene.blades = saved.blades.into_owned();
        let sleep = Sleep::from_saved(saved.sleep, count);
        scene.sleep = sleep.ok_or(invalid("sleeping states"))?;
        let contacts = ContactDetection::from_saved(saved.contacts, count);
        scene.detection = contacts.ok_or(invalid("contacts"))?;
        let islands = Islands::from_saved(saved.held, &scene.bodies);
        scene.islands = islands.ok_or(invalid("held contacts"))?;
        Ok(scene)
    }
}
