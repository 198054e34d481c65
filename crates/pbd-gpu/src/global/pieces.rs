//! [`PieceMotions`]: the pieces of a body, those with a pin, and the rigid motions of the others.

use crate::particles::Particles;
use incise_mesh::{Surface, Vec3, VertexId};
use nalgebra::Matrix3;

/// Piece of a vertex whose piece has a pin, or that no triangle uses.
const HELD: u32 = u32::MAX;

/// The pieces of all vertices.
#[derive(Debug, Clone, Default)]
pub(super) struct PieceMotions {
    /// Number of the piece of a vertex, or [`HELD`], shape [vertex slots].
    vertices: Vec<u32>,
    /// By piece number: whether it has a pin.
    has_pin: Vec<bool>,
    /// The pins of `vertices`.
    pins: Vec<VertexId>,
    is_current: bool,
    /// By piece number.
    motions: Vec<Motion>,
}

/// The mass of a piece and its rigid motion in a substep.
#[derive(Debug, Clone, Copy, Default)]
struct Motion {
    mass: f64,
    center: Vec3,
    translation: Vec3,
    inertia: Matrix3<f64>,
    /// Angular momentum times time, then the angle of the rotation.
    turn: Vec3,
}

impl PieceMotions {
    /// Finds the pieces again after an edit or a change of pins. O(triangles) then.
    pub(super) fn update(&mut self, particles: &Particles, surface: &Surface) {
        let pins = particles.pins.iter().map(|pin| pin.vertex);
        if self.is_current && pins.clone().eq(self.pins.iter().copied()) {
            return;
        }
        self.is_current = true;
        self.pins.clear();
        self.pins.extend(pins);
        self.has_pin.clear();
        self.has_pin.resize(surface.piece_bound() as usize, false);
        let topology = surface.topology();
        let piece = |t| surface.piece(t) as usize;
        let first_triangles = self.pins.iter().map(|&pin| topology.outgoing(pin));
        for h in first_triangles.filter(|h| !h.is_null()) {
            self.has_pin[piece(h.triangle())] = true;
        }
        self.vertices.clear();
        self.vertices.resize(surface.positions().len(), HELD);
        for t in topology.triangles().filter(|&t| !self.has_pin[piece(t)]) {
            for v in topology.triangle(t) {
                self.vertices[v.index()] = surface.piece(t);
            }
        }
    }

    /// Marks the pieces as changed by an edit.
    pub(super) fn forget(&mut self) {
        self.is_current = false;
    }

    /// Returns whether there are pins.
    pub(super) fn has_pins(&self) -> bool {
        !self.pins.is_empty()
    }

    /// Returns whether a vertex belongs to a piece with a pin, or to no triangle.
    pub(super) fn is_held(&self, v: usize) -> bool {
        self.vertices.get(v).is_none_or(|&piece| piece == HELD)
    }

    /// Computes the rigid part of displacements of vertices at `points` \[m\] of `masses` \[kg\].
    ///
    /// Momentum and angular momentum of each piece are those of the displacements. Pieces with a
    /// pin have none. With `turns` the vertices move on circles, by the angle whose tangent the
    /// displacements have: that is the implicit Euler step of a rigid piece. Returns half of the
    /// sum of masses times squared rotations.
    pub(super) fn find_rigid(
        &mut self,
        (points, masses): (&[Vec3], &[f64]),
        (displacements, turns): (&[Vec3], bool),
        rigid: &mut Vec<Vec3>,
    ) -> f64 {
        let motions = &mut self.motions;
        motions.clear();
        motions.resize(self.has_pin.len(), Motion::default());
        let vertices = || {
            let of_vertices = self.vertices.iter().zip(points.iter().zip(masses));
            of_vertices
                .zip(displacements)
                .filter(|((piece, _), _)| **piece != HELD)
        };
        for ((&piece, (point, &mass)), by) in vertices() {
            let motion = &mut motions[piece as usize];
            motion.mass += mass;
            motion.center += point * mass;
            motion.translation += by * mass;
        }
        for motion in motions.iter_mut().filter(|motion| motion.mass > 0.0) {
            motion.center /= motion.mass;
            motion.translation /= motion.mass;
        }
        for ((&piece, (point, &mass)), by) in vertices() {
            let motion = &mut motions[piece as usize];
            let arm = point - motion.center;
            motion.turn += arm.cross(&(by - motion.translation)) * mass;
            motion.inertia +=
                (Matrix3::identity() * arm.norm_squared() - arm * arm.transpose()) * mass;
        }
        let mut rotation = 0.0;
        for motion in motions.iter_mut() {
            let inverse = motion.inertia.try_inverse();
            let angle = inverse.map_or(Vec3::zeros(), |inverse| inverse * motion.turn);
            rotation += angle.dot(&motion.turn) / 2.0;
            motion.turn = angle;
        }
        rigid.clear();
        let of_vertices = self.vertices.iter().zip(points);
        rigid.extend(of_vertices.map(|(&piece, point)| {
            let Some(motion) = motions.get(piece as usize) else {
                return Vec3::zeros();
            };
            let arm = point - motion.center;
            let along = motion.turn.cross(&arm);
            if !turns {
                return motion.translation + along;
            }
            // Rodrigues' formula with sine and cosine of the arctangent.
            let cosine = (1.0 + motion.turn.norm_squared()).sqrt().recip();
            let inward = motion.turn.cross(&along);
            motion.translation + along * cosine + inward * (cosine * cosine / (1.0 + cosine))
        }));
        rotation
    }

    /// Returns the memory \[bytes\].
    pub(super) fn bytes(&self) -> usize {
        4 * self.vertices.capacity()
            + self.has_pin.capacity()
            + 4 * self.pins.capacity()
            + size_of::<Motion>() * self.motions.capacity()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rigid_part_of_a_screw_is_all_of_it() {
        let points: Vec<Vec3> = (0..5)
            .map(|i| Vec3::new(f64::from(i), f64::from(i * i), f64::from(i % 2)))
            .collect();
        let masses = [1.0, 2.0, 0.5, 3.0, 1.0];
        let screw = |p: &Vec3| Vec3::new(0.3, 0.0, 0.1) + Vec3::new(0.0, 0.2, -0.1).cross(p);
        let displacements: Vec<Vec3> = points.iter().map(screw).collect();
        let mut pieces = PieceMotions {
            vertices: vec![0, 0, 0, 0, HELD],
            has_pin: vec![false],
            ..PieceMotions::default()
        };
        let mut rigid = Vec::new();
        let body = (&points[..], &masses[..]);
        pieces.find_rigid(body, (&displacements, false), &mut rigid);
        for (found, expected) in rigid.iter().zip(&displacements).take(4) {
            assert!((found - expected).norm() < 1e-12, "{found} {expected}");
        }
        assert_eq!(rigid[4], Vec3::zeros(), "it is held");
        // A stretch has no rigid part.
        let stretch: Vec<Vec3> = points.iter().map(|p| p * 0.1).collect();
        pieces.find_rigid(body, (&stretch, false), &mut rigid);
        let momentum: Vec3 = (0..4).map(|i| (stretch[i] - rigid[i]) * masses[i]).sum();
        assert!(momentum.norm() < 1e-12, "{momentum}");
        // Along circles distances stay.
        pieces.find_rigid(body, (&displacements, true), &mut rigid);
        for (i, j) in [(0, 1), (1, 3), (2, 0)] {
            let [before, after] = [Vec3::zeros(), rigid[i] - rigid[j]];
            let [before, after] = [before, after].map(|by| (points[i] - points[j] + by).norm());
            assert!((after - before).abs() < 1e-12, "{before} {after}");
        }
    }
}
