//! Patches: parts of a body that fit in the memory of one workgroup of a GPU.
//!
//! Patches of one patching share no vertex, so a workgroup can project the constraints within a
//! patch without synchronization. The first patching divides the whole body. The second consists of
//! strips along the borders of the first, the third of islands along the borders of the second.
//! Constraints within no patch are few; they are projected by color over the whole body first. The
//! order is fixed by the topology, so all backends agree.

#[cfg(any(test, feature = "gpu"))]
mod content;
mod cover;
mod divide;
mod patching;
#[cfg(test)]
mod tests;

use crate::constraints::coloring::LAYERS;
use crate::constraints::edges::{EdgeId, EdgeTable};
use crate::error::ConstraintError;
#[cfg(any(test, feature = "gpu"))]
use crate::follow::changes::Log;
use cover::{Stencil, cover};
use divide::divide;
use incise_mesh::{Surface, Topology, TopologyDelta, VertexId};
pub(crate) use patching::Patching;

/// Maximum number of vertices of a patch, limited by the memory of a workgroup.
pub const PATCH_VERTICES: u32 = 256;

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

/// The patchings of a body, see the [module](self).
#[derive(Debug, Clone)]
pub(crate) struct Patches {
    /// The constraints within patches of patching `i` are layer `i + 1`.
    patchings: [Patching; LAYERS - 1],
    /// Number of vertices of a new patch.
    new_size: usize,
}

impl Patches {
    /// Divides a surface by rest positions.
    ///
    /// With `bends`, constraints of an edge include its opposite vertices.
    pub(crate) fn new(
        params: &PatchParams,
        surface: &Surface,
        edges: &EdgeTable,
        bends: bool,
    ) -> Self {
        let mut patches = Self {
            patchings: std::array::from_fn(|_| Patching::new(params.vertices)),
            new_size: (params.vertices - params.room) as usize,
        };
        patches.resize_vertices(surface.topology().vertex_slots());
        let mut vertices: Vec<VertexId> = surface.topology().vertices().collect();
        patches.divide(surface, &mut vertices);
        let topology = surface.topology();
        let all = topology.edges().filter_map(|h| edges.of(h));
        patches.cover_borders(all, topology, edges, bends);
        patches
    }

    /// Returns the patching of a layer, or `None` for layer 0.
    pub(crate) fn of_layer(&self, layer: usize) -> Option<&Patching> {
        self.patchings.get(layer.checked_sub(1)?)
    }

    /// Returns the first layer whose patching has all `vertices` in one patch, or 0.
    pub(crate) fn layer_of(&self, vertices: &[VertexId]) -> usize {
        let contains = |patching: &Patching| patching.shared(vertices).is_some();
        self.patchings
            .iter()
            .position(contains)
            .map_or(0, |i| i + 1)
    }

    /// Logs the patch of an added or removed constraint of `layer`.
    pub(crate) fn mark_changed(&mut self, layer: usize, vertices: &[VertexId]) {
        let patching = layer.checked_sub(1).map(|i| &mut self.patchings[i]);
        if let (Some(patching), Some(&v)) = (patching, vertices.first())
            && let Some(patch) = patching.patch_of(v)
        {
            patching.log.record(patch);
        }
    }

    /// Returns the logs of changed patches.
    #[cfg(any(test, feature = "gpu"))]
    pub(crate) fn logs(&mut self) -> impl Iterator<Item = &mut Log<u32>> {
        self.patchings.iter_mut().map(|patching| &mut patching.log)
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

    /// Adds the new vertices of an edit, before their constraints.
    ///
    /// A vertex is added to the patch of a neighbor or parent with room. The others are divided
    /// into new patches. `changed` are the edges of changed triangles.
    pub(crate) fn add_vertices(
        &mut self,
        surface: &Surface,
        delta: &TopologyDelta,
        changed: impl Iterator<Item = EdgeId>,
        edges: &EdgeTable,
        bends: bool,
    ) {
        let topology = surface.topology();
        let mut unplaced = Vec::new();
        for added in &delta.vertices_added {
            let parents = added.origin.weights().map(|(v, _)| v);
            self.place(surface, added.vertex, &parents, &mut unplaced);
        }
        // An existing vertex without triangles may get some.
        for &t in &delta.triangles_added {
            for v in topology.triangle(t) {
                self.place(surface, v, &[v], &mut unplaced);
            }
        }
        unplaced.sort_unstable();
        unplaced.dedup();
        // Some have been placed since.
        unplaced.retain(|&v| self.patchings[0].patch_of(v).is_none());
        self.place_in_new(surface, unplaced);
        self.cover_borders(changed, topology, edges, bends);
    }

    /// Adds a vertex to the patch of a neighbor or parent with room, or to `unplaced`.
    fn place(
        &mut self,
        surface: &Surface,
        v: VertexId,
        parents: &[VertexId],
        unplaced: &mut Vec<VertexId>,
    ) {
        let topology = surface.topology();
        let patching = &mut self.patchings[0];
        if topology.outgoing(v).is_null() || patching.patch_of(v).is_some() {
            return;
        }
        let neighbors = topology
            .outgoing_fan(v)
            .filter_map(|h| patching.patch_of(topology.target(h)));
        let parents = parents.iter().filter_map(|&v| patching.last_patch(v));
        let mut candidates = neighbors
            .chain(parents)
            .filter(|&patch| patching.room(patch) > 0);
        match candidates.next() {
            Some(patch) => patching.insert(v, patch),
            None => unplaced.push(v),
        }
    }

    /// Adds vertices to the newest patch, or divides them into new ones.
    fn place_in_new(&mut self, surface: &Surface, mut unplaced: Vec<VertexId>) {
        let patching = &mut self.patchings[0];
        match patching.newest() {
            Some(newest) if patching.room(newest) >= unplaced.len() => {
                for v in unplaced {
                    patching.insert(v, newest);
                }
            }
            _ => self.divide(surface, &mut unplaced),
        }
    }

    fn divide(&mut self, surface: &Surface, vertices: &mut [VertexId]) {
        let patching = &mut self.patchings[0];
        let at = |v: VertexId| surface.rest_positions()[v.index()];
        divide(vertices, self.new_size, &at, &mut |part| {
            let patch = patching.add_patch();
            for &v in part {
                patching.insert(v, patch);
            }
        });
    }

    /// Extends each patching along the borders of the one before, near the given edges.
    fn cover_borders(
        &mut self,
        near: impl Iterator<Item = EdgeId>,
        topology: &Topology,
        edges: &EdgeTable,
        bends: bool,
    ) {
        let mut stencils: Vec<Stencil> = near
            .filter_map(|edge| edges.stencil(edge, topology, bends))
            .collect();
        let [mut before, others @ ..] = self.patchings.each_mut();
        for patching in others {
            stencils.retain(|stencil| before.shared(stencil).is_none());
            // Adjacent patches have adjacent numbers.
            stencils.sort_by_key(|stencil| before.patch_of(stencil[0]));
            cover(patching, &stencils, self.new_size);
            before = patching;
        }
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
