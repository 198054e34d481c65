//! [`LatticeChange`]: a change of a lattice as data, which a solver follows.

use crate::lattice::Moments;
use crate::work::Work;
use incise_mesh::VertexId;

/// A copy as it was before a change.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OldCopy {
    /// The copy.
    pub copy: u32,
    /// Its nodes before the change.
    pub nodes: [u32; 8],
    /// Its moments before the change.
    pub moments: Moments,
}

/// A copy that a change added.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AddedCopy {
    /// The copy.
    pub copy: u32,
    /// The copy that held its part before, from which rotation and forces are taken.
    ///
    /// Of several copies in the cell, the one with most of the part's vertices; where the cell was
    /// empty, a copy beside it. The same change may remove it. [`NO_COPY`](crate::NO_COPY) where
    /// the body is new.
    pub parent: u32,
}

/// A node that a change added.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AddedNode {
    /// The node.
    pub node: u32,
    /// Its first source among [`LatticeChange::node_sources`].
    pub first_source: u32,
    /// Number of its sources; 0 where the body is new.
    pub source_count: u32,
}

/// A node before a change, from which the position and velocity of a new node are interpolated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NodeSource {
    /// The node before the change.
    pub node: u32,
    /// Its weight. The weights of a new node add up to 1; some are negative in extrapolations.
    pub weight: f64,
}

/// One change of a lattice: the input of a solver that follows it.
///
/// A change never reuses a number that it freed itself. So a solver finds all old values in place
/// when it computes new ones.
#[derive(Debug, Default)]
pub struct LatticeChange {
    /// Removed copies, ascending.
    pub copies_removed: Vec<OldCopy>,
    /// Added copies, in the order of cells.
    pub copies_added: Vec<AddedCopy>,
    /// Remaining copies with other nodes or moments, ascending, as they were.
    pub copies_changed: Vec<OldCopy>,
    /// Removed nodes, ascending.
    pub nodes_removed: Vec<u32>,
    /// Added nodes, in the order of their positions.
    pub nodes_added: Vec<AddedNode>,
    /// Sources of added nodes, one node after the other.
    pub node_sources: Vec<NodeSource>,
    /// Remaining nodes with another volume, ascending.
    pub nodes_changed: Vec<u32>,
    /// Vertices with another copy or other weights, and added ones.
    pub vertices_changed: Vec<VertexId>,
    pub(crate) work: Work,
}

impl LatticeChange {
    /// Returns whether copies, nodes and vertices are as before.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.copies_removed.is_empty()
            && self.copies_added.is_empty()
            && self.copies_changed.is_empty()
            && self.nodes_changed.is_empty()
            && self.vertices_changed.is_empty()
    }

    /// Returns the sources of an added node.
    #[must_use]
    pub fn sources(&self, added: &AddedNode) -> &[NodeSource] {
        let from = added.first_source as usize;
        let sources = self
            .node_sources
            .get(from..from + added.source_count as usize);
        sources.unwrap_or_default()
    }

    pub(crate) fn clear(&mut self) {
        self.copies_removed.clear();
        self.copies_added.clear();
        self.copies_changed.clear();
        self.nodes_removed.clear();
        self.nodes_added.clear();
        self.node_sources.clear();
        self.nodes_changed.clear();
        self.vertices_changed.clear();
    }
}
