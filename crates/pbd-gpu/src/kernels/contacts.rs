//! Contacts: a vertex stays on its side of a triangle (Mueller et al. 2007, section 4.3).
//!
//! Coulomb friction acts as in [`ground`](super::ground), bounded by the sum of all corrections of
//! a substep. Contacts with a plane, such as a cut face, keep the vertex on its side.

use super::block::difference;
use super::particle_state::{ParticleState, ParticleStates};
use crate::constraints::contacts::{ContactRecord, NO_CORNER};

/// Separates vertices and triangles at a time of the frame \[s\], one contact after the other.
///
/// The remaining friction bound is kept for the other iterations of the substep.
#[inline(never)]
pub(crate) fn contacts(
    particles: ParticleStates<'_>,
    contacts: &mut [ContactRecord],
    (friction, accumulates): (f32, bool),
    time: f32,
) {
    for contact in contacts {
        let [v, a, b, c] = contact.vertices.map(|v| v as usize);
        if contact.vertices[1] == NO_CORNER {
            separate_from_plane(particles, contact, (friction, accumulates), time);
            continue;
        }
        let [wb, wc] = contact.weights;
        let wa = (1.0 - wb) - wc;
        let n = contact.normal;
        let [pv, pa, pb, pc] = [v, a, b, c].map(|i| particles.get(i));
        // Vectors from the vertex to the point, hence the other sign of the distance.
        let [ra, rb, rc] = [pa, pb, pc].map(|p| difference(pv, p));
        let way = |k: usize| wa * ra[k] + wb * rb[k] + wc * rc[k];
        let gap = contact.gap + contact.gap_rate * time;
        let depth = gap + (way(0) * n[0] + way(1) * n[1] + way(2) * n[2]);
        let shares = [pv.x[3], wa * pa.x[3], wb * pb.x[3], wc * pc.x[3]];
        let weight = (shares[0] + wa * shares[1]) + (wb * shares[2] + wc * shares[3]);
        if !(depth > 0.0 && weight > 0.0) {
            continue;
        }
        // How far the vertex moves past the point along the triangle in this substep.
        let past = |k: usize| pv.d[k] - (wa * pa.d[k] + wb * pb.d[k] + wc * pc.d[k]);
        let along = past(0) * n[0] + past(1) * n[1] + past(2) * n[2];
        let slide = [0, 1, 2].map(|k: usize| past(k) - along * n[k]);
        let back = friction_fraction(contact, slide, friction * depth, accumulates);
        let push = [0, 1, 2].map(|k: usize| (depth * n[k] - back * slide[k]) / weight);
        let moved = |to: [f32; 4], by: f32| {
            [
                to[0] + by * push[0],
                to[1] + by * push[1],
                to[2] + by * push[2],
                to[3],
            ]
        };
        particles.set_d(v, moved(pv.d, shares[0]));
        particles.set_d(a, moved(pa.d, -shares[1]));
        particles.set_d(b, moved(pb.d, -shares[2]));
        particles.set_d(c, moved(pc.d, -shares[3]));
    }
}

/// Moves the vertex of a contact to its side of a plane and applies friction.
fn separate_from_plane(
    particles: ParticleStates<'_>,
    contact: &mut ContactRecord,
    (friction, accumulates): (f32, bool),
    time: f32,
) {
    let v = contact.vertices[0] as usize;
    let n = contact.normal;
    let ParticleState { x, d: dv } = particles.get(v);
    let at = |k: usize| x[k] + dv[k];
    let gap = contact.gap + contact.gap_rate * time;
    let depth = gap - (at(0) * n[0] + at(1) * n[1] + at(2) * n[2]);
    if !(depth > 0.0 && x[3] > 0.0) {
        return;
    }
    let along = dv[0] * n[0] + dv[1] * n[1] + dv[2] * n[2];
    let slide = [0, 1, 2].map(|k: usize| dv[k] - along * n[k]);
    let back = friction_fraction(contact, slide, friction * depth, accumulates);
    let moved = |k: usize| dv[k] + (depth * n[k] - back * slide[k]);
    particles.set_d(v, [moved(0), moved(1), moved(2), dv[3]]);
}

/// Returns the fraction of a slide that friction removes, and adds `more` to the friction bound.
fn friction_fraction(
    contact: &mut ContactRecord,
    slide: [f32; 3],
    more: f32,
    accumulates: bool,
) -> f32 {
    let length = (slide[0] * slide[0] + slide[1] * slide[1] + slide[2] * slide[2]).sqrt();
    let held = if accumulates {
        contact.friction_left
    } else {
        0.0
    };
    let limit = held + more;
    let slips = length > limit;
    if accumulates {
        contact.friction_left = if slips { 0.0 } else { limit - length };
    }
    if slips { limit / length } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernels::particle_state::on_arrays;

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
            weights: [1.0 / 3.0; 2],
            gap_rate: 0.0,
            normal: [0.0, 1.0, 0.0],
            gap: 0.05,
            friction_left: 0.0,
        };
        (x, contact)
    }

    #[test]
    fn vertex_and_triangle_are_separated_by_inverse_mass() {
        let (x, contact) = pair();
        let mut d = [[0.0, -0.2, 0.0, 0.0], [0.0; 4], [0.0; 4], [0.0; 4]];
        on_arrays(&x, &mut d, |p| {
            contacts(p, &mut [contact], (0.0, false), 0.0)
        });
        // 0.15 m too near; inverse masses 1/2 and 3 (1/3)^2.
        let step = 0.15 / (0.5 + 1.0 / 3.0);
        assert!((d[0][1] - (-0.2 + 0.5 * step)).abs() < 1e-6, "{d:?}");
        for corner in &d[1..] {
            assert!((corner[1] + step / 3.0).abs() < 1e-6, "{d:?}");
        }
        let before = d;
        on_arrays(&x, &mut d, |p| {
            contacts(p, &mut [contact], (0.0, false), 0.0)
        });
        let off = (d[0][1] - before[0][1]).abs();
        assert!(off < 1e-6, "separated contacts are inactive");
        let rising = ContactRecord {
            gap_rate: 2.0,
            ..contact
        };
        on_arrays(&x, &mut d, |p| {
            contacts(p, &mut [rising], (0.0, false), 0.01)
        });
        let step = 0.02 / (0.5 + 1.0 / 3.0);
        let pushed = d[0][1] - before[0][1];
        assert!((pushed - 0.5 * step).abs() < 1e-6, "the gap has grown");
    }

    #[test]
    fn a_vertex_below_a_plane_is_lifted_with_the_gap_rate() {
        let (x, contact) = pair();
        let plane = ContactRecord {
            vertices: [0, NO_CORNER, NO_CORNER, NO_CORNER],
            gap: 0.15,
            gap_rate: 2.0,
            ..contact
        };
        for (time, height) in [(0.0, 0.15), (0.05, 0.25)] {
            let mut d = [[0.3, -0.2, 0.0, 0.0], [0.0; 4], [0.0; 4], [0.0; 4]];
            on_arrays(&x, &mut d, |p| contacts(p, &mut [plane], (0.5, true), time));
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
            contacts(p, &mut [plane], (0.5, true), 0.0)
        });
        assert_eq!(d, [[0.0; 4]; 4], "pinned vertices stay");
    }

    #[test]
    fn friction_is_limited_by_the_normal_correction() {
        for (slide, left) in [(0.03, 0.0), (0.4, 0.325)] {
            let (x, contact) = pair();
            let mut d = [[slide, -0.2, 0.0, 0.0], [0.0; 4], [0.0; 4], [0.0; 4]];
            let mut list = [contact];
            on_arrays(&x, &mut d, |p| contacts(p, &mut list, (0.5, true), 0.0));
            let point = (d[1][0] + d[2][0] + d[3][0]) / 3.0;
            assert!((d[0][0] - point - left).abs() < 1e-6, "{d:?}");
            let momentum = 2.0 * d[0][0] + d[1][0] + d[2][0] + d[3][0];
            assert!((momentum - 2.0 * slide).abs() < 1e-6, "none is lost");
            let held = if left > 0.0 { 0.0 } else { 0.075 - slide };
            assert!((list[0].friction_left - held).abs() < 1e-6);
        }
    }
}
