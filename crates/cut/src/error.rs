//! Why a cut cannot be done. The surface is then what it was.

use incise_mesh::{TopologyError, TriangleId, VertexId};
use incise_refine::RefineError;

/// Why a cut cannot be done. The surface is then bit for bit what it was.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CutError {
    /// The sweep has no area.
    #[error(
        "the sweep has no area: the blade has no length or did not move across it, or the plane has no normal"
    )]
    BladeDegenerate,
    /// The snapping distance is not from 0 up to 0.5.
    #[error("snap must be at least 0 and below 0.5 of an edge, not {snap}")]
    SnapOutOfRange {
        /// The distance [local edge lengths].
        snap: f64,
    },
    /// The tolerance of remeshing is not from 0 up to 0.5.
    #[error("remesh must be at least 0 and below 0.5 of an edge, not {remesh}")]
    RemeshOutOfRange {
        /// The tolerance [local edge lengths].
        remesh: f64,
    },
    /// A coordinate of the sweep is NaN or infinite.
    #[error("corner {corner} of the sweep is not finite")]
    SweepNotFinite {
        /// Which of the four.
        corner: usize,
    },
    /// A corner of the sweep is so far out that rounding would decide where the body is cut.
    #[error(
        "corner {corner} of the sweep is {times:.1e} times as far out as the body, and rounding would move the cut: \
         make the sweep smaller, 5e8 times is the most; for a plane, Sweep::across_box makes one that fits"
    )]
    SweepTooLarge {
        /// Which of the four.
        corner: usize,
        /// Its largest coordinate over the body's.
        times: f64,
    },
    /// A coordinate of the surface is NaN or infinite.
    #[error("vertex {vertex} is not finite")]
    VertexNotFinite {
        /// The vertex.
        vertex: VertexId,
    },
    /// The surface has a boundary where the sweep crosses it.
    #[error("the surface is open at {triangle}; only closed surfaces can be cut")]
    OpenSurface {
        /// The triangle at the boundary.
        triangle: TriangleId,
    },
    /// The sweep crosses a triangle that the search tree holds to be elsewhere.
    #[error(
        "the search tree does not know where triangle {triangle} is: refit it after vertices have moved"
    )]
    StaleSearchTree {
        /// The triangle.
        triangle: TriangleId,
    },
    /// The sweep ends inside the body.
    #[error(
        "the sweep ends inside the body at triangle {triangle}: only full slices can be cut, make the sweep larger"
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
    /// A loop of the cross-section lies inside another: the paper's method knows simple loops only.
    #[error(
        "the cross-section has a hole at triangle {triangle}; the rebuild method handles simple loops only"
    )]
    NestedSection {
        /// A triangle on the inner loop.
        triangle: TriangleId,
    },
    /// The cap cannot be made.
    #[error("the cap cannot be made: {0}")]
    Refine(#[from] RefineError),
    /// The rebuilt surface would not be a manifold.
    #[error("the rebuilt surface would not be a closed manifold at {vertex}")]
    NotManifold {
        /// A vertex where it fails.
        vertex: VertexId,
    },
    /// The new triangles do not fit the surface.
    #[error("the new triangles do not fit the surface: {0}")]
    Topology(#[from] TopologyError),
}
