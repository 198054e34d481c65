//! Surfaces made by formula: the paper's seven models, and spheres and tori of any resolution.
//!
//! The paper names its models and their sizes but not their files, so four of them are stand-ins: a
//! smooth implicit body with the features of the name, polygonized, decimated to the paper's number
//! of triangles and given texture seams until a renderer counts the paper's number of vertices.

mod bodies;
mod decimate;
mod ellipsoid;
mod implicit;
mod polygonize;
mod relax;
mod seams;
mod shell;
mod sphere;
mod torus;
mod tube;

pub use sphere::{cube_sphere, icosphere};
pub use torus::torus;

use crate::geometry::{Vec3, round};
use crate::surface::Surface;
use implicit::Body;
use shell::Shell;

/// Radius of the sphere models \[m\].
const SPHERE_RADIUS: f64 = 0.5;

/// The models of the paper's Table 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Model {
    /// An icosahedron, flat shaded.
    Sphere20,
    /// An icosahedron with every triangle split in four, flat shaded.
    Sphere80,
    /// A cube of 8 x 8 quads a side, blown up.
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

    /// The name in the table.
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

    /// "Number of Triangles" in the table.
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

    /// "Number of Vertices" in the table: what [`Surface::seam_split_vertices`] counts.
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

    /// Distinct points, one particle each: half the triangles and two, by Euler's formula for a
    /// closed surface without handles.
    #[must_use]
    pub const fn particles(self) -> usize {
        self.triangles() / 2 + 2
    }
}

/// Builds a model: closed, one piece, without handles, normals outward, y up, with the table's
/// number of triangles and seam-split vertices. Spheres have radius 0.5 around the origin; the box of
/// the others is centered there and has a diagonal of 1 \[m\]. The same bits every time: everything
/// is made of IEEE sums, products, quotients and square roots.
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

/// The surface of `body` with `triangles` triangles, from samples `cell` apart, scaled to a box of
/// diagonal 1 around the origin.
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
        .map(|p: &Vec3| round((p - center) * scale))
        .collect();
    Surface::from_triangles(&positions, &faces).expect("edits of a shell keep it a closed manifold")
}
