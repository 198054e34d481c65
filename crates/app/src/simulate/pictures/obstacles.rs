//! [`Obstacles`]: the colliders of a scene in its pictures.

use incise_mesh::geometry::{to_f32, to_f64};
use incise_mesh::{Aabb, Surface, TriangleId, Vec3, icosphere};
use incise_pbd_gpu::Collider;
use incise_render::{BodyView, Color, Overlay, OverlayTriangle, RenderError, Renderer};

/// Color of planes, through which bodies are seen.
const PLANE: Color = Color::rgb(96, 104, 112).with_alpha(60);
/// Side of a plane [diagonals of the bodies' box].
const PLANE_SIDE: f64 = 3.0;
/// Color of balls, capsules and boxes.
const SOLID: Color = Color::rgb(178, 182, 188);
/// Subdivisions of a round shape: its silhouette shows no corners in a picture of 1,000 pixels.
const SUBDIVISIONS: u32 = 4;
/// Corners of the sides of a box; the bits of a corner tell its end along each axis.
const BOX_SIDES: [[u32; 4]; 6] = [
    [0, 4, 6, 2],
    [1, 3, 7, 5],
    [0, 1, 5, 4],
    [2, 6, 7, 3],
    [0, 2, 3, 1],
    [4, 5, 7, 6],
];

/// The static colliders of a scene on the GPU: opaque solids and translucent planes.
pub(super) struct Obstacles {
    /// Absent without solids.
    pub(super) solids: Option<BodyView>,
    pub(super) planes: Overlay,
}

impl Obstacles {
    /// Uploads colliders; planes are cut off around the bodies' box.
    pub(super) fn new(
        renderer: &Renderer,
        colliders: &[Collider],
        bounds: &Aabb,
    ) -> Result<Self, RenderError> {
        let (mut points, mut triangles, mut planes) = (Vec::new(), Vec::new(), Vec::new());
        for collider in colliders {
            if let Collider::Plane { point, normal } = *collider {
                let corners = plane_corners(to_f64(point), to_f64(normal), bounds).map(to_f32);
                planes.extend(halves(corners).map(|corners| OverlayTriangle {
                    corners,
                    color: PLANE,
                }));
            } else {
                add_solid(collider, &mut points, &mut triangles);
            }
        }
        let color = |_: TriangleId| Some(SOLID);
        let solids = (!triangles.is_empty()).then(|| {
            let surface = Surface::from_triangles(&points, &triangles);
            let surface = surface.expect("every solid is a closed manifold of its own");
            BodyView::from_surface(renderer, &surface, color)
        });
        Ok(Self {
            solids: solids.transpose()?,
            planes: Overlay::new(renderer, &planes, &[])?,
        })
    }
}

/// Adds the triangles of a ball, a capsule or a box.
fn add_solid(collider: &Collider, points: &mut Vec<[f32; 3]>, triangles: &mut Vec<[u32; 3]>) {
    let first = incise_mesh::index_u32(points.len());
    let mut add = |faces: &[[u32; 3]]| triangles.extend(faces.iter().map(|t| t.map(|v| first + v)));
    match *collider {
        Collider::Plane { .. } => {}
        Collider::Sphere { center, radius } => {
            add(&add_capsule([center; 2], radius, points));
        }
        Collider::Capsule { ends, radius } => add(&add_capsule(ends, radius, points)),
        Collider::Box { center, half, axes } => {
            let x = to_f64(axes[0]).normalize();
            let y = to_f64(axes[1]);
            let y = (y - x * x.dot(&y)).normalize();
            let axes = [x, y, x.cross(&y)];
            points.extend((0..8_u32).map(|corner| {
                let along = |k: usize| {
                    let sign = if corner >> k & 1 == 1 { 1.0 } else { -1.0 };
                    axes[k] * (sign * f64::from(half[k]))
                };
                to_f32(to_f64(center) + along(0) + along(1) + along(2))
            }));
            add(BOX_SIDES.map(halves).as_flattened());
        }
    }
}

/// Adds the points of a ball that is pulled apart to the ends of a segment; returns its triangles.
fn add_capsule(ends: [[f32; 3]; 2], radius: f32, points: &mut Vec<[f32; 3]>) -> Vec<[u32; 3]> {
    let ball = icosphere(SUBDIVISIONS, 1.0);
    let ends = ends.map(to_f64);
    let axis = ends[1] - ends[0];
    points.extend(ball.rest_positions().iter().map(|&p| {
        let end = ends[usize::from(to_f64(p).dot(&axis) > 0.0)];
        to_f32(end + to_f64(p) * f64::from(radius))
    }));
    let topology = ball.topology();
    let triangles = topology.triangles();
    triangles
        .map(|t| topology.triangle(t).map(|v| v.0))
        .collect()
}

/// Returns the corners of a square of the plane, around the point closest to the middle of a box.
fn plane_corners(point: Vec3, normal: Vec3, bounds: &Aabb) -> [Vec3; 4] {
    let normal = normal.normalize();
    let center = bounds.center();
    let middle = center + normal * normal.dot(&(point - center));
    let mut axis = Vec3::zeros();
    axis[normal.iamin()] = 1.0;
    let u = normal.cross(&axis).normalize();
    let half = PLANE_SIDE / 2.0 * bounds.diagonal();
    let (u, v) = (u * half, normal.cross(&u) * half);
    [
        middle - u - v,
        middle + u - v,
        middle + u + v,
        middle - u + v,
    ]
}

/// Returns the two triangles of a quadrilateral.
fn halves<T: Copy>([a, b, c, d]: [T; 4]) -> [[T; 3]; 2] {
    [[a, b, c], [a, c, d]]
}
