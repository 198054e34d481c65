//! Contacts: two features, or a feature and a plane, keep a distance (Mueller et al. 2007, 4.3).
//!
//! `C = n . sum of w_i x_i - gap`. Vertex against face, edge against edge and vertex against plane
//! differ in their weights only. Coulomb friction removes sliding. The vector sum of all that it
//! removes in a substep is bounded by the sum of the corrections of the distance. With a bound of
//! its own, a projection after volumes would lose the slide that they add, and stacked bodies would
//! creep downhill. A sum of lengths would count a slide and its return twice. Friction also takes
//! back the drift of the last substep, see [`contact_features`](super::contact_features).
//!
//! Planes push vertices out after the contacts. So a contact computes with the positions to which
//! the planes will move its vertices. It counts a vertex that it presses into a plane as fixed
//! along the plane's normal. Such a vertex gets its correction nevertheless: the plane pushes it
//! out again, and the plane's friction includes the load.

use super::colliders::{Planes, dot};
use super::particle_state::{ParticleState, ParticleStates, lanes};
use crate::constraints::contacts::{ContactRecord, SupportedSide};
use std::cell::Cell;

/// Separates the features of the contacts with the indices `facing`, one after the other.
///
/// The slice begins with the index `first`. Marks the vertices of [supported](crate::SupportedSide)
/// features in `carried`, shape [vertices]. `corrections`, the displacements by constraints, lose
/// those by contacts; empty without a lift.
#[inline(never)]
pub(crate) fn contacts(
    vertices: impl VertexStates,
    carried: &[Cell<bool>],
    corrections: &[Cell<[f32; 4]>],
    contacts: &mut [ContactRecord],
    first: usize,
    facing: &[u32],
    planes: Planes<'_>,
) {
    for &i in facing {
        let contact = &mut contacts[i as usize - first];
        let count = contact.vertex_count();
        let mut p = [ParticleState::default(); 4];
        for (p, &v) in p.iter_mut().zip(&contact.vertices[..count]) {
            *p = vertices.state(v as usize);
        }
        // Planes push vertices out later in the substep.
        let lifted = p.map(|p| lifted(p, planes));
        let n = contact.normal;
        let between = between_features(contact, lifted);
        let gap = if count == 4 {
            contact.gap
        } else {
            contact.gap + contact.gap_rate * planes.time
        };
        let depth = gap - dot(between, n);
        let is_near = depth > 0.0;
        if !is_near {
            contact.is_active = 0;
            continue;
        }
        let w = contact.weights;
        let shares = vertices.shares(w, p);
        let free = inverse_mass(w, shares, [[1.0; 2]; 4]);
        // Vertices on a plane slide along it only.
        let parts = slides(w, n, p, planes).map(|slide| match slide {
            Some(along) if dot(along, along) < MIN_SLIDE => [0.0; 2],
            Some(along) => {
                let size = along[0].abs() + along[1].abs() + along[2].abs();
                [dot(along, along), size]
            }
            None => [1.0; 2],
        });
        let weight = inverse_mass(w, shares, parts);
        let is_active = weight > 0.0;
        contact.is_active = u32::from(is_active);
        if !is_active {
            continue;
        }
        // The motion of one feature along the other in this substep, and the drift of the last one.
        let motion = weighted_sum(w, lifted.map(|p| p.d));
        let motion = [0, 1, 2].map(|k: usize| motion[k] + contact.drift[k]);
        let along = dot(motion, n);
        let slide = [0, 1, 2].map(|k: usize| motion[k] - along * n[k]);
        // The correction that moves all vertices freely by the impulse which separates them.
        let press = depth * (free / weight);
        let held = hold(contact, slide, contact.friction * press);
        let push = [0, 1, 2].map(|k: usize| (press * n[k] - held[k]) / free);
        let response =
            (w[0] * shares[0] + w[1] * shares[1]) + (w[2] * shares[2] + w[3] * shares[3]);
        contact.held_at = [0, 1, 2].map(|k: usize| between[k] + response * push[k]);
        for i in 0..count {
            let (d, by) = (p[i].d, shares[i]);
            let moved = [
                d[0] + by * push[0],
                d[1] + by * push[1],
                d[2] + by * push[2],
                d[3],
            ];
            let v = contact.vertices[i] as usize;
            let after = ParticleState { d: moved, ..p[i] };
            vertices.move_to(v, p[i], after, [by, w[i]]);
            if let Some(correction) = corrections.get(v) {
                let u = correction.get();
                correction.set([0, 1, 2, 3].map(|k: usize| u[k] - (moved[k] - d[k])));
            }
            if contact.is_carried(w[i]) {
                carried[v].set(true);
            }
        }
    }
}

/// Returns the vector from the second feature to the first one \[m\].
///
/// For a plane it starts at the origin.
#[inline(always)]
pub(super) fn between_features(contact: &ContactRecord, p: [ParticleState; 4]) -> [f32; 3] {
    // Differences keep precision far from the origin, from which a plane is measured.
    let center = if contact.vertex_count() == 4 {
        p[0]
    } else {
        ParticleState::default()
    };
    weighted_sum(contact.weights, p.map(|p| center.vector_to(p)))
}

/// Returns a state as the planes will leave it.
#[inline(always)]
fn lifted(mut state: ParticleState, planes: Planes<'_>) -> ParticleState {
    for push in planes.push_out(state) {
        for (d, push) in state.d.iter_mut().zip(push) {
            *d += push;
        }
    }
    state
}

/// Maximum motion of a vertex, relative to the correction of the distance.
///
/// Without this bound it is at most 1.4 for equal masses, if the vertices of a feature can move or
/// all of them are fixed. Next to a pin it may be the reciprocal of a tiny weight.
pub(crate) const MAX_SHARE: f32 = 8.0;

/// Minimum squared sine between the normals of a contact and of a plane for vertices to slide.
///
/// Between a held face and a parallel plane rounding would move them by a million corrections.
pub(crate) const MIN_SLIDE: f32 = 1e-6;

/// The vertices of bodies in contact: particles, or points of solids.
pub(crate) trait VertexStates: Copy {
    /// Returns the state of a vertex.
    fn state(self, v: usize) -> ParticleState;

    /// Returns the weights of the vertices of a contact times their inverse masses.
    fn shares(self, w: [f32; 4], p: [ParticleState; 4]) -> [f32; 4];

    /// Moves a vertex from one state to another, given its share and its weight.
    fn move_to(self, v: usize, from: ParticleState, to: ParticleState, share_and_weight: [f32; 2]);
}

impl VertexStates for ParticleStates<'_> {
    #[inline(always)]
    fn state(self, v: usize) -> ParticleState {
        self.get(v)
    }

    #[inline(always)]
    fn shares(self, w: [f32; 4], p: [ParticleState; 4]) -> [f32; 4] {
        [0, 1, 2, 3].map(|i: usize| w[i] * p[i].x[3])
    }

    #[inline(always)]
    fn move_to(self, v: usize, _: ParticleState, to: ParticleState, _: [f32; 2]) {
        self.set(v, to);
    }
}

/// Returns the direction in which each vertex can move, if the correction of a contact along `n`
/// presses it into a plane.
#[inline(always)]
fn slides(
    w: [f32; 4],
    n: [f32; 3],
    p: [ParticleState; 4],
    planes: Planes<'_>,
) -> [Option<[f32; 3]>; 4] {
    [0, 1, 2, 3].map(|i: usize| {
        let sign = if w[i] < 0.0 { -1.0 } else { 1.0 };
        if w[i] == 0.0 {
            return None;
        }
        planes.slide(p[i], n.map(|c| sign * c))
    })
}

/// Returns the effective inverse mass of a contact [1/kg], bounded from below by [`MAX_SHARE`].
///
/// The parts of the vertices multiply their inverse masses, and their motion in the bound.
#[inline(always)]
fn inverse_mass(w: [f32; 4], shares: [f32; 4], parts: [[f32; 2]; 4]) -> f32 {
    let along = [0, 1, 2, 3].map(|i: usize| shares[i] * parts[i][0]);
    let [a, b, c, d] = [0, 1, 2, 3].map(|i: usize| shares[i].abs() * parts[i][1]);
    let weight = (w[0] * along[0] + w[1] * along[1]) + (w[2] * along[2] + w[3] * along[3]);
    greater(weight, greater(greater(a, b), greater(c, d)) / MAX_SHARE)
}

#[inline(always)]
fn greater(a: f32, b: f32) -> f32 {
    if b > a { b } else { a }
}

#[inline(always)]
fn lesser(a: f32, b: f32) -> f32 {
    if b < a { b } else { a }
}

/// Rate at which a distance below the minimum grows, relative to the missing distance [1/s].
pub(crate) const RECOVERY: f32 = 5.0;

/// Maximum missing distance that recovers at once [minimum distances].
pub(crate) const MAX_MISSING: f32 = 2.0;

/// Recovery of a carried feature per substep [displacements by gravity].
pub(crate) const LIFT: f32 = 4.0;

/// Ends a substep of `h` \[s\]: active contacts of pairs separate without velocity.
///
/// Displacements lose their separating part, and start positions gain it and the recovery of
/// missing distances, without entering planes. [Supported](crate::SupportedSide) features only
/// rise, and recover more: contacts on which others press lose parts of `fall`, the displacement by
/// gravity in a substep \[m\], in each substep. Returns an upper bound of the change of a position
/// by recovery along an axis \[m\], if no vertex is in two of the contacts.
#[inline(never)]
pub(crate) fn recover_contacts(
    vertices: impl VertexStates,
    corrections: &[Cell<[f32; 4]>],
    contacts: &[ContactRecord],
    planes: Planes<'_>,
    h: f32,
    fall: [f32; 3],
) -> f32 {
    let mut max_change = 0.0;
    for contact in contacts {
        if contact.is_active == 0 || contact.vertex_count() < 4 {
            continue;
        }
        let p = contact.vertices.map(|v| vertices.state(v as usize));
        let (w, n) = (contact.weights, contact.normal);
        let shares = vertices.shares(w, p);
        let free = inverse_mass(w, shares, [[1.0; 2]; 4]);
        let is_movable = free > 0.0;
        if !is_movable {
            continue;
        }
        // The carrying feature stays, as planes do.
        let is_carried = contact.carried != SupportedSide::Neither as u16;
        let down = dot(n, fall);
        let slides = slides(w, n, p, planes);
        let rising = [0, 1, 2, 3].map(|i: usize| {
            let stays = slides[i].is_some() || is_carried && w[i] * down > 0.0;
            if stays { 0.0 } else { 1.0 }
        });
        let weight = inverse_mass(w, shares, rising.map(|part| [part; 2]));
        let (rising, weight) = if weight > 0.0 {
            (rising, weight)
        } else {
            ([1.0; 4], free)
        };
        let along = dot(weighted_sum(w, p.map(|p| p.d)), n);
        let separation = if along > 0.0 { along } else { 0.0 };
        let missing = contact.thickness - contact.gap;
        let slow = lesser(missing, MAX_MISSING * contact.thickness) * (RECOVERY * h);
        let lift = if is_carried { LIFT * down.abs() } else { 0.0 };
        let recovery = lesser(missing, slow + lift);
        let [lost, gained] = [separation / free, recovery / weight];
        for (i, ParticleState { x, d }) in p.into_iter().enumerate() {
            let lost = shares[i] * lost;
            let shift = lost + shares[i] * (gained * rising[i]);
            let mut state = ParticleState {
                x: [
                    x[0] + shift * n[0],
                    x[1] + shift * n[1],
                    x[2] + shift * n[2],
                    x[3],
                ],
                d: [
                    d[0] - lost * n[0],
                    d[1] - lost * n[1],
                    d[2] - lost * n[2],
                    d[3],
                ],
            };
            let mut change = shift.abs();
            for push in planes.push_out(state) {
                for (x, push) in state.x.iter_mut().zip(push) {
                    *x += push;
                    change += push.abs();
                }
            }
            let v = contact.vertices[i] as usize;
            if let Some(correction) = corrections.get(v) {
                let u = correction.get();
                correction.set([0, 1, 2, 3].map(|k: usize| u[k] - (state.d[k] - d[k])));
            }
            vertices.move_to(v, ParticleState { x, d }, state, [shares[i], w[i]]);
            max_change = f32::max(max_change, change);
        }
    }
    max_change
}

/// Returns the sum of four weighted vectors.
#[inline(always)]
fn weighted_sum(w: [f32; 4], r: [[f32; 4]; 4]) -> [f32; 3] {
    let [x, y, z, _] =
        lanes(|k| (w[0] * r[0][k] + w[1] * r[1][k]) + (w[2] * r[2][k] + w[3] * r[3][k]));
    [x, y, z]
}

/// Returns the part of a slide that friction removes, and adds `more` to the friction bound.
#[inline(always)]
fn hold(contact: &mut ContactRecord, slide: [f32; 3], more: f32) -> [f32; 3] {
    let before = contact.friction_sum;
    let sum = [0, 1, 2].map(|k: usize| before[k] + slide[k]);
    let length = (sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]).sqrt();
    let bound = contact.friction_bound + more;
    let part = if length > bound { bound / length } else { 1.0 };
    contact.friction_bound = bound;
    contact.friction_sum = sum.map(|c| part * c);
    [0, 1, 2].map(|k: usize| contact.friction_sum[k] - before[k])
}

#[cfg(test)]
mod tests;
