//! [`CapMarker`]: marks the caps of new cuts by a material of their own.

use crate::params::CutParams;
use incise_mesh::{Surface, TriangleId};
use std::collections::HashSet;

/// A material that only the caps and walls of coming cuts have.
///
/// Later cuts divide the caps of earlier ones, so that [`CutOutcome::cap`](crate::CutOutcome) is
/// valid until the next cut alone.
#[derive(Debug, Clone, Copy)]
pub struct CapMarker {
    params: CutParams,
    cap_material: u32,
}

impl CapMarker {
    /// Chooses a material that no triangle has. O(n).
    #[must_use]
    pub fn new(surface: &Surface, params: &CutParams) -> Self {
        let triangles = surface.topology().triangles();
        let used: HashSet<u32> = triangles.map(|t| surface.material(t)).collect();
        let cap_material = params.cap_material;
        let free = (cap_material..).find(|material| !used.contains(material));
        Self {
            params: CutParams {
                cap_material: free.unwrap_or(cap_material),
                ..*params
            },
            cap_material,
        }
    }

    /// Returns the parameters of cuts whose caps and walls are marked.
    #[must_use]
    pub fn params(&self) -> &CutParams {
        &self.params
    }

    /// Returns the marked triangles in slot order, and gives them the material of caps.
    pub fn take(&self, surface: &mut Surface) -> Vec<TriangleId> {
        let is_marked = |&t: &TriangleId| surface.material(t) == self.params.cap_material;
        let marked: Vec<TriangleId> = surface.topology().triangles().filter(is_marked).collect();
        for &t in &marked {
            surface.set_material(t, self.cap_material);
        }
        marked
    }
}
