//! Why a hole stays open.

use crate::patch::RefineError;
use incise_mesh::{HalfEdge, VertexId};

/// Why holes cannot be filled. The surface is then bit for bit what it was.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum HoleError {
    /// z is not a positive number.
    #[error("z must be a positive number, not {z}")]
    NonPositiveLevel {
        /// The z.
        z: f64,
    },
    /// The rim is not a closed chain of boundary half-edges.
    #[error(
        "the rim is open at {half_edge}: it has a triangle on both sides or does not begin where the \
         one before ends; take the rim from Topology::boundary_loops"
    )]
    OpenRim {
        /// Where.
        half_edge: HalfEdge,
    },
    /// The rim passes a vertex twice.
    #[error("the rim passes {vertex} twice; fill the loops that touch there one by one")]
    RepeatedVertex {
        /// The vertex.
        vertex: VertexId,
    },
    /// A coordinate on a rim or beside it is NaN or infinite.
    #[error("{vertex}, on a rim or beside it, is not finite; mend its position")]
    NonFinite {
        /// The vertex.
        vertex: VertexId,
    },
    /// Parts of the surface meet in a vertex and no hole lies between them, so that closing the holes
    /// leaves no manifold.
    #[error("parts that no hole joins touch in {vertex}; give each a vertex of its own")]
    Pinched {
        /// The vertex.
        vertex: VertexId,
    },
    /// The patches would be larger than allowed.
    #[error(
        "the patches need more than {limit} triangles; choose a coarser level or a larger limit"
    )]
    TooManyTriangles {
        /// The limit that was passed.
        limit: usize,
    },
    /// A patch is so fine that fairing it would take minutes.
    #[error(
        "the patch at {vertex} needs more than {limit} new vertices, and no more can be faired; choose a \
         coarser level or fill without fairing"
    )]
    TooFineToFair {
        /// A vertex of its rim.
        vertex: VertexId,
        /// The most that are faired.
        limit: usize,
    },
    /// The crate was built without the feature `fair`.
    #[error("this build cannot fair patches; build incise-refine with the feature fair")]
    NoFairing,
    /// A plane patch cannot be made.
    #[error(transparent)]
    Plane(RefineError),
}
