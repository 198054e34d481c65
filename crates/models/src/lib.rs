#![doc = include_str!("../README.md")]

mod bodies;
mod decimate;
mod ellipsoid;
mod implicit;
mod polygonize;
mod relax;
mod scene_shapes;
#[cfg(feature = "scenes")]
pub mod scenes;
mod seams;
mod shell;
mod tube;

use implicit::Body;
use incise_mesh::geometry::to_f32;
use incise_mesh::{Surface, Vec3, cube_sphere, icosphere};
pub use scene_shapes::{double_cone, place, pose, sheet};
use shell::Shell;

/// Radius of the sphere models \[m\].
const SPHERE_RADIUS: f64 = 0.5;

/// A model of the paper's Table 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Model {
    /// An icosahedron, flat shaded.
    Sphere20,
    /// An icosahedron, subdivided once, flat shaded.
    Sphere80,
    /// A sphere from a cube of 8 x 8 quads a side.
    Sphere768,
    /// A sitting rabbit.
    Bunny,
    /// A head on eight arms.
    Octopus,
    /// A bent fruit with five blunt ridges.
    Banana,
    /// A standing armadillo with a bumpy back.
    Armadillo,
}

impl Model {
    /// All models, in the order of the table.
    pub const ALL: [Self; 7] = [
        Self::Sphere20,
        Self::Sphere80,
        Self::Sphere768,
        Self::Bunny,
        Self::Octopus,
        Self::Banana,
        Self::Armadillo,
    ];

    /// Returns the name in the table.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Sphere20 => "Sphere20",
            Self::Sphere80 => "Sphere80",
            Self::Sphere768 => "Sphere768",
            Self::Bunny => "Bunny",
            Self::Octopus => "Octopus",
            Self::Banana => "Banana",
            Self::Armadillo => "Armadillo",
        }
    }

    /// Returns the "Number of Triangles" in the table.
    #[must_use]
    pub const fn triangles(self) -> usize {
        match self {
            Self::Sphere20 => 20,
            Self::Sphere80 => 80,
            Self::Sphere768 => 768,
            Self::Bunny => 1500,
            Self::Octopus => 2816,
            Self::Banana => 5592,
            Self::Armadillo => 30_000,
        }
    }

    /// Returns the "Number of Vertices" in the table, which [`Surface::seam_split_vertices`]
    /// counts.
    #[must_use]
    pub const fn vertices(self) -> usize {
        match self {
            Self::Sphere20 => 60,
            Self::Sphere80 => 240,
            Self::Sphere768 => 515,
            Self::Bunny => 752,
            Self::Octopus => 1939,
            Self::Banana => 2894,
            Self::Armadillo => 18_992,
        }
    }

    /// Returns the number of particles: half the triangles plus 2, by Euler's formula for genus 0.
    #[must_use]
    pub const fn particles(self) -> usize {
        self.triangles() / 2 + 2
    }
}

/// Builds a model: one closed piece of genus 0 with the table's triangles and vertices.
///
/// The y axis is up. Spheres have radius 0.5 m around the origin. The bounding boxes of the others
/// are centered there and have a diagonal of 1 m. The bits are the same on every machine, because
/// only IEEE sums, products, quotients and square roots are used.
#[must_use]
pub fn build_model(model: Model) -> Surface {
    let mut surface = match model {
        Model::Sphere20 => icosphere(0, SPHERE_RADIUS),
        Model::Sphere80 => icosphere(1, SPHERE_RADIUS),
        Model::Sphere768 => cube_sphere(8, SPHERE_RADIUS),
        Model::Bunny => sculpt(&bodies::bunny(), bodies::BUNNY_CELL, model.triangles()),
        Model::Octopus => sculpt(&bodies::octopus(), bodies::OCTOPUS_CELL, model.triangles()),
        Model::Banana => sculpt(&bodies::banana(), bodies::BANANA_CELL, model.triangles()),
        Model::Armadillo => sculpt(
            &bodies::armadillo(),
            bodies::ARMADILLO_CELL,
            model.triangles(),
        ),
    };
    let missing = model.vertices() - surface.seam_split_vertices();
    if missing > 0 {
        seams::split_corners(&mut surface, missing);
    }
    surface
}

/// Returns the surface of `body` with `triangles` triangles, sampled at distance `cell`.
///
/// It is scaled to a bounding box of diagonal 1 around the origin.
fn sculpt(body: &Body, cell: f64, triangles: usize) -> Surface {
    let (points, faces) = polygonize::polygonize(body, cell);
    let mut shell = Shell::new(points, &faces);
    decimate::decimate(&mut shell, triangles);
    relax::relax(&mut shell, body);
    let (points, faces) = shell.into_triangles();
    let (mut low, mut high) = (points[0], points[0]);
    for p in &points {
        low = low.inf(p);
        high = high.sup(p);
    }
    let center = (low + high) / 2.0;
    let scale = 1.0 / (high - low).norm();
    let positions: Vec<[f32; 3]> = points
        .iter()
        .map(|p: &Vec3| to_f32((p - center) * scale))
        .collect();
    Surface::from_triangles(&positions, &faces).expect("edits of a shell keep it a closed manifold")
}
