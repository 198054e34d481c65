//! Narrow phase: which edges of a triangle does the sweep cross, decided by exact signs.
//!
//! An edge crosses the sweep when it passes through one of its two triangles (not both: then its
//! ends are on the same side of a bent sweep). Each edge is always tested from its smaller to its
//! larger vertex, so its two triangles agree. A vertex exactly on a sweep triangle's plane counts
//! as above it. Where an edge passes exactly through the diagonal, or ends on it, neither triangle
//! alone can tell: there the two planes are seen together as a roof or a valley, and the edge
//! crosses when its ends are on different sides of that. So no crossing is lost or counted twice.

use crate::error::CutError;
use crate::sweep::Sweep;
use incise_mesh::geometry::round;
use incise_mesh::{HalfEdge, Surface, TriangleId, Vec3};
use robust::{Coord3D, orient3d};

/// A triangle that the sweep crosses: in through one edge, out through another. `entry` and `exit`
/// are half-edges of the triangle; `entry` runs from the negative to the positive side, `exit` back.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Hit {
    pub(crate) triangle: TriangleId,
    pub(crate) entry: HalfEdge,
    pub(crate) exit: HalfEdge,
}

/// The sweep, prepared for signs.
#[derive(Debug)]
pub(crate) struct Signs {
    corners: [Coord3D<f64>; 4],
    triangles: [[Vec3; 3]; 2],
    normals: [Vec3; 2],
    /// Whether each of the two triangles has an area.
    exists: [bool; 2],
    /// Whether the second triangle rises above the first one's plane.
    is_valley: bool,
}

/// How an edge crosses, from its smaller to its larger vertex.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Crossing {
    /// Whether the larger vertex is on the positive side.
    pub(crate) rises: bool,
    /// Where: 0 at the smaller vertex, 1 at the larger.
    pub(crate) t: f64,
}

impl Signs {
    pub(crate) fn new(sweep: &Sweep) -> Self {
        let triangles = sweep.triangles();
        let normals = triangles.map(|[a, b, c]| (b - a).cross(&(c - a)));
        let corners = sweep.corners().map(|[x, y, z]| Coord3D {
            x: f64::from(x),
            y: f64::from(y),
            z: f64::from(z),
        });
        let [s0, s1, s2, s3] = corners;
        Self {
            corners,
            is_valley: orient3d(s0, s1, s2, s3) < 0.0,
            exists: normals.map(|n| n.norm() > 0.0),
            normals,
            triangles,
        }
    }

    /// How the triangle is hit, if it is.
    ///
    /// # Errors
    /// [`CutError`] when the sweep ends in the triangle, passes one of its vertices on both sides,
    /// or a vertex is not finite.
    pub(crate) fn hit(
        &self,
        surface: &Surface,
        triangle: TriangleId,
    ) -> Result<Option<Hit>, CutError> {
        let topology = surface.topology();
        for v in topology.triangle(triangle) {
            if !surface.positions[v.index()][..3]
                .iter()
                .all(|x| x.is_finite())
            {
                return Err(CutError::VertexNotFinite { vertex: v });
            }
        }
        let mut entry = HalfEdge::NULL;
        let mut exit = HalfEdge::NULL;
        let mut crossed = 0;
        for h in triangle.half_edges() {
            let Some(crossing) = self.crossing(surface, h) else {
                continue;
            };
            crossed += 1;
            let runs_up = topology.origin(h) < topology.target(h);
            if crossing.rises == runs_up {
                entry = h;
            } else {
                exit = h;
            }
        }
        match crossed {
            0 => Ok(None),
            2 if !entry.is_null() && !exit.is_null() => Ok(Some(Hit {
                triangle,
                entry,
                exit,
            })),
            2 => {
                let h = if entry.is_null() { exit } else { entry };
                Err(CutError::SideConflict {
                    vertex: topology.origin(h),
                })
            }
            _ => Err(CutError::PartialCut { triangle }),
        }
    }

    /// Where the edge of `h` crosses the sweep, if it does.
    pub(crate) fn crossing(&self, surface: &Surface, h: HalfEdge) -> Option<Crossing> {
        let (a, b) = (surface.topology().origin(h), surface.topology().target(h));
        let (low, high) = if a < b { (a, b) } else { (b, a) };
        let (p, q) = (surface.position(low), surface.position(high));
        let (rises, i) = self.passes(coord(p), coord(q))?;
        let height = |x: Vec3| self.normals[i].dot(&(x - self.triangles[i][0]));
        let (from, to) = (height(p), height(q));
        let t = from / (from - to);
        let t = if t.is_finite() {
            t.clamp(0.0, 1.0)
        } else {
            0.5
        };
        Some(Crossing { rises, t })
    }

    /// Whether the segment from `p` to `q` passes the sweep, and if so whether it rises and through
    /// which triangle's plane.
    fn passes(&self, p: Coord3D<f64>, q: Coord3D<f64>) -> Option<(bool, usize)> {
        let [s0, s1, s2, s3] = self.corners;
        let planes = [[s0, s1, s2], [s0, s2, s3]];
        // `orient3d` is negative for a point on the side to which the triangle's normal points.
        let above = |i: usize, x| {
            let [a, b, c] = planes[i];
            orient3d(a, b, c, x) <= 0.0
        };
        let [from, to] = [p, q].map(|x| [0, 1].map(|i| self.exists[i] && above(i, x)));
        let [first, second] = [0, 1].map(|i| from[i] != to[i]);
        if !first && !second {
            return None;
        }
        // Positive where the segment passes on the inner side of the sweep's edge from `x` to `y`.
        let side = |rises: bool, x, y| {
            let sign = orient3d(p, q, x, y);
            if rises { -sign } else { sign }
        };
        let in_first = |rises| side(rises, s0, s1) >= 0.0 && side(rises, s1, s2) >= 0.0;
        let in_second = |rises| side(rises, s2, s3) >= 0.0 && side(rises, s3, s0) >= 0.0;
        let diagonal = orient3d(p, q, s0, s2);
        if diagonal == 0.0 && self.exists == [true; 2] {
            let is_above = |[a, b]: [bool; 2]| if self.is_valley { a && b } else { a || b };
            let rises = is_above(to);
            let crosses = is_above(from) != rises && (in_first(rises) || in_second(rises));
            return crosses.then_some((rises, usize::from(!first)));
        }
        // The diagonal is measured once for both triangles, so that they agree.
        let beyond = |rises: bool| if rises { -diagonal } else { diagonal };
        let through_first = first && beyond(to[0]) <= 0.0 && in_first(to[0]);
        let through_second = second && beyond(to[1]) >= 0.0 && in_second(to[1]);
        // Through both, the edge is on the same side again.
        match (through_first, through_second) {
            (true, false) => Some((to[0], 0)),
            (false, true) => Some((to[1], 1)),
            _ => None,
        }
    }
}

fn coord(p: Vec3) -> Coord3D<f64> {
    Coord3D {
        x: p.x,
        y: p.y,
        z: p.z,
    }
}

/// The point at `t` from `a` to `b`, with the `t` that storage keeps.
pub(crate) fn point_between(a: Vec3, b: Vec3, t: f32) -> Vec3 {
    a + (b - a) * f64::from(t)
}

/// `t` as storage keeps it.
pub(crate) fn round_t(t: f64) -> f32 {
    round(Vec3::new(t, 0.0, 0.0))[0]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn sweep() -> Sweep {
        // The unit square in the plane z = 0, normal up.
        Sweep::new(
            [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]],
            [[0.0, 1.0, 0.0], [1.0, 1.0, 0.0]],
        )
        .unwrap()
    }

    /// A triangle whose first edge runs through (x, y) from below or from above.
    fn edge(x: f32, y: f32, z0: f32, z1: f32) -> Surface {
        Surface::from_triangles(&[[x, y, z0], [x, y, z1], [9.0, 9.0, z0]], &[[0, 1, 2]]).unwrap()
    }

    fn crossing(x: f32, y: f32, z0: f32, z1: f32) -> Option<Crossing> {
        Signs::new(&sweep()).crossing(&edge(x, y, z0, z1), HalfEdge(0))
    }

    #[test]
    fn an_edge_through_the_square_crosses_once() {
        for (x, y) in [(0.3, 0.6), (0.6, 0.3), (0.5, 0.5), (0.25, 0.25)] {
            let up = crossing(x, y, -1.0, 3.0).unwrap();
            assert!(up.rises && (up.t - 0.25).abs() < 1e-15, "{x} {y} {up:?}");
            let down = crossing(x, y, 3.0, -1.0).unwrap();
            assert!(!down.rises && (down.t - 0.75).abs() < 1e-15);
        }
        for (x, y) in [(-0.1, 0.5), (1.1, 0.5), (0.5, -0.1), (0.5, 1.1)] {
            assert_eq!(crossing(x, y, -1.0, 3.0), None, "beside the square");
        }
        assert_eq!(crossing(0.5, 0.5, 0.0, 1.0), None, "on the plane is above");
        assert!(crossing(0.5, 0.5, -1.0, 0.0).is_some());
    }

    #[test]
    fn a_vertex_on_the_diagonal_of_a_roof_is_above_it_for_all_its_edges() {
        // z = 0 on one side of the diagonal, falling on the other.
        let roof = Sweep::new(
            [[-8.0, -8.0, 0.0], [8.0, -8.0, 0.0]],
            [[-8.0, 8.0, -8.0], [8.0, 8.0, 0.0]],
        )
        .unwrap();
        // On the diagonal, over the falling side but below z = 0, and above everything.
        let corners = [[0.0, 0.0, 0.0], [-2.0, 2.0, -1.0], [0.0, 0.0, 5.0]];
        let surface = Surface::from_triangles(&corners, &[[0, 1, 2]]).unwrap();
        let hit = Signs::new(&roof).hit(&surface, TriangleId(0));
        assert_eq!(hit, Ok(None), "all three are above the roof");
    }

    proptest! {
        /// On a grid many edges run exactly through the diagonal and the corners' lines.
        #[test]
        fn no_crossing_inside_is_lost_or_doubled(x in 1u8..16, y in 1u8..16) {
            let (x, y) = (f32::from(x) / 16.0, f32::from(y) / 16.0);
            prop_assert!(crossing(x, y, -1.0, 1.0).is_some());
            prop_assert!(crossing(x, y, 1.0, -1.0).is_some());
        }

        /// Flat, bent up and bent down; corners on the planes, edges through the diagonal and along
        /// it. On one side or the other of every vertex: a triangle has no crossing or two that turn.
        #[test]
        fn ties_with_a_bent_sweep_agree_around_a_triangle(
            heights in prop::array::uniform4(-2i8..=2),
            corners in prop::array::uniform3(prop::array::uniform3(-3i8..=3)),
        ) {
            let [h0, h1, h2, h3] = heights.map(f32::from);
            let sweep = Sweep::new(
                [[-8.0, -8.0, h0], [8.0, -8.0, h1]],
                [[-8.0, 8.0, h3], [8.0, 8.0, h2]],
            )
            .unwrap();
            let corners = corners.map(|p| p.map(f32::from));
            let surface = Surface::from_triangles(&corners, &[[0, 1, 2]]).unwrap();
            prop_assert!(Signs::new(&sweep).hit(&surface, TriangleId(0)).is_ok());
        }
    }
}
