//! [`FrictionAnchors`]: where friction held contacts at the end of a frame.
//!
//! Contacts are found again in every frame. This list has the positions at which friction held them
//! in the last one. Without it, the balls of a heap would creep.

use incise_mesh::{VertexId, index_u32};
use incise_pbd_gpu::{Contact, ContactSet, FrictionAnchor};

/// A contact and where friction held it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct HeldContact {
    /// Body and vertex of each of its vertices.
    key: [[u32; 2]; 4],
    held: FrictionAnchor,
}

/// The held contacts of the last frame, in memory reused between frames.
#[derive(Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct FrictionAnchors {
    /// Ascending by key once it is [sorted](Self::sort).
    list: Vec<HeldContact>,
    /// By body index: version of its topology; none of a body whose contacts are forgotten.
    versions: Vec<Option<u64>>,
}

impl FrictionAnchors {
    /// Begins a list without contacts; `versions` are those of the bodies' topologies.
    pub(crate) fn begin(&mut self, versions: impl Iterator<Item = Option<u64>>) {
        self.list.clear();
        self.versions.clear();
        self.versions.extend(versions);
    }

    /// Adds contacts; `locate` returns body and number of one of their vertices.
    pub(crate) fn add(&mut self, contacts: &ContactSet, locate: impl Fn(VertexId) -> [u32; 2]) {
        let held = contacts.held().map(|(vertices, held)| HeldContact {
            key: vertices.map(&locate),
            held,
        });
        self.list.extend(held);
    }

    /// Sorts the contacts, for [`FrictionAnchors::find`].
    pub(crate) fn sort(&mut self) {
        self.list.sort_unstable_by_key(|contact| contact.key);
    }

    /// Forgets the contacts of a body that is edited or moved.
    pub(crate) fn forget(&mut self, body: usize) {
        if let Some(version) = self.versions.get_mut(body) {
            *version = None;
        }
    }

    /// Returns whether the list is about this version of a body.
    fn is_current(&self, body: usize, version: Option<u64>) -> bool {
        let known = self.versions.get(body).copied().flatten();
        known.is_some() && known == version
    }

    /// Returns where friction held a contact of two bodies, given the versions of their topologies.
    pub(crate) fn find(
        &self,
        contact: &Contact,
        bodies: [(usize, Option<u64>); 2],
    ) -> Option<FrictionAnchor> {
        let mut both = bodies.into_iter();
        if !both.all(|(i, version)| self.is_current(i, version)) {
            return None;
        }
        let first = contact.first_vertex_count();
        let mut key = contact.vertices.map(|v| [0, v.0]);
        for (i, [body, _]) in key.iter_mut().enumerate() {
            *body = index_u32(bodies[usize::from(i >= first)].0);
        }
        let found = self.list.binary_search_by_key(&key, |contact| contact.key);
        found.ok().map(|i| self.list[i].held)
    }

    /// Returns whether all contacts are finite.
    #[cfg(feature = "serde")]
    pub(crate) fn are_finite(&self) -> bool {
        self.list.iter().all(|contact| contact.held.is_finite())
    }
}
