//! Parameters of [`crate::Cutter::cut`]: the shared ones, and those of each method.

use crate::error::CutError;
use incise_params::{ParamError, Params, Range, resolve};
use incise_refine::{RefineMethod, RefineParams};

incise_params::params! {
    /// Parameters of a cut.
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub struct CutParams {
        /// The method that opens the surface, with its own parameters.
        method: CutMethod = CutMethod::Exact(ExactParams::default());
        /// The refinement of caps. With [`incise_refine::RefineMethod::Paper`] the exact method's
        /// caps follow the paper's listings. The paper's method ignores [`RefineParams::method`]:
        /// its caps always follow the listings.
        refine: RefineParams = RefineParams::default();
        /// The curves along which the exact method closes the surface again.
        caps: Caps = Caps::Bodies;
        /// The material of caps and walls.
        cap_material: u32 = 1;
        /// Texture coordinates of the exact method's caps and walls per unit of length. They are
        /// positions in the sweep laid flat, times this number.
        cap_uv_scale: f64 = 1.0, range: Range::NOT_NEGATIVE, unit: "1/m";
        /// Cuts only this piece of the surface; the sweep passes through the others. A step of an
        /// incision may renumber the piece of its tip.
        only_piece: Option<u32> = None;
    }
}

incise_params::choices! {
    /// The curves of a cut along which caps and walls close the surface again.
    ///
    /// The paper's method cuts bodies only and closes all loops.
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

incise_params::variants! {
    /// A method to open a surface along a sweep. The default is [`Self::Exact`].
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub enum CutMethod = Self::Exact(ExactParams::default());
    names {}
    values {
        /// Splits the hit triangles along the sweep. The surface loses no area, and a cross-section
        /// may have any shape. The time depends on the triangles near the sweep, plus one pass over
        /// all triangles if the surface has sheets.
        Exact(ExactParams) = "exact";
        /// Deletes the hit triangles, rebuilds the boundary from the intersection points, patches
        /// and refines the hole (the paper's Algorithms 2, 3, A2, 4 and A3).
        Paper(PaperParams) = "paper";
    }
}

impl CutParams {
    /// Checks the ranges of all parameters, as every cut does.
    ///
    /// # Errors
    /// [`CutError::Parameter`] with the first number that is not in its range.
    pub fn check(&self) -> Result<(), CutError> {
        Ok(self.check_ranges()?)
    }

    /// Checks that the chosen methods use the parameters of these names, for values that a user
    /// gives by name.
    ///
    /// # Errors
    /// [`ParamError::NotChosen`] for one that they ignore.
    pub fn check_given<'a>(
        &self,
        names: impl IntoIterator<Item = &'a str>,
    ) -> Result<(), ParamError> {
        let is_paper = matches!(self.method, CutMethod::Paper(_));
        let refines_as_paper = self.refine.method == RefineMethod::Paper;
        for name in names {
            let is_ignored = match resolve(Self::FIELDS, name)?.as_str() {
                "caps" | "cap_uv_scale" => is_paper,
                "refine.grading" => is_paper || refines_as_paper,
                "refine.method" => is_paper && !refines_as_paper,
                _ => false,
            };
            if is_ignored {
                let chosen = RefineMethod::Paper.name();
                let name = name.to_owned();
                return Err(ParamError::NotChosen { name, chosen });
            }
        }
        Ok(())
    }
}

incise_params::params! {
    /// Parameters of [`CutMethod::Exact`]. Lengths are relative to the edges around each point.
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub struct ExactParams {
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
    }
}

impl ExactParams {
    const PART_OF_EDGE: Range = Range::NOT_NEGATIVE.below(0.5);
}

incise_params::params! {
    /// Parameters of [`CutMethod::Paper`]. Lengths are relative to the mean edge of the hit
    /// triangles.
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub struct PaperParams {
        /// Distance below which intersection points merge: the alpha of Algorithm 2, line 24.
        ///
        /// Larger values make rims more even and move more volume. The paper gives no number; at
        /// the default a rim's mean edge is about that of the surface.
        min_distance: f64 = 0.5, range: Range::NOT_NEGATIVE, unit: "mean edge lengths";
        /// Distance from the plane below which an edge of the old boundary stays: the beta of
        /// Algorithm 3. The paper gives no number.
        beta: f64 = 0.15, range: Range::NOT_NEGATIVE, unit: "mean edge lengths";
        /// Angle below which an ear of the new boundary is closed: Algorithm 3, line 31. The
        /// paper's value is 120.
        ear_angle: f64 = 120.0, range: Range::NOT_NEGATIVE, unit: "degrees";
    }
}
