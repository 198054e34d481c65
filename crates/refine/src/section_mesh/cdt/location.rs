//! Point location in a [`Cdt`] by a visibility walk.

use super::{Cdt, NONE, orient};

/// The element of a triangulation that contains a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Location {
    /// The interior of a triangle.
    Face(u32),
    /// The interior of an edge, named by a half-edge.
    Edge(u32),
    /// A vertex with the same coordinates.
    Vertex(u32),
}

impl Cdt {
    /// Locates `p`, which must lie in the box, by a visibility walk from triangle `start`.
    pub(crate) fn locate(&self, p: [f64; 2], start: u32) -> Location {
        let (mut t, mut from) = (start, NONE);
        // In a constrained triangulation a walk can cycle; then every triangle is tested.
        let limit = 64 + self.region.len();
        'walk: for step in 0u32.. {
            if step as usize > limit {
                break;
            }
            let (mut zeros, mut zero) = (0, NONE);
            let places = self.corner_points(t);
            for i in 0..3 {
                let k = (i + step) % 3;
                let h = 3 * t + k;
                if h == from {
                    continue;
                }
                let side = orient(places[k as usize], places[(k as usize + 1) % 3], p);
                if side < 0.0 {
                    from = self.twin[h as usize];
                    t = from / 3;
                    continue 'walk;
                }
                if side == 0.0 {
                    zeros += 1;
                    zero = h;
                }
            }
            return self.classify(t, zeros, zero, p);
        }
        for t in 0..self.triangles() {
            let sides = [3 * t, 3 * t + 1, 3 * t + 2].map(|h| {
                (
                    orient(self.point(self.start(h)), self.point(self.end(h)), p),
                    h,
                )
            });
            if sides.iter().all(|&(side, _)| side >= 0.0) {
                let zeros = sides.iter().filter(|s| s.0 == 0.0);
                let zero = zeros.clone().next().map_or(NONE, |s| s.1);
                return self.classify(t, zeros.count(), zero, p);
            }
        }
        Location::Face(start)
    }

    /// Classifies `p` in triangle `t`, given how many sides it lies on and one of them.
    fn classify(&self, t: u32, zeros: usize, zero: u32, p: [f64; 2]) -> Location {
        match zeros {
            0 => Location::Face(t),
            1 => Location::Edge(zero),
            _ => self
                .corners(t)
                .into_iter()
                .find(|&v| self.point(v) == p)
                .map_or(Location::Edge(zero), Location::Vertex),
        }
    }
}
