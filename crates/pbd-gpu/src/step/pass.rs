//! [`Pass`]: the passes of a substep in the order in which they run.
//!
//! Their `Ord` is the only place that states this order. Plans of several bodies are merged by it,
//! and a unit test compares the shader that steps a whole body in one dispatch with it.

use crate::constraints::batches::BatchId;
use std::cmp::{Ordering, Reverse};

/// A kind of constraint that is projected in batches; layers project the kinds in this order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ConstraintKind {
    /// Lengths of edges.
    Stretch,
    /// Dihedral angles of edges.
    Bending,
    /// Lengths of interior springs, after all layers of the other kinds.
    InteriorSpring,
}

impl ConstraintKind {
    /// All kinds; the index of a kind is its number.
    pub const ALL: [Self; 3] = [Self::Stretch, Self::Bending, Self::InteriorSpring];

    /// Returns 0 for the kinds that alternate by layer, 1 for interior springs.
    fn stage(self) -> u32 {
        u32::from(self == Self::InteriorSpring)
    }
}

/// One pass over vertices or over the constraints of one batch.
///
/// Passes are ordered as they run in a substep, so that the lists of several bodies can be merged.
/// The variants below are listed in that order; the batches of stretch and bending alternate by
/// layer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Pass {
    /// Applies gravity to velocities and predicts displacements (Algorithm 1, lines 5 to 8).
    Predict,
    /// Moves pinned vertices towards their targets.
    Pins,
    /// Finds nearest points and normals of contacts at the start of the substep.
    ContactFeatures,
    /// Sets all multipliers to zero.
    ResetMultipliers,
    /// Pulls vertices back that are too far from their pinned anchor.
    LongRangeAttachments,
    /// Pulls pinned vertices of a solid and pushes vertices out of colliders before its cells.
    ///
    /// The prediction repeats the forces of cells, but not those of supports. Without this pass,
    /// cells would see nodes that fall through a plane, and the body would be softer.
    SolidSupports,
    /// Projects the cells of one batch of a solid.
    Cells(BatchId),
    /// Pulls pinned vertices of a solid toward their targets.
    SolidPins,
    /// Projects the constraints of one batch.
    Project {
        /// The kind of the constraints.
        kind: ConstraintKind,
        /// The batch in the set of that kind.
        batch: BatchId,
    },
    /// Projects the constraints of one batch once more, on the way back: all batches in reverse
    /// order.
    ///
    /// Without these passes the product of projections is not self-adjoint. It has complex
    /// eigenvalues then, whose modes grow in a body that nothing moves.
    ProjectBack {
        /// The kind of the constraints.
        kind: ConstraintKind,
        /// The batch in the set of that kind; the overflow reverses its inner order.
        batch: BatchId,
    },
    /// Projects contacts before volumes, in a body that has both.
    ///
    /// The volumes pass then restores in the same substep the volume that contacts removed.
    /// Otherwise that loss would be an old error in the next substep, which is corrected slowly,
    /// and stacked pieces would collapse.
    ContactsBeforeVolumes,
    /// Pushes vertices out of colliders before volumes, in a body that has both.
    ///
    /// The volumes pass then counts these vertices as fixed, so that a piece keeps its volume
    /// between colliders.
    CollidersBeforeVolumes,
    /// Restores the volumes of closed pieces.
    Volumes,
    /// Projects contacts, color by color.
    Contacts,
    /// Pushes vertices out of colliders and applies friction.
    Colliders,
    /// Lets active contacts separate without velocity.
    ContactRecovery,
    /// Updates velocities and positions from displacements (Algorithm 1, lines 10 to 13).
    Integrate,
}

/// A sort key of passes.
type Rank = (
    u32,
    usize,
    Option<ConstraintKind>,
    Option<BatchId>,
    Option<(
        Reverse<u32>,
        Reverse<usize>,
        Reverse<ConstraintKind>,
        Reverse<BatchId>,
    )>,
);

impl Pass {
    /// Returns the sort key of the pass: stage, layer, kind, batch; on the way back in reverse.
    fn rank(self) -> Rank {
        let stage = |stage| (stage, 0, None, None, None);
        match self {
            Self::Predict => stage(0),
            Self::Pins => stage(1),
            Self::ContactFeatures => stage(2),
            Self::ResetMultipliers => stage(3),
            Self::LongRangeAttachments => stage(4),
            Self::SolidSupports => stage(5),
            Self::Cells(batch) => (6, 0, None, Some(batch), None),
            Self::SolidPins => stage(7),
            Self::Project { kind, batch } => (
                8 + kind.stage(),
                batch.layer(),
                Some(kind),
                Some(batch),
                None,
            ),
            Self::ProjectBack { kind, batch } => {
                let (stage, layer) = (Reverse(kind.stage()), Reverse(batch.layer()));
                let reverse = (stage, layer, Reverse(kind), Reverse(batch));
                (10, 0, None, None, Some(reverse))
            }
            Self::ContactsBeforeVolumes => stage(11),
            Self::CollidersBeforeVolumes => stage(12),
            Self::Volumes => stage(13),
            Self::Contacts => stage(14),
            Self::Colliders => stage(15),
            Self::ContactRecovery => stage(16),
            Self::Integrate => stage(17),
        }
    }

    /// Returns the layer of a pass over constraints within patches.
    pub(crate) fn patch_layer(self) -> Option<usize> {
        match self {
            Self::Project { batch, .. } | Self::ProjectBack { batch, .. } => {
                Some(batch.layer()).filter(|&layer| layer > 0)
            }
            _ => None,
        }
    }

    /// Returns whether the pass projects in reverse order.
    pub(crate) fn is_back(self) -> bool {
        matches!(self, Self::ProjectBack { .. })
    }

    /// Returns kind and layer of a pass over constraints. Passes of one direction that agree in
    /// both may share a dispatch.
    #[cfg(feature = "gpu")]
    pub(crate) fn kind_and_layer(self) -> Option<(ConstraintKind, usize)> {
        match self {
            Self::Project { kind, batch } | Self::ProjectBack { kind, batch } => {
                Some((kind, batch.layer()))
            }
            _ => None,
        }
    }

    /// Returns the batch of a pass over constraints.
    #[cfg(feature = "gpu")]
    pub(crate) fn batch(self) -> Option<BatchId> {
        match self {
            Self::Project { batch, .. } | Self::ProjectBack { batch, .. } => Some(batch),
            _ => None,
        }
    }
}

impl Ord for Pass {
    fn cmp(&self, other: &Self) -> Ordering {
        self.rank().cmp(&other.rank())
    }
}

impl PartialOrd for Pass {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
