//! The arrays of a body as kernels see them.

use crate::constraints::Constraints;
use crate::constraints::attachments::LongRangeAttachment;
use crate::constraints::batches::{BendingSet, StretchSet};
use crate::constraints::cells::CellSet;
use crate::constraints::colliders::ColliderRecord;
use crate::constraints::volumes::VolumeSet;
use crate::interior::Interior;
use crate::kernels::colliders::ColliderPass;
use crate::kernels::particle_state::ParticleStates;
use crate::kernels::points::{self, Near, Points};
use crate::particles::{Particles, Pin};
use crate::patches::content::PatchContents;
use crate::step::constants::StepConstants;
use incise_lattice::Lattice;
use incise_mesh::Surface;

/// Assumed motion of a vertex in a frame, relative to the fastest node.
///
/// A heavy part throws a light one at twice its own speed.
pub(crate) const MARGIN: f32 = 2.0;

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
    /// The cells of a solid, whose particles are nodes.
    pub(crate) solid: Option<SolidArrays<'a>>,
}

/// The arrays of a solid, besides those of its nodes.
#[derive(Debug)]
pub(crate) struct SolidArrays<'a> {
    pub(crate) cells: &'a mut CellSet,
    /// Nodes and weights of vertices.
    pub(crate) lattice: &'a Lattice,
    /// Length of the edges of a cell \[m\].
    pub(crate) cell_size: f32,
    /// Inverse masses of vertices as pushes see them [1/kg], shape [vertex slots].
    pub(crate) inverse_masses: &'a [f32],
    /// Positions of pinned vertices at the start of the frame \[m\], shape \[pins\].
    pub(crate) pin_starts: &'a [[f32; 3]],
    /// Vertices that colliders may reach in the frame.
    pub(crate) near: &'a mut Vec<Near>,
}

impl SolidArrays<'_> {
    /// Returns the vertices, given the states of the nodes.
    pub(crate) fn points<'a>(&'a self, nodes: ParticleStates<'a>) -> Points<'a> {
        Points {
            nodes,
            lattice: self.lattice,
            cell_size: self.cell_size,
            inverse_masses: self.inverse_masses,
        }
    }

    /// Pushes vertices out of colliders; returns whether one was inside.
    ///
    /// The first substep of a frame finds the vertices that may reach one.
    pub(crate) fn push_out(
        &mut self,
        nodes: ParticleStates<'_>,
        velocities: &[[f32; 4]],
        colliders: &[ColliderRecord],
        pass: ColliderPass,
        constants: &StepConstants,
    ) -> bool {
        let points = Points {
            nodes,
            lattice: self.lattice,
            cell_size: self.cell_size,
            inverse_masses: self.inverse_masses,
        };
        if pass.time <= pass.h {
            let time = constants.collider_step * constants.substeps as f32;
            let squares = velocities
                .iter()
                .map(|v| v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
            let speed = squares.fold(0.0, f32::max).sqrt();
            let [x, y, z] = constants.gravity_step;
            let gain = (x.abs() + y.abs() + z.abs()) * constants.substeps as f32;
            points::find_near(points, colliders, MARGIN * (speed + gain) * time, self.near);
        }
        points::colliders(points, self.near, colliders, pass)
    }
}

impl<'a> Body<'a> {
    /// Borrows the arrays of a solver and its surface.
    pub(crate) fn new(
        particles: &'a mut Particles,
        constraints: &'a mut Constraints,
        surface: &'a mut Surface,
    ) -> Self {
        let (positions, velocities, corrections, solid) = match &mut constraints.interior {
            Some(interior) => {
                let cell_size = interior.cell_size();
                let Interior {
                    lattice,
                    positions,
                    velocities,
                    node_forces,
                    cells,
                    inverse_masses,
                    pin_starts,
                    near,
                    ..
                } = &mut **interior;
                let solid = SolidArrays {
                    cells,
                    lattice,
                    cell_size,
                    inverse_masses,
                    pin_starts,
                    near,
                };
                (&mut positions[..], velocities, node_forces, Some(solid))
            }
            None => (
                surface.positions_mut(),
                &mut particles.velocities,
                &mut particles.corrections,
                None,
            ),
        };
        Self {
            positions,
            velocities,
            corrections,
            solid,
            stretch: &mut constraints.stretch,
            bending: constraints.bending.as_mut(),
            interior_springs: constraints.interior_springs.as_mut(),
            volumes: &mut constraints.volumes,
            colliders: constraints.colliders.records(),
            patches: &mut constraints.patch_contents,
            pins: &particles.pins,
            attachments: constraints.attachments.list(),
        }
    }
}
