//! Unfolds the sweep: rotates its two triangles about the crease into one plane.
//!
//! x runs along the crease. The first triangle lies at y <= 0, the second at y >= 0. Seen against
//! the sweep's normal, the axes are counterclockwise.

use crate::intersection::node::{Node, On};
use crate::intersection::signs::Signs;
use crate::intersection::trace::Trace;
use incise_mesh::Vec3;

/// Coordinates in the plane of the unfolded sweep.
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

    /// Returns the position of a node in the plane \[m\].
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

    /// Returns the area inside the closed curves without holes \[m^2\], and their length \[m\].
    pub(super) fn section_size(&self, trace: &Trace) -> (f64, f64) {
        let (mut doubled, mut length) = (0.0, 0.0);
        for curve in &trace.loops {
            let nodes = &trace.nodes[curve.start as usize..curve.end as usize];
            let outline = || nodes.iter().map(|node| self.flatten(node));
            for ([ax, ay], [bx, by]) in outline().zip(outline().cycle().skip(1)) {
                doubled += ax * by - ay * bx;
                length += (bx - ax).hypot(by - ay);
            }
        }
        (f64::abs(doubled) / 2.0, length)
    }

    /// Returns the position of a point of the plane in space, and the sweep's normal there.
    pub(super) fn lift(&self, [x, y]: [f64; 2]) -> (Vec3, Vec3) {
        let i = match self.exists {
            [true, true] => usize::from(y > 0.0),
            [first, _] => usize::from(!first),
        };
        let point = self.origin + self.along * x + self.across[i] * y;
        (point, self.normals[i])
    }
}
