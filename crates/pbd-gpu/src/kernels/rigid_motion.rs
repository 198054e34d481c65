//! The rigid motion of a piece: mass, center, velocity, angular momentum and angular velocity.
//!
//! Vertices are summed in [`CHUNK`] columns, then in a tree. The fixed order makes the sums equal
//! on any number of threads and on any GPU. Positions are relative to the first vertex of a piece,
//! which keeps their precision far from the origin.
//!
//! All pins of a piece together weigh [`PIN_WEIGHT`] times its other vertices: a rigid motion is
//! one that the pins allow, such as the swing of a pendulum.

use super::volume::{CHUNK, tree};
use incise_mesh::VertexId;

/// Regularization of the inertia tensor, relative to its trace.
///
/// A straight rod has no moment of inertia about its axis. Sums of 32-bit numbers leave about this
/// error, eight roundings, of the largest moment.
pub(crate) const MIN_INERTIA: f32 = 1e-6;

/// Weight of all pins of a piece, relative to its mass.
///
/// Its inverse is the share of a motion against the pins that counts as rigid. Much more would cost
/// digits of the center of mass.
pub(crate) const PIN_WEIGHT: f32 = 30.0;

/// A vector of three components.
type Vector = [f32; 3];

/// The rigid motion of a piece at one time.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct RigidMotion {
    /// Mass and weights of pins \[kg\].
    pub(crate) mass: f32,
    /// Position of the first vertex \[m\].
    pub(crate) origin: Vector,
    /// Center of mass, relative to the origin \[m\].
    pub(crate) center: Vector,
    /// Velocity of the center [m/s].
    pub(crate) velocity: Vector,
    /// Angular momentum about the center [kg m^2/s].
    pub(crate) angular_momentum: Vector,
    /// Number of its pins.
    pub(crate) pin_count: f32,
    /// Kinetic energy of all vertices \[J\].
    pub(crate) kinetic_energy: f32,
    /// Moments of inertia xx, yy and zz, products xy, yz and zx with their signs [kg m^2].
    inertia: [f32; 6],
}

/// Sums over the vertices of a piece: mass and mass times position, momentum and twice the kinetic
/// energy, angular momentum, second moments xx, yy and zz, then xy, yz and zx.
type Sums = [f32; 17];

impl RigidMotion {
    /// Measures a piece of a body with or without pins.
    ///
    /// The fourth component of positions is the inverse mass, 0 for a pin.
    #[inline(always)]
    pub(crate) fn from_vertices(
        positions: &[[f32; 4]],
        velocities: &[[f32; 4]],
        vertices: &[VertexId],
        has_pins: bool,
    ) -> Self {
        let Some(first) = vertices.first() else {
            return Self::default();
        };
        let [ox, oy, oz, _] = positions[first.index()];
        let origin = [ox, oy, oz];
        let of = |weight: fn(f32) -> f32| {
            let terms = |v: &VertexId| {
                let v = v.index();
                terms(positions[v], velocities[v], origin, weight(positions[v][3]))
            };
            let mut columns = [[0.0; CHUNK]; 17];
            for chunk in vertices.chunks(CHUNK) {
                for (i, terms) in chunk.iter().map(terms).enumerate() {
                    for (column, term) in columns.iter_mut().zip(terms) {
                        column[i] += term;
                    }
                }
            }
            tree(&mut columns, vertices.len().min(CHUNK), |a, b| a + b)
        };
        let mut sums = of(|w| if w > 0.0 { 1.0 / w } else { 0.0 });
        let mut pins = 0.0;
        if has_pins {
            let of_pins = of(|w| if w > 0.0 { 0.0 } else { 1.0 });
            pins = of_pins[0];
            if pins > 0.0 {
                let weight = PIN_WEIGHT * sums[0] / pins;
                for (sum, of_pins) in sums.iter_mut().zip(of_pins) {
                    *sum += weight * of_pins;
                }
            }
        }
        Self {
            pin_count: pins,
            ..Self::from_sums(origin, sums)
        }
    }

    #[inline(always)]
    fn from_sums(origin: Vector, sums: Sums) -> Self {
        let [
            mass,
            sx,
            sy,
            sz,
            px,
            py,
            pz,
            square,
            hx,
            hy,
            hz,
            xx,
            yy,
            zz,
            xy,
            yz,
            zx,
        ] = sums;
        if mass == 0.0 {
            return Self {
                origin,
                ..Self::default()
            };
        }
        let [cx, cy, cz] = [sx / mass, sy / mass, sz / mass];
        let velocity = [px / mass, py / mass, pz / mass];
        let of_center = cross([sx, sy, sz], velocity);
        let (xx, yy, zz) = (xx - cx * sx, yy - cy * sy, zz - cz * sz);
        Self {
            mass,
            origin,
            center: [cx, cy, cz],
            velocity,
            angular_momentum: [hx - of_center[0], hy - of_center[1], hz - of_center[2]],
            pin_count: 0.0,
            kinetic_energy: 0.5 * square,
            inertia: [
                yy + zz,
                zz + xx,
                xx + yy,
                cx * sy - xy,
                cy * sz - yz,
                cz * sx - zx,
            ],
        }
    }

    /// Returns the angular velocity of an angular momentum about the center [rad/s].
    #[inline(always)]
    pub(crate) fn angular_velocity(&self, [x, y, z]: Vector) -> Vector {
        let [xx, yy, zz, xy, yz, zx] = self.inertia;
        let least = MIN_INERTIA * (xx + yy + zz);
        let positive = |square: f32| if square > least { square } else { least };
        // Cholesky decomposition.
        let a = positive(xx + least).sqrt();
        if a == 0.0 {
            return [0.0; 3];
        }
        let (b, c) = (xy / a, zx / a);
        let d = positive((yy + least) - b * b).sqrt();
        let e = (yz - c * b) / d;
        let f = positive(((zz + least) - c * c) - e * e).sqrt();
        let x = x / a;
        let y = (y - b * x) / d;
        let z = ((z - c * x) - e * y) / f;
        let z = z / f;
        let y = (y - e * z) / d;
        [((x - b * y) - c * z) / a, y, z]
    }
}

/// Returns the terms of a vertex in the sums, for its weight \[kg\].
#[inline(always)]
fn terms(x: [f32; 4], v: [f32; 4], origin: Vector, mass: f32) -> Sums {
    let [x, y, z] = [0, 1, 2].map(|k: usize| x[k] - origin[k]);
    let (mx, my, mz) = (mass * x, mass * y, mass * z);
    let [vx, vy, vz, _] = v;
    let (px, py, pz) = (mass * vx, mass * vy, mass * vz);
    [
        mass,
        mx,
        my,
        mz,
        px,
        py,
        pz,
        px * vx + py * vy + pz * vz,
        my * vz - mz * vy,
        mz * vx - mx * vz,
        mx * vy - my * vx,
        mx * x,
        my * y,
        mz * z,
        mx * y,
        my * z,
        mz * x,
    ]
}

/// Returns the cross product.
#[inline(always)]
pub(crate) fn cross(a: Vector, b: Vector) -> Vector {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Vertices of a tilted box of 300 masses in rigid motion far from the origin.
    #[test]
    fn a_rigid_motion_is_found() {
        let (velocity, turn) = ([1.0, -2.0, 0.5], [0.7, 1.3, -0.4]);
        let mut random = incise_test_support::random::Random::new(3);
        let mut place =
            || [0, 1, 2].map(|k| 100.0 + (k as f32 + 0.5) * (2.0 * random.fraction() - 1.0));
        let mut positions: Vec<[f32; 4]> = Vec::new();
        for i in 0..300 {
            let [x, y, z] = place();
            positions.push([x, y, z, if i == 7 { 0.0 } else { 1.0 + (i % 5) as f32 }]);
        }
        let about = [100.0, 100.0, 100.0];
        let velocities: Vec<[f32; 4]> = (positions.iter())
            .map(|x| {
                let arm = [0, 1, 2].map(|k: usize| x[k] - about[k]);
                let along = cross(turn, arm);
                [0, 1, 2, 3].map(|k: usize| if k < 3 { velocity[k] + along[k] } else { 0.0 })
            })
            .collect();
        let vertices: Vec<VertexId> = (0..300).map(VertexId).collect();
        let found = RigidMotion::from_vertices(&positions, &velocities, &vertices, false);
        let free = positions.iter().filter(|x| x[3] > 0.0);
        let mass: f64 = free.clone().map(|x| 1.0 / f64::from(x[3])).sum();
        assert!((f64::from(found.mass) / mass - 1.0).abs() < 1e-6);
        let omega = found.angular_velocity(found.angular_momentum);
        let center = [0, 1, 2].map(|k: usize| found.origin[k] + found.center[k] - about[k]);
        let along = cross(turn, center);
        for k in 0..3 {
            assert!((omega[k] - turn[k]).abs() < 1e-5, "{omega:?}");
            let off = found.velocity[k] - (velocity[k] + along[k]);
            assert!(off.abs() < 1e-5, "{:?}", found.velocity);
        }
        let squares = positions
            .iter()
            .zip(&velocities)
            .filter(|(x, _)| x[3] > 0.0);
        let kinetic: f64 = squares
            .map(|(x, v)| {
                let square: f64 = v.iter().map(|&c| f64::from(c).powi(2)).sum();
                square / f64::from(x[3]) / 2.0
            })
            .sum();
        assert!((f64::from(found.kinetic_energy) / kinetic - 1.0).abs() < 1e-6);
    }

    #[test]
    fn rods_and_points_have_finite_turns() {
        let rod: Vec<[f32; 4]> = (0..5).map(|i| [i as f32, 0.0, 0.0, 1.0]).collect();
        let still = vec![[0.0; 4]; 5];
        let vertices: Vec<VertexId> = (0..5).map(VertexId).collect();
        for count in [1, 5] {
            let found = RigidMotion::from_vertices(&rod, &still, &vertices[..count], false);
            let turn = found.angular_velocity([1e-3, 1.0, 2.0]);
            assert!(turn.iter().all(|c| c.is_finite()), "{turn:?}");
        }
    }
}
