//! Nearest points, normals and distances of the features of contacts, at the start of a substep.
//!
//! A vertex is in front of its triangle, on the side of the normal. Whether it keeps its distance
//! from the plane or from the nearest point is decided once a frame, so that a vertex which slides
//! over an edge onto the next triangle is not lost. The normal between two edges
//! keeps its side from substep to substep, so that edges which have crossed are separated the way
//! they came. A feature that the other one has left does nothing. Normals stay for the substep, so
//! that its sums of friction are along the same plane.
//!
//! Other constraints move the features on after friction has held them. Friction takes this drift
//! back in the next substep. Without that, each ball of a heap creeps.

use super::contacts::{VertexStates, between_features};
use super::particle_state::ParticleState;
use crate::constraints::contacts::{ContactKind, ContactRecord};

/// Distance of an inactive contact \[m\], less than any other.
pub(crate) const INACTIVE: f32 = -1e30;

/// Minimum squared sine between two edges.
pub(crate) const MIN_SQUARED_SINE: f32 = 1e-4;

/// Finds the features of all contacts between pairs, and begins their sums of friction.
///
/// Replaces the indices in `facing` by those of the contacts that may be active in the substep:
/// most pairs found near each other have left their features.
#[inline(never)]
pub(crate) fn contact_features(
    vertices: impl VertexStates,
    contacts: &mut [ContactRecord],
    facing: &mut Vec<u32>,
) {
    facing.clear();
    for (i, contact) in (0..).zip(contacts) {
        let was_held = contact.friction_bound > 0.0;
        contact.friction_bound = 0.0;
        contact.friction_sum = [0.0; 3];
        contact.is_active = 0;
        if contact.kind == ContactKind::Plane as u16 {
            facing.push(i);
            continue;
        }
        let p = contact.vertices.map(|v| vertices.state(v as usize));
        contact.drift = if was_held {
            let now = between_features(contact, p.map(ParticleState::at_start));
            [0, 1, 2].map(|k: usize| now[k] - contact.held_at[k])
        } else {
            [0.0; 3]
        };
        let distance = if contact.kind == ContactKind::EdgeEdge as u16 {
            edge_edge(contact, p)
        } else {
            vertex_face(contact, p)
        };
        // Closer features keep the distance that they have; it recovers without velocity.
        contact.gap = if distance < contact.thickness {
            distance
        } else {
            contact.thickness
        };
        if distance > INACTIVE {
            facing.push(i);
        }
    }
}

/// Sets weights and normal of a vertex and a triangle and returns their signed distance.
fn vertex_face(contact: &mut ContactRecord, [v, a, b, c]: [ParticleState; 4]) -> f32 {
    let [ab, ac, av] = [b, c, v].map(|p| between(a.x, p.x));
    let area = cross(ab, ac);
    let area_square = dot(area, area);
    let has_area = area_square > 0.0;
    if !has_area {
        return INACTIVE;
    }
    let [wa, wb, wc] = nearest_weights(ab, ac, av);
    contact.weights = [1.0, -wa, -wb, -wc];
    let offset = [0, 1, 2].map(|k: usize| av[k] - (wb * ab[k] + wc * ac[k]));
    let square = dot(offset, offset);
    let area_length = area_square.sqrt();
    let normal = area.map(|c| c / area_length);
    let height = dot(normal, av);
    let is_inside = wa > 0.0 && wb > 0.0 && wc > 0.0;
    if contact.kind == ContactKind::VertexPoint as u16 && !is_inside {
        if height > 0.0 && square > 0.0 {
            let length = square.sqrt();
            contact.normal = offset.map(|c| c / length);
            return length;
        }
        return INACTIVE;
    }
    contact.normal = normal;
    let beside = square - height * height;
    if height > 0.0 || beside <= contact.thickness * contact.thickness {
        height
    } else {
        INACTIVE
    }
}

/// Sets weights and normal of two edges and returns their signed distance.
fn edge_edge(contact: &mut ContactRecord, [a, b, c, d]: [ParticleState; 4]) -> f32 {
    let (ab, cd, ca) = (between(a.x, b.x), between(c.x, d.x), between(c.x, a.x));
    let (aa, ee, bb) = (dot(ab, ab), dot(cd, cd), dot(ab, cd));
    let (first, second) = (dot(ab, ca), dot(cd, ca));
    // Equals the square of the cross product, which keeps more digits of small angles.
    let across = cross(ab, cd);
    let square = dot(across, across);
    let cross_each_other = square > MIN_SQUARED_SINE * (aa * ee);
    if !cross_each_other {
        return INACTIVE;
    }
    let s = (bb * second - first * ee) / square;
    let t = (aa * second - bb * first) / square;
    // At an end the contacts of its vertex act.
    if !(s > 0.0 && s < 1.0 && t > 0.0 && t < 1.0) {
        return INACTIVE;
    }
    let length = square.sqrt();
    let side = if dot(across, contact.normal) < 0.0 {
        -length
    } else {
        length
    };
    contact.weights = [1.0 - s, s, t - 1.0, -t];
    contact.normal = across.map(|c| c / side);
    dot(contact.normal, ca)
}

/// Returns the barycentric coordinates of the point of a triangle nearest to a point.
///
/// Ericson 2005, section 5.1.5, for vectors from the first corner.
fn nearest_weights(ab: [f32; 3], ac: [f32; 3], ap: [f32; 3]) -> [f32; 3] {
    let (d1, d2) = (dot(ab, ap), dot(ac, ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let bp = [0, 1, 2].map(|k: usize| ap[k] - ab[k]);
    let (d3, d4) = (dot(ab, bp), dot(ac, bp));
    if d3 >= 0.0 && d4 <= d3 {
        return [0.0, 1.0, 0.0];
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let t = d1 / (d1 - d3);
        return [1.0 - t, t, 0.0];
    }
    let cp = [0, 1, 2].map(|k: usize| ap[k] - ac[k]);
    let (d5, d6) = (dot(ab, cp), dot(ac, cp));
    if d6 >= 0.0 && d5 <= d6 {
        return [0.0, 0.0, 1.0];
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let t = d2 / (d2 - d6);
        return [1.0 - t, 0.0, t];
    }
    let va = d3 * d6 - d5 * d4;
    let (e, f) = (d4 - d3, d5 - d6);
    if va <= 0.0 && e >= 0.0 && f >= 0.0 {
        let t = e / (e + f);
        return [0.0, 1.0 - t, t];
    }
    let sum = (va + vb) + vc;
    if sum > 0.0 {
        [va / sum, vb / sum, vc / sum]
    } else {
        [1.0, 0.0, 0.0]
    }
}

fn between(from: [f32; 4], to: [f32; 4]) -> [f32; 3] {
    [to[0] - from[0], to[1] - from[1], to[2] - from[2]]
}

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernels::particle_state::on_arrays;

    const TRIANGLE: [[f32; 4]; 3] = [
        [0.0, 0.0, 0.0, 1.0],
        [0.0, 0.0, 1.0, 1.0],
        [1.0, 0.0, 0.0, 1.0],
    ];

    /// Returns the record of a vertex at `at` over the triangle in y = 0.
    fn over_triangle(kind: ContactKind, at: [f32; 3]) -> ContactRecord {
        let [a, b, c] = TRIANGLE;
        let x = [[at[0], at[1], at[2], 1.0], a, b, c];
        let mut contact = [ContactRecord {
            vertices: [0, 1, 2, 3],
            thickness: 0.1,
            kind: kind as u16,
            ..ContactRecord::default()
        }];
        on_arrays(&x, &mut [[0.0; 4]; 4], |p| {
            contact_features(p, &mut contact, &mut Vec::new())
        });
        contact[0]
    }

    #[test]
    fn a_vertex_has_the_nearest_point_of_its_triangle() {
        let up = [0.0, 1.0, 0.0];
        let [face, point] = [ContactKind::VertexFace, ContactKind::VertexPoint];
        for kind in [face, point] {
            let inside = over_triangle(kind, [0.25, 0.3, 0.5]);
            assert_eq!(inside.weights, [1.0, -0.25, -0.5, -0.25]);
            assert_eq!((inside.normal, inside.gap), (up, 0.1));
            let near = over_triangle(kind, [0.25, 0.04, 0.5]);
            assert!((near.gap - 0.04).abs() < 1e-6, "{}", near.gap);
            let behind = over_triangle(kind, [0.25, -0.3, 0.5]);
            assert!((behind.gap + 0.3).abs() < 1e-6, "{}", behind.gap);
            let gone = over_triangle(kind, [-0.3, -0.1, 0.5]);
            assert_eq!(gone.gap, INACTIVE, "it has left the triangle");
        }
        let beside = over_triangle(point, [-0.3, 0.4, 0.5]);
        assert_eq!(beside.weights, [1.0, -0.5, -0.5, 0.0]);
        assert!((beside.normal[0] + 0.6).abs() < 1e-6, "{:?}", beside.normal);
        let sliding = over_triangle(face, [-0.3, 0.04, 0.5]);
        assert_eq!(sliding.normal, up);
        assert!((sliding.gap - 0.04).abs() < 1e-6, "{}", sliding.gap);
    }

    #[test]
    fn crossed_edges_keep_their_side() {
        let edges = |height: f32, normal: [f32; 3], x: f32| {
            let x = [
                [x - 1.0, height, 0.0, 1.0],
                [x + 3.0, height, 0.0, 1.0],
                [0.0, 0.0, -1.0, 1.0],
                [0.0, 0.0, 1.0, 1.0],
            ];
            let mut contact = [ContactRecord {
                vertices: [0, 1, 2, 3],
                normal,
                thickness: 0.1,
                kind: ContactKind::EdgeEdge as u16,
                ..ContactRecord::default()
            }];
            on_arrays(&x, &mut [[0.0; 4]; 4], |p| {
                contact_features(p, &mut contact, &mut Vec::new())
            });
            contact[0]
        };
        let up = [0.0, 1.0, 0.0];
        let above = edges(0.3, [0.6, 0.8, 0.0], 0.0);
        assert_eq!(above.weights, [0.75, 0.25, -0.5, -0.5]);
        assert_eq!((above.normal, above.gap), (up, 0.1));
        let crossed = edges(-0.05, up, 0.0);
        assert_eq!(crossed.normal, up, "the side is kept");
        assert!((crossed.gap + 0.05).abs() < 1e-6, "{}", crossed.gap);
        let beyond = edges(0.05, up, 2.0);
        assert_eq!(beyond.gap, INACTIVE, "it is beyond the end");
    }
}
