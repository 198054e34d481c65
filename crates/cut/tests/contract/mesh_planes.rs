//! Progressive strokes exactly in planes of mesh edges and through vertices.

use crate::common::{check, params};
use incise_cut::{Cutter, Incision};
use incise_mesh::{Surface, icosphere};
use std::collections::BTreeMap;
use std::f32::consts::{FRAC_PI_2, TAU};

/// Strokes through each plane in one run of a test.
const STROKES: u8 = 12;

/// Returns a cuboid around the origin with a grid of vertices on each face.
fn cuboid(cells: [u16; 3], size: [f32; 3]) -> Surface {
    let mut ids = BTreeMap::new();
    let mut positions = Vec::new();
    let mut faces = Vec::new();
    for axis in 0..3 {
        let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
        for side in [0, cells[axis]] {
            let cells_of_side = (0..cells[u]).flat_map(|i| (0..cells[v]).map(move |j| (i, j)));
            for (i, j) in cells_of_side {
                let mut id = |a: u16, b: u16| {
                    let mut cell = [0; 3];
                    (cell[axis], cell[u], cell[v]) = (side, i + a, j + b);
                    *ids.entry(cell).or_insert_with(|| {
                        let part = |k: usize| f32::from(cell[k]) / f32::from(cells[k]) - 0.5;
                        positions.push([0, 1, 2].map(|k| size[k] * part(k)));
                        u32::try_from(positions.len() - 1).unwrap()
                    })
                };
                let [a, b, c, d] = [id(0, 0), id(1, 0), id(1, 1), id(0, 1)];
                faces.extend(if side == 0 {
                    [[a, c, b], [a, d, c]]
                } else {
                    [[a, b, c], [a, c, d]]
                });
            }
        }
    }
    Surface::from_triangles(&positions, &faces).unwrap()
}

/// Returns a sphere of rings around the y axis, with a vertex at each pole.
fn uv_sphere(meridians: u16, parallels: u16, radius: f32) -> Surface {
    let mut positions = vec![[0.0, radius, 0.0]];
    // Exactly zero in the planes of symmetry.
    let exact = |x: f32| if x.abs() < 1e-6 { 0.0 } else { x };
    for i in 1..parallels {
        let polar = TAU / 2.0 * f32::from(i) / f32::from(parallels);
        for j in 0..meridians {
            let (sin, cos) = (TAU * f32::from(j) / f32::from(meridians)).sin_cos();
            positions.push([
                radius * polar.sin() * exact(cos),
                radius * exact(polar.cos()),
                radius * polar.sin() * exact(sin),
            ]);
        }
    }
    positions.push([0.0, -radius, 0.0]);
    let last = u32::try_from(positions.len() - 1).unwrap();
    let id = |i: u16, j: u16| match i {
        0 => 0,
        _ if i == parallels => last,
        _ => u32::from(1 + (i - 1) * meridians + j % meridians),
    };
    let mut faces = Vec::new();
    for (i, j) in (0..parallels).flat_map(|i| (0..meridians).map(move |j| (i, j))) {
        let [a, b, c, d] = [id(i, j), id(i, j + 1), id(i + 1, j + 1), id(i + 1, j)];
        if i > 0 {
            faces.push([a, b, c]);
        }
        if i + 1 < parallels {
            faces.push([a, c, d]);
        }
    }
    Surface::from_triangles(&positions, &faces).unwrap()
}

/// A stroke of a long blade in the plane of all points with one coordinate.
#[derive(Debug, Clone, Copy)]
struct Stroke {
    axis: usize,
    plane: f32,
    angle: f32,
    steps: u16,
    snap: f64,
}

impl Stroke {
    fn pose(&self, step: u16) -> [[f32; 3]; 2] {
        let s = -1.2 + 2.4 * f32::from(step) / f32::from(self.steps);
        let (sin, cos) = self.angle.sin_cos();
        [-1.5, 1.5].map(|end: f32| {
            let mut p = [0.0; 3];
            p[self.axis] = self.plane;
            p[(self.axis + 1) % 3] = s * cos - end * sin;
            p[(self.axis + 2) % 3] = s * sin + end * cos;
            p
        })
    }

    /// Asserts that the stroke opens a convex body as one disc, and at last cuts it in two.
    fn run(&self, whole: &Surface) {
        let mut body = whole.clone();
        let mut cutter = Cutter::new(&body);
        let mut incision = Incision::default();
        for step in 0..=self.steps {
            let pose = self.pose(step);
            let outcome = cutter.advance(&mut body, &mut incision, &pose, &params(self.snap));
            let _ = outcome.unwrap_or_else(|error| panic!("{self:?}, step {step}: {error}"));
            let pieces = i64::try_from(body.piece_count()).unwrap();
            assert_eq!(check(&body), 2 * pieces, "{self:?}, step {step}");
        }
        assert!(!incision.is_inside(), "{self:?}: the blade is out");
        assert_eq!(body.piece_count(), 2, "{self:?}");
        let error = (body.volume() / whole.volume() - 1.0).abs();
        let bound = if self.snap == 0.0 { 1e-5 } else { 2e-3 };
        assert!(error < bound, "{self:?}: the volume changes by {error}");
    }
}

/// Cuts a convex body by strokes from all sides in planes perpendicular to an axis.
///
/// Every other stroke is along an axis, and so in line with mesh edges.
fn cut_in_planes(whole: &Surface, axis: usize, planes: &[f32]) {
    let mut seed = 1 + axis as u64;
    let mut random = move || {
        seed = seed
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        u16::try_from(seed >> 48).unwrap()
    };
    for n in 0..STROKES {
        let steps = 5 + random() % 56;
        let angle = if n.is_multiple_of(2) {
            FRAC_PI_2 * f32::from(random() % 4)
        } else {
            TAU * f32::from(random()) / 65_536.0
        };
        let stroke = Stroke {
            axis,
            plane: planes[usize::from(n) % planes.len()],
            angle,
            steps,
            snap: if n % 4 < 2 { 0.0 } else { 0.1 },
        };
        stroke.run(whole);
    }
}

#[test]
fn strokes_along_the_grid_of_a_cuboid() {
    let whole = cuboid([8, 4, 6], [1.0, 0.5, 0.75]);
    assert_eq!(check(&whole), 2);
    let planes = [
        [-0.375, 0.0, 0.25],
        [-0.125, 0.0, 0.125],
        [-0.25, 0.0, 0.125],
    ];
    for (axis, planes) in planes.iter().enumerate() {
        cut_in_planes(&whole, axis, planes);
    }
}

#[test]
fn strokes_in_the_planes_of_symmetry_of_spheres() {
    for whole in [icosphere(3, 0.5), uv_sphere(16, 8, 0.5)] {
        assert_eq!(check(&whole), 2);
        (0..3).for_each(|axis| cut_in_planes(&whole, axis, &[0.0]));
    }
}

/// The slit's end and the node beside it were in line with a vertex, and rounding folded the
/// sliver between them.
#[test]
fn a_slit_that_ends_in_line_with_a_vertex_goes_on() {
    let stroke = Stroke {
        axis: 0,
        plane: 0.0,
        angle: -FRAC_PI_2,
        steps: 53,
        snap: 0.1,
    };
    stroke.run(&icosphere(3, 0.5));
}
