//! [`SavedBody`]: a body as plain data, for files.

use super::{Body, LooseBounds};
use crate::interior_springs::InteriorSpringSearch;
use crate::piece_shapes::{PieceShapes, SavedShape};
use crate::save::LoadError;
use incise_cut::{Cutter, Incision, SavedCutter, SavedIncision};
use incise_mesh::{Aabb, ArchiveError, SavedSurface, index_u32};
use incise_pbd_gpu::{SavedSolver, Solver};
use serde::{Deserialize, Serialize};

/// A [`Body`], as it is saved.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct SavedBody<'a> {
    surface: SavedSurface<'a>,
    solver: SavedSolver<'a>,
    cutter: SavedCutter<'a>,
    /// Incisions by the numbers of their blades.
    incisions: Vec<(u32, SavedIncision)>,
    /// The rest shapes of the pieces; `None` if they are to be measured.
    piece_shapes: Option<Vec<SavedShape>>,
    is_stale: bool,
    /// A bounding box and the maximum displacement since \[m\].
    loose_bounds: Option<(Aabb, f64)>,
}

impl Body {
    /// Returns the body, whose edits are validated, as plain data for a file.
    ///
    /// # Errors
    /// [`ArchiveError`] if the surface is invalid.
    pub(crate) fn to_saved(&self) -> Result<SavedBody<'_>, ArchiveError> {
        let incisions = self.incisions.iter();
        let incisions = incisions.map(|(blade, incision)| (index_u32(*blade), incision.to_saved()));
        Ok(SavedBody {
            surface: self.surface.to_saved()?,
            solver: self.solver.to_saved(),
            cutter: self.cutter.to_saved(&self.surface),
            incisions: incisions.collect(),
            piece_shapes: self.piece_shapes.to_saved(&self.surface),
            is_stale: self.stale,
            loose_bounds: self.loose_bounds.map(|loose| (loose.bounds, loose.drift)),
        })
    }

    /// Returns a saved body, the `index`-th of a scene with a number of blades.
    ///
    /// # Errors
    /// [`LoadError`] of the body.
    pub(crate) fn from_saved(
        saved: SavedBody<'_>,
        (index, blades): (usize, usize),
    ) -> Result<Self, LoadError> {
        let surface = saved.surface.into_surface();
        let surface = surface.map_err(|error| LoadError::Surface { index, error })?;
        let solver = Solver::from_saved(saved.solver, &surface);
        let solver = solver.map_err(|error| LoadError::Solver { index, error })?;
        let cutter = Cutter::from_saved(saved.cutter, &surface);
        let cutter = cutter.map_err(|error| LoadError::Bvh { index, error })?;
        let mut incisions: Vec<(usize, Incision)> = Vec::new();
        for (blade, incision) in saved.incisions {
            let incision = Incision::from_saved(incision);
            let incision = incision.map_err(|error| LoadError::Incision { index, error })?;
            let blade = blade as usize;
            if blade >= blades || incisions.iter().any(|(known, _)| *known == blade) {
                return Err(LoadError::Array { array: "incisions" });
            }
            incisions.push((blade, incision));
        }
        Ok(Self {
            topology_version: surface.fingerprint(),
            version_before_cut: surface.fingerprint(),
            piece_shapes: PieceShapes::from_saved(saved.piece_shapes, &surface),
            surface,
            solver,
            cutter,
            incisions,
            spring_search: InteriorSpringSearch::default(),
            stale: saved.is_stale,
            loose_bounds: (saved.loose_bounds).map(|(bounds, drift)| LooseBounds { bounds, drift }),
            is_edited: false,
        })
    }
}
