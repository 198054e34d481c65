//! The bodies that cases are about.

use super::failure::Failure;
use incise_mesh::geometry::round;
use incise_mesh::{Surface, Vec3, VertexId, icosphere};
use incise_pbd_gpu::{Material, SolverParams, Stiffness};

/// A frame of 60 a second \[s\].
pub(super) const FRAME: f32 = 1.0 / 60.0;

/// Ground at height 0, earth's gravity; one substep of ten iterations, which is harder than the default's 16 of one, and what else
/// the default has.
pub(super) const GROUND: SolverParams = SolverParams {
    iterations: 10,
    substeps: 1,
    gravity: [0.0, -9.81, 0.0],
    ground: Some(0.0),
    own_weight: 0.5,
    tethers: true,
    ..SolverParams::paper()
};

/// As [`GROUND`], without the ground.
pub(super) const HANGING: SolverParams = SolverParams {
    ground: None,
    ..GROUND
};

/// Nothing pulls.
pub(super) const WEIGHTLESS: SolverParams = SolverParams {
    gravity: [0.0; 3],
    ..HANGING
};

/// A shell of 1 kg/m^2 with one compliance for stretch [m/N] and one for bending [rad/(N m)].
pub(super) fn elastic_shell(stretch: f32, bending: f32) -> Material {
    Material {
        stretch: Stiffness::Compliance(stretch),
        bending: Some(Stiffness::Compliance(bending)),
        ..Material::default()
    }
}

/// A sphere of half a meter around a point at that height \[m\], 20 triangles divided so many times.
pub(super) fn ball(subdivisions: u32, height: f64) -> Surface {
    let mut surface = icosphere(subdivisions, 0.5);
    shift(&mut surface, Vec3::new(0.0, height, 0.0));
    surface
}

/// Moves a surface, in place and at rest \[m\].
pub(super) fn shift(surface: &mut Surface, by: Vec3) {
    place(surface, |p| p + by);
}

/// Puts every vertex elsewhere, in place and at rest \[m\].
pub(super) fn place(surface: &mut Surface, to: impl Fn(Vec3) -> Vec3) {
    for i in 0..surface.positions.len() {
        let rest = to(surface.rest_position(VertexId::from_index(i)));
        surface.rest[i] = round(rest);
    }
    pose(surface, to);
}

/// Puts every vertex elsewhere but not its rest position \[m\].
pub(super) fn pose(surface: &mut Surface, to: impl Fn(Vec3) -> Vec3) {
    for i in 0..surface.positions.len() {
        let [x, y, z] = round(to(surface.position(VertexId::from_index(i))));
        let weight = surface.positions[i][3];
        surface.positions[i] = [x, y, z, weight];
    }
}

/// A sheet in the plane of x and y, its upper left corner at the origin: so many squares across and down,
/// so wide and high \[m\]. Vertex `row * (across + 1) + column`; the diagonals alternate.
///
/// # Errors
/// None: it is a surface.
pub(super) fn sheet(counts: [u32; 2], size: [f32; 2]) -> Result<Surface, Failure> {
    let [across, down] = counts;
    let number = |column: u32, row: u32| row * (across + 1) + column;
    let (mut points, mut faces) = (Vec::new(), Vec::new());
    for row in 0..=down {
        for column in 0..=across {
            let part = |i: u32, n: u32| i as f32 / n as f32;
            points.push([
                size[0] * part(column, across),
                -size[1] * part(row, down),
                0.0,
            ]);
        }
    }
    for row in 0..down {
        for column in 0..across {
            let a = number(column, row);
            let (b, c, d) = (a + 1, number(column, row + 1), number(column + 1, row + 1));
            if (row + column) % 2 == 0 {
                faces.extend([[a, c, d], [a, d, b]]);
            } else {
                faces.extend([[a, c, b], [b, c, d]]);
            }
        }
    }
    Ok(Surface::from_triangles(&points, &faces)?)
}

/// A closed double cone: `n` vertices around a ring at height 1, one above and one below it, both of
/// valence `n` \[m\].
///
/// # Errors
/// None: it is a surface for 3 and more.
pub(super) fn double_cone(n: u32) -> Result<Surface, Failure> {
    let mut points = vec![[0.0, 1.5, 0.0], [0.0, 0.5, 0.0]];
    points.extend((0..n).map(|i| {
        let turn = std::f32::consts::TAU * i as f32 / n as f32;
        [turn.cos(), 1.0, turn.sin()]
    }));
    let sides = (0..n).map(|i| (2 + i, 2 + (i + 1) % n));
    let faces: Vec<[u32; 3]> = sides.flat_map(|(a, b)| [[0, b, a], [1, a, b]]).collect();
    Ok(Surface::from_triangles(&points, &faces)?)
}

/// Shells that most bodies are tried as.
pub(super) fn materials() -> [(&'static str, Material); 3] {
    let paper = Material {
        bending: Some(Stiffness::Pbd(1.0)),
        ..Material::default()
    };
    [
        ("PBD", paper),
        ("compliance 0", elastic_shell(0.0, 0.0)),
        ("compliance 1e-5", elastic_shell(1e-5, 1e-2)),
    ]
}

/// The least whole number of steps that are not fewer.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a saturating cast of a positive number"
)]
pub(super) fn whole(x: f32) -> u32 {
    x.ceil() as u32
}
