//! Bodies that several tests cut.

use incise_mesh::Surface;
use incise_models::{Model, build_model};

/// A sphere of 80 triangles and, inside it, one a fifth as large and inside out.
pub(crate) fn hollow_sphere() -> Surface {
    let sphere = build_model(Model::Sphere80);
    let topology = sphere.topology();
    let mut points: Vec<[f32; 3]> = sphere
        .positions()
        .iter()
        .map(|&[x, y, z, _]| [x, y, z])
        .collect();
    let mut faces: Vec<[u32; 3]> = topology
        .triangles()
        .map(|t| topology.triangle(t).map(|v| v.0))
        .collect();
    let offset = u32::try_from(points.len()).unwrap();
    points.extend(points.clone().iter().map(|p| p.map(|c| c / 5.0)));
    faces.extend(
        faces
            .clone()
            .iter()
            .map(|&[a, b, c]| [a, c, b].map(|v| v + offset)),
    );
    Surface::from_triangles(&points, &faces).unwrap()
}
