//! [`SavedPatches`]: the patches of a body, for files.

use super::patching::SavedPatching;
use super::{PatchParams, Patches, Patching};
use crate::constraints::coloring::LAYERS;
use incise_mesh::{Surface, index_u32};
use serde::{Deserialize, Serialize};

/// [`Patches`], as they are saved.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct SavedPatches<'a> {
    /// Maximum number of vertices of a patch.
    capacity: u32,
    /// Number of vertices of a new patch.
    new_size: u32,
    patchings: [SavedPatching<'a>; LAYERS - 1],
}

impl Patches {
    /// Returns the patches as plain data for a file.
    pub(crate) fn to_saved(&self) -> SavedPatches<'_> {
        SavedPatches {
            capacity: self.patchings[0].capacity(),
            new_size: index_u32(self.new_size),
            patchings: self.patchings.each_ref().map(Patching::to_saved),
        }
    }

    /// Returns saved patches of a surface.
    ///
    /// # Errors
    /// The broken rule.
    pub(crate) fn from_saved(
        saved: SavedPatches<'_>,
        surface: &Surface,
    ) -> Result<Self, &'static str> {
        let SavedPatches {
            capacity, new_size, ..
        } = saved;
        let params = PatchParams {
            vertices: capacity,
            room: capacity.wrapping_sub(new_size),
        };
        if params.check().is_err() {
            return Err("patches have a limited size");
        }
        let slots = surface.topology().vertex_slots();
        let [a, b, c] = saved.patchings.map(|patching| {
            let patching = Patching::from_saved(patching, capacity, slots);
            patching.ok_or("patches are disjoint and have vertices of the surface")
        });
        let patches = Self {
            patchings: [a?, b?, c?],
            new_size: new_size as usize,
        };
        patches.check(surface)?;
        Ok(patches)
    }
}
