//! The arrays of a body as kernels see them.

use crate::constraints::Constraints;
use crate::constraints::attachments::LongRangeAttachment;
use crate::constraints::batches::{BendingSet, StretchSet};
use crate::constraints::colliders::ColliderRecord;
use crate::constraints::volumes::VolumeSet;
use crate::particles::{Particles, Pin};
use crate::patches::content::PatchContents;
use incise_mesh::Surface;

/// The arrays of a body that kernels read and write.
#[derive(Debug)]
pub(crate) struct Body<'a> {
    /// Position at the start of the substep \[m\] and inverse mass [1/kg], shape [vertex slots].
    pub(crate) positions: &'a mut [[f32; 4]],
    /// Velocity [m/s], last component 0, shape [vertex slots].
    pub(crate) velocities: &'a mut [[f32; 4]],
    /// Displacement by constraints in the last substep \[m\], shape [vertex slots].
    pub(crate) corrections: &'a mut [[f32; 4]],
    /// Stretch constraints.
    pub(crate) stretch: &'a mut StretchSet,
    /// Bending constraints, if the material has bending.
    pub(crate) bending: Option<&'a mut BendingSet>,
    /// Interior springs, if the material has them.
    pub(crate) interior_springs: Option<&'a mut StretchSet>,
    /// Volume constraints.
    pub(crate) volumes: &'a mut VolumeSet,
    /// Colliders of the frame.
    pub(crate) colliders: &'a [ColliderRecord],
    /// Pinned vertices, ascending.
    pub(crate) pins: &'a [Pin],
    /// Constraints by patch; empty if the body is not divided.
    pub(crate) patches: &'a mut PatchContents,
    /// Long range attachments.
    pub(crate) attachments: &'a [LongRangeAttachment],
    /// The global step, if the body takes it.
    #[cfg(feature = "global")]
    pub(crate) global: Option<&'a mut crate::global::GlobalStep>,
}

impl<'a> Body<'a> {
    /// Borrows the arrays of a solver and its surface.
    pub(crate) fn new(
        particles: &'a mut Particles,
        constraints: &'a mut Constraints,
        surface: &'a mut Surface,
    ) -> Self {
        Self {
            positions: surface.positions_mut(),
            velocities: &mut particles.velocities,
            corrections: &mut particles.corrections,
            stretch: &mut constraints.stretch,
            bending: constraints.bending.as_mut(),
            interior_springs: constraints.interior_springs.as_mut(),
            volumes: &mut constraints.volumes,
            colliders: constraints.colliders.records(),
            patches: &mut constraints.patch_contents,
            pins: &particles.pins,
            attachments: constraints.attachments.list(),
            #[cfg(feature = "global")]
            global: None,
        }
    }
}
