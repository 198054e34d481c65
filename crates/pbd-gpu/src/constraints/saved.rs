//! [`SavedConstraints`]: all constraints of a body, for files.
//!
//! Attachments, the copies of constraints by patch, color masks and multipliers of a substep follow
//! from them.

use super::Constraints;
use super::attachments::LongRangeAttachments;
use super::batches::{BendingSet, ConstraintSet, SavedSet, StretchSet};
use super::colliders::{Colliders, MovingCollider};
use super::coloring::LAYERS;
use super::contacts::{ContactRecord, ContactSet, Press};
use super::edges::{EdgeTable, SavedEdges};
use super::interior_springs::is_inside;
use super::validate::{broken, check_layers};
use super::volumes::{SavedVolumes, VolumeSet};
use crate::error::{InvalidConstraints, InvalidSolver};
use crate::material::Material;
use crate::patches::content::PatchContents;
use crate::patches::{Patches, SavedPatches};
use incise_mesh::{Surface, VertexId};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// [`Constraints`], as they are saved.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct SavedConstraints<'a> {
    stretch: SavedSet<'a>,
    bending: Option<SavedSet<'a>>,
    interior_springs: Option<SavedSet<'a>>,
    volumes: SavedVolumes<'a>,
    contacts: Cow<'a, [Vec<ContactRecord>]>,
    press: Press,
    colliders: Cow<'a, [MovingCollider]>,
    edges: SavedEdges<'a>,
    patches: Option<SavedPatches<'a>>,
}

impl Constraints {
    /// Returns the constraints as plain data for a file.
    pub(crate) fn to_saved(&self) -> SavedConstraints<'_> {
        SavedConstraints {
            stretch: self.stretch.to_saved(),
            bending: self.bending.as_ref().map(BendingSet::to_saved),
            interior_springs: self.interior_springs.as_ref().map(StretchSet::to_saved),
            volumes: self.volumes.to_saved(),
            contacts: self.contacts.to_saved().into(),
            press: self.contacts.press(),
            colliders: self.colliders.list().into(),
            edges: self.edges.to_saved(),
            patches: self.patches.as_ref().map(Patches::to_saved),
        }
    }

    /// Returns saved constraints of a surface.
    ///
    /// # Errors
    /// [`InvalidSolver`] with the first part that does not match the surface or the material.
    pub(crate) fn from_saved(
        saved: SavedConstraints<'_>,
        surface: &Surface,
        material: &Material,
    ) -> Result<Self, InvalidSolver> {
        let topology = surface.topology();
        let slots = topology.vertex_slots();
        let layers = if saved.patches.is_some() { LAYERS } else { 1 };
        let stretch = StretchSet::from_saved(saved.stretch, slots, layers)?;
        let bending = saved
            .bending
            .map(|set| ConstraintSet::from_saved(set, slots, layers));
        let springs = saved
            .interior_springs
            .map(|set| ConstraintSet::from_saved(set, slots, 1));
        let (bending, interior_springs) = (bending.transpose()?, springs.transpose()?);
        let edges = EdgeTable::from_saved(saved.edges, topology, &stretch, bending.as_ref())?;
        let patches = saved
            .patches
            .map(|patches| Patches::from_saved(patches, surface));
        let patches = match patches.transpose() {
            Ok(patches) => patches,
            Err(rule) => return Err(InvalidConstraints { rule, edge: None }.into()),
        };
        check_layers(&stretch, patches.as_ref())?;
        if let Some(bending) = &bending {
            check_layers(bending, patches.as_ref())?;
        }
        let volumes = VolumeSet::from_saved(saved.volumes, surface)?;
        let is_used = |v: VertexId| !topology.outgoing(v).is_null();
        let contacts = (saved.contacts.into_owned(), saved.press);
        let contacts = ContactSet::from_saved(contacts, (slots, is_used));
        let contacts = contacts.ok_or(InvalidSolver::Array { array: "contacts" })?;
        let mut colliders = Colliders::default();
        colliders.set(&saved.colliders)?;
        let constraints = Self {
            stretch,
            bending,
            interior_springs,
            volumes,
            contacts,
            colliders,
            attachments: LongRangeAttachments::default(),
            edges,
            patches,
            patch_contents: PatchContents::default(),
        };
        constraints.check_kinds(surface, material)?;
        Ok(constraints)
    }

    /// Checks that the kinds of constraints are those of the material.
    fn check_kinds(&self, surface: &Surface, of: &Material) -> Result<(), InvalidConstraints> {
        if self.bending.is_some() != of.bending.is_some()
            || self.interior_springs.is_some() != of.interior_springs.is_some()
            || !(self.volumes.pieces.is_empty() || of.volume.is_some())
        {
            return broken("constraints are of the kinds of the material", None);
        }
        let mut springs = self.interior_springs.iter().flat_map(|set| set.all());
        let is_spring = |ends: &[VertexId; 2]| ends[0] != ends[1] && is_inside(surface, *ends);
        if springs.all(|batch| batch.vertices().iter().all(is_spring)) {
            Ok(())
        } else {
            broken("interior springs lie within a piece", None)
        }
    }
}
