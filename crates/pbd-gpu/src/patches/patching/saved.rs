//! [`SavedPatching`]: the vertices of patches, for files. The places of vertices follow from it.

use super::{Patching, Place};
use incise_mesh::{VertexId, index_u32};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// Patches that a small body may have in addition to two per vertex slot.
///
/// An empty patch takes one byte in a file and a kilobyte in memory.
const EXTRA_PATCHES: usize = 256;

/// A [`Patching`], as it is saved.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct SavedPatching<'a> {
    sizes: Cow<'a, [u32]>,
    /// The vertices of all patches, one patch after another.
    members: Vec<VertexId>,
    emptied: Cow<'a, [u32]>,
    newest: Option<u32>,
}

impl Patching {
    /// Returns the patches as plain data for a file.
    pub(crate) fn to_saved(&self) -> SavedPatching<'_> {
        let patches = 0..index_u32(self.len());
        SavedPatching {
            sizes: (&self.sizes).into(),
            members: patches
                .flat_map(|patch| self.vertices(patch))
                .copied()
                .collect(),
            emptied: (&self.emptied).into(),
            newest: self.newest,
        }
    }

    /// Returns saved patches of a body with `slots` vertex slots, if they are disjoint.
    pub(crate) fn from_saved(
        saved: SavedPatching<'_>,
        capacity: u32,
        slots: usize,
    ) -> Option<Self> {
        let count = saved.sizes.len();
        let is_patch = |&patch: &u32| (patch as usize) < count;
        if count > 2 * slots + EXTRA_PATCHES
            || !saved.emptied.iter().chain(&saved.newest).all(is_patch)
            || saved.sizes.iter().any(|&size| size > capacity)
        {
            return None;
        }
        let mut patching = Self {
            members: vec![VertexId::NULL; count * capacity as usize],
            sizes: saved.sizes.into_owned(),
            emptied: saved.emptied.into_owned(),
            newest: saved.newest,
            revisions: vec![1; count],
            ..Self::new(capacity)
        };
        patching.resize_vertices(slots);
        let mut members = saved.members.iter();
        for patch in 0..index_u32(count) {
            for local in 0..patching.sizes[patch as usize] {
                let &v = members.next()?;
                if v.index() >= slots || patching.place(v).is_some() {
                    return None;
                }
                patching.members[(patch * capacity + local) as usize] = v;
                patching.places[v.index()] = Place { patch, local };
            }
        }
        members.next().is_none().then_some(patching)
    }
}
