//! The result and the way to it.

use crate::level::RefinementLevel;
use crate::refine::{mean_rim_length, refine};
use crate::triangulate::triangulate;
use incise_mesh::Vec3;

/// How the triangles of a cap come about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum RefineMethod {
    /// A core of equilateral triangles and a band around it, or a frontal Delaunay refinement where targets differ
    /// too much for one core.
    #[default]
    Delaunay,
    /// The paper's: ears cut off, smallest angle first (Algorithm A2), then triangles divided at their centers and
    /// edges swapped (Algorithms 4 and A3) until they are as long as the mean of the targets along the rim. Loops that
    /// are nested or follow a crease, which the paper does not know, start from their constrained Delaunay
    /// triangulation.
    Paper,
}

/// How to refine a patch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RefineParams {
    /// Which of the two ways the exact method of cutting takes. [`fill`], and the paper's method of cutting with it,
    /// knows the paper's alone and does not ask.
    pub method: RefineMethod,
    /// How long edges get, relative to the rim's.
    pub level: RefinementLevel,
    /// The t of Formula 2 \[m\] for the whole patch. Without it the exact method takes at every rim
    /// vertex the mean edge of the surface there, the paper's the mean length of the rim's edges.
    pub rim_length: Option<f64>,
    /// The exact method with [`RefineMethod::Delaunay`]: by how much the length grows with every meter off the rim \[m/m\]. 0 keeps
    /// the surface's at the rim to the middle; above, a patch costs its rim and not its area. Where the rim's own
    /// edges are shorter, either starts from theirs.
    pub grading: f64,
    /// [`RefineMethod::Paper`]: the most rounds of subdividing and swapping (n of Algorithm 4). A round divides the
    /// length of edges by about the root of 3; refinement ends by itself when no triangle is too large.
    pub max_rounds: u32,
    /// The most triangles that a patch may get, so that a tiny z ends with an error and not with
    /// all memory gone.
    pub max_triangles: usize,
}

impl Default for RefineParams {
    fn default() -> Self {
        Self {
            method: RefineMethod::default(),
            level: RefinementLevel::Original,
            rim_length: None,
            grading: 0.0,
            max_rounds: 24,
            max_triangles: 4_000_000,
        }
    }
}

impl RefineParams {
    /// Whether the numbers can be worked with.
    ///
    /// # Errors
    /// [`RefineError::NonPositiveLevel`] and [`RefineError::NonPositiveLength`].
    pub fn check(&self) -> Result<(), RefineError> {
        let z = self.level.z();
        if !(z > 0.0 && z.is_finite()) {
            return Err(RefineError::NonPositiveLevel { z });
        }
        match self.rim_length {
            Some(length) if !(length > 0.0 && length.is_finite()) => {
                Err(RefineError::NonPositiveLength { length })
            }
            _ => Ok(()),
        }
    }
}

/// Why a rim cannot be filled.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RefineError {
    /// The rim is not a polygon.
    #[error("a rim needs at least 3 vertices, this one has {vertices}")]
    RimTooShort {
        /// How many it has.
        vertices: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex} of the rim is not finite")]
    NonFinite {
        /// Its index in the rim.
        vertex: usize,
    },
    /// z is not a positive number.
    #[error("z must be a positive number, not {z}")]
    NonPositiveLevel {
        /// The z.
        z: f64,
    },
    /// The length to refine to is not a positive number.
    #[error("the length of a rim's edges must be a positive number, not {length}")]
    NonPositiveLength {
        /// The length \[m\].
        length: f64,
    },
    /// Targets cannot shrink with the distance from the rim.
    #[error("the grading must be 0 or a positive number, not {grading}")]
    NegativeGrading {
        /// The grading \[m/m\].
        grading: f64,
    },
    /// No triangle has three larger angles.
    #[error(
        "angles below which triangles are improved lie between 0 and 60 degrees, not {degrees}"
    )]
    SharpAngle {
        /// The angle \[degrees\].
        degrees: f64,
    },
    /// A point of the section's loops has no target.
    #[error("there are fewer target lengths than points: point {point} has none")]
    NoLength {
        /// The point.
        point: u32,
    },
    /// A loop of a section is no polygon.
    #[error("a loop needs at least 3 points, loop {index} has {points}")]
    LoopTooShort {
        /// Which loop.
        index: usize,
        /// How many points it has.
        points: usize,
    },
    /// A loop names a point that the section does not have.
    #[error("loop {index} names point {point}, which the section does not have")]
    UnknownPoint {
        /// Which loop.
        index: usize,
        /// The point.
        point: u32,
    },
    /// A point is on two loops or twice on one; a copy of it at the same place is allowed.
    #[error("loop {index} names point {point}, which a loop has already; give it a copy")]
    PointTwice {
        /// Which loop.
        index: usize,
        /// The point.
        point: u32,
    },
    /// The patch would be larger than allowed.
    #[error(
        "the patch needs more than {limit} triangles; choose a coarser level, a grading or a larger limit"
    )]
    TooManyTriangles {
        /// The limit that was passed.
        limit: usize,
    },
}

/// What the refinement did.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RefineReport {
    /// Rounds of subdividing and swapping that changed something.
    pub rounds: u32,
    /// Edges swapped.
    pub swaps: usize,
    /// Whether no triangle's mean edge exceeds the threshold.
    pub converged: bool,
}

/// A filled hole. Vertices `0..rim` are the rim's, in its order; the rest lie inside.
#[derive(Debug, Clone, PartialEq)]
pub struct Patch {
    /// How many vertices the rim has.
    pub rim: usize,
    /// Positions \[m\], rim first.
    pub points: Vec<Vec3>,
    /// The three vertices whose mean is vertex `rim + i`; parents come before children.
    pub inner: Vec<[u32; 3]>,
    /// Triangles, wound like the rim: rim edge i runs from vertex i to vertex i + 1.
    pub triangles: Vec<[u32; 3]>,
    /// What the refinement did.
    pub report: RefineReport,
}

/// Fills the hole inside `rim`, a loop of points \[m\] that runs counterclockwise seen against
/// `normal`. `joined(i, j)` says whether the surface outside already has an edge between two rim
/// vertices: the patch then makes no second one.
///
/// A rim that is a simple polygon when projected along `normal` gives a patch that covers it once.
/// Any other rim (flat, self-crossing) still gives a patch whose triangles meet edge to edge and
/// whose boundary is the rim.
///
/// # Errors
/// [`RefineError`] on a rim of fewer than 3 vertices, a coordinate that is not finite, a z that is
/// not positive or a patch over the size limit.
pub fn fill(
    rim: &[Vec3],
    normal: Vec3,
    params: &RefineParams,
    joined: impl Fn(u32, u32) -> bool,
) -> Result<Patch, RefineError> {
    if rim.len() < 3 {
        return Err(RefineError::RimTooShort {
            vertices: rim.len(),
        });
    }
    if let Some(vertex) = rim.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
        return Err(RefineError::NonFinite { vertex });
    }
    params.check()?;
    let mut patch = triangulate(rim, normal, &joined);
    // Formula 2, on the mean length of Formula 1.
    let alpha = params.rim_length.unwrap_or_else(|| mean_rim_length(rim)) * params.level.z();
    refine(&mut patch, normal, alpha, params, &joined)?;
    Ok(patch)
}
