//! Bodies, materials and parameters of the stress cases.

use incise_mesh::geometry::to_f32;
use incise_mesh::{Surface, Vec3, VertexId, icosphere};
use incise_pbd_gpu::{Material, SolverParams, Stiffness};

/// Length of a frame \[s\].
pub(super) const FRAME: f32 = 1.0 / 60.0;

/// Ground at height 0 and one substep of ten iterations, which is harder than the default's 16 of
/// one.
pub(super) const GROUND: SolverParams = SolverParams {
    iterations: 10,
    substeps: 1,
    gravity: [0.0, -9.81, 0.0],
    ground: Some(0.0),
    diagonal_scale: 0.5,
    attachments: true,
    ..SolverParams::paper()
};

/// As [`GROUND`], without the ground.
pub(super) const HANGING: SolverParams = SolverParams {
    ground: None,
    ..GROUND
};

/// As [`HANGING`], without gravity.
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

/// A sphere of radius 0.5 m around a point at a height \[m\]: a subdivided icosahedron.
pub(super) fn ball(subdivisions: u32, height: f64) -> Surface {
    let mut surface = icosphere(subdivisions, 0.5);
    shift(&mut surface, Vec3::new(0.0, height, 0.0));
    surface
}

/// Moves a surface and its rest positions \[m\].
pub(super) fn shift(surface: &mut Surface, by: Vec3) {
    place(surface, |p| p + by);
}

/// Moves every vertex and its rest position \[m\].
pub(super) fn place(surface: &mut Surface, to: impl Fn(Vec3) -> Vec3) {
    for i in 0..surface.positions().len() {
        let rest = to(surface.rest_position(VertexId::from_index(i)));
        surface.rest_positions_mut()[i] = to_f32(rest);
    }
    pose(surface, to);
}

/// Moves every vertex; rest positions stay \[m\].
pub(super) fn pose(surface: &mut Surface, to: impl Fn(Vec3) -> Vec3) {
    for i in 0..surface.positions().len() {
        let [x, y, z] = to_f32(to(surface.position(VertexId::from_index(i))));
        let weight = surface.positions()[i][3];
        surface.positions_mut()[i] = [x, y, z, weight];
    }
}

/// Shells of the paper's stiffness, rigid and elastic.
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

/// Rounds up to a whole number of steps.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a saturating cast of a positive number"
)]
pub(super) fn whole(x: f32) -> u32 {
    x.ceil() as u32
}
