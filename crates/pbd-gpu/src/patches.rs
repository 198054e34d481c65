//! Patches: parts of a body that one thread, or one workgroup of a GPU, steps on its own.
//!
//! Patches of one patching share no vertex, so the constraints within a patch are projected without
//! synchronization, in the cache of a core or the memory of a workgroup. The first patching divides
//! the whole body. The second consists of strips along the borders of the first, the third of
//! islands along the borders of the second. Constraints within no patch are few; they are projected
//! by color over the whole body first. The order is fixed by the topology, so all backends agree.

pub(crate) mod content;
mod cover;
mod divide;
mod patching;
#[cfg(test)]
mod tests;

use crate::constraints::coloring::LAYERS;
use crate::constraints::edges::{EdgeLists, EdgeTable};
use crate::error::ConstraintError;
use cover::{Stencil, cover};
use divide::divide;
use incise_mesh::{Surface, Topology, TopologyDelta, VertexId};
pub(crate) use patching::Patching;

/// Maximum number of vertices of a patch, limited by the memory of a workgroup.
pub const PATCH_VERTICES: u32 = 256;

/// Minimum number of vertices of a body that is divided by default.
const MIN_DIVIDED: usize = 512;

/// Number of triangles around a vertex that are visited once.
const FAN: usize = 16;

/// Parameters of the division of a body into patches.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PatchParams {
    /// Maximum number of vertices of a patch, 8 to [`PATCH_VERTICES`].
    pub vertices: u32,
    /// Part of `vertices` that a new patch leaves free for edits.
    pub room: u32,
}

impl Default for PatchParams {
    fn default() -> Self {
        Self {
            vertices: PATCH_VERTICES,
            room: PATCH_VERTICES / 8,
        }
    }
}

impl PatchParams {
    /// Returns the default parameters for a body from 512 vertices, and `None` for a smaller one.
    ///
    /// Smaller bodies would have one or two patches, which keep no second thread busy.
    #[must_use]
    pub fn for_body(vertices: usize) -> Option<Self> {
        (vertices >= MIN_DIVIDED).then(Self::default)
    }

    /// Checks both parameters.
    ///
    /// # Errors
    /// [`ConstraintError::BadPatches`].
    pub fn check(&self) -> Result<(), ConstraintError> {
        let Self { vertices, room } = *self;
        if (8..=PATCH_VERTICES).contains(&vertices) && room < vertices {
            Ok(())
        } else {
            Err(ConstraintError::BadPatches { vertices, room })
        }
    }
}

/// Layer and patch of a constraint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Home {
    /// The first layer whose patching has all vertices of the constraint in one patch, or 0.
    pub(crate) layer: u32,
    /// The patch; not used in layer 0.
    patch: u32,
}

impl Home {
    /// The home of a constraint that is within no patch.
    pub(crate) const BODY: Self = Self { layer: 0, patch: 0 };
}

/// The patchings of a body, see the [module](self).
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Patches {
    /// The constraints within patches of patching `i` are layer `i + 1`.
    patchings: [Patching; LAYERS - 1],
    /// Number of vertices of a new patch.
    new_size: usize,
}

impl Patches {
    /// Completes patches that were read with serde, of their surface.
    ///
    /// # Errors
    /// The broken rule.
    #[cfg(feature = "serde")]
    pub(crate) fn finish_load(&mut self, surface: &Surface) -> Result<(), &'static str> {
        let capacity = self.patchings[0].capacity();
        let params = PatchParams {
            vertices: capacity,
            room: capacity.wrapping_sub(u32::try_from(self.new_size).unwrap_or(0)),
        };
        if params.check().is_err() {
            return Err("patches have a limited size");
        }
        let slots = surface.topology().vertex_slots();
        let mut patchings = self.patchings.iter_mut();
        if !patchings.all(|patching| patching.finish_load(capacity, slots).is_some()) {
            return Err("patches are disjoint and have vertices of the surface");
        }
        self.check(surface)
    }

    /// Divides a surface by rest positions, and finds the homes of its edges.
    ///
    /// With `bends`, constraints of an edge include its opposite vertices.
    pub(crate) fn new(
        params: &PatchParams,
        surface: &Surface,
        edges: &EdgeTable,
        lists: &mut EdgeLists,
        bends: bool,
    ) -> Self {
        let mut patches = Self {
            patchings: std::array::from_fn(|_| Patching::new(params.vertices)),
            new_size: (params.vertices - params.room) as usize,
        };
        let topology = surface.topology();
        patches.resize_vertices(topology.vertex_slots());
        let mut vertices: Vec<VertexId> = topology.vertices().collect();
        let position = |v: VertexId| surface.rest_positions()[v.index()];
        let [first, _, _] = &mut patches.patchings;
        divide(&mut vertices, patches.new_size, &position, &mut |part| {
            let patch = first.add_patch();
            for &v in part {
                first.insert(v, patch);
            }
        });
        patches.add_vertices(topology, edges, lists, bends);
        patches
    }

    /// Returns the patching of a layer, or `None` for layer 0.
    pub(crate) fn of_layer(&self, layer: usize) -> Option<&Patching> {
        self.patchings.get(layer.checked_sub(1)?)
    }

    /// Returns the home of a constraint over `vertices`.
    pub(crate) fn home_of(&self, vertices: &[VertexId]) -> Home {
        let homes = (1..).zip(&self.patchings);
        let mut homes = homes.filter_map(|(layer, patching)| {
            let patch = patching.shared(vertices)?;
            Some(Home { layer, patch })
        });
        homes.next().unwrap_or(Home::BODY)
    }

    /// Returns the patchings with their layers.
    pub(crate) fn layers(&self) -> impl Iterator<Item = (usize, &Patching)> {
        (1..).zip(&self.patchings)
    }

    /// Records that a patch gained a constraint.
    pub(crate) fn mark_gain(&mut self, Home { layer, patch }: Home) {
        if let Some(i) = layer.checked_sub(1) {
            self.patchings[i as usize].mark_changed(patch);
        }
    }

    /// Records that a patch lost a constraint of `layer`.
    pub(crate) fn mark_loss(&mut self, layer: usize, vertices: &[VertexId]) {
        let patching = layer.checked_sub(1).map(|i| &mut self.patchings[i]);
        if let (Some(patching), Some(&v)) = (patching, vertices.first())
            && let Some(patch) = patching.patch_of(v)
        {
            patching.mark_changed(patch);
        }
    }

    /// Removes vertices without triangles. Their constraints must already be removed.
    pub(crate) fn remove_vertices(&mut self, surface: &Surface, delta: &TopologyDelta) {
        let topology = surface.topology();
        let corners = delta.triangles_removed.iter().flat_map(|(_, c)| c);
        for &v in corners.filter(|&&v| topology.outgoing(v).is_null()) {
            for patching in &mut self.patchings {
                patching.remove(v);
            }
        }
    }

    /// Adds the new vertices of an edit, before their constraints, and finds the homes of the
    /// listed edges.
    ///
    /// A vertex without a patch joins one of its neighbors, or a new one. Each patching is extended
    /// along the borders of the one before.
    pub(crate) fn add_vertices(
        &mut self,
        topology: &Topology,
        edges: &EdgeTable,
        lists: &mut EdgeLists,
        bends: bool,
    ) {
        let mut homes = std::mem::take(&mut lists.homes);
        homes.clear();
        homes.resize(lists.len(), Home::BODY);
        let stencils = || lists.stencils(edges, topology, bends);
        let neighbors = |v: VertexId, out: &mut Vec<VertexId>| append_neighbors(topology, v, out);
        let mut homeless: Vec<(u32, Stencil)> = Vec::new();
        let mut find = |(i, stencil): (u32, Stencil), layer: u32, patching: &Patching| {
            let patch = patching.shared(&stencil);
            if let Some(patch) = patch {
                homes[i as usize] = Home { layer, patch };
            }
            patch.is_some()
        };
        let [first, others @ ..] = &mut self.patchings;
        cover(
            first,
            stencils().map(|entry| entry.1),
            self.new_size,
            neighbors,
        );
        homeless.extend(stencils().filter(|&entry| !find(entry, 1, first)));
        for (layer, patching) in (2..).zip(others) {
            let left = homeless.iter().map(|entry| entry.1);
            cover(patching, left, self.new_size, neighbors);
            homeless.retain(|&entry| !find(entry, layer, patching));
        }
        lists.homes = homes;
    }

    /// Checks that all vertices in use, and no others, are in a patch of the first patching.
    pub(crate) fn check(&self, surface: &Surface) -> Result<(), &'static str> {
        let topology = surface.topology();
        for patching in &self.patchings {
            patching.check()?;
        }
        let [first, others @ ..] = &self.patchings;
        for v in (0..topology.vertex_slots()).map(VertexId::from_index) {
            let used = !topology.outgoing(v).is_null();
            if first.patch_of(v).is_some() != used {
                return Err("every vertex in use is in a patch");
            }
            if !used && others.iter().any(|p| p.patch_of(v).is_some()) {
                return Err("patches contain only vertices in use");
            }
        }
        Ok(())
    }

    /// Adds vertices without a patch, or removes the last ones.
    pub(crate) fn resize_vertices(&mut self, vertex_slots: usize) {
        for patching in &mut self.patchings {
            patching.resize_vertices(vertex_slots);
        }
    }
}

/// Appends the neighbors of a vertex in the order of [`Topology::outgoing_fan`].
fn append_neighbors(topology: &Topology, v: VertexId, out: &mut Vec<VertexId>) {
    let mut near = [VertexId::NULL; FAN];
    let first = topology.outgoing(v);
    let mut at = first;
    for (count, slot) in (1..).zip(&mut near) {
        if at.is_null() {
            break;
        }
        *slot = topology.target(at);
        at = topology.twin(at.prev());
        if at == first {
            out.extend_from_slice(&near[..count]);
            return;
        }
    }
    // At a boundary the fan begins elsewhere.
    out.extend(topology.outgoing_fan(v).map(|h| topology.target(h)));
}
