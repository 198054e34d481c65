//! Quality of triangles, and the distance between two triangulations of a quad.

use super::super::contract::{flatness, swept_volume};
use incise_mesh::geometry::area_vector;
use incise_mesh::{Domain, HalfEdge, Surface, Vec3};

/// Cosine of 30 degrees: the maximum rotation of a triangle, and the dihedral angle of a feature.
const FEATURE: f64 = 0.866_025_403_784_438_6;

/// A corner of the surface: position, rest position and texture coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Point {
    /// Position and rest position \[m\].
    pub(super) at: [Vec3; 2],
    pub(super) uv: [f64; 2],
}

impl Point {
    /// Returns the corner at the origin of `h`.
    pub(super) fn new(surface: &Surface, h: HalfEdge) -> Self {
        let v = surface.topology().origin(h);
        let uv = surface.corner_uvs().get(h.index()).copied();
        Self {
            at: [surface.position(v), surface.rest_position(v)],
            uv: uv.unwrap_or_default().map(f64::from),
        }
    }

    /// Returns whether it is at its rest position.
    pub(super) fn is_at_rest(&self) -> bool {
        self.at[0] == self.at[1]
    }
}

/// Returns whether two corners of a vertex have equal attributes.
pub(super) fn are_alike(surface: &Surface, a: HalfEdge, b: HalfEdge) -> bool {
    let (uvs, normals) = (surface.corner_uvs(), surface.corner_normals());
    uvs.get(a.index()) == uvs.get(b.index())
        && normals.get(a.index()) == normals.get(b.index())
        && (surface.channels().iter())
            .filter(|channel| channel.domain() == Domain::Corner)
            .all(|channel| channel.row(a.index()) == channel.row(b.index()))
}

/// Returns the squared sine of a triangle's smallest angle, 0 to 0.75.
///
/// The smallest angle is between the two longer edges.
pub(super) fn quality([a, b, c]: [Vec3; 3]) -> f64 {
    let [x, y, z] = [b - a, c - b, a - c].map(|edge| edge.norm_squared());
    let longer = (x * y).max(y * z).max(z * x);
    let square = area_vector([a, b, c]).norm_squared() / longer;
    if square.is_finite() { square } else { 0.0 }
}

/// Returns whether the angle between two normals is less than 30 degrees.
pub(super) fn is_smooth(u: Vec3, v: Vec3) -> bool {
    u.dot(&v) >= FEATURE * (u.norm() * v.norm())
}

/// The two triangles on an edge from `a` to `c`, and beyond it `b` and `d`, seen counterclockwise.
#[derive(Debug, Clone, Copy)]
pub(super) struct Quad(pub(super) [Point; 4]);

impl Quad {
    fn layer(&self, layer: usize) -> [Vec3; 4] {
        self.0.map(|p| p.at[layer])
    }

    /// Returns the triangles with the edge from `a` to `c`, and with the one from `b` to `d`.
    fn triangles([a, b, c, d]: [Vec3; 4]) -> [[[Vec3; 3]; 2]; 2] {
        [[[a, c, d], [c, a, b]], [[b, c, d], [d, a, b]]]
    }

    /// Returns the quality of the worse triangle with either edge.
    pub(super) fn qualities(&self, layer: usize) -> [f64; 2] {
        Self::triangles(self.layer(layer))
            .map(|[first, second]| quality(first).min(quality(second)))
    }

    /// Returns the volume between the triangles with either edge \[m^3\].
    pub(super) fn volume(&self) -> f64 {
        let [a, b, c, d] = self.layer(0);
        swept_volume([a, b, c], d).abs()
    }

    /// Returns the maximum displacement of the surface by a flip, also at rest and in the texture
    /// \[m\].
    ///
    /// None if the edge is a feature, a triangle rotates by more than 30 degrees, or the quad is
    /// not convex. Projected along the common normal of the diagonals, old and new triangles cover
    /// the same convex quad. Their distance is 0 on its outline and largest where the diagonals
    /// cross.
    pub(super) fn flip_distance(&self) -> Option<f64> {
        let distance = Self::distance(self.layer(0))?.max(self.texture_distance()?);
        if self.0.iter().all(Point::is_at_rest) {
            return Some(distance);
        }
        Some(distance.max(Self::distance(self.layer(1))?))
    }

    fn distance(points: [Vec3; 4]) -> Option<f64> {
        let [a, b, c, d] = points;
        let [old, new] = Self::triangles(points);
        let old = old.map(flatness);
        let [(first, first_is_flat), (second, second_is_flat)] = old;
        if !first_is_flat && !second_is_flat && !is_smooth(first, second) {
            return None;
        }
        let mut across = (c - a).cross(&(d - b));
        if across.dot(&(first + second)) < 0.0 {
            across = -across;
        }
        for triangle in new.map(area_vector) {
            if triangle.dot(&across) <= 0.0 {
                return None;
            }
            for (was, is_flat) in old {
                if !is_flat && (was.dot(&across) <= 0.0 || !is_smooth(was, triangle)) {
                    return None;
                }
            }
        }
        let distance = ((b - a).dot(&across) / across.norm()).abs();
        distance.is_finite().then_some(distance)
    }

    /// Returns the displacement of the texture where the diagonals cross \[m\]; none if it would be
    /// inverted.
    fn texture_distance(&self) -> Option<f64> {
        let [a, b, c, d] = self.0;
        let sides = [[a, b], [b, c], [c, d], [d, a]];
        let Some(scale) = texture_scale(sides.into_iter()) else {
            return Some(0.0);
        };
        let old = [[a, c, d], [c, a, b]].map(|t| texture_side(t.map(|p| p.uv)));
        let new = [[b, c, d], [d, a, b]].map(|t| texture_side(t.map(|p| p.uv)));
        if !may_follow(old.into_iter(), new.into_iter()) {
            return None;
        }
        let (u, w) = (c.at[0] - a.at[0], d.at[0] - b.at[0]);
        let (across, offset) = (u.cross(&w), b.at[0] - a.at[0]);
        let whole = across.norm_squared();
        let s = offset.cross(&w).dot(&across) / whole;
        let t = offset.cross(&u).dot(&across) / whole;
        let gap = [0, 1].map(|k| {
            let first = a.uv[k] + s * (c.uv[k] - a.uv[k]);
            first - (b.uv[k] + t * (d.uv[k] - b.uv[k]))
        });
        let distance = scale * gap[0].hypot(gap[1]);
        distance.is_finite().then_some(distance)
    }
}

/// Returns the length of a unit of the texture along these edges \[m\]; none without a texture.
pub(super) fn texture_scale(edges: impl Iterator<Item = [Point; 2]>) -> Option<f64> {
    let (mut length, mut chart) = (0.0, 0.0);
    for [a, b] in edges {
        length += (b.at[0] - a.at[0]).norm();
        chart += (b.uv[0] - a.uv[0]).hypot(b.uv[1] - a.uv[1]);
    }
    (chart != 0.0).then(|| length / chart)
}

/// Returns the orientation of a triangle in the texture; 0 if its area is 0 up to rounding.
pub(super) fn texture_side([a, b, c]: [[f64; 2]; 3]) -> i8 {
    let at = |p: [f64; 2]| Vec3::new(p[0], p[1], 0.0);
    match flatness([a, b, c].map(at)) {
        (_, true) => 0,
        (doubled, _) if doubled.z > 0.0 => 1,
        _ => -1,
    }
}

/// Returns whether new triangles of the texture keep the common orientation of the old ones.
pub(super) fn may_follow(
    mut old: impl Iterator<Item = i8>,
    mut new: impl Iterator<Item = i8>,
) -> bool {
    let mut side = 0;
    old.all(|s| s == 0 || std::mem::replace(&mut side, s) != -s)
        && new.all(|s| s == side || (s == 0 && side == 0))
}
