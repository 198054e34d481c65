//! Vertices of a solid: pins and colliders act on them, and their nodes move.
//!
//! A vertex is where its weights `b` place it. A push of it moves node `i` by `w_i b_i` of the
//! impulse, and the vertex by `sum of b^2 w` of it. Contacts between vertices take the inverse mass
//! `(sum of b sqrt(w))^2` instead, which bounds the motion of every vertex that the push moves.

use super::colliders::{ColliderPass, dot, separation};
use super::particle_state::{ParticleState, ParticleStates};
use crate::constraints::colliders::ColliderRecord;
use crate::particles::Pin;
use incise_lattice::Lattice;

/// Speed at which vertices leave a collider that they were in before the substep [m/s].
///
/// A push of one vertex moves others by less than it should, or by more. A faster recovery would
/// give its speed to the body: 1 m/s is that of a fall by 5 cm.
pub(crate) const RECOVERY_SPEED: f32 = 1.0;

/// Maximum number of symmetric sweeps over pins per pass.
///
/// Each one leaves a tenth to a third of what the pins of a face are off.
pub(crate) const PIN_SWEEPS: usize = 16;

/// Distance of pins from their targets at which the sweeps of a pass end [cells].
///
/// At a clamp of two cells it turns a beam by 1e-4 rad.
pub(crate) const PIN_TOLERANCE: f32 = 1e-4;

/// The vertices of a solid during a substep.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Points<'a> {
    /// States of the nodes.
    pub(crate) nodes: ParticleStates<'a>,
    /// Nodes and weights of vertices.
    pub(crate) lattice: &'a Lattice,
    /// Length of the edges of a cell \[m\].
    pub(crate) cell_size: f32,
    /// Inverse masses of vertices as pushes see them [1/kg], shape [vertex slots].
    pub(crate) inverse_masses: &'a [f32],
}

impl Points<'_> {
    /// Returns the state of a vertex; an unused slot has no mass.
    #[inline(always)]
    pub(crate) fn state(&self, slot: usize) -> ParticleState {
        let Some((nodes, weights)) = self.embedding(slot) else {
            return ParticleState::default();
        };
        let first = self.nodes.get(nodes[0] as usize);
        let (mut x, mut d) = ([0.0; 4], [0.0; 4]);
        for (&node, &weight) in nodes.iter().zip(weights).skip(1) {
            let node = self.nodes.get(node as usize);
            for k in 0..4 {
                x[k] += weight * (node.x[k] - first.x[k]);
                d[k] += weight * (node.d[k] - first.d[k]);
            }
        }
        for k in 0..4 {
            x[k] += first.x[k];
            d[k] += first.d[k];
        }
        x[3] = self.inverse_masses[slot];
        ParticleState { x, d }
    }

    /// Moves the nodes of a vertex by an impulse times the substep [kg m].
    #[inline(always)]
    pub(crate) fn push(&self, slot: usize, impulse: [f32; 3]) {
        let Some((nodes, weights)) = self.embedding(slot) else {
            return;
        };
        for (&node, &weight) in nodes.iter().zip(weights) {
            let state = self.nodes.get(node as usize);
            let by = weight * state.x[3];
            let [x, y, z] = impulse.map(|c| by * c);
            self.nodes.add_d(node as usize, [x, y, z, 0.0]);
        }
    }

    /// Moves the nodes of a vertex at the start of the substep, by an impulse times the substep
    /// [kg m].
    #[inline(always)]
    pub(crate) fn shift(&self, slot: usize, impulse: [f32; 3]) {
        if impulse == [0.0; 3] {
            return;
        }
        let Some((nodes, weights)) = self.embedding(slot) else {
            return;
        };
        for (&node, &weight) in nodes.iter().zip(weights) {
            let mut state = self.nodes.get(node as usize);
            let by = weight * state.x[3];
            for (x, impulse) in state.x.iter_mut().zip(impulse) {
                *x += by * impulse;
            }
            self.nodes.set(node as usize, state);
        }
    }

    /// Returns the inverse mass by which a push of a vertex moves itself, `sum of b^2 w` [1/kg].
    #[inline(always)]
    fn response(&self, slot: usize) -> f32 {
        let Some((nodes, weights)) = self.embedding(slot) else {
            return 0.0;
        };
        let mut sum = 0.0;
        for (&node, &weight) in nodes.iter().zip(weights) {
            sum += weight * weight * self.nodes.get(node as usize).x[3];
        }
        sum
    }

    #[inline(always)]
    fn embedding(&self, slot: usize) -> Option<(&[u32; 8], &[f32; 8])> {
        let copy = self.lattice.vertex_copies[slot];
        let nodes = self.lattice.nodes.get(copy as usize)?;
        Some((nodes, &self.lattice.vertex_weights[slot]))
    }
}

/// Moves pinned vertices along lines from `starts` to their targets, which they reach with the last
/// of `substeps_left`.
///
/// Pins with common nodes undo each other's pushes in part. So they are repeated, each by what the
/// vertex is off its line.
#[inline(always)]
pub(crate) fn pins(points: Points<'_>, pins: &[Pin], starts: &[[f32; 3]], [left, count]: [u32; 2]) {
    let rest = (left - 1) as f32 / count as f32;
    let tolerance = PIN_TOLERANCE * points.cell_size;
    let there = pins.iter().zip(starts);
    for _ in 0..PIN_SWEEPS {
        let mut largest = 0.0;
        for (pin, start) in there.clone().chain(there.clone().rev()) {
            let slot = pin.vertex.index();
            let ParticleState { x, d } = points.state(slot);
            let w = points.response(slot);
            if w > 0.0 {
                let off = [0, 1, 2].map(|k: usize| {
                    let target = pin.target[k] + rest * (start[k] - pin.target[k]);
                    (target - x[k]) - d[k]
                });
                let size = (off[0].abs() + off[1].abs()) + off[2].abs();
                largest = if size > largest { size } else { largest };
                points.push(slot, [off[0] / w, off[1] / w, off[2] / w]);
            }
        }
        if largest <= tolerance {
            break;
        }
    }
}

/// Lists the vertices that colliders may reach within a frame, in which they move by `motion` \[m\]
/// at most.
pub(crate) fn find_near(
    points: Points<'_>,
    colliders: &[ColliderRecord],
    motion: f32,
    near: &mut Vec<Near>,
) {
    near.clear();
    for slot in 0..points.inverse_masses.len() {
        let ParticleState { x, .. } = points.state(slot);
        let is_near = |c: &ColliderRecord| {
            let q = [0, 1, 2].map(|k: usize| x[k] - c.origin[k]);
            let (distance, _) = separation(q, [0.0; 3], c);
            let [a, b, c] = c.velocity;
            distance < motion + (a.abs() + b.abs() + c.abs())
        };
        if x[3] > 0.0 && colliders.iter().any(is_near) {
            let slot = incise_mesh::index_u32(slot);
            near.push(Near {
                slot,
                normal: 0.0,
                tangent: [0.0; 3],
            });
        }
    }
}

/// A vertex near a collider.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Near {
    slot: u32,
    /// Sum of the pushes along the normal, an impulse times the substep [kg m].
    normal: f32,
    /// Sum of the pushes by friction, an impulse times the substep [kg m].
    tangent: [f32; 3],
}

/// Pushes vertices out of colliders at a time of the frame; returns whether one was inside.
///
/// A push moves the nodes by as little as possible, by their masses. Neighbors share nodes, so the
/// sums of the pushes are limited: along the normal they are not negative, and friction is at most
/// the coefficient times them (projected Gauss-Seidel, one symmetric sweep). A later push may take
/// back an earlier one. A depth that a vertex had before the substep shrinks by [`RECOVERY_SPEED`].
#[inline(never)]
pub(crate) fn colliders(
    points: Points<'_>,
    near: &mut [Near],
    colliders: &[ColliderRecord],
    pass: ColliderPass,
) -> bool {
    let mut has_pushed = false;
    for c in colliders {
        let frame = ColliderFrame::new(c, pass);
        for near in &mut *near {
            (near.normal, near.tangent) = (0.0, [0.0; 3]);
        }
        let mut push = |near: &mut Near| has_pushed |= frame.push(points, near);
        near.iter_mut().for_each(&mut push);
        near.iter_mut().rev().for_each(&mut push);
    }
    has_pushed
}

/// A collider in a pass.
struct ColliderFrame<'a> {
    collider: &'a ColliderRecord,
    pass: ColliderPass,
    /// Origins now and before the substep \[m\].
    origins: [[f32; 3]; 2],
    /// Displacement of the collider in the substep \[m\].
    dragged: [f32; 3],
}

impl<'a> ColliderFrame<'a> {
    fn new(collider: &'a ColliderRecord, pass: ColliderPass) -> Self {
        let origins = [pass.time, pass.time - pass.h].map(|time| collider.origin_at(time));
        let dragged = collider.velocity.map(|c| c * pass.h);
        Self {
            collider,
            pass,
            origins,
            dragged,
        }
    }

    /// Solves the contact of one vertex; returns whether it presses on the collider.
    #[inline(always)]
    fn push(&self, points: Points<'_>, near: &mut Near) -> bool {
        let slot = near.slot as usize;
        let ParticleState { x, d, .. } = points.state(slot);
        let [q, before] = self.origins.map(|o| [0, 1, 2].map(|k: usize| x[k] - o[k]));
        let (distance, n) = separation(q, [d[0], d[1], d[2]], self.collider);
        let is_touching = near.normal > 0.0 || distance < 0.0;
        let w = points.response(slot);
        if !(is_touching && w > 0.0) {
            return false;
        }
        let (start, _) = separation(before, [0.0; 3], self.collider);
        let left = -start - RECOVERY_SPEED * self.pass.h;
        let left = if left > 0.0 { left } else { 0.0 };
        let normal = near.normal - (distance + left) / w;
        let normal = if normal > 0.0 { normal } else { 0.0 };
        let relative = [0, 1, 2].map(|k: usize| d[k] - self.dragged[k]);
        let along = dot(relative, n);
        let held = [0, 1, 2].map(|k: usize| near.tangent[k] - (relative[k] - along * n[k]) / w);
        let limit = self.pass.friction * normal;
        let length = dot(held, held).sqrt();
        let share = if length > limit { limit / length } else { 1.0 };
        let tangent = held.map(|c| share * c);
        let by = normal - near.normal;
        let push = [0, 1, 2].map(|k: usize| by * n[k] + (tangent[k] - near.tangent[k]));
        points.push(slot, push);
        (near.normal, near.tangent) = (normal, tangent);
        normal > 0.0
    }
}
