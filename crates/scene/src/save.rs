//! Saving and loading of scenes, see [`Scene::save`] and [`Scene::load`].
//!
//! A file has everything that later frames depend on. Scratch memory, the results of the last frame
//! and what follows from other parts, such as boxes and color masks, are made again. The file
//! format is that of [`incise_mesh::FORMAT_VERSION`].

use crate::blade::Blade;
use crate::body::BodyId;
use crate::error::SceneError;
use crate::scene::Scene;
use incise_cut::CutError;
use incise_mesh::{ArchiveError, FileKind, InvalidBvh, read_archive, write_archive};
use incise_pbd_gpu::InvalidSolver;

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
        for (i, body) in self.bodies.iter().enumerate() {
            let saved = body
                .as_ref()
                .map_or(Ok(()), |body| body.surface().check_save());
            let body = self.body_id(i);
            saved.map_err(|error| SaveError::Body { body, error })?;
        }
        Ok(write_archive(FileKind::Scene, &*self)?)
    }

    /// Loads a scene of [`Scene::save`].
    ///
    /// Its frames give the same bits as those of the saved scene, on any number of threads. The
    /// scene is on the CPU. Its ids are those of [`Scene::bodies`] and [`Scene::blades`], in the
    /// order of the saved scene; ids of the saved scene are unknown to it.
    ///
    /// # Errors
    /// [`LoadError`].
    pub fn load(bytes: &[u8]) -> Result<Self, LoadError> {
        let archive = read_archive(FileKind::Scene, bytes)?;
        let mut scene: Self = archive.content()?;
        let is_finite =
            |blade: &Blade| blade.face.is_none_or(|to| to.iter().all(|c| c.is_finite()));
        if !scene.blades.iter().all(is_finite) {
            let array = "blade faces";
            return Err(LoadError::Array { array });
        }
        for (index, body) in scene.bodies.iter_mut().enumerate() {
            if let Some(body) = body {
                body.finish_load(index, scene.blades.len())?;
            }
        }
        let bodies = scene.bodies.len();
        scene.sleep.finish_load(bodies)?;
        scene.detection.validate(bodies)?;
        scene.islands.validate()?;
        Ok(scene)
    }
}
