//! Joins the pieces that an undo has made one, after they have moved apart.
//!
//! Every such piece first moves as a rigid body into the frame of the heaviest one. Deformations
//! remain; steps from rest remove the gaps that they leave between the pieces.

use super::Solver;
use crate::error::StepError;
use crate::step::params::SolverParams;
use incise_mesh::geometry::{Vec3, to_f32};
use incise_mesh::{Surface, VertexId};
use nalgebra::Matrix3;

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
        if !self.follow.is_late_undo() {
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
            let frames: Vec<Frame> = (parts.iter())
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
    fn frame(&self, surface: &Surface, members: &[Member]) -> Frame {
        let masses = |member: &Member| f64::from(self.particles.mass[member.vertex.index()]);
        let mass: f64 = members.iter().map(masses).sum();
        let mean = |of: &dyn Fn(VertexId) -> Vec3| {
            let moments = members.iter().map(|m| of(m.vertex) * masses(m));
            moments.sum::<Vec3>() / mass
        };
        let center = mean(&|v| surface.position(v));
        let rest_center = mean(&|v| surface.rest_position(v));
        let terms = members.iter().map(|m| {
            let rest = surface.rest_position(m.vertex) - rest_center;
            (surface.position(m.vertex) - center) * rest.transpose() * masses(m)
        });
        Frame {
            mass,
            center,
            rest_center,
            rotation: nearest_rotation(terms.sum()),
        }
    }
}

/// A vertex with the pieces that it belonged and belongs to; ordered by them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Member {
    present: u32,
    former: Option<u32>,
    vertex: VertexId,
}

/// A rigid motion from rest positions to present positions.
#[derive(Debug, Clone, Copy)]
struct Frame {
    /// \[kg\]
    mass: f64,
    /// Center of mass \[m\].
    center: Vec3,
    /// Center of mass at rest \[m\].
    rest_center: Vec3,
    rotation: Matrix3<f64>,
}

impl Frame {
    fn to_rest(self, at: Vec3) -> Vec3 {
        self.rotation.transpose() * (at - self.center) + self.rest_center
    }

    fn to_present(self, at: Vec3) -> Vec3 {
        self.rotation * (at - self.rest_center) + self.center
    }
}

/// Returns the rotation nearest to a covariance (Kabsch 1976).
fn nearest_rotation(covariance: Matrix3<f64>) -> Matrix3<f64> {
    let svd = covariance.svd(true, true);
    let (Some(u), Some(v_t)) = (svd.u, svd.v_t) else {
        return Matrix3::identity();
    };
    let smallest = svd.singular_values.imin();
    let mut signs = Vec3::repeat(1.0);
    signs[smallest] = (u * v_t).determinant().signum();
    u * Matrix3::from_diagonal(&signs) * v_t
}

/// Sets a position and keeps the inverse mass.
fn place(surface: &mut Surface, v: VertexId, at: Vec3) {
    surface.positions_mut()[v.index()][..3].copy_from_slice(&to_f32(at));
}
