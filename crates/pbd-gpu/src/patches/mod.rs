//! Patches: parts of a body small enough for one workgroup's memory.
//!
//! A constraint whose vertices are all in one patch can be projected without regard to other patches, so
//! a device keeps the patch close by and goes through its colors without a word to anybody. The first
//! patching divides the whole body; the second gathers what the borders of the first cut apart, some five
//! in hundred constraints in strips; the third gathers what the second cuts apart, which is islands of a
//! few vertices, so next to nothing is left. That is solved by color over the whole body, before the rest.
//! It stays Gauss-Seidel in an order that the topology fixes, so all backends agree.

mod content;
mod cover;
mod divide;
mod patching;
#[cfg(test)]
mod tests;

use crate::changes::Log;
use crate::coloring::LAYERS;
use crate::edges::{EdgeId, EdgeTable};
use crate::error::ConstraintError;
use cover::{Tie, cover};
use divide::divide;
use incise_mesh::{Surface, Topology, TopologyDelta, VertexId};
pub(crate) use patching::Patching;

/// The most vertices that a patch can have: so many fit into the memory of a workgroup.
pub const PATCH_VERTICES: u32 = 256;

/// How a body is divided into patches.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PatchParams {
    /// The most vertices of a patch, 8 to [`PATCH_VERTICES`].
    pub vertices: u32,
    /// Places that a new patch leaves free for vertices that edits add, less than `vertices`.
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
    /// Checks both numbers.
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

/// The patchings of a body.
#[derive(Debug, Clone)]
pub(crate) struct Patches {
    /// The first one is of all vertices, each other one of those near the borders of the one before. The
    /// constraints within a patch of patching `i` are layer `i + 1`.
    patchings: [Patching; LAYERS - 1],
    /// How many vertices a new patch gets.
    most: usize,
}

impl Patches {
    /// Divides a surface by rest positions. The edges are those of the surface; `bends` says whether
    /// vertices across an edge are tied as well.
    pub(crate) fn new(
        params: &PatchParams,
        surface: &Surface,
        edges: &EdgeTable,
        bends: bool,
    ) -> Self {
        let mut patches = Self {
            patchings: std::array::from_fn(|_| Patching::new(params.vertices)),
            most: (params.vertices - params.room) as usize,
        };
        patches.resize_vertices(surface.topology().vertex_slots());
        let mut vertices: Vec<VertexId> = surface.topology().vertices().collect();
        patches.divide(surface, &mut vertices);
        let topology = surface.topology();
        let all = topology.edges().filter_map(|h| edges.of(h));
        patches.cover_borders(all, topology, edges, bends);
        patches
    }

    /// The patching whose patches hold the constraints of `layer`, none for layer 0.
    pub(crate) fn of_layer(&self, layer: usize) -> Option<&Patching> {
        self.patchings.get(layer.checked_sub(1)?)
    }

    /// The layer of a constraint over `vertices`: the first whose patching has all of them in one patch,
    /// or 0.
    pub(crate) fn layer_of(&self, vertices: &[VertexId]) -> usize {
        let holds = |patching: &Patching| patching.shared(vertices).is_some();
        self.patchings.iter().position(holds).map_or(0, |i| i + 1)
    }

    /// Notes that a constraint of `layer` over `vertices` came or went.
    pub(crate) fn touch(&mut self, layer: usize, vertices: &[VertexId]) {
        let patching = layer.checked_sub(1).map(|i| &mut self.patchings[i]);
        if let (Some(patching), Some(&v)) = (patching, vertices.first())
            && let Some(patch) = patching.patch_of(v)
        {
            patching.log.note(patch);
        }
    }

    /// The logs of touched patches.
    pub(crate) fn logs(&mut self) -> impl Iterator<Item = &mut Log<u32>> {
        self.patchings.iter_mut().map(|patching| &mut patching.log)
    }

    /// Takes out the vertices that an edit left without triangles. Their constraints must be gone.
    pub(crate) fn leave(&mut self, surface: &Surface, delta: &TopologyDelta) {
        let topology = surface.topology();
        let corners = delta.triangles_removed.iter().flat_map(|(_, c)| c);
        for &v in corners.filter(|&&v| topology.outgoing(v).is_null()) {
            for patching in &mut self.patchings {
                patching.leave(v);
            }
        }
    }

    /// Takes in the vertices that an edit added, before their constraints. A vertex goes to the patch of
    /// a neighbor or parent that has room; what finds none is divided into new patches. `touched` are
    /// the edges of triangles that came.
    pub(crate) fn join(
        &mut self,
        surface: &Surface,
        delta: &TopologyDelta,
        touched: impl Iterator<Item = EdgeId>,
        edges: &EdgeTable,
        bends: bool,
    ) {
        let topology = surface.topology();
        let mut strays = Vec::new();
        for added in &delta.vertices_added {
            let parents = added.origin.weights().map(|(v, _)| v);
            self.settle(surface, added.vertex, &parents, &mut strays);
        }
        // A vertex without triangles may get some again.
        for &t in &delta.triangles_added {
            for v in topology.triangle(t) {
                self.settle(surface, v, &[v], &mut strays);
            }
        }
        strays.sort_unstable();
        strays.dedup();
        // Some that had no neighbor in a patch at first have one by now.
        strays.retain(|&v| self.patchings[0].patch_of(v).is_none());
        self.house(surface, strays);
        self.cover_borders(touched, topology, edges, bends);
    }

    /// Puts a vertex into the patch of a neighbor or parent that has room, or among the strays.
    fn settle(
        &mut self,
        surface: &Surface,
        v: VertexId,
        parents: &[VertexId],
        strays: &mut Vec<VertexId>,
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
        let mut roomy = neighbors
            .chain(parents)
            .filter(|&patch| patching.room(patch) > 0);
        match roomy.next() {
            Some(patch) => patching.join(v, patch),
            None => strays.push(v),
        }
    }

    /// Finds patches for vertices whose neighbors have no room.
    fn house(&mut self, surface: &Surface, mut strays: Vec<VertexId>) {
        let patching = &mut self.patchings[0];
        match patching.newest() {
            Some(newest) if patching.room(newest) >= strays.len() => {
                for v in strays {
                    patching.join(v, newest);
                }
            }
            _ => self.divide(surface, &mut strays),
        }
    }

    fn divide(&mut self, surface: &Surface, vertices: &mut [VertexId]) {
        let patching = &mut self.patchings[0];
        let at = |v: VertexId| surface.rest[v.index()];
        divide(vertices, self.most, &at, &mut |part| {
            let patch = patching.add_patch();
            for &v in part {
                patching.join(v, patch);
            }
        });
    }

    /// Lets each patching cover what the one before cuts apart around some edges.
    fn cover_borders(
        &mut self,
        among: impl Iterator<Item = EdgeId>,
        topology: &Topology,
        edges: &EdgeTable,
        bends: bool,
    ) {
        let mut ties: Vec<Tie> = among
            .filter_map(|edge| edges.tie(edge, topology, bends))
            .collect();
        let [mut before, others @ ..] = self.patchings.each_mut();
        for patching in others {
            ties.retain(|tie| before.shared(tie).is_none());
            // Patches next to one another have numbers next to one another.
            ties.sort_by_key(|tie| before.patch_of(tie[0]));
            cover(patching, &ties, self.most);
            before = patching;
        }
    }

    /// Says which rule is broken: vertices in use are in a patch of the first patching, others in none.
    pub(crate) fn check(&self, surface: &Surface) -> Result<(), &'static str> {
        let topology = surface.topology();
        for patching in &self.patchings {
            patching.check()?;
        }
        let [first, others @ ..] = &self.patchings;
        for v in (0..topology.vertex_slots()).map(VertexId::from_index) {
            let used = !topology.outgoing(v).is_null();
            if first.patch_of(v).is_some() != used {
                return Err("patches divide the vertices in use");
            }
            if !used && others.iter().any(|p| p.patch_of(v).is_some()) {
                return Err("patches have vertices in use only");
            }
        }
        Ok(())
    }

    /// Makes room for vertices that are in no patch, or gives up slots of such.
    pub(crate) fn resize_vertices(&mut self, vertex_slots: usize) {
        for patching in &mut self.patchings {
            patching.resize_vertices(vertex_slots);
        }
    }
}
