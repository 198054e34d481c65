//! Bodies that blades cut: slices, slivers, a plate split in its plane, and a slit that gapes.

use super::contacts::block;
use super::{
    Directions, GROUND, Grouping, Part, ScriptedScene, cuboid, grouped, touching, weightless,
};
use crate::{Model, build_model, place};
use incise_cut::{CutError, CutParams, Cutter, Sweep};
use incise_mesh::{Surface, Vec3, VertexId, cube_sphere, icosphere};
use incise_pbd_gpu::{Material, Stiffness, Volume};
use incise_scene::{BackendRequest, ContactParams, Scene, SceneError, SceneParams};

/// Slices of a block.
pub const SLICES: u32 = 10;
/// Random planes through a bunny.
pub const SHATTERING: u32 = 10;
/// Random planes through a ball.
pub const SLICING: u32 = 6;
/// Frames in which the ends of a slit ball move.
pub const PULLING: u16 = 60;
/// Radius of the slit ball \[m\].
const RADIUS: f64 = 0.5;

/// Returns a random plane through the middle half of a piece, or of all pieces.
///
/// # Errors
/// As [`Sweep::from_plane`].
pub fn random_plane(
    surface: &Surface,
    piece: Option<u32>,
    directions: &mut Directions,
) -> Result<Sweep, CutError> {
    let is_meant = |&t: &_| piece.is_none_or(|piece| surface.piece(t) == piece);
    let triangles = surface.topology().triangles().filter(is_meant);
    let (mut low, mut high) = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
    for p in triangles.flat_map(|t| surface.triangle_positions(t)) {
        low = low.inf(&p);
        high = high.sup(&p);
    }
    let normal = directions.next_unit();
    let off = Vec3::from_fn(|_, _| directions.signed()).component_mul(&(high - low)) / 4.0;
    let point = (low + high) / 2.0 + off;
    Sweep::from_plane(normal.into(), normal.dot(&point), &surface.bounds())
}

/// Moves a new blade along a sweep in the next frame.
fn sweep_once(scene: &mut Scene, sweep: &Sweep) -> Result<(), SceneError> {
    let [before, after] = sweep.ends();
    let blade = scene.add_blade(before);
    scene.move_blade(blade, after)
}

/// Adds one body; cuts all of its pieces along one random plane a frame.
fn cut_at_random(
    backend: &BackendRequest,
    params: SceneParams,
    surface: Surface,
    material: &Material,
    planes: u32,
    seed: u64,
) -> Result<ScriptedScene, SceneError> {
    let mut scene = Scene::with_backend(params, backend)?;
    let body = scene.add_body(surface, material)?;
    let mut directions = Directions(seed);
    let cut = move |scene: &mut Scene, frame: u32| {
        if frame >= planes {
            return Ok(());
        }
        scene.read_back(body)?;
        let sweep = random_plane(scene.body(body)?.surface(), None, &mut directions);
        sweep_once(scene, &sweep.map_err(SceneError::Cut)?)
    };
    Ok(ScriptedScene::new(scene, cut))
}

/// Builds a weightless ball that is cut along a random plane in each of the first frames.
///
/// # Errors
/// As [`Scene::with_backend`].
pub fn slivers(backend: &BackendRequest, seed: u64) -> Result<ScriptedScene, SceneError> {
    let (ball, material) = (icosphere(2, 0.5), Material::soft_body());
    cut_at_random(backend, weightless(), ball, &material, SLICING, seed)
}

/// Builds a bunny that is cut along a random plane in each of the first frames of its fall.
///
/// # Errors
/// As [`Scene::with_backend`].
pub fn shatter(
    backend: &BackendRequest,
    seed: u64,
    contacts: Option<ContactParams>,
) -> Result<ScriptedScene, SceneError> {
    let params = SceneParams {
        contacts,
        ..touching()
    };
    let (bunny, material) = (build_model(Model::Bunny), Material::soft_body());
    cut_at_random(backend, params, bunny, &material, SHATTERING, seed)
}

/// Builds a plate of 1 cm on the ground that a blade splits in its plane in the first frame.
///
/// # Errors
/// As [`Scene::with_backend`].
pub fn split_plate(
    backend: &BackendRequest,
    material: &Material,
) -> Result<ScriptedScene, SceneError> {
    let mut plate = cuboid([1.0, 0.01, 1.0], [12, 1, 12]);
    place(&mut plate, |p| p + Vec3::new(0.0, 0.005, 0.0));
    let sweep = Sweep::from_plane([0.0, 1.0, 0.0], 0.0052, &plate.bounds());
    let (mut scene, _) = grouped(backend, touching(), &[plate], Grouping::Bodies, material)?;
    scene.colliders.push(GROUND);
    sweep_once(&mut scene, &sweep.map_err(SceneError::Cut)?)?;
    Ok(scene.into())
}

/// Returns a stiff and a soft solid, and a body of skin and volume only.
#[must_use]
pub fn sliced_materials() -> [(&'static str, Material); 3] {
    let solid = |young_modulus| Material {
        friction: 0.7,
        ..Material::solid(young_modulus, 0.45, 1000.0)
    };
    let skin = Material {
        stretch: Stiffness::Compliance(1e-5),
        volume: Some(Volume::default()),
        damping: 1.0,
        friction: 0.7,
        ..Material::default()
    };
    [
        ("stiff solid", solid(1e6)),
        ("soft solid", solid(1e5)),
        ("skin and volume", skin),
    ]
}

/// Builds a block on the ground of which a blade cuts a slice in each of the first frames.
///
/// # Errors
/// As [`Scene::with_backend`].
pub fn slices(backend: &BackendRequest, material: &Material) -> Result<ScriptedScene, SceneError> {
    let mut surface = block(10, [1.0, 3.0, 1.0]);
    place(&mut surface, |p| p + Vec3::new(0.0, 1.5, 0.0));
    let mut scene = Scene::with_backend(touching(), backend)?;
    scene.colliders.push(GROUND);
    scene.add_body(surface, material)?;
    let edge = |x: f32, y: f32| [[x, y, -9.0], [x, y, 9.0]];
    let blade = scene.add_blade(edge(-9.0, 9.0));
    let cut = move |scene: &mut Scene, frame: u32| {
        if frame + 1 >= SLICES {
            return Ok(());
        }
        // Not through the rows of vertices, which would be slices of their own.
        let y = 0.3 * (frame + 1) as f32 + 0.007;
        scene.teleport_blade(blade, edge(-9.0, y))?;
        scene.move_blade(blade, edge(9.0, y))
    };
    Ok(ScriptedScene::new(scene, cut))
}

/// Returns a soft and a firm body.
#[must_use]
pub fn slit_materials() -> [(&'static str, Material); 2] {
    [
        ("soft", Material::soft_body()),
        ("firm", Material::solid(1e6, 0.45, 1000.0)),
    ]
}

/// Builds a weightless ball, slit from above to its center across the x axis.
///
/// Its ends move apart by a distance \[m\], or together for a negative one, and are held then.
///
/// # Errors
/// As [`Scene::with_backend`].
pub fn slit_ball(
    backend: &BackendRequest,
    material: &Material,
    distance: f32,
) -> Result<ScriptedScene, SceneError> {
    let mut ball = cube_sphere(12, RADIUS);
    let pose = |y: f32| [[0.01, y, -0.7], [0.01, y, 0.7]];
    let sweep = Sweep::new(pose(0.7), pose(0.005));
    let sweep = sweep.map_err(SceneError::Cut)?;
    let slit = Cutter::new(&ball).incise(&mut ball, &sweep, &CutParams::default());
    let slit = slit.map_err(SceneError::Cut)?;
    debug_assert!(!slit.is_miss(), "the blade ends in the middle of the ball");
    let params = SceneParams {
        contacts: Some(ContactParams {
            self_collision: true,
            ..ContactParams::default()
        }),
        ..weightless()
    };
    let mut scene = Scene::with_backend(params, backend)?;
    let body = scene.add_body(ball, material)?;
    let ball = Part { body, piece: 0 };
    let ends = super::pin(&mut scene, ball, |p| p.x.abs() > 0.8 * RADIUS)?;
    let positions = scene.body(body)?.surface().positions();
    let start: Vec<(VertexId, [f32; 4])> =
        ends.iter().map(|&v| (v, positions[v.index()])).collect();
    let pull = move |scene: &mut Scene, frame: u32| {
        let frame = u16::try_from(frame + 1).map_or(PULLING, |frame| frame.min(PULLING));
        let part = f32::from(frame) / f32::from(PULLING);
        for &(v, [x, y, z, _]) in &start {
            let x = x + 0.5 * distance * x.signum() * part;
            scene.set_pin_target(body, v, [x, y, z])?;
        }
        Ok(())
    };
    Ok(ScriptedScene::new(scene, pull))
}

/// Builds a body that falls on the ground by half its size \[m\].
///
/// `surface` is of [one size](super::unit_size).
///
/// # Errors
/// As [`Scene::with_backend`].
pub fn dropped(
    backend: &BackendRequest,
    mut surface: Surface,
    material: &Material,
    contacts: Option<ContactParams>,
    size: f64,
) -> Result<ScriptedScene, SceneError> {
    place(&mut surface, |p| (p + Vec3::new(0.0, 0.5, 0.0)) * size);
    let params = SceneParams {
        contacts,
        ..touching()
    };
    let (mut scene, _) = grouped(backend, params, &[surface], Grouping::Bodies, material)?;
    scene.colliders.push(GROUND);
    Ok(scene.into())
}
