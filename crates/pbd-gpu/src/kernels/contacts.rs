//! Contacts: two features, or a feature and a plane, keep a distance (Mueller et al. 2007, 4.3).
//!
//! `C = n . sum of w_i x_i - gap`. Vertex against face, edge against edge and vertex against plane
//! differ in their weights only. Coulomb friction removes sliding. The vector sum of all that it
//! removes in a substep is bounded by the sum of the corrections of the distance. With a bound of
//! its own, a projection after volumes would lose the slide that they add, and stacked bodies would
//! creep downhill. A sum of lengths would count a slide and its return twice.
//!
//! The ground lifts its vertices after the contacts. A contact sees them as the ground will leave
//! them, and counts them as fixed in height. They take the reaction nevertheless: the ground undoes
//! it, and its friction counts the load.

use super::block::difference;
use super::particle_state::{ParticleState, ParticleStates};
use crate::constraints::contacts::{Carried, ContactRecord};
use std::cell::Cell;

/// Separates the features of contacts at a time of the frame \[s\], one contact after the other.
///
/// Those at or below `ground` \[m\] are on it. Marks the vertices of [carried](crate::Carried) features in `carried`, shape [vertices].
#[inline(never)]
pub(crate) fn contacts(
    particles: ParticleStates<'_>,
    carried: &[Cell<bool>],
    contacts: &mut [ContactRecord],
    (ground, time): (f32, f32),
) {
    for contact in contacts {
        let count = contact.vertex_count();
        let mut p = [ParticleState::default(); 4];
        for (p, &v) in p.iter_mut().zip(&contact.vertices[..count]) {
            *p = particles.get(v as usize);
        }
        // The ground lifts its vertices later in the substep.
        let lifted = p.map(|p| lifted(p, ground));
        // Differences keep precision far from the origin, from which a plane is measured.
        let center = if count == 4 {
            lifted[0]
        } else {
            ParticleState::default()
        };
        let n = contact.normal;
        let between = weighted_sum(contact.weights, lifted.map(|p| difference(center, p)));
        let gap = if count == 4 {
            contact.gap
        } else {
            contact.gap + contact.gap_rate * time
        };
        let depth = gap - dot(between, n);
        let w = contact.weights;
        let shares = shares(w, p);
        let free = inverse_mass((w, shares), [[1.0; 2]; 4]);
        // Vertices on the ground move along the horizontal part of the normal only.
        let level = [greater(1.0 - n[1] * n[1], 0.0), n[0].abs() + n[2].abs()];
        let is_low = is_pressed_into((w, n), p, ground);
        let parts = is_low.map(|is_low| if is_low { level } else { [1.0; 2] });
        let weight = inverse_mass((w, shares), parts);
        let is_active = depth > 0.0 && weight > 0.0;
        contact.is_active = u32::from(is_active);
        if !is_active {
            continue;
        }
        // The sliding of one feature along the other in this substep.
        let motion = weighted_sum(w, lifted.map(|p| p.d));
        let along = dot(motion, n);
        let slide = [0, 1, 2].map(|k: usize| motion[k] - along * n[k]);
        // The correction that moves all vertices freely by the impulse which separates them.
        let press = depth * (free / weight);
        let held = hold(contact, slide, contact.friction * press);
        let push = [0, 1, 2].map(|k: usize| (press * n[k] - held[k]) / free);
        for i in 0..count {
            let (d, by) = (p[i].d, shares[i]);
            let moved = [
                d[0] + by * push[0],
                d[1] + by * push[1],
                d[2] + by * push[2],
                d[3],
            ];
            let v = contact.vertices[i] as usize;
            particles.set_d(v, moved);
            if contact.is_carried(w[i]) {
                carried[v].set(true);
            }
        }
    }
}

/// Returns a state as the ground will leave it.
#[inline(always)]
fn lifted(ParticleState { x, mut d }: ParticleState, ground: f32) -> ParticleState {
    let depth = ground - (x[1] + d[1]);
    if depth > 0.0 && x[3] > 0.0 {
        d[1] += depth;
    }
    ParticleState { x, d }
}

/// Maximum motion of a vertex, relative to the correction of the distance.
///
/// Without this bound it is at most 1.4 for equal masses, if the vertices of a feature can move or
/// all of them are fixed. Next to a pin it may be the reciprocal of a tiny weight.
pub(crate) const MAX_SHARE: f32 = 8.0;

/// Returns the weights of vertices times their inverse masses.
#[inline(always)]
fn shares(w: [f32; 4], p: [ParticleState; 4]) -> [f32; 4] {
    [0, 1, 2, 3].map(|i: usize| w[i] * p[i].x[3])
}

/// Returns whether the correction of a contact presses each vertex into the ground.
#[inline(always)]
fn is_pressed_into((w, n): ([f32; 4], [f32; 3]), p: [ParticleState; 4], ground: f32) -> [bool; 4] {
    [0, 1, 2, 3].map(|i: usize| w[i] * n[1] < 0.0 && p[i].x[1] + p[i].d[1] <= ground)
}

/// Returns the effective inverse mass of a contact [1/kg], bounded from below by [`MAX_SHARE`].
///
/// The parts of the vertices multiply their inverse masses, and their motion in the bound.
#[inline(always)]
fn inverse_mass((w, shares): ([f32; 4], [f32; 4]), parts: [[f32; 2]; 4]) -> f32 {
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
const RECOVERY: f32 = 5.0;

/// Maximum missing distance that recovers at once [minimum distances].
const MAX_MISSING: f32 = 2.0;

/// Recovery of a carried feature per substep [displacements by gravity].
const LIFT: f32 = 4.0;

/// Ends a substep of `h` \[s\]: active contacts of pairs separate without velocity.
///
/// Displacements lose their separating part, and start positions gain it and the recovery of
/// missing distances. [Carried](crate::Carried) features only rise, and recover more: contacts on
/// which others press lose parts of `fall`, the displacement by gravity in a substep \[m\], in each
/// substep. Returns an upper bound of the change of a position by recovery along an axis \[m\], if no vertex
/// is in two of the contacts.
#[inline(never)]
pub(crate) fn recover_contacts(
    particles: ParticleStates<'_>,
    contacts: &[ContactRecord],
    (ground, h): (f32, f32),
    fall: [f32; 3],
) -> f32 {
    let mut max_change = 0.0;
    for contact in contacts {
        if contact.is_active == 0 || contact.vertex_count() < 4 {
            continue;
        }
        let p = contact.vertices.map(|v| particles.get(v as usize));
        let (w, n) = (contact.weights, contact.normal);
        let shares = shares(w, p);
        let free = inverse_mass((w, shares), [[1.0; 2]; 4]);
        let is_movable = free > 0.0;
        if !is_movable {
            continue;
        }
        // The carrying feature stays, as the ground does.
        let is_carried = contact.carried != Carried::Neither as u16;
        let base = if is_carried { f32::INFINITY } else { ground };
        let rising = is_pressed_into((w, n), p, base).map(|stays| if stays { 0.0 } else { 1.0 });
        let weight = inverse_mass((w, shares), rising.map(|part| [part; 2]));
        let (rising, weight) = if weight > 0.0 {
            (rising, weight)
        } else {
            ([1.0; 4], free)
        };
        let along = dot(weighted_sum(w, p.map(|p| p.d)), n);
        let separation = if along > 0.0 { along } else { 0.0 };
        let missing = contact.thickness - contact.gap;
        let slow = lesser(missing, MAX_MISSING * contact.thickness) * (RECOVERY * h);
        let lift = if is_carried {
            LIFT * dot(fall, n).abs()
        } else {
            0.0
        };
        let recovery = lesser(missing, slow + lift);
        let [lost, gained] = [separation / free, recovery / weight];
        for (i, ParticleState { x, d }) in p.into_iter().enumerate() {
            let lost = shares[i] * lost;
            let shift = lost + shares[i] * (gained * rising[i]);
            let state = ParticleState {
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
            particles.set(contact.vertices[i] as usize, state);
            max_change = f32::max(max_change, shift.abs());
        }
    }
    max_change
}

/// Returns the sum of four weighted vectors.
#[inline(always)]
fn weighted_sum(w: [f32; 4], r: [[f32; 4]; 4]) -> [f32; 3] {
    [0, 1, 2].map(|k: usize| (w[0] * r[0][k] + w[1] * r[1][k]) + (w[2] * r[2][k] + w[3] * r[3][k]))
}

#[inline(always)]
fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Returns the part of a slide that friction removes, and adds `more` to the friction bound.
#[inline(always)]
fn hold(contact: &mut ContactRecord, slide: [f32; 3], more: f32) -> [f32; 3] {
    let [x, y, z, _] = contact.friction_sum;
    let before = [x, y, z];
    let sum = [0, 1, 2].map(|k: usize| before[k] + slide[k]);
    let length = (sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]).sqrt();
    let bound = contact.friction_bound + more;
    let part = if length > bound { bound / length } else { 1.0 };
    let [x, y, z] = sum.map(|c| part * c);
    contact.friction_bound = bound;
    contact.friction_sum = [x, y, z, 0.0];
    [x - before[0], y - before[1], z - before[2]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constraints::contacts::{ContactKind, NO_VERTEX};
    use crate::kernels::particle_state::on_arrays;

    const NO_GROUND: f32 = f32::NEG_INFINITY;

    /// A vertex of 2 kg over the middle of a triangle of 3 kg that lies in the plane y = 0.
    fn pair() -> (Vec<[f32; 4]>, ContactRecord) {
        let x = vec![
            [1.0, 0.1, 1.0, 0.5],
            [0.0, 0.0, 0.0, 1.0],
            [3.0, 0.0, 0.0, 1.0],
            [0.0, 0.0, 3.0, 1.0],
        ];
        let contact = ContactRecord {
            vertices: [0, 1, 2, 3],
            weights: [1.0, -1.0 / 3.0, -1.0 / 3.0, -1.0 / 3.0],
            normal: [0.0, 1.0, 0.0],
            gap: 0.05,
            ..ContactRecord::default()
        };
        (x, contact)
    }

    #[test]
    fn vertex_and_triangle_are_separated_by_inverse_mass() {
        let (x, contact) = pair();
        let mut d = [[0.0, -0.2, 0.0, 0.0], [0.0; 4], [0.0; 4], [0.0; 4]];
        on_arrays(&x, &mut d, |p| {
            contacts(p, &[], &mut [contact], (NO_GROUND, 0.0))
        });
        // 0.15 m too near; inverse masses 1/2 and 3 (1/3)^2.
        let step = 0.15 / (0.5 + 1.0 / 3.0);
        assert!((d[0][1] - (-0.2 + 0.5 * step)).abs() < 1e-6, "{d:?}");
        for corner in &d[1..] {
            assert!((corner[1] + step / 3.0).abs() < 1e-6, "{d:?}");
        }
        let before = d;
        on_arrays(&x, &mut d, |p| {
            contacts(p, &[], &mut [contact], (NO_GROUND, 0.0))
        });
        let off = (d[0][1] - before[0][1]).abs();
        assert!(off < 1e-6, "separated contacts are inactive");
    }

    /// Regression: next to pins a corner moved by the reciprocal of its weight, here by 1,500 m.
    #[test]
    fn a_vertex_moves_by_a_few_corrections_at_most() {
        let (mut x, contact) = pair();
        for fixed in &mut x[..3] {
            fixed[3] = 0.0;
        }
        let contact = ContactRecord {
            weights: [1.0, -0.5, -0.4999, -1e-4],
            ..contact
        };
        let mut d = [[0.0, -0.2, 0.0, 0.0], [0.0; 4], [0.0; 4], [0.0; 4]];
        on_arrays(&x, &mut d, |p| {
            contacts(p, &[], &mut [contact], (NO_GROUND, 0.0))
        });
        let depth = 0.15;
        assert!((d[3][1] + MAX_SHARE * depth).abs() < 1e-5, "{d:?}");
    }

    /// Runs the end of a substep of 0.01 s.
    fn recovered(d: [f32; 3], contact: ContactRecord) -> (Vec<ParticleState>, Vec<ParticleState>) {
        let [x, y, z] = d;
        let d = [[x, y, z, 0.0], [0.0; 4], [0.0; 4], [0.0; 4]];
        let states: Vec<_> = (pair().0.into_iter().zip(d))
            .map(|(x, d)| ParticleState { x, d })
            .collect();
        let mut after = states.clone();
        let states_after = ParticleStates::new(&mut after);
        let change = recover_contacts(states_after, &[contact], (NO_GROUND, 0.01), [0.0; 3]);
        assert_eq!(change > 0.0, after != states);
        (states, after)
    }

    #[test]
    fn active_contacts_separate_without_velocity() {
        let contact = ContactRecord {
            is_active: 1,
            thickness: 0.05,
            ..pair().1
        };
        let (before, after) = recovered([0.3, 0.1, 0.0], contact);
        let along = after[0].d[1] - (after[1].d[1] + after[2].d[1] + after[3].d[1]) / 3.0;
        assert!(along.abs() < 1e-7, "{along} m are left");
        assert_eq!(after[0].d[0], 0.3, "along the triangle it moves on");
        let momentum = 2.0 * after[0].d[1] + after[1].d[1] + after[2].d[1] + after[3].d[1];
        assert!((momentum - 0.2).abs() < 1e-6, "{momentum} is left");
        for (after, before) in after.iter().zip(&before) {
            for k in 0..3 {
                let [after, before] = [after, before].map(|state| state.x[k] + state.d[k]);
                assert!((after - before).abs() < 1e-6, "positions stay");
            }
        }
        let inactive = ContactRecord {
            is_active: 0,
            ..contact
        };
        for (d, contact) in [([0.0, 0.1, 0.0], inactive), ([0.0, -0.1, 0.0], contact)] {
            let (before, after) = recovered(d, contact);
            assert!(before == after, "nothing separates");
        }
    }

    #[test]
    fn a_missing_distance_recovers_in_positions_only() {
        let contact = ContactRecord {
            is_active: 1,
            thickness: 0.07,
            gap: 0.03,
            ..pair().1
        };
        let (before, after) = recovered([0.0; 3], contact);
        let between = after[0].x[1] - (after[1].x[1] + after[2].x[1] + after[3].x[1]) / 3.0;
        // A twentieth of the missing 0.04 m in 0.01 s.
        assert!((between - 0.102).abs() < 1e-6, "{between} m apart");
        for (after, before) in after.iter().zip(&before) {
            assert_eq!(after.d, before.d, "velocities stay");
        }
    }

    /// Regression: the ground undid half of each correction, so that upper sheets sank into lower
    /// ones.
    #[test]
    fn a_triangle_on_the_ground_counts_as_fixed_in_height() {
        let (x, contact) = pair();
        for normal in [[0.0, 1.0, 0.0], [0.6, 0.8, 0.0]] {
            let contact = ContactRecord { normal, ..contact };
            let mut d = [[0.0, -0.08, 0.0, 0.0]; 4];
            on_arrays(&x, &mut d, |p| contacts(p, &[], &mut [contact], (0.0, 0.0)));
            let lift = d[1..].iter().map(|corner| -0.08 - corner[1]).sum::<f32>() / 3.0;
            let press = 2.0 * (d[0][1] + 0.08) / 3.0;
            assert!(
                (lift - press).abs() < 1e-6,
                "{d:?}: the ground takes the reaction"
            );
            // Relative to the corners on the ground.
            let shift = d[0][0] - (d[1][0] + d[2][0] + d[3][0]) / 3.0;
            let distance = normal[0] * shift + normal[1] * (0.1 + d[0][1]);
            assert!((distance - 0.05).abs() < 1e-6, "{distance} m, {d:?}");
            let momentum = 2.0 * d[0][0] + d[1][0] + d[2][0] + d[3][0];
            assert!(momentum.abs() < 1e-6, "sideways it is free: {momentum}");
        }
    }

    /// Regression: a contact on which others press lost more in each substep than it regained.
    #[test]
    fn a_carried_feature_rises() {
        let contact = ContactRecord {
            is_active: 1,
            thickness: 0.07,
            gap: 0.03,
            ..pair().1
        };
        let fall = [0.0, -0.005, 0.0];
        for missing in [0.04, 0.005] {
            let contact = ContactRecord {
                gap: contact.thickness - missing,
                carried: Carried::First as u16,
                ..contact
            };
            let mut states: Vec<_> = (pair().0.into_iter())
                .map(|x| ParticleState { x, d: [0.0; 4] })
                .collect();
            let before = states.clone();
            let particles = ParticleStates::new(&mut states);
            recover_contacts(particles, &[contact], (NO_GROUND, 0.01), fall);
            let expected = f32::min(missing, 0.05 * missing + 0.02);
            assert!(
                (states[0].x[1] - 0.1 - expected).abs() < 1e-6,
                "{expected} m"
            );
            assert_eq!(states[1..], before[1..], "nothing is pressed down");
        }
    }

    #[test]
    fn crossed_edges_are_separated_by_inverse_mass() {
        // Edges along x and z cross at a quarter of the first and the middle of the second.
        let x = [
            [-1.0, 0.1, 0.0, 0.5],
            [3.0, 0.1, 0.0, 0.5],
            [0.0, 0.0, -1.0, 1.0],
            [0.0, 0.0, 1.0, 1.0],
        ];
        let contact = ContactRecord {
            vertices: [0, 1, 2, 3],
            weights: [0.75, 0.25, -0.5, -0.5],
            normal: [0.0, 1.0, 0.0],
            gap: 0.05,
            ..ContactRecord::default()
        };
        let mut d = [
            [0.0, -0.2, 0.0, 0.0],
            [0.0, -0.2, 0.0, 0.0],
            [0.0; 4],
            [0.0; 4],
        ];
        on_arrays(&x, &mut d, |p| {
            contacts(p, &[], &mut [contact], (NO_GROUND, 0.0))
        });
        let heights = [0, 1, 2, 3].map(|i: usize| x[i][1] + d[i][1]);
        let between = 0.75 * heights[0] + 0.25 * heights[1] - 0.5 * (heights[2] + heights[3]);
        assert!((between - 0.05).abs() < 1e-6, "{between} m apart");
        let momentum = 2.0 * (d[0][1] + d[1][1] + 0.4) + (d[2][1] + d[3][1]);
        assert!(momentum.abs() < 1e-6, "none is made: {momentum}");
    }

    #[test]
    fn a_vertex_below_a_plane_is_lifted_with_the_gap_rate() {
        let (x, contact) = pair();
        let plane = ContactRecord {
            vertices: [0, NO_VERTEX, NO_VERTEX, NO_VERTEX],
            kind: ContactKind::Plane as u16,
            weights: [1.0, 0.0, 0.0, 0.0],
            friction: 0.5,
            gap: 0.15,
            gap_rate: 2.0,
            ..contact
        };
        for (time, height) in [(0.0, 0.15), (0.05, 0.25)] {
            let mut d = [[0.3, -0.2, 0.0, 0.0], [0.0; 4], [0.0; 4], [0.0; 4]];
            on_arrays(&x, &mut d, |p| {
                contacts(p, &[], &mut [plane], (NO_GROUND, time))
            });
            assert!((x[0][1] + d[0][1] - height).abs() < 1e-6, "{d:?}");
            // Friction removes half of the lift.
            let left = 0.3 - 0.5 * (height + 0.1);
            assert!((d[0][0] - left).abs() < 1e-6 && d[0][2] == 0.0, "{d:?}");
            assert_eq!(d[1..], [[0.0; 4]; 3], "other vertices stay");
        }
        let mut held = x;
        held[0][3] = 0.0;
        let mut d = [[0.0; 4]; 4];
        on_arrays(&held, &mut d, |p| {
            contacts(p, &[], &mut [plane], (NO_GROUND, 0.0))
        });
        assert_eq!(d, [[0.0; 4]; 4], "pinned vertices stay");
    }

    #[test]
    fn friction_is_limited_by_the_normal_correction() {
        for (slide, left) in [(0.03, 0.0), (0.4, 0.325)] {
            let (x, contact) = pair();
            let mut d = [[slide, -0.2, 0.0, 0.0], [0.0; 4], [0.0; 4], [0.0; 4]];
            let mut list = [ContactRecord {
                friction: 0.5,
                ..contact
            }];
            on_arrays(&x, &mut d, |p| {
                contacts(p, &[], &mut list, (NO_GROUND, 0.0))
            });
            let point = (d[1][0] + d[2][0] + d[3][0]) / 3.0;
            assert!((d[0][0] - point - left).abs() < 1e-6, "{d:?}");
            let momentum = 2.0 * d[0][0] + d[1][0] + d[2][0] + d[3][0];
            assert!((momentum - 2.0 * slide).abs() < 1e-6, "none is lost");
        }
    }

    #[test]
    fn friction_is_bounded_by_the_sums_of_a_substep() {
        let (x, contact) = pair();
        let mut list = [ContactRecord {
            friction: 0.5,
            ..contact
        }];
        // 0.15 m too near, then not at all: friction holds 0.075 m of all slides together.
        let mut d = [[0.06, -0.2, 0.0, 0.0], [0.0; 4], [0.0; 4], [0.0; 4]];
        for (pull, left) in [(0.0, 0.0), (-0.1, 0.0), (0.06, 0.0), (0.1, 0.045)] {
            d[0][0] += pull;
            d[0][1] -= 1e-9;
            on_arrays(&x, &mut d, |p| {
                contacts(p, &[], &mut list, (NO_GROUND, 0.0))
            });
            let slide = d[0][0] - (d[1][0] + d[2][0] + d[3][0]) / 3.0;
            assert!((slide - left).abs() < 1e-6, "{slide} m after {pull} m");
        }
    }
}
