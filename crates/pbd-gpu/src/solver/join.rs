//! Joins the pieces that an undo has made one, after they have moved apart.
//!
//! Every such piece first moves as a rigid body into the frame of the heaviest one. Deformations
//! remain; steps from rest remove the gaps that they leave between the pieces.

use super::Solver;
use crate::error::StepError;
use crate::rigid_frame::RigidFrame;
use crate::step::params::SolverParams;
use incise_mesh::geometry::{Vec3, to_f32};
use incise_mesh::{Surface, VertexId};

/// Maximum number of steps from rest.
const MAX_STEPS: u32 = 30;

/// Displacement below which steps from rest end [mean rest edge lengths].
const SLOW: f64 = 0.01;

impl Solver {
    /// Moves the pieces that an undo has joined together, and keeps all velocities.
    ///
    /// `pieces` has the piece of every vertex slot before the undo, for slots that were in use.
    /// Pieces that have moved since the undone edit may be far apart; a step would turn that
    /// distance into velocity. The center of mass stays, except where a collider is in the way.
    /// Returns false, and moves nothing, if the last edit was no undo or nothing had moved before
    /// it. Pieces of a solid move together when the solver follows the undo, so that nothing is
    /// left to do.
    ///
    /// # Errors
    /// As [`Solver::step`].
    pub fn join_after_undo(
        &mut self,
        surface: &mut Surface,
        pieces: &[Option<u32>],
        dt: f32,
        params: &SolverParams,
    ) -> Result<bool, StepError> {
        if !self.follow.is_late_undo {
            return Ok(false);
        }
        if self.is_solid() {
            return Ok(true);
        }
        params.check(dt)?;
        self.check_step(surface)?;
        self.align(surface, pieces);
        // One substep a frame, so that no substep goes on with the velocity of a correction.
        let relaxation = SolverParams {
            gravity: [0.0; 3],
            iterations: (params.iterations.saturating_mul(params.substeps(dt)))
                .clamp(1, SolverParams::MAX_COUNT),
            substep: None,
            lift: 0.0,
            conserve: false,
            ..*params
        };
        let at_rest = vec![[0.0; 4]; self.particles.velocities.len()];
        let velocities = std::mem::replace(&mut self.particles.velocities, at_rest);
        self.particles.corrections.fill([0.0; 4]);
        let time_left = self.step.time_left;
        let slow = SLOW * self.mean_rest_length();
        let mut done = Ok(true);
        for _ in 0..MAX_STEPS {
            self.particles.velocities.fill([0.0; 4]);
            match self.step(surface, dt, &relaxation) {
                Ok(stats) if f64::from(stats.max_substep_displacement) < slow => break,
                Ok(_) => {}
                Err(error) => {
                    done = Err(error);
                    break;
                }
            }
        }
        self.step.time_left = time_left;
        self.particles.velocities = velocities;
        done
    }

    /// Moves every former piece into the frame of the heaviest one of its present piece.
    fn align(&self, surface: &mut Surface, pieces: &[Option<u32>]) {
        let topology = surface.topology();
        let mut members: Vec<Member> = (topology.vertices())
            .map(|vertex| Member {
                present: surface.piece(topology.outgoing(vertex).triangle()),
                former: pieces.get(vertex.index()).copied().flatten(),
                vertex,
            })
            .collect();
        members.sort_unstable();
        for members in members.chunk_by(|a, b| a.present == b.present) {
            let parts: Vec<&[Member]> = members.chunk_by(|a, b| a.former == b.former).collect();
            let frames: Vec<RigidFrame> = (parts.iter())
                .map(|part| self.frame(surface, part))
                .collect();
            let known = parts.iter().zip(&frames);
            let known = known.filter(|(part, _)| part[0].former.is_some());
            let heaviest = known.max_by(|(_, a), (_, b)| a.mass.total_cmp(&b.mass));
            let (Some((_, target)), 2..) = (heaviest, parts.len()) else {
                continue;
            };
            let center = self.frame(surface, members).center;
            for (part, frame) in parts.iter().zip(&frames) {
                for member in *part {
                    let at = match member.former {
                        Some(_) => frame.to_rest(surface.position(member.vertex)),
                        None => surface.rest_position(member.vertex),
                    };
                    place(surface, member.vertex, target.to_present(at));
                }
            }
            let shift = center - self.frame(surface, members).center;
            for member in members {
                place(
                    surface,
                    member.vertex,
                    surface.position(member.vertex) + shift,
                );
            }
        }
    }

    /// Returns the rigid motion that brings vertices closest to where they are.
    fn frame(&self, surface: &Surface, members: &[Member]) -> RigidFrame {
        RigidFrame::of(members.iter().map(|member| {
            let v = member.vertex;
            let mass = f64::from(self.particles.mass[v.index()]);
            (surface.position(v), surface.rest_position(v), mass)
        }))
    }
}

/// A vertex with the pieces that it belonged and belongs to; ordered by them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Member {
    present: u32,
    former: Option<u32>,
    vertex: VertexId,
}

/// Sets a position and keeps the inverse mass.
fn place(surface: &mut Surface, v: VertexId, at: Vec3) {
    surface.positions_mut()[v.index()][..3].copy_from_slice(&to_f32(at));
}
