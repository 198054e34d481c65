//! [`PieceMotions`]: the pieces of a body, how pins hold them, and their rigid motions.

use crate::particles::Particles;
use incise_mesh::{Surface, Vec3, VertexId};
use nalgebra::Matrix3;

/// Piece of a vertex that no triangle uses.
const NO_PIECE: u32 = u32::MAX;

/// Maximum distance of pins from a line, relative to the distance of the first two.
const MAX_OFFSET: f64 = 1e-4;

/// The rigid motions that the pins of a piece allow.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
enum Joint {
    #[default]
    Free,
    /// Rotations about a pin.
    Point(VertexId),
    /// Rotations about the line through two pins.
    Axis([VertexId; 2]),
    /// None of its own: the piece moves as its pins, which are off a line.
    Fixed,
}

impl Joint {
    /// Returns the joint with one more pin.
    fn with(self, pin: VertexId, surface: &Surface) -> Self {
        match self {
            Self::Free => Self::Point(pin),
            Self::Point(first) => Self::Axis([first, pin]),
            Self::Axis(ends) => {
                let [from, to] = ends.map(|v| surface.position(v));
                let (along, offset) = (to - from, surface.position(pin) - from);
                let is_on_line = along.cross(&offset).norm() <= MAX_OFFSET * along.norm_squared();
                if is_on_line { self } else { Self::Fixed }
            }
            Self::Fixed => Self::Fixed,
        }
    }

    /// Returns the vertex about which the piece turns.
    fn center(self) -> Option<VertexId> {
        match self {
            Self::Point(pin) | Self::Axis([pin, _]) => Some(pin),
            Self::Free | Self::Fixed => None,
        }
    }
}

/// The pieces of all vertices.
#[derive(Debug, Clone, Default)]
pub(super) struct PieceMotions {
    /// Number of the piece of a vertex, or [`NO_PIECE`], shape [vertex slots].
    vertices: Vec<u32>,
    /// By piece number.
    joints: Vec<Joint>,
    /// The pins of `vertices`.
    pins: Vec<VertexId>,
    is_current: bool,
    /// By piece number.
    motions: Vec<Motion>,
}

/// The rigid motion of a piece in a substep, and the sum of the weights of its vertices.
#[derive(Debug, Clone, Copy, Default)]
struct Motion {
    mass: f64,
    center: Vec3,
    translation: Vec3,
    inertia: Matrix3<f64>,
    /// Angular momentum times time, then the angle of the rotation.
    turn: Vec3,
}

impl Motion {
    /// Returns the angle of the rotation that the joint allows.
    fn angle(&self, joint: Joint, points: &[Vec3]) -> Vec3 {
        let angle = match joint {
            Joint::Free | Joint::Point(_) | Joint::Fixed => {
                (self.inertia.try_inverse()).map(|inverse| inverse * self.turn)
            }
            Joint::Axis(ends) => {
                let [from, to] = ends.map(|v| points[v.index()]);
                let axis = to - from;
                Some(axis * (axis.dot(&self.turn) / axis.dot(&(self.inertia * axis))))
            }
        };
        let is_finite = |angle: &Vec3| angle.iter().all(|c| c.is_finite());
        angle.filter(is_finite).unwrap_or_default()
    }
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
        self.joints.clear();
        let pieces = surface.piece_bound() as usize;
        self.joints.resize(pieces, Joint::default());
        let topology = surface.topology();
        for &pin in &self.pins {
            let h = topology.outgoing(pin);
            if !h.is_null() {
                let joint = &mut self.joints[surface.piece(h.triangle()) as usize];
                *joint = joint.with(pin, surface);
            }
        }
        self.vertices.clear();
        self.vertices.resize(surface.positions().len(), NO_PIECE);
        for t in topology.triangles() {
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
        let piece = self.vertices.get(v);
        let joint = piece.and_then(|&piece| self.joints.get(piece as usize));
        joint.is_none_or(|&joint| joint != Joint::Free)
    }

    /// Returns whether a piece turns about pins.
    pub(super) fn has_pivots(&self) -> bool {
        self.joints.iter().any(|joint| joint.center().is_some())
    }

    /// Computes the rigid part of displacements of vertices at `points` \[m\] of `masses` \[kg\].
    ///
    /// Momentum and angular momentum of a piece without pins are those of its displacements. Pieces
    /// with pins turn about them, those with pins off a line move as these do. With `turns` the
    /// vertices move on circles, by the angle whose tangent the displacements have: that is the
    /// implicit Euler step of a rigid piece. Returns half of the sum of masses times squared
    /// rotations of pieces without pins.
    pub(super) fn find_rigid(
        &mut self,
        (points, masses): (&[Vec3], &[f64]),
        (displacements, turns): (&[Vec3], bool),
        rigid: &mut Vec<Vec3>,
    ) -> f64 {
        let motions = &mut self.motions;
        motions.clear();
        motions.resize(self.joints.len(), Motion::default());
        let joints = &self.joints;
        let vertices = || {
            let of_vertices = self.vertices.iter().zip(points.iter().zip(masses));
            of_vertices
                .zip(displacements)
                .filter(|((piece, _), _)| **piece != NO_PIECE)
                .map(|((&piece, (point, &mass)), by)| {
                    let weight = match joints[piece as usize] {
                        Joint::Fixed if mass == 0.0 => 1.0,
                        Joint::Fixed => 0.0,
                        _ => mass,
                    };
                    (piece, point, weight, by)
                })
        };
        for (piece, point, weight, by) in vertices() {
            let motion = &mut motions[piece as usize];
            motion.mass += weight;
            motion.center += point * weight;
            motion.translation += by * weight;
        }
        for (motion, joint) in motions.iter_mut().zip(&self.joints) {
            if let Some(pin) = joint.center().map(VertexId::index) {
                (motion.center, motion.translation) = (points[pin], displacements[pin]);
            } else if motion.mass > 0.0 {
                motion.center /= motion.mass;
                motion.translation /= motion.mass;
            }
        }
        for (piece, point, weight, by) in vertices() {
            let motion = &mut motions[piece as usize];
            let arm = point - motion.center;
            motion.turn += arm.cross(&(by - motion.translation)) * weight;
            motion.inertia +=
                (Matrix3::identity() * arm.norm_squared() - arm * arm.transpose()) * weight;
        }
        let mut rotation = 0.0;
        for (motion, joint) in motions.iter_mut().zip(&self.joints) {
            let angle = motion.angle(*joint, points);
            if *joint == Joint::Free {
                rotation += angle.dot(&motion.turn) / 2.0;
            }
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
            + size_of::<Joint>() * self.joints.capacity()
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
            vertices: vec![0, 0, 0, 0, NO_PIECE],
            joints: vec![Joint::Free],
            ..PieceMotions::default()
        };
        let mut rigid = Vec::new();
        let body = (&points[..], &masses[..]);
        pieces.find_rigid(body, (&displacements, false), &mut rigid);
        for (found, expected) in rigid.iter().zip(&displacements).take(4) {
            assert!((found - expected).norm() < 1e-12, "{found} {expected}");
        }
        assert_eq!(rigid[4], Vec3::zeros(), "it is in no piece");
        // About a pin at the first point, and about a line through the first and the third.
        let turn = Vec3::new(0.0, 0.2, -0.1);
        let about_first: Vec<Vec3> = points.iter().map(|p| turn.cross(p)).collect();
        let axis = points[2].normalize();
        let ends = [VertexId(0), VertexId(2)];
        for (joint, expected) in [(Joint::Point(ends[0]), turn), (Joint::Axis(ends), axis)] {
            pieces.joints[0] = joint;
            let given: Vec<Vec3> = points.iter().map(|p| expected.cross(p)).collect();
            pieces.find_rigid(body, (&given, false), &mut rigid);
            for (found, given) in rigid.iter().zip(&given).take(4) {
                assert!((found - given).norm() < 1e-12, "{found} {given}");
            }
        }
        pieces.find_rigid(body, (&about_first, false), &mut rigid);
        assert!(rigid[2].norm() < 1e-12, "the axis stays");
        // With pins off a line, as these move.
        pieces.joints[0] = Joint::Fixed;
        let pinned = [0.0, 0.0, 0.0, 3.0, 1.0];
        let mut dragged = displacements.clone();
        dragged[3] = Vec3::zeros();
        pieces.find_rigid((&points, &pinned), (&dragged, false), &mut rigid);
        assert!((rigid[3] - displacements[3]).norm() < 1e-12, "{}", rigid[3]);
        pieces.joints[0] = Joint::Free;
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
