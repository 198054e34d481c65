//! Parameters of [`crate::Cutter::cut`]: the shared ones, and those of each method.

use crate::error::CutError;
use incise_refine::RefineParams;

/// Parameters of a cut.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CutParams {
    /// The method that opens the surface, with its own parameters.
    pub method: CutMethod,
    /// The refinement of caps. With [`incise_refine::RefineMethod::Paper`] the exact method's caps
    /// follow the paper's listings. The paper's method ignores [`RefineParams::method`]: its caps
    /// always follow the listings.
    pub refine: RefineParams,
    /// The curves along which the exact method closes the surface again.
    pub caps: Caps,
    /// The material of caps and walls.
    pub cap_material: u32,
    /// Texture coordinates of the exact method's caps and walls per unit of length \[1/m\], at
    /// least 0. They are positions in the sweep laid flat, times this number.
    pub cap_uv_scale: f64,
    /// Cuts only this piece of the surface; the sweep passes through the others. A step of an
    /// incision may renumber the piece of its tip.
    pub only_piece: Option<u32>,
}

impl Default for CutParams {
    fn default() -> Self {
        Self {
            method: CutMethod::default(),
            refine: RefineParams::default(),
            caps: Caps::default(),
            cap_material: 1,
            cap_uv_scale: 1.0,
            only_piece: None,
        }
    }
}

/// The curves of a cut along which caps and walls close the surface again.
///
/// The paper's method cuts bodies only and closes all loops.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Caps {
    /// Caps bodies. A piece with a boundary is a sheet and stays open.
    #[default]
    Bodies,
    /// Caps bodies and closed curves in sheets, for scans with holes elsewhere. Steps of a blade in
    /// a sheet make open curves, which stay open.
    AllLoops,
    /// Caps nothing. A cut body becomes a sheet.
    None,
}

/// A method to open a surface along a sweep. The default is [`Self::Exact`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum CutMethod {
    /// Splits the hit triangles along the sweep. The surface loses no area, and a cross-section may
    /// have any shape. The time depends on the triangles near the sweep, plus one pass over all
    /// triangles if the surface has sheets.
    Exact(ExactParams),
    /// Deletes the hit triangles, rebuilds the boundary from the intersection points, patches and
    /// refines the hole (the paper's Algorithms 2, 3, A2, 4 and A3).
    Paper(PaperParams),
}

impl CutParams {
    /// Checks the ranges of all parameters, as every cut does.
    ///
    /// # Errors
    /// [`CutError::ParameterOutOfRange`], [`CutError::Refine`].
    pub fn check(&self) -> Result<(), CutError> {
        self.refine.check()?;
        check("cap_uv_scale", self.cap_uv_scale, f64::INFINITY)?;
        match self.method {
            CutMethod::Exact(ExactParams { snap, remesh }) => {
                check("snap", snap, 0.5)?;
                check("remesh", remesh, 0.5)
            }
            CutMethod::Paper(paper) => {
                check("min_distance", paper.min_distance, f64::INFINITY)?;
                check("beta", paper.beta, f64::INFINITY)?;
                check("ear_angle", paper.ear_angle, f64::INFINITY)
            }
        }
    }
}

/// Checks that a parameter is at least 0 and below `limit`.
fn check(parameter: &'static str, value: f64, limit: f64) -> Result<(), CutError> {
    if (0.0..limit).contains(&value) {
        return Ok(());
    }
    Err(CutError::ParameterOutOfRange {
        parameter,
        value,
        limit,
    })
}

impl Default for CutMethod {
    fn default() -> Self {
        Self::Exact(ExactParams::default())
    }
}

/// Parameters of [`CutMethod::Exact`]. Lengths are relative to the edges around each point.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ExactParams {
    /// Minimum length of edges along the rim \[local edge lengths\], at least 0 and below 0.5.
    ///
    /// An intersection point closer to a vertex moves that vertex into the rim. Two points closer
    /// to each other merge. Neither joins nor removes a piece. At 0 the geometry is exact and
    /// slivers remain.
    pub snap: f64,
    /// Maximum displacement of the old surface by remeshing \[local edge lengths\], at least 0 and
    /// below 0.5.
    ///
    /// Remeshing removes slivers next to the cut by edge flips and edge collapses; rim and cap
    /// stay in place. At 0, the default, there is no remeshing.
    pub remesh: f64,
}

impl Default for ExactParams {
    fn default() -> Self {
        Self {
            snap: 0.1,
            remesh: 0.0,
        }
    }
}

/// Parameters of [`CutMethod::Paper`]. Lengths are relative to the mean edge of the hit triangles.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PaperParams {
    /// Distance below which intersection points merge \[mean edges\]: the alpha of Algorithm 2,
    /// line 24.
    ///
    /// Larger values make rims more even and move more volume. The paper gives no number; at the
    /// default 0.5 a rim's mean edge is about that of the surface.
    pub min_distance: f64,
    /// Distance from the plane below which an edge of the old boundary stays \[mean edges\]: the
    /// beta of Algorithm 3. The paper gives no number.
    pub beta: f64,
    /// Angle below which an ear of the new boundary is closed \[degrees\]: Algorithm 3, line 31.
    /// The paper's value is 120.
    pub ear_angle: f64,
}

impl Default for PaperParams {
    fn default() -> Self {
        Self {
            min_distance: 0.5,
            beta: 0.15,
            ear_angle: 120.0,
        }
    }
}
