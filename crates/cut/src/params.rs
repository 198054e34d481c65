//! Parameters of [`crate::Cutter::cut`].

use crate::error::CutError;
use incise_params::{Params, Range};
use incise_refine::RefineParams;

incise_params::params! {
    /// Parameters of a cut.
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub struct CutParams {
        /// Minimum length of edges along the rim.
        ///
        /// An intersection point closer to a vertex moves that vertex into the rim. Two points
        /// closer to each other merge. Neither joins nor removes a piece. At 0 the geometry is
        /// exact and slivers remain.
        snap: f64 = 0.1, range: Self::PART_OF_EDGE, unit: "local edge lengths";
        /// Maximum displacement of the old surface by remeshing.
        ///
        /// Remeshing removes slivers next to the cut by edge flips and edge collapses; rim and cap
        /// stay in place. At 0 there is no remeshing. 0.1 removes about half of the slivers.
        remesh: f64 = 0.0, range: Self::PART_OF_EDGE, unit: "local edge lengths";
        /// The refinement of caps.
        refine: RefineParams = RefineParams::default();
        /// The curves along which caps and walls close the surface again.
        caps: Caps = Caps::Bodies;
        /// The material of caps and walls.
        cap_material: u32 = 1;
        /// Texture coordinates of caps and walls per unit of length. They are positions in the
        /// sweep laid flat, times this number.
        cap_uv_scale: f64 = 1.0, range: Range::NOT_NEGATIVE, unit: "1/m";
        /// Cuts only this piece of the surface; the sweep passes through the others. A step of an
        /// incision may renumber the piece of its tip.
        only_piece: Option<u32> = None;
    }
}

incise_params::choices! {
    /// The curves of a cut along which caps and walls close the surface again.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    #[non_exhaustive]
    pub enum Caps {
        /// Caps bodies. A piece with a boundary is a sheet and stays open.
        Bodies = "bodies",
        /// Caps bodies and closed curves in sheets, for scans with holes elsewhere. Steps of a
        /// blade in a sheet make open curves, which stay open.
        AllLoops = "all-loops",
        /// Caps nothing. A cut body becomes a sheet.
        None = "none",
    }
}

impl CutParams {
    const PART_OF_EDGE: Range = Range::NOT_NEGATIVE.below(0.5);

    /// Checks the ranges of all parameters, as every cut does.
    ///
    /// # Errors
    /// [`CutError::Parameter`] with the first number that is not in its range.
    pub fn check(&self) -> Result<(), CutError> {
        Ok(self.check_ranges()?)
    }
}
