//! [`PaperError`]: reasons for which a cut or a patch is refused.

use incise_cut::CutError;
use incise_mesh::{TriangleId, VertexId};
use incise_params::OutOfRange;
use incise_refine::RefineError;

/// A refused cut or patch. The surface of a cut is then bit for bit what it was.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PaperError {
    /// A parameter is out of range.
    #[error(transparent)]
    Parameter(#[from] OutOfRange),
    /// The sweep and the surface cannot be intersected.
    #[error(transparent)]
    Cut(#[from] CutError),
    /// The sweep crosses a sheet.
    #[error(
        "the sweep crosses a surface with a boundary at triangle {triangle}, and the paper's \
         method cuts closed bodies only; close its holes, or use Cutter::cut"
    )]
    OpenSurface {
        /// A triangle of the sheet.
        triangle: TriangleId,
    },
    /// The sweep ends inside the body.
    #[error(
        "the sweep ends inside the body at triangle {triangle}, and the paper's method cuts full \
         slices only; make the sweep larger, or use Cutter::incise"
    )]
    PartialCut {
        /// The triangle in which it ends.
        triangle: TriangleId,
    },
    /// A bent sweep passes a vertex on both sides.
    #[error("the bent sweep passes vertex {vertex} on both sides; use a flatter or smaller sweep")]
    SideConflict {
        /// The vertex.
        vertex: VertexId,
    },
    /// A loop of the cross-section lies inside another.
    #[error(
        "the cross-section has a hole at triangle {triangle}, and the paper's method fills simple \
         loops only; use Cutter::cut"
    )]
    NestedSection {
        /// A triangle on the inner loop.
        triangle: TriangleId,
    },
    /// The cut would not leave a manifold.
    #[error(
        "the cut surface would not be a manifold at vertex {vertex}; move the blade a little, or \
         use Cutter::cut"
    )]
    NotManifold {
        /// A vertex at which it fails.
        vertex: VertexId,
    },
    /// A rim is not a polygon.
    #[error("the rim has {vertices} vertices; it needs at least 3")]
    RimTooShort {
        /// Number of vertices.
        vertices: usize,
    },
    /// A patch cannot be made.
    #[error("the cap cannot be meshed: {0}")]
    Refine(#[from] RefineError),
}
