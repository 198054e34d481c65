//! Contacts: a vertex stays on its side of a triangle (Mueller et al. 2007, section 4.3), with Coulomb's friction between
//! the two as [`ground`](super::ground) has it: bounded by all that a substep pushed them apart. Or it stays above a plane that does not move along itself.

use super::block::difference;
use super::displacements::Displacements;
use crate::contacts::{ContactRecord, NO_CORNER};

/// Pushes vertices and triangles apart that are too near at a time of the frame \[s\], one contact after the other. What friction has left is kept for
/// other iterations of the substep if there are any.
#[inline(never)]
pub(crate) fn contacts(
    x: &[[f32; 4]],
    d: &mut impl Displacements,
    contacts: &mut [ContactRecord],
    (friction, keeps): (f32, bool),
    time: f32,
) {
    for contact in contacts {
        let [v, a, b, c] = contact.vertices.map(|v| v as usize);
        if contact.vertices[1] == NO_CORNER {
            above_plane(x[v], d, contact, (friction, keeps), time);
            continue;
        }
        let [wb, wc] = contact.weights;
        let wa = (1.0 - wb) - wc;
        let n = contact.normal;
        let (xv, xa, xb, xc) = (x[v], x[a], x[b], x[c]);
        let (dv, da, db, dc) = (d.get(v), d.get(a), d.get(b), d.get(c));
        // From the vertex to the point, so that the distance has the other sign.
        let (ra, rb, rc) = (
            difference(xv, dv, xa, da),
            difference(xv, dv, xb, db),
            difference(xv, dv, xc, dc),
        );
        let way = |k: usize| wa * ra[k] + wb * rb[k] + wc * rc[k];
        let gap = contact.gap + contact.rise * time;
        let depth = gap + (way(0) * n[0] + way(1) * n[1] + way(2) * n[2]);
        let shares = [xv[3], wa * xa[3], wb * xb[3], wc * xc[3]];
        let weight = (shares[0] + wa * shares[1]) + (wb * shares[2] + wc * shares[3]);
        if !(depth > 0.0 && weight > 0.0) {
            continue;
        }
        // How far the vertex moves past the point along the triangle in this substep.
        let past = |k: usize| dv[k] - (wa * da[k] + wb * db[k] + wc * dc[k]);
        let along = past(0) * n[0] + past(1) * n[1] + past(2) * n[2];
        let slide = [0, 1, 2].map(|k: usize| past(k) - along * n[k]);
        let back = held_back(contact, slide, friction * depth, keeps);
        let push = [0, 1, 2].map(|k: usize| (depth * n[k] - back * slide[k]) / weight);
        let moved = |to: [f32; 4], by: f32| {
            [
                to[0] + by * push[0],
                to[1] + by * push[1],
                to[2] + by * push[2],
                to[3],
            ]
        };
        d.set(v, moved(dv, shares[0]));
        d.set(a, moved(da, -shares[1]));
        d.set(b, moved(db, -shares[2]));
        d.set(c, moved(dc, -shares[3]));
    }
}

/// Lifts the vertex of a contact to its side of a plane, which holds it back where it slides.
fn above_plane(
    x: [f32; 4],
    d: &mut impl Displacements,
    contact: &mut ContactRecord,
    (friction, keeps): (f32, bool),
    time: f32,
) {
    let v = contact.vertices[0] as usize;
    let (n, dv) = (contact.normal, d.get(v));
    let at = |k: usize| x[k] + dv[k];
    let gap = contact.gap + contact.rise * time;
    let depth = gap - (at(0) * n[0] + at(1) * n[1] + at(2) * n[2]);
    if !(depth > 0.0 && x[3] > 0.0) {
        return;
    }
    let along = dv[0] * n[0] + dv[1] * n[1] + dv[2] * n[2];
    let slide = [0, 1, 2].map(|k: usize| dv[k] - along * n[k]);
    let back = held_back(contact, slide, friction * depth, keeps);
    let moved = |k: usize| dv[k] + (depth * n[k] - back * slide[k]);
    d.set(v, [moved(0), moved(1), moved(2), dv[3]]);
}

/// The part of a slide that friction takes, if a push adds so much to what it may take.
fn held_back(contact: &mut ContactRecord, slide: [f32; 3], more: f32, keeps: bool) -> f32 {
    let length = (slide[0] * slide[0] + slide[1] * slide[1] + slide[2] * slide[2]).sqrt();
    let held = if keeps { contact.held } else { 0.0 };
    let limit = held + more;
    let slips = length > limit;
    if keeps {
        contact.held = if slips { 0.0 } else { limit - length };
    }
    if slips { limit / length } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

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
            rise: 0.0,
            normal: [0.0, 1.0, 0.0],
            gap: 0.05,
            held: 0.0,
        };
        (x, contact)
    }

    #[test]
    fn who_comes_too_near_is_pushed_apart_by_mass() {
        let (x, contact) = pair();
        let mut d = [[0.0, -0.2, 0.0, 0.0], [0.0; 4], [0.0; 4], [0.0; 4]];
        contacts(&x, &mut d, &mut [contact], (0.0, false), 0.0);
        // 0.15 m too near; inverse masses 1/2 and 3 (1/3)^2.
        let step = 0.15 / (0.5 + 1.0 / 3.0);
        assert!((d[0][1] - (-0.2 + 0.5 * step)).abs() < 1e-6, "{d:?}");
        for corner in &d[1..] {
            assert!((corner[1] + step / 3.0).abs() < 1e-6, "{d:?}");
        }
        let before = d;
        contacts(&x, &mut d, &mut [contact], (0.0, false), 0.0);
        let off = (d[0][1] - before[0][1]).abs();
        assert!(off < 1e-6, "once apart nothing is pushed");
        let rising = ContactRecord {
            rise: 2.0,
            ..contact
        };
        contacts(&x, &mut d, &mut [rising], (0.0, false), 0.01);
        let step = 0.02 / (0.5 + 1.0 / 3.0);
        let pushed = d[0][1] - before[0][1];
        assert!((pushed - 0.5 * step).abs() < 1e-6, "the gap has grown");
    }

    #[test]
    fn who_is_below_a_plane_is_lifted_by_what_the_plane_rises_too() {
        let (x, contact) = pair();
        let plane = ContactRecord {
            vertices: [0, NO_CORNER, NO_CORNER, NO_CORNER],
            gap: 0.15,
            rise: 2.0,
            ..contact
        };
        for (time, height) in [(0.0, 0.15), (0.05, 0.25)] {
            let mut d = [[0.3, -0.2, 0.0, 0.0], [0.0; 4], [0.0; 4], [0.0; 4]];
            contacts(&x, &mut d, &mut [plane], (0.5, true), time);
            assert!((x[0][1] + d[0][1] - height).abs() < 1e-6, "{d:?}");
            // Friction takes half of what it was lifted by.
            let left = 0.3 - 0.5 * (height + 0.1);
            assert!((d[0][0] - left).abs() < 1e-6 && d[0][2] == 0.0, "{d:?}");
            assert_eq!(d[1..], [[0.0; 4]; 3], "and nobody else moves");
        }
        let mut held = x;
        held[0][3] = 0.0;
        let mut d = [[0.0; 4]; 4];
        contacts(&held, &mut d, &mut [plane], (0.5, true), 0.0);
        assert_eq!(d, [[0.0; 4]; 4], "who is pinned stays");
    }

    #[test]
    fn friction_takes_what_slides_up_to_its_share_of_the_push() {
        for (slide, left) in [(0.03, 0.0), (0.4, 0.325)] {
            let (x, contact) = pair();
            let mut d = [[slide, -0.2, 0.0, 0.0], [0.0; 4], [0.0; 4], [0.0; 4]];
            let mut list = [contact];
            contacts(&x, &mut d, &mut list, (0.5, true), 0.0);
            let point = (d[1][0] + d[2][0] + d[3][0]) / 3.0;
            assert!((d[0][0] - point - left).abs() < 1e-6, "{d:?}");
            let momentum = 2.0 * d[0][0] + d[1][0] + d[2][0] + d[3][0];
            assert!((momentum - 2.0 * slide).abs() < 1e-6, "none is lost");
            let held = if left > 0.0 { 0.0 } else { 0.075 - slide };
            assert!((list[0].held - held).abs() < 1e-6);
        }
    }
}
