//! [`Projection`]: a triangle seen along an axis, and the scanlines that cross it.

use incise_mesh::Vec3;

/// A place at which a line along an axis crosses a triangle.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Passage {
    /// Coordinate along the line \[m\].
    pub(crate) at: f64,
    /// Whether the line leaves the body there; it enters otherwise.
    pub(crate) leaves: bool,
}

/// The corners of a triangle in lexicographic order.
#[derive(Debug)]
pub(crate) struct Sorted {
    corners: [Vec3; 3],
    /// Whether the corners go around in the triangle's direction.
    is_even: bool,
}

impl Sorted {
    pub(crate) fn new(corners: &[Vec3; 3]) -> Self {
        let mut sorted = *corners;
        let mut is_even = true;
        let is_less = |a: &Vec3, b: &Vec3| {
            a.x < b.x || (a.x == b.x && (a.y < b.y || (a.y == b.y && a.z < b.z)))
        };
        for (a, b) in [(0, 1), (1, 2), (0, 1)] {
            if is_less(&sorted[b], &sorted[a]) {
                sorted.swap(a, b);
                is_even = !is_even;
            }
        }
        Self {
            corners: sorted,
            is_even,
        }
    }
}

/// A triangle seen along an axis.
#[derive(Debug)]
pub(crate) struct Projection<'a> {
    triangle: &'a Sorted,
    /// The other corners from the first one.
    sides: [Vec3; 2],
    determinant: f64,
    axis: usize,
    across: [usize; 2],
}

impl<'a> Projection<'a> {
    pub(crate) fn new(triangle: &'a Sorted, axis: usize, [u, v]: [usize; 2]) -> Self {
        let [a, b, c] = &triangle.corners;
        let sides = [b - a, c - a];
        Self {
            triangle,
            sides,
            determinant: sides[0][u] * sides[1][v] - sides[0][v] * sides[1][u],
            axis,
            across: [u, v],
        }
    }

    /// Returns where a line along the axis crosses the triangle.
    ///
    /// An edge gives both of its triangles the same answer, so that no line slips between them.
    pub(crate) fn crossing(&self, place: [f64; 2]) -> Option<Passage> {
        let [u, v] = self.across;
        let [a, b, c] = &self.triangle.corners;
        let is_left = |a: &Vec3, b: &Vec3| {
            let cross = (b[u] - a[u]) * (place[1] - a[v]) - (b[v] - a[v]) * (place[0] - a[u]);
            cross >= 0.0
        };
        let is_left_of_all = is_left(a, b);
        if is_left(b, c) != is_left_of_all || is_left(a, c) == is_left_of_all {
            return None;
        }
        let [first, second] = &self.sides;
        let (x, y) = (place[0] - a[u], place[1] - a[v]);
        let parts = [
            (x * second[v] - y * second[u]) / self.determinant,
            (first[u] * y - first[v] * x) / self.determinant,
        ];
        let k = self.axis;
        let at = a[k] + parts[0] * first[k] + parts[1] * second[k];
        // Rounding errors of triangles along the line are not bounded otherwise.
        let (low, high) = (a[k].min(b[k]).min(c[k]), a[k].max(b[k]).max(c[k]));
        let at = at.max(low).min(high);
        let leaves = is_left_of_all == self.triangle.is_even;
        (self.determinant != 0.0).then_some(Passage { at, leaves })
    }
}
