//! The error types of the crate: [`RefineError`] for rims and sections, [`HoleError`] for surfaces.

use incise_mesh::{HalfEdge, VertexId};
use incise_params::OutOfRange;

/// The error of a rim or section that cannot be triangulated.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RefineError {
    /// A parameter is out of range.
    #[error(transparent)]
    Parameter(#[from] OutOfRange),
    /// A coordinate is NaN or infinite.
    #[error("the position of point {vertex} is not finite; correct it")]
    NonFinite {
        /// Index of the point in the rim or section.
        vertex: usize,
    },
    /// The target length is not a positive number.
    #[error("the target length must be a positive number, not {length}")]
    NonPositiveLength {
        /// The length \[m\].
        length: f64,
    },
    /// The grading is negative or not a number.
    #[error("the grading is {grading}; it must be 0 or a positive number")]
    NegativeGrading {
        /// The grading \[m/m\].
        grading: f64,
    },
    /// The minimum angle is outside of 0 to 60 degrees.
    #[error("the minimum angle must be 0 to 60 degrees, not {degrees}")]
    InvalidMinAngle {
        /// The angle \[degrees\].
        degrees: f64,
    },
    /// A point of the section's loops has no target length.
    #[error("point {point} has no target length; give one for each point of the section")]
    MissingTarget {
        /// Index of the point.
        point: u32,
    },
    /// A loop of a section is not a polygon.
    #[error("loop {index} has {points} points; it needs at least 3")]
    LoopTooShort {
        /// Index of the loop.
        index: usize,
        /// Number of points.
        points: usize,
    },
    /// A loop refers to a point that the section does not have.
    #[error("loop {index} has point {point}, which does not exist")]
    UnknownPoint {
        /// Index of the loop.
        index: usize,
        /// Index of the point.
        point: u32,
    },
    /// A point is on two loops or twice on one; a copy at the same position is allowed.
    #[error("loop {index} repeats point {point}; give the loop a copy of the point")]
    RepeatedPoint {
        /// Index of the loop.
        index: usize,
        /// Index of the point.
        point: u32,
    },
    /// The patch would exceed the maximum number of triangles.
    #[error(
        "the patch needs more than {limit} triangles; choose a coarser level, a grading or a \
         larger limit"
    )]
    TooManyTriangles {
        /// The limit.
        limit: usize,
    },
}

/// The error of filling holes. The surface is then bit for bit unchanged.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum HoleError {
    /// A parameter is out of range.
    #[error(transparent)]
    Parameter(#[from] OutOfRange),
    /// The rim is not a closed chain of boundary half-edges.
    #[error(
        "the rim is open at {half_edge}: it has a triangle on both sides, or does not start where \
         the previous half-edge ends; take the rim from Topology::boundary_loops"
    )]
    OpenRim {
        /// The first half-edge that breaks the chain.
        half_edge: HalfEdge,
    },
    /// The rim passes a vertex twice.
    #[error("the rim passes {vertex} twice; fill the loops that touch there one at a time")]
    RepeatedVertex {
        /// The vertex.
        vertex: VertexId,
    },
    /// A coordinate on a rim or beside it is NaN or infinite.
    #[error("the position of {vertex}, at a rim, is not finite; correct it")]
    NonFinite {
        /// The vertex.
        vertex: VertexId,
    },
    /// Parts of the surface touch at a vertex without a common hole.
    ///
    /// Filling the holes would not give a manifold.
    #[error("parts without a common hole touch at {vertex}; give each part its own vertex")]
    Pinched {
        /// The vertex.
        vertex: VertexId,
    },
    /// The patches would exceed the maximum number of triangles.
    #[error(
        "the patches need more than {limit} triangles; choose a coarser level or a larger limit"
    )]
    TooManyTriangles {
        /// The limit.
        limit: usize,
    },
    /// A patch has too many new vertices for fairing.
    #[error(
        "the patch at {vertex} needs more than {limit} new vertices, the maximum for fairing; \
         choose a coarser level or fill without fairing"
    )]
    TooFineToFair {
        /// A vertex of the rim.
        vertex: VertexId,
        /// Maximum number of new vertices of a faired patch.
        limit: usize,
    },
    /// A planar rim cannot be triangulated.
    #[error(transparent)]
    Planar(RefineError),
}
