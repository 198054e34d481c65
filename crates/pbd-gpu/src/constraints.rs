//! Constraints of a body: their vertices, rest values, colors and multipliers.
//!
//! [`Solver`](crate::Solver) owns one set of each kind; [`step`](crate::step) projects them and
//! [`follow`](crate::follow) changes them after an edit.

pub(crate) mod attachments;
pub(crate) mod batches;
pub(crate) mod cells;
pub(crate) mod colliders;
pub(crate) mod coloring;
pub(crate) mod contacts;
pub(crate) mod edges;
pub(crate) mod interior_springs;
#[cfg(feature = "serde")]
mod load;
pub(crate) mod pieces;
pub(crate) mod rest;
mod validate;
pub(crate) mod volumes;

use crate::error::ConstraintError;
use crate::interior::Interior;
use crate::material::Material;
use crate::patches::content::PatchContents;
use crate::patches::{PatchParams, Patches};
use attachments::LongRangeAttachments;
use batches::{BendingSet, ConstraintSet, StretchSet};
use colliders::Colliders;
use coloring::LAYERS;
use contacts::ContactSet;
use edges::{EdgeLists, EdgeTable, Sets};
use incise_mesh::Surface;
use pieces::PieceVertices;
use volumes::VolumeSet;

/// All constraints of a body.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Constraints {
    pub(crate) stretch: StretchSet,
    pub(crate) bending: Option<BendingSet>,
    pub(crate) interior_springs: Option<StretchSet>,
    pub(crate) volumes: VolumeSet,
    pub(crate) contacts: ContactSet,
    pub(crate) colliders: Colliders,
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) attachments: LongRangeAttachments,
    /// The stretch and bending constraint of every edge.
    pub(crate) edges: EdgeTable,
    /// Patches, which assign constraints to layers; `None` for one layer.
    pub(crate) patches: Option<Patches>,
    /// Constraints by patch, see [`Self::update_patch_contents`].
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) patch_contents: PatchContents,
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) pieces: PieceVertices,
    /// The inside of a solid, which has no other constraints within.
    pub(crate) interior: Option<Box<Interior>>,
}

impl Constraints {
    /// Creates the constraints of a surface, without interior springs, contacts and colliders.
    ///
    /// # Errors
    /// [`ConstraintError::ZeroRestLength`].
    pub(crate) fn new(
        surface: &Surface,
        material: &Material,
        patches: Option<&PatchParams>,
    ) -> Result<Self, ConstraintError> {
        let slots = surface.topology().vertex_slots();
        let layers = if patches.is_some() { LAYERS } else { 1 };
        let mut stretch = StretchSet::with_layers(slots, layers);
        let mut bending = (material.bending).map(|_| BendingSet::with_layers(slots, layers));
        let topology = surface.topology();
        let mut edges = EdgeTable::default();
        edges.resize_triangles(topology.triangle_slots());
        let mut lists = EdgeLists::default();
        for t in topology.triangles() {
            edges.add_triangle(t, topology, &mut lists);
        }
        let bends = bending.is_some();
        let mut patches =
            patches.map(|params| Patches::new(params, surface, &edges, &mut lists, bends));
        let mut sets = Sets {
            stretch: &mut stretch,
            bending: bending.as_mut(),
            patches: patches.as_mut(),
        };
        edges.add_missing(&lists, surface, &mut sets);
        for batch in stretch.all() {
            if let Some(i) = batch.rest().iter().position(|&length| length <= 0.0) {
                let [a, b] = batch.vertices()[i];
                return Err(ConstraintError::ZeroRestLength { a, b });
            }
        }
        let springs = material.interior_springs;
        Ok(Self {
            stretch,
            bending,
            interior_springs: springs.map(|_| StretchSet::with_layers(slots, 1)),
            volumes: VolumeSet::default(),
            contacts: ContactSet::default(),
            colliders: Colliders::default(),
            attachments: LongRangeAttachments::default(),
            edges,
            patches,
            patch_contents: PatchContents::default(),
            pieces: PieceVertices::default(),
            interior: None,
        })
    }

    /// Creates the constraints of a solid, without its inside, contacts and colliders.
    pub(crate) fn of_solid(surface: &Surface) -> Self {
        let slots = surface.topology().vertex_slots();
        Self {
            stretch: StretchSet::with_layers(slots, 1),
            bending: None,
            interior_springs: None,
            volumes: VolumeSet::default(),
            contacts: ContactSet::default(),
            colliders: Colliders::default(),
            attachments: LongRangeAttachments::default(),
            edges: EdgeTable::default(),
            patches: None,
            patch_contents: PatchContents::default(),
            pieces: PieceVertices::default(),
            interior: None,
        }
    }

    /// Finds the volume constraints of the surface as it is now, if the material has any.
    pub(crate) fn update_volumes(&mut self, surface: &Surface, material: &Material) {
        if material.volume.is_some() && self.interior.is_none() {
            self.volumes.update(surface);
        } else {
            self.volumes.clear();
        }
    }

    /// Copies the constraints of patches that have changed since the last call.
    pub(crate) fn update_patch_contents(&mut self) {
        if let Some(patches) = &self.patches {
            let bending = self.bending.as_ref();
            (self.patch_contents).update(patches, &self.stretch, bending);
        }
    }

    /// Finds the pieces as they are now, if the body was edited since: of vertices, or of the nodes
    /// of a solid.
    pub(crate) fn update_pieces(&mut self, surface: &Surface) {
        match &self.interior {
            Some(interior) => self.pieces.update_nodes(&interior.lattice),
            None => self.pieces.update(surface),
        }
    }

    /// Adds vertices without constraints, or removes the last ones.
    pub(crate) fn resize_vertices(&mut self, slots: usize) {
        self.stretch.resize_vertices(slots);
        if let Some(bending) = &mut self.bending {
            bending.resize_vertices(slots);
        }
        if let Some(interior_springs) = &mut self.interior_springs {
            interior_springs.resize_vertices(slots);
        }
        if let Some(patches) = &mut self.patches {
            patches.resize_vertices(slots);
        }
    }

    /// Allocates room for edits, so that the first one does not copy every array.
    pub(crate) fn reserve(&mut self, vertices: usize) {
        self.edges.reserve();
        self.stretch.reserve(vertices);
        if let Some(bending) = &mut self.bending {
            bending.reserve(vertices);
        }
        if let Some(interior_springs) = &mut self.interior_springs {
            interior_springs.reserve(vertices);
        }
    }

    /// Returns the allocated size in elements.
    pub(crate) fn capacity(&self) -> usize {
        let springs = self.interior_springs.as_ref();
        self.stretch.capacity()
            + self.bending.as_ref().map_or(0, ConstraintSet::capacity)
            + springs.map_or(0, ConstraintSet::capacity)
            + self.volumes.capacity()
            + self.contacts.capacity()
            + self.attachments.capacity()
            + self.patch_contents.capacity()
            + self.pieces.capacity()
            + self
                .interior
                .as_ref()
                .map_or(0, |interior| interior.capacity())
    }
}
