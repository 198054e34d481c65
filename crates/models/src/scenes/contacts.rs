//! Bodies that fall on others or hit them, and plates that close on a body.

use super::{Grouping, ScriptedScene, cuboid, grouped, pin, sprung, throw, touching, weightless};
use crate::place;
use incise_mesh::geometry::to_f32;
use incise_mesh::{Surface, Vec3, cube_sphere, icosphere, sheet};
use incise_pbd_gpu::{Collider, Material, Stiffness};
use incise_scene::{BackendRequest, Scene, SceneError};

/// Thickness of a bar \[m\].
pub const BAR: f64 = 0.1;
/// Radius of the ball under a sheet \[m\].
pub const DRAPED: f64 = 0.5;
/// Thickness of the plate that a block hits \[m\].
pub const PLATE: f64 = 0.02;
/// Speed of each closing plate, for a body of 1 m [m/s].
pub const CLOSING_SPEED: f64 = 0.25;
/// Distance of a closing plate from the middle at the start, and when closed, for a body of 1 m
/// \[m\].
const DISTANCES: [f64; 2] = [0.55, 0.25];
/// Time for which the plates stay closed \[s\].
const CLOSED: f64 = 0.5;
/// Time until the plates are open again \[s\].
pub const OPEN_AGAIN: f64 = 2.0 * (DISTANCES[0] - DISTANCES[1]) / CLOSING_SPEED + CLOSED;

/// Builds a bar of 12 triangles that falls across a held one at an angle \[rad\].
///
/// # Errors
/// As [`Scene::with_backend`].
pub fn bars(
    backend: &BackendRequest,
    grouping: Grouping,
    angle: f64,
) -> Result<ScriptedScene, SceneError> {
    let lower = cuboid([1.0, BAR, 0.1], [1; 3]);
    let mut upper = lower.clone();
    let (sin, cos) = angle.sin_cos();
    place(&mut upper, |p| {
        let turned = Vec3::new(cos * p.x + sin * p.z, p.y, cos * p.z - sin * p.x);
        turned + Vec3::new(0.0, BAR + 0.05, 0.0)
    });
    let material = Material {
        stretch: Stiffness::Compliance(0.0),
        ..sprung()
    };
    let surfaces = [lower, upper];
    let (mut scene, parts) = grouped(backend, touching(), &surfaces, grouping, &material)?;
    pin(&mut scene, parts[0], |_| true)?;
    Ok(scene.into())
}

/// Builds a sheet that falls on a held ball around the origin; a `side` of 1 has its outer side up,
/// -1 down.
///
/// # Errors
/// As [`Scene::with_backend`].
pub fn drape(backend: &BackendRequest, side: f64) -> Result<ScriptedScene, SceneError> {
    let ball = icosphere(3, DRAPED);
    let mut cloth = sheet([1.6; 2], [40; 2]);
    place(&mut cloth, |p| Vec3::new(p.x, DRAPED + 0.1, -side * p.y));
    let (surfaces, material) = ([ball, cloth], Material::default());
    let (mut scene, parts) = grouped(backend, touching(), &surfaces, Grouping::Bodies, &material)?;
    pin(&mut scene, parts[0], |_| true)?;
    Ok(scene.into())
}

/// Builds a plate held at its rim and a block that hits it with a speed [m/s].
///
/// # Errors
/// As [`Scene::with_backend`].
pub fn block_on_plate(
    backend: &BackendRequest,
    grouping: Grouping,
    speed: f32,
) -> Result<ScriptedScene, SceneError> {
    let plate = cuboid([1.0, PLATE, 1.0], [10, 1, 10]);
    let mut block = cuboid([0.2; 3], [3; 3]);
    place(&mut block, |p| p + Vec3::new(0.013, 0.15, 0.007));
    let (surfaces, material) = ([plate, block], sprung());
    let (mut scene, parts) = grouped(backend, touching(), &surfaces, grouping, &material)?;
    pin(&mut scene, parts[0], |p| {
        p.x.abs() > 0.49 || p.z.abs() > 0.49
    })?;
    throw(&mut scene, parts[1], [0.0, -speed, 0.0])?;
    Ok(scene.into())
}

/// Returns a block with sides of given lengths \[m\] and `squares` x `squares` squares each.
pub(super) fn block(squares: u32, sides: [f64; 3]) -> Surface {
    let mut surface = cube_sphere(squares, 1.0);
    place(&mut surface, |p| {
        let cube = p / p.amax();
        Vec3::from(sides).component_mul(&cube) / 2.0
    });
    surface
}

/// Builds a held plate and a ball that hits it by ten of the plate's diagonals a second.
///
/// Both are pieces of one body: the plate of 4 m, the ball with a radius of 1 m, `offset` beside
/// the plate's middle \[m\]; all lengths are multiplied by `scale`.
///
/// # Errors
/// As [`Scene::with_backend`].
pub fn tunnel(
    backend: &BackendRequest,
    material: &Material,
    offset: f64,
    scale: f64,
) -> Result<ScriptedScene, SceneError> {
    let mut plate = block(8, [4.0, 0.2, 4.0]);
    let mut ball = icosphere(3, 1.0);
    place(&mut ball, |p| p + Vec3::new(offset, 3.0, offset / 3.0));
    for part in [&mut plate, &mut ball] {
        place(part, |p| p * scale);
    }
    let [_, speed, _] = to_f32(Vec3::repeat(10.0 * 2.0 * 3.0_f64.sqrt() * scale));
    let surfaces = [plate, ball];
    let (mut scene, parts) = grouped(backend, weightless(), &surfaces, Grouping::Pieces, material)?;
    pin(&mut scene, parts[0], |_| true)?;
    throw(&mut scene, parts[1], [0.0, -speed, 0.0])?;
    Ok(scene.into())
}

/// Returns the distance of closing plates from the middle of a body of 1 m \[m\].
#[must_use]
pub fn plate_distance(time: f64) -> f64 {
    let [open, closed] = DISTANCES;
    let duration = (open - closed) / CLOSING_SPEED;
    let since_opening = time - duration - CLOSED;
    (open - CLOSING_SPEED * time).max(closed)
        + (CLOSING_SPEED * since_opening).clamp(0.0, open - closed)
}

/// Builds a weightless body between two plates along an axis that close to half its size, wait and
/// open again.
///
/// # Errors
/// As [`Scene::with_backend`].
pub fn closing(
    backend: &BackendRequest,
    surface: Surface,
    material: &Material,
    axis: usize,
) -> Result<ScriptedScene, SceneError> {
    let bounds = surface.bounds();
    let middle = bounds.center();
    let size = f64::from(bounds.max[axis] - bounds.min[axis]);
    let (scene, _) = grouped(
        backend,
        weightless(),
        &[surface],
        Grouping::Bodies,
        material,
    )?;
    let close = move |scene: &mut Scene, frame: u32| {
        let away = size * plate_distance(f64::from(frame + 1) / 60.0);
        scene.colliders = [-1.0, 1.0]
            .map(|side| {
                let mut point = middle;
                point[axis] += side * away;
                let mut normal = [0.0; 3];
                normal[axis] = if side > 0.0 { -1.0 } else { 1.0 };
                Collider::Plane {
                    point: to_f32(point),
                    normal,
                }
            })
            .into();
        Ok(())
    };
    Ok(ScriptedScene::new(scene, close))
}
