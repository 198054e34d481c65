//! Coordinates in the planes of the facets, and of the whole sweep laid flat.
//!
//! The two facets beside a diagonal have a common origin and x-axis, its start and its direction.
//! Seen against the normal, the axes are counterclockwise. To lay the sweep flat, the facets are
//! rotated about their common edges into one plane, which gives continuous texture coordinates.

use crate::intersection::facets::Facets;
use crate::intersection::trace::{Curve, Trace};
use incise_mesh::Vec3;

/// Coordinates of all facets.
#[derive(Debug, Clone, Default)]
pub(crate) struct Frames {
    frames: Vec<Frame>,
}

#[derive(Debug, Clone, Copy)]
struct Frame {
    origin: Vec3,
    along: Vec3,
    across: Vec3,
    normal: Vec3,
    /// Cosine and sine of the rotation and the displacement that lay the facet flat.
    rotation: [f64; 2],
    shift: [f64; 2],
}

impl Frame {
    fn local(&self, p: Vec3) -> [f64; 2] {
        let offset = p - self.origin;
        [self.along.dot(&offset), self.across.dot(&offset)]
    }

    fn flat(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let ([cos, sin], [dx, dy]) = (self.rotation, self.shift);
        [cos * x - sin * y + dx, sin * x + cos * y + dy]
    }
}

impl Frames {
    pub(super) fn read(&mut self, facets: &Facets) {
        self.frames.clear();
        for i in 0..facets.len() {
            // The first facet has the diagonal's end as its last corner, the second as the middle.
            let corners = facets.corners_of(i);
            let (origin, end) = (corners[0], corners[if i % 2 == 0 { 2 } else { 1 }]);
            let along = (end - origin).try_normalize(0.0).unwrap_or_default();
            let normal = (facets.normal(i).try_normalize(0.0)).unwrap_or_default();
            let (rotation, shift) = match i {
                0 | 1 => ([1.0, 0.0], [0.0; 2]),
                _ if i % 2 == 1 => {
                    let first = self.frames[i as usize - 1];
                    (first.rotation, first.shift)
                }
                _ => ([1.0, 0.0], [0.0; 2]),
            };
            self.frames.push(Frame {
                origin,
                along,
                across: normal.cross(&along),
                normal,
                rotation,
                shift,
            });
        }
        for first in (2..self.frames.len()).step_by(2) {
            self.attach(facets, first);
        }
    }

    /// Lays the facets `first` and `first` + 1 flat beside the two before them.
    fn attach(&mut self, facets: &Facets, first: usize) {
        // The common edge runs from the origin of both to the last corner of the second.
        let [start, _, end] = facets.corners_of(incise_mesh::index_u32(first + 1));
        let before = self.frames[first - 2];
        let [from, to] = [start, end].map(|p| before.flat(before.local(p)));
        let [own_from, own_to] = [start, end].map(|p| self.frames[first + 1].local(p));
        let (u, v) = (minus(to, from), minus(own_to, own_from));
        let [cos, sin] = [v[0] * u[0] + v[1] * u[1], v[0] * u[1] - v[1] * u[0]];
        let length = cos.hypot(sin);
        let rotation = if length > 0.0 {
            [cos / length, sin / length]
        } else {
            before.rotation
        };
        for frame in &mut self.frames[first..first + 2] {
            frame.rotation = rotation;
            frame.shift = [0.0; 2];
            frame.shift = minus(from, frame.flat(own_from));
        }
    }

    /// Returns the coordinates of a point in the plane of a facet \[m\].
    pub(super) fn local(&self, facet: u32, p: Vec3) -> [f64; 2] {
        self.frames[facet as usize].local(p)
    }

    /// Returns the coordinates in the sweep laid flat of a point of a facet's plane \[m\].
    pub(super) fn flat(&self, facet: u32, local: [f64; 2]) -> [f64; 2] {
        self.frames[facet as usize].flat(local)
    }

    /// Returns the position of a point of a facet's plane \[m\].
    pub(super) fn lift(&self, facet: u32, [x, y]: [f64; 2]) -> Vec3 {
        let frame = &self.frames[facet as usize];
        frame.origin + frame.along * x + frame.across * y
    }

    /// Returns the unit normal of a facet.
    pub(super) fn normal(&self, facet: u32) -> Vec3 {
        self.frames[facet as usize].normal
    }

    /// Returns the point of the sweep at coordinates of the sweep laid flat \[m\], and the unit
    /// normal there; none beside the sweep.
    pub(super) fn unfold(&self, facets: &Facets, [x, y]: [f64; 2]) -> Option<(Vec3, Vec3)> {
        (0..facets.len())
            .filter(|&i| facets.exists(i))
            .find_map(|i| {
                let frame = &self.frames[i as usize];
                let ([cos, sin], [x, y]) = (frame.rotation, minus([x, y], frame.shift));
                let point = self.lift(i, [cos * x + sin * y, cos * y - sin * x]);
                let is_inside = (0..3).all(|k| facets.outside(i, k, point) <= 0.0);
                is_inside.then_some((point, frame.normal))
            })
    }

    /// Iterates over the edges of a curve in the sweep laid flat \[m\].
    ///
    /// An open curve is closed by the straight line between its ends.
    pub(super) fn flat_edges<'a>(
        &'a self,
        trace: &'a Trace,
        curve: &Curve,
    ) -> impl Iterator<Item = [[f64; 2]; 2]> + Clone + 'a {
        let nodes = &trace.nodes[curve.nodes.start as usize..curve.nodes.end as usize];
        let outline = nodes.iter().enumerate().map(move |(i, node)| {
            // The curve ends in the facet that it was in.
            let facet = if node.is_end && i > 0 {
                nodes[i - 1].facet
            } else {
                node.facet
            };
            self.flat(facet, self.local(facet, node.position))
        });
        let following = outline.clone().cycle().skip(1);
        outline.zip(following).map(|(a, b)| [a, b])
    }

    /// Returns the radius of a disc with the same ratio of area to circumference as the section
    /// inside the capped curves, without holes \[m\].
    ///
    /// NaN if the section is a point, infinite without capped curves.
    pub(super) fn section_width(&self, trace: &Trace) -> f64 {
        let (mut doubled, mut length) = (0.0, 0.0);
        for curve in trace.curves.iter().filter(|curve| curve.is_capped) {
            for [[ax, ay], [bx, by]] in self.flat_edges(trace, curve) {
                doubled += ax * by - ay * bx;
                length += (bx - ax).hypot(by - ay);
            }
        }
        let has_section = trace.curves.iter().any(|curve| curve.is_capped);
        if has_section {
            f64::abs(doubled) / length
        } else {
            f64::INFINITY
        }
    }
}

fn minus(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}
