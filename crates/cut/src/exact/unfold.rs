//! The sweep laid flat: its two triangles turned about the crease into one plane.
//!
//! x runs along the crease, the first triangle lies at y <= 0, the second at y >= 0, and the sweep's
//! normal points to who sees x turn into y counterclockwise.

use super::node::{Node, On};
use super::signs::Signs;
use incise_mesh::Vec3;

/// Coordinates in the sweep.
#[derive(Debug)]
pub(super) struct Unfold {
    origin: Vec3,
    along: Vec3,
    /// By sweep triangle, the direction of y and the unit normal.
    across: [Vec3; 2],
    normals: [Vec3; 2],
    exists: [bool; 2],
}

impl Unfold {
    pub(super) fn new(signs: &Signs) -> Self {
        let [origin, end] = signs.crease();
        let along = (end - origin).normalize();
        let normals = [0, 1].map(|i| signs.normal(i).normalize());
        Self {
            origin,
            along,
            across: normals.map(|n| n.cross(&along)),
            normals,
            exists: [0, 1].map(|i| signs.exists(i)),
        }
    }

    /// Where a node is in the plane \[m\].
    pub(super) fn flatten(&self, node: &Node) -> [f64; 2] {
        let offset = node.position - self.origin;
        let y = match node.on {
            On::Face { .. } => 0.0,
            On::Edge { plane, .. } => {
                let y = self.across[plane].dot(&offset);
                // Rounding may not carry it over the crease.
                match (self.exists, plane) {
                    ([true, true], 0) => y.min(0.0),
                    ([true, true], _) => y.max(0.0),
                    _ => y,
                }
            }
        };
        [self.along.dot(&offset), y]
    }

    /// Where a point of the plane is in space, and the sweep's normal there.
    pub(super) fn lift(&self, [x, y]: [f64; 2]) -> (Vec3, Vec3) {
        let i = match self.exists {
            [true, true] => usize::from(y > 0.0),
            [first, _] => usize::from(!first),
        };
        let point = self.origin + self.along * x + self.across[i] * y;
        (point, self.normals[i])
    }
}
