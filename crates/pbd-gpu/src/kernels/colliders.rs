//! Collision of vertices with colliders, with Coulomb friction.
//!
//! Friction in a substep is bounded by the sum of its normal corrections, and slows the motion
//! relative to the collider. A pass that needs less than its bound leaves the rest to the next
//! ones. With a separate bound for each pass, later iterations would move bodies at rest, because
//! their corrections are small.

use super::particle_state::{ParticleState, ParticleStates};
use crate::constraints::colliders::{ColliderRecord, PLANE, ROUND};
use std::cell::Cell;

/// Maximum distance of a vertex that touches a collider, relative to its coordinates from there.
///
/// Rounding leaves half of the vertices that were pushed out of a tilted plane slightly above it.
pub(crate) const TOUCH: f32 = 2.0 * f32::EPSILON;

/// Vertices that are tested without a branch.
const BLOCK: usize = 16;

/// Friction and time of a pass over colliders.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ColliderPass {
    /// Coefficient of Coulomb friction.
    pub(crate) friction: f32,
    /// Time of the frame per substep \[s\].
    pub(crate) h: f32,
    /// Time of the frame at the end of the substep \[s\].
    pub(crate) time: f32,
}

/// Pushes vertices out of colliders at a time of the frame, one collider after the other.
///
/// What is left of the friction of earlier passes also holds vertices that only touch a collider.
/// The fourth component of the velocity holds the remaining friction bound \[m\]; it is 0 before
/// the first pass. `corrections`, the internal displacements, exclude the pushes; empty without
/// a lift. Returns whether a vertex was in a collider.
#[inline(never)]
pub(crate) fn colliders(
    particles: ParticleStates<'_>,
    v: &mut [[f32; 4]],
    corrections: &[Cell<[f32; 4]>],
    colliders: &[ColliderRecord],
    pass: ColliderPass,
) -> bool {
    let vertices = Vertices {
        particles,
        corrections,
    };
    let mut has_pushed = false;
    for c in colliders {
        has_pushed |= if c.kind == PLANE {
            push_out_of_plane(vertices, v, c, pass)
        } else {
            push_out(vertices, v, c, |q, d| separation(q, d, c), pass)
        };
    }
    has_pushed
}

/// States of vertices, and their displacements by constraints.
#[derive(Debug, Clone, Copy)]
struct Vertices<'a> {
    particles: ParticleStates<'a>,
    corrections: &'a [Cell<[f32; 4]>],
}

/// Pushes vertices out of a plane; tests [`BLOCK`] of them before it moves one.
#[inline(always)]
fn push_out_of_plane(
    vertices: Vertices<'_>,
    v: &mut [[f32; 4]],
    plane: &ColliderRecord,
    pass: ColliderPass,
) -> bool {
    let origin = plane.origin_at(pass.time);
    let mut has_pushed = false;
    let blocks = vertices.particles.0.chunks(BLOCK).zip(v.chunks_mut(BLOCK));
    for (i, (cells, v)) in blocks.enumerate() {
        let mut is_near = false;
        for cell in cells {
            let ParticleState { x, d } = cell.get();
            let q = [0, 1, 2].map(|k: usize| x[k] - origin[k]);
            is_near |= touches(height(q, [d[0], d[1], d[2]], plane), q);
        }
        if is_near {
            let rest = vertices.corrections.get(i * BLOCK..).unwrap_or_default();
            let block = Vertices {
                particles: ParticleStates(cells),
                corrections: rest,
            };
            let separation = |q, d| (height(q, d, plane), plane.extent);
            has_pushed |= push_out(block, v, plane, separation, pass);
        }
    }
    has_pushed
}

/// Pushes vertices out of a collider with a given separation.
#[inline(always)]
fn push_out(
    vertices: Vertices<'_>,
    v: &mut [[f32; 4]],
    collider: &ColliderRecord,
    separation: impl Fn([f32; 3], [f32; 3]) -> (f32, [f32; 3]),
    pass: ColliderPass,
) -> bool {
    let mut has_pushed = false;
    let origin = collider.origin_at(pass.time);
    let dragged = collider.velocity.map(|c| c * pass.h);
    for (i, (cell, v)) in vertices.particles.iter().zip(v).enumerate() {
        let ParticleState { x, mut d } = cell.get();
        let q = [0, 1, 2].map(|k: usize| x[k] - origin[k]);
        let (distance, n) = separation(q, [d[0], d[1], d[2]]);
        if touches(distance, q) && x[3] > 0.0 && (distance < 0.0 || v[3] > 0.0) {
            let depth = if distance < 0.0 { -distance } else { 0.0 };
            let before = d;
            push(&mut d, &mut v[3], n, depth, pass.friction, dragged);
            if let Some(correction) = vertices.corrections.get(i) {
                let u = correction.get();
                correction.set([0, 1, 2, 3].map(|k: usize| u[k] - (d[k] - before[k])));
            }
            cell.set(ParticleState { x, d });
            has_pushed |= depth > 0.0;
        }
    }
    has_pushed
}

/// Moves a displacement out by `depth` and applies friction to its tangential part, relative to
/// the displacement of the collider.
#[inline(always)]
fn push(
    d: &mut [f32; 4],
    held: &mut f32,
    n: [f32; 3],
    depth: f32,
    friction: f32,
    dragged: [f32; 3],
) {
    let relative = [0, 1, 2].map(|k: usize| d[k] - dragged[k]);
    let along = dot(relative, n);
    let slide = [0, 1, 2].map(|k: usize| relative[k] - along * n[k]);
    let length = (slide[0] * slide[0] + slide[1] * slide[1] + slide[2] * slide[2]).sqrt();
    let limit = *held + friction * depth;
    let slips = length > limit;
    *held = if slips { 0.0 } else { limit - length };
    let kept = if slips { 1.0 - limit / length } else { 0.0 };
    let normal = along + depth;
    for k in 0..3 {
        d[k] = dragged[k] + (normal * n[k] + kept * slide[k]);
    }
}

/// Returns whether a point `q` relative to a collider, at a distance from it, touches it.
#[inline(always)]
pub(crate) fn touches(distance: f32, q: [f32; 3]) -> bool {
    distance <= TOUCH * ((q[0].abs() + q[1].abs()) + q[2].abs())
}

/// Returns the height of a point `q + d` above a plane \[m\].
#[inline(always)]
fn height(q: [f32; 3], d: [f32; 3], plane: &ColliderRecord) -> f32 {
    dot(plane.extent, q) + dot(plane.extent, d)
}

/// Returns the signed distance of a point from a collider \[m\], and the outward unit normal.
///
/// The point is `q + d` relative to the origin of the collider. The change by `d` is computed
/// separately, since a displacement would be lost in the rounding of large coordinates.
#[inline(always)]
pub(crate) fn separation(q: [f32; 3], d: [f32; 3], c: &ColliderRecord) -> (f32, [f32; 3]) {
    if c.kind == PLANE {
        return (height(q, d, c), c.extent);
    }
    let p = [0, 1, 2].map(|k: usize| q[k] + d[k]);
    if c.kind == ROUND {
        let share = dot(c.axes[0], p);
        let share = if share < 0.0 { 0.0 } else { share };
        let share = if share > 1.0 { 1.0 } else { share };
        let before = [0, 1, 2].map(|k: usize| q[k] - share * c.extent[k]);
        let from = [0, 1, 2].map(|k: usize| before[k] + d[k]);
        let (first, length) = (dot(before, before).sqrt(), dot(from, from).sqrt());
        let sum = first + length;
        let grown = 2.0 * dot(before, d) + dot(d, d);
        let grown = if sum > 0.0 { grown / sum } else { 0.0 };
        // At the center every direction is equivalent.
        let n = if length > 0.0 {
            from.map(|c| c / length)
        } else {
            [0.0, 1.0, 0.0]
        };
        return ((first - c.radius) + grown, n);
    }
    let [u, v] = c.axes;
    let w = [
        u[1] * v[2] - u[2] * v[1],
        u[2] * v[0] - u[0] * v[2],
        u[0] * v[1] - u[1] * v[0],
    ];
    let local = [dot(u, p), dot(v, p), dot(w, p)];
    let (before, way) = (
        [dot(u, q), dot(v, q), dot(w, q)],
        [dot(u, d), dot(v, d), dot(w, d)],
    );
    let beyond = [0, 1, 2].map(|k: usize| {
        let sign = if local[k] < 0.0 { -1.0 } else { 1.0 };
        (sign * before[k] - c.extent[k]) + sign * way[k]
    });
    // Out by the nearest side. Vertices outside are not moved.
    let first = beyond[1] > beyond[0];
    let least = if first { beyond[1] } else { beyond[0] };
    let axis = if first { v } else { u };
    let side = if first { local[1] } else { local[0] };
    let last = beyond[2] > least;
    let least = if last { beyond[2] } else { least };
    let axis = if last { w } else { axis };
    let side = if last { local[2] } else { side };
    let sign = if side < 0.0 { -1.0 } else { 1.0 };
    (least, axis.map(|c| sign * c))
}

/// The planes that bodies lie on, at the end of a substep.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Planes<'a> {
    pub(crate) records: &'a [ColliderRecord],
    /// Time of the frame \[s\].
    pub(crate) time: f32,
}

impl Planes<'_> {
    /// Returns the vectors that move a vertex out of each plane \[m\], one after the other.
    #[inline(always)]
    pub(crate) fn push_out(
        self,
        ParticleState { x, mut d }: ParticleState,
    ) -> impl Iterator<Item = [f32; 3]> {
        self.records.iter().map(move |plane| {
            let q = plane.relative(x, self.time);
            let distance = height(q, [d[0], d[1], d[2]], plane);
            let depth = if distance < 0.0 && x[3] > 0.0 {
                -distance
            } else {
                0.0
            };
            let push = plane.extent.map(|n| depth * n);
            for k in 0..3 {
                d[k] += push[k];
            }
            push
        })
    }

    /// Returns the part of a direction along which a vertex can move, if it would be pressed into
    /// planes that it touches.
    #[inline(always)]
    pub(crate) fn slide(
        self,
        ParticleState { x, d }: ParticleState,
        direction: [f32; 3],
    ) -> Option<[f32; 3]> {
        let mut free = None;
        for plane in self.records {
            let q = plane.relative(x, self.time);
            let n = plane.extent;
            let before = free.unwrap_or(direction);
            let along = dot(before, n);
            if along < 0.0 && touches(height(q, [d[0], d[1], d[2]], plane), q) {
                free = Some([0, 1, 2].map(|k: usize| before[k] - along * n[k]));
            }
        }
        free
    }
}

#[inline(always)]
pub(super) fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constraints::colliders::{Collider, MovingCollider};
    use crate::kernels::particle_state::on_arrays;

    fn out(collider: Collider, p: [f32; 3]) -> (f32, [f32; 3]) {
        let record = collider.record().unwrap();
        let d = [0.03, -0.02, 0.01];
        let q = [0, 1, 2].map(|k: usize| (p[k] - record.origin[k]) - d[k]);
        separation(q, d, &record)
    }

    fn assert_out(collider: Collider, p: [f32; 3], distance: f32, n: [f32; 3]) {
        let found = out(collider, p);
        assert!((found.0 - distance).abs() < 1e-6, "{found:?}");
        let off = [0, 1, 2].map(|k: usize| (found.1[k] - n[k]).abs());
        assert!(off.into_iter().all(|c| c < 1e-6), "{found:?}");
    }

    #[test]
    fn the_separation_is_the_shortest() {
        let plane = Collider::Plane {
            point: [1.0, 2.0, 3.0],
            normal: [0.0, 5.0, 0.0],
        };
        assert_out(plane, [9.0, 1.5, -7.0], -0.5, [0.0, 1.0, 0.0]);
        let sphere = Collider::Sphere {
            center: [1.0, 0.0, 0.0],
            radius: 2.0,
        };
        assert_out(sphere, [1.0, 0.0, -1.5], -0.5, [0.0, 0.0, -1.0]);
        assert_out(sphere, [1.0, 0.0, 0.0], -2.0, [0.0, 1.0, 0.0]);
        let capsule = Collider::Capsule {
            ends: [[0.0; 3], [4.0, 0.0, 0.0]],
            radius: 1.0,
        };
        assert_out(capsule, [3.0, 0.0, 0.75], -0.25, [0.0, 0.0, 1.0]);
        assert_out(capsule, [4.5, 0.0, 0.0], -0.5, [1.0, 0.0, 0.0]);
        assert_out(capsule, [-3.0, 0.0, 0.0], 2.0, [-1.0, 0.0, 0.0]);
        // A box turned by a quarter about z, whose second axis is not orthogonal.
        let turned = Collider::Box {
            center: [0.0, 0.0, 1.0],
            half: [3.0, 1.0, 2.0],
            axes: [[0.0, 2.0, 0.0], [-1.0, 7.0, 0.0]],
        };
        assert_out(turned, [0.9, 2.0, 1.0], -0.1, [1.0, 0.0, 0.0]);
        assert_out(turned, [0.0, -2.9, 1.0], -0.1, [0.0, -1.0, 0.0]);
        assert_out(turned, [0.0, 0.0, 2.5], -0.5, [0.0, 0.0, 1.0]);
        assert!(out(turned, [2.0, 0.0, 1.0]).0 > 0.0, "it is outside");
    }

    fn on_ground(x: &[[f32; 4]], d: &mut [[f32; 4]], v: &mut [[f32; 4]]) -> bool {
        let record = [Collider::ground(0.0).record().unwrap()];
        let pass = ColliderPass {
            friction: 0.5,
            h: 0.1,
            time: 0.1,
        };
        on_arrays(x, d, |p| colliders(p, v, &[], &record, pass))
    }

    #[test]
    fn the_push_is_exact_and_friction_is_limited_by_it() {
        let x = [[0.0, 0.5, 0.0, 1.0]; 3];
        let mut d = [
            [0.3, -0.75, 0.4, 0.0],
            [0.3, -1.5, 0.4, 0.0],
            [0.3, 0.0, 0.4, 0.0],
        ];
        let mut v = [[0.0; 4]; 3];
        assert!(on_ground(&x, &mut d, &mut v));
        let expected = [[0.225, -0.5, 0.3], [0.0, -0.5, 0.0], [0.3, 0.0, 0.4]];
        for (d, expected) in d.iter().zip(expected) {
            for k in 0..3 {
                assert!((d[k] - expected[k]).abs() < 1e-7, "{d:?}");
            }
        }
        assert_eq!(v[0][3], 0.0, "all of it was taken");
        assert!((v[1][3] - 0.0).abs() < 1e-6, "as much as slid");
    }

    #[test]
    fn the_friction_of_a_substep_is_limited_by_all_of_its_pushes() {
        // Lifted by 0.4 m it is held by 0.2 m at most, of which the first pass needs 0.05 m: 0.15 m
        // are left, and 0.01 m for the second lift come to them.
        let x = [[0.0, 0.0, 0.0, 1.0]];
        let mut v = [[0.0; 4]];
        let mut d = [[0.03, -0.4, 0.04, 0.0]];
        on_ground(&x, &mut d, &mut v);
        assert_eq!(d[0], [0.0; 4], "it is held");
        for (pull, slips) in [(0.1, 0.0), (0.1, 0.04), (0.1, 0.14)] {
            // Pulls after the first one lift by 0.02 m and nothing.
            let sinks = if slips == 0.0 { -0.02 } else { -1e-9 };
            d[0] = [d[0][0] + pull, sinks, 0.0, 0.0];
            on_ground(&x, &mut d, &mut v);
            assert!((d[0][0] - slips).abs() < 1e-6, "{d:?}, {slips} m are right");
        }
    }

    #[test]
    fn a_pinned_vertex_may_be_inside() {
        let mut d = [[0.0, -1.0, 0.0, 0.0]];
        assert!(!on_ground(&[[0.0; 4]], &mut d, &mut [[0.0; 4]]));
        assert_eq!(d[0][1], -1.0);
    }

    #[test]
    fn a_moving_floor_lifts_and_drags() {
        let floor = |y| Collider::Plane {
            point: [y, y, 0.0],
            normal: [0.0, 1.0, 0.0],
        };
        let moving = MovingCollider::between(&floor(0.0), &floor(0.8), 1.0);
        assert_eq!(
            (moving.start, moving.velocity),
            (floor(0.0), [0.8, 0.8, 0.0])
        );
        let record = [moving.record().unwrap()];
        let x = [[0.0, 0.0, 0.0, 1.0]];
        for (time, height) in [(0.25, 0.2), (1.0, 0.8)] {
            let (mut d, mut v) = ([[0.0; 4]], [[0.0; 4]]);
            let pass = ColliderPass {
                friction: 10.0,
                h: 0.25,
                time,
            };
            on_arrays(&x, &mut d, |p| {
                colliders(p, &mut v, &[], &record, pass);
            });
            assert!((d[0][1] - height).abs() < 1e-6, "{d:?} after {time} s");
            assert!((d[0][0] - 0.2).abs() < 1e-6, "{d:?} moves with the floor");
        }
    }

    #[test]
    fn invalid_shapes_are_refused() {
        let none = [
            Collider::Plane {
                point: [0.0; 3],
                normal: [0.0; 3],
            },
            Collider::Sphere {
                center: [f32::NAN, 0.0, 0.0],
                radius: 1.0,
            },
            Collider::Capsule {
                ends: [[0.0; 3]; 2],
                radius: -1.0,
            },
            Collider::Box {
                center: [0.0; 3],
                half: [1.0; 3],
                axes: [[1.0, 0.0, 0.0]; 2],
            },
        ];
        for collider in none {
            assert_eq!(collider.record(), None, "{collider:?}");
        }
    }
}
