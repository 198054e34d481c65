//! [`CutError`]: reasons for which a cut is refused.

use incise_mesh::{TriangleId, VertexId};
use incise_params::OutOfRange;
use incise_refine::RefineError;

/// A refused cut. The surface is then bit for bit what it was.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CutError {
    /// The sweep has no area.
    #[error(
        "the sweep has no area: the blade has no length or moved along its edge, or the plane's \
         normal is zero"
    )]
    BladeDegenerate,
    /// The polylines of a sweep do not match.
    #[error(
        "the blade has {previous} points before and {current} after the step; pass the same \
         number, at least 2"
    )]
    PolylineLength {
        /// Number of points in the previous frame.
        previous: usize,
        /// Number of points in the current frame.
        current: usize,
    },
    /// A parameter of the cut is out of range.
    #[error(transparent)]
    Parameter(#[from] OutOfRange),
    /// A coordinate of the sweep is NaN or infinite.
    #[error("corner {corner} of the sweep is not finite; pass finite positions of the blade")]
    SweepNotFinite {
        /// Number of the corner: an index of [`crate::Sweep::points`].
        corner: usize,
    },
    /// A corner of the sweep is so far away that rounding would move the cut.
    #[error(
        "corner {corner} of the sweep has coordinates {times:.1e} times those of the body, at most \
         5e8 times is possible; make the sweep smaller, or use Sweep::from_plane"
    )]
    SweepTooLarge {
        /// Number of the corner: an index of [`crate::Sweep::points`].
        corner: usize,
        /// Ratio of its largest coordinate to the body's.
        times: f64,
    },
    /// A coordinate of the surface is NaN or infinite.
    #[error("vertex {vertex} has a coordinate that is NaN or infinite; repair it and refit")]
    VertexNotFinite {
        /// The vertex.
        vertex: VertexId,
    },
    /// The BVH misses a triangle: a call of `Cutter::refit_moved` did not have all that moved.
    #[error("the BVH misses a triangle that has moved; call Cutter::refit instead of refit_moved")]
    StaleBvh,
    /// The surface was edited by something else than the cutter, or it is another one.
    #[error(
        "the surface was edited since the BVH was built, or it is another one; call Cutter::refit \
         with it, or make a Cutter for each surface"
    )]
    SurfaceEdited,
    /// The sweep ends inside the body.
    #[error(
        "the sweep ends inside the body at triangle {triangle}; make the sweep larger, or let it \
         end there with Cutter::incise"
    )]
    PartialCut {
        /// The triangle in which it ends.
        triangle: TriangleId,
    },
    /// The sweep meets the walls of the incision at the tip that it continues.
    #[error(
        "the blade turned into a wall of its incision at triangle {triangle}; pull it out and \
         start anew, or move it in smaller steps"
    )]
    TipBlocked {
        /// The triangle of the wall.
        triangle: TriangleId,
    },
    /// The boundaries of the section do not close.
    #[error(
        "the section of the body is not closed: the body overlaps itself where the sweep cuts it, \
         or the tip of the incision lies on its surface; move the blade, or cut piece by piece"
    )]
    OpenSection,
    /// The cap cannot be meshed.
    #[error("the cap cannot be meshed: {0}")]
    Refine(#[from] RefineError),
    /// The cut would not leave a manifold: it crosses an incision whose walls share vertices.
    #[error("the cut surface would not be a manifold at vertex {vertex}; move the blade a little")]
    NotManifold {
        /// A vertex at which it fails.
        vertex: VertexId,
    },
}
