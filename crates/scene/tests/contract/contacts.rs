//! Contacts between the pieces of a body and with colliders, through [`Scene::step`].

mod bodies;
mod cuts;
mod folds;
mod friction;
mod obstacles;
mod overlaps;
mod pieces;
mod sheets;
mod turned;

use incise_mesh::{Bvh, Surface, TriangleId, VertexId, cube_sphere};
use incise_models::scenes::sprung;
use incise_pbd_gpu::{
    Collider, InteriorSprings, Material, Solver, SolverParams, Stiffness, Volume,
};
use incise_scene::{Body, BodyId, ContactParams, Scene, SceneParams, SleepParams};
use incise_test_support::materials::firm;
use turned::Turn;

pub(crate) fn params(gravity: [f32; 3]) -> SceneParams {
    SceneParams {
        solver: SolverParams {
            gravity,
            substep: Some(1.0 / 960.0),
            ..SolverParams::default()
        },
        contacts: Some(ContactParams::default()),
        sleep: None,
        ..SceneParams::default()
    }
}

/// Returns an empty scene with contacts and a ground at a height \[m\].
pub(crate) fn above(ground: f32) -> Scene {
    let mut scene = Scene::new(SceneParams {
        contacts: Some(ContactParams::default()),
        ..SceneParams::default()
    });
    scene.colliders.push(Collider::ground(ground));
    scene
}

/// Returns a material with a volume and interior springs.
pub(crate) fn with_springs() -> Material {
    Material {
        volume: Some(Volume::default()),
        interior_springs: Some(InteriorSprings::default()),
        ..Material::default()
    }
}

/// Returns the surfaces as components of one.
pub(crate) fn merged(parts: &[Surface]) -> Surface {
    let (mut corners, mut faces) = (Vec::new(), Vec::new());
    for part in parts {
        let offset = u32::try_from(corners.len()).unwrap();
        corners.extend_from_slice(part.rest_positions());
        let topology = part.topology();
        let of = |t: TriangleId| topology.triangle(t).map(|v| v.0 + offset);
        faces.extend(topology.triangles().map(of));
    }
    Surface::from_triangles(&corners, &faces).unwrap()
}

pub(crate) fn moved(surface: &Surface, by: [f32; 3], scale: [f32; 3]) -> Surface {
    let mut out = surface.clone();
    for p in out.rest_positions_mut() {
        *p = [0, 1, 2].map(|k| p[k] * scale[k] + by[k]);
    }
    out
}

/// Returns a cube of 2 m with n x n quads per side.
pub(crate) fn cube(n: u32) -> Surface {
    let mut surface = cube_sphere(n, 1.0);
    for p in surface.rest_positions_mut() {
        let largest = p.iter().fold(0.0_f32, |a, c| a.max(c.abs()));
        *p = p.map(|c| c / largest);
    }
    surface
}

pub(crate) fn piece_of(surface: &Surface, v: VertexId) -> u32 {
    surface.piece(surface.topology().outgoing(v).triangle())
}

/// Returns the maximum penetration depth of a vertex into another piece \[m\].
pub(crate) fn max_penetration(surface: &Surface) -> f64 {
    let bvh = Bvh::build(surface);
    let mut max_penetration = 0.0_f64;
    for v in surface.topology().vertices() {
        let own = piece_of(surface, v);
        let at = surface.position(v);
        let found = bvh.nearest(surface, at, 10.0, |t| surface.piece(t) != own);
        max_penetration = max_penetration.max(found.map_or(0.0, |found| -found.distance));
    }
    max_penetration
}

/// Returns the lowest and the highest y coordinate of a piece \[m\].
pub(crate) fn height_range(body: &Body, piece: u32) -> [f32; 2] {
    let surface = body.surface();
    let all = surface.topology().vertices();
    let of_piece = all.filter(|&v| piece_of(surface, v) == piece);
    of_piece.fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], v| {
        let y = surface.positions()[v.index()][1];
        [low.min(y), high.max(y)]
    })
}

/// Returns the vertical velocity of a piece's center of mass [m/s].
pub(crate) fn vertical_velocity(body: &Body, piece: u32) -> f32 {
    let solver = body.solver();
    let (mut momentum, mut mass) = (0.0, 0.0);
    for v in of_piece(body.surface(), piece) {
        momentum += solver.masses()[v.index()] * solver.velocity(v)[1];
        mass += solver.masses()[v.index()];
    }
    momentum / mass
}

/// Pins all vertices of a piece.
pub(crate) fn pin_piece(scene: &mut Scene, id: BodyId, piece: u32) {
    let (solver, surface) = scene.edit(id).unwrap().solver_mut();
    for v in of_piece(surface, piece) {
        solver.pin(surface, v).unwrap();
    }
}

pub(crate) fn of_piece(surface: &Surface, piece: u32) -> Vec<VertexId> {
    let all = surface.topology().vertices();
    all.filter(|&v| piece_of(surface, v) == piece).collect()
}

pub(crate) fn set_piece_velocity(scene: &mut Scene, id: BodyId, piece: u32, velocity: [f32; 3]) {
    let (solver, surface) = scene.edit(id).unwrap().solver_mut();
    for v in of_piece(surface, piece) {
        solver.set_velocity(v, velocity).unwrap();
    }
}
