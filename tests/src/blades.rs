//! Random sweeps, including degenerate ones.

use incise_cut::{CutError, Sweep};
use incise_mesh::geometry::{Vec3, area_vector, to_f32, to_f64};
use incise_mesh::{Surface, TriangleId, VertexId};
use incise_refine::RefinementLevel;
use proptest::prelude::*;

/// Description of a sweep. Indices of vertices and triangles are taken modulo their number.
#[derive(Debug, Clone, Copy)]
pub enum Blade {
    /// A plane with any normal, at this fraction of the half extent from the center.
    Plane([f64; 3], f64),
    /// A plane perpendicular to an axis, exactly through a vertex.
    AxisThroughVertex(usize, u32),
    /// The plane through three vertices; exact for coordinates on a lattice.
    ThroughVertices([u32; 3]),
    /// A plane along this direction through an edge of a triangle.
    ThroughEdge(u32, usize, [f64; 3]),
    /// The plane of a triangle.
    InFace(u32),
    /// A plane with any normal that touches the outermost vertex.
    Grazing([f64; 3]),
    /// A plane with one corner moved out by this fraction of the body.
    Bent([f64; 3], f64, f64),
    /// A part of a plane; it may end inside the body.
    Short([f64; 3], f64, f64),
}

impl Blade {
    /// Returns the sweep through `surface`.
    ///
    /// # Errors
    /// [`CutError`] if the chosen points span no plane.
    pub fn sweep(&self, surface: &Surface) -> Result<Sweep, CutError> {
        let bounds = surface.bounds();
        let topology = surface.topology();
        let vertices: Vec<VertexId> = topology.vertices().collect();
        let triangles: Vec<TriangleId> = topology.triangles().collect();
        let at = |i: u32| surface.position(vertices[i as usize % vertices.len()]);
        let triangle = |i: u32| surface.triangle_positions(triangles[i as usize % triangles.len()]);
        let plane = |n: Vec3, p: Vec3| Sweep::from_plane(n.into(), n.dot(&p), &bounds);
        let middle = |n: Vec3, part: f64| {
            let size = to_f64(bounds.max) - to_f64(bounds.min);
            let extent = n.abs().dot(&size) / 2.0;
            Sweep::from_plane(n.into(), n.dot(&bounds.center()) + part * extent, &bounds)
        };
        match *self {
            Self::Plane(n, part) => middle(n.into(), part),
            Self::AxisThroughVertex(axis, v) => plane(Vec3::ith(axis % 3, 1.0), at(v)),
            Self::ThroughVertices(vs) => span(surface, vs.map(at)),
            Self::ThroughEdge(t, corner, n) => {
                let corners = triangle(t);
                let (a, b) = (corners[corner % 3], corners[(corner + 1) % 3]);
                span(surface, [a, b, a + Vec3::from(n)])
            }
            Self::InFace(t) => span(surface, triangle(t)),
            Self::Grazing(n) => {
                let n = Vec3::from(n);
                let height = |v: &VertexId| n.dot(&surface.position(*v));
                let top = (vertices.iter())
                    .max_by(|a, b| height(a).total_cmp(&height(b)))
                    .expect("a body has vertices");
                plane(n, surface.position(*top))
            }
            Self::Bent(n, part, bend) => {
                let [a, b, c, d] = square(&middle(n.into(), part)?);
                let out = Vec3::from(n).normalize() * (bend * bounds.diagonal());
                Sweep::new([to_f32(a), to_f32(b)], [to_f32(d + out), to_f32(c)])
            }
            Self::Short(n, part, length) => {
                let [a, b, c, d] = square(&middle(n.into(), part)?);
                let (c, d) = (b + (c - b) * length, a + (d - a) * length);
                Sweep::new([to_f32(a), to_f32(b)], [to_f32(d), to_f32(c)])
            }
        }
    }

    /// Whether it cuts all the way along one plane, so that nothing but a hole in the cross-section
    /// may keep it from cutting.
    #[must_use]
    pub fn is_full_plane(&self) -> bool {
        !matches!(self, Self::Bent(..) | Self::Short(..))
    }
}

/// The square around the circle inside a plane's triangle, one side along the triangle's first,
/// which touches the circle.
fn square(plane: &Sweep) -> [Vec3; 4] {
    let [[a, b], [c, _]] = plane.ends().map(|edge| edge.map(to_f64));
    // An equilateral triangle is three times as high as the circle's radius.
    let side = (b - a).normalize() * ((c - (a + b) / 2.0).norm() / 3.0);
    let up = (c - (a + b) / 2.0) * (2.0 / 3.0);
    let [left, right] = [(a + b) / 2.0 - side, (a + b) / 2.0 + side];
    [left, right, right + up, left + up]
}

/// Maximum number of times that the sides of a triangle are doubled to span a sweep.
const MAX_DOUBLINGS: f64 = 14.0;

/// A sweep in the plane of three points, far over the body on all sides. The corners are sums of
/// whole multiples of the sides, so lattice points give a plane exactly through all three.
fn span(surface: &Surface, points: [Vec3; 3]) -> Result<Sweep, CutError> {
    let [a, b, c] = points;
    let (u, v) = (b - a, c - a);
    let height = area_vector(points).norm() / u.norm().max(v.norm()).max(f64::MIN_POSITIVE);
    let reach = 2.0 * surface.bounds().diagonal();
    // Points in a line span no plane; nearly in a line, its far corners would be mostly rounding.
    let exponent = (reach / height).log2().ceil();
    if exponent.is_nan() || exponent > MAX_DOUBLINGS {
        return Err(CutError::BladeDegenerate);
    }
    let k = exponent.max(1.0).exp2();
    let corner = |s: f64, t: f64| to_f32(a + u * (s * k) + v * (t * k));
    Sweep::new(
        [corner(-1.0, -1.0), corner(1.0, -1.0)],
        [corner(-1.0, 1.0), corner(1.0, 1.0)],
    )
}

fn direction() -> impl Strategy<Value = [f64; 3]> {
    let axis = (0..3_usize).prop_map(|k| Vec3::ith(k, 1.0).into());
    let any = prop::array::uniform3(-1.0..1.0_f64)
        .prop_filter("a direction has a length", |n| Vec3::from(*n).norm() > 0.1);
    prop_oneof![1 => axis, 4 => any]
}

/// Full planes, many of them through vertices, edges or triangles.
pub fn flat_blade() -> impl Strategy<Value = Blade> {
    let index = || 0..100_000_u32;
    prop_oneof![
        4 => (direction(), -0.95..0.95_f64).prop_map(|(n, part)| Blade::Plane(n, part)),
        2 => (0..3_usize, index()).prop_map(|(axis, v)| Blade::AxisThroughVertex(axis, v)),
        1 => prop::array::uniform3(index()).prop_map(Blade::ThroughVertices),
        1 => (index(), 0..3_usize, direction())
            .prop_map(|(t, corner, n)| Blade::ThroughEdge(t, corner, n)),
        1 => index().prop_map(Blade::InFace),
        1 => direction().prop_map(Blade::Grazing),
    ]
}

/// Full planes, bent sweeps and sweeps that end too early.
pub fn any_blade() -> impl Strategy<Value = Blade> {
    let part = -0.9..0.9_f64;
    prop_oneof![
        4 => flat_blade(),
        1 => (direction(), part.clone(), -0.6..0.6_f64)
            .prop_map(|(n, part, bend)| Blade::Bent(n, part, bend)),
        1 => (direction(), part, 0.1..0.9_f64)
            .prop_map(|(n, part, length)| Blade::Short(n, part, length)),
    ]
}

/// The five levels of the paper and any between.
pub fn any_level() -> impl Strategy<Value = RefinementLevel> {
    prop_oneof![
        prop::sample::select(RefinementLevel::FIVE.to_vec()),
        (0.4..3.0_f64).prop_map(RefinementLevel::Z),
    ]
}
