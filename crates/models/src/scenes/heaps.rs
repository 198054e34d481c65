//! Heaps of bodies that come to rest: small ones in a bowl, and models on each other.

use super::{Directions, GROUND, Grouping, ScriptedScene, grouped, sprung, touching};
use crate::place;
use incise_mesh::geometry::to_f32;
use incise_mesh::{Surface, Vec3, icosphere};
use incise_pbd_gpu::Collider;
use incise_scene::{BackendRequest, SceneError};
use std::f64::consts::TAU;

/// Radius of a poured ball \[m\].
pub const RADIUS: f64 = 0.05;
/// Radius of the bowl's floor \[m\]; its walls rise by 45 degrees.
const FLOOR: f64 = 0.4;
/// Number of the bowl's walls.
const WALLS: u32 = 8;
/// Size of a stacked model \[m\].
pub const SIZE: f64 = 0.5;
/// Triangles of the largest model in a heap.
pub const TRIANGLES: usize = 3000;
/// Models of a heap.
const MODELS: u32 = 10;

/// Returns a point and the inward normal of a wall of the bowl.
fn wall(number: u32) -> (Vec3, Vec3) {
    let angle = TAU * f64::from(number) / f64::from(WALLS);
    let normal = Vec3::new(-angle.cos(), 1.0, -angle.sin()).normalize();
    let foot = Vec3::new(-normal.x, 0.0, -normal.z).normalize() * FLOOR;
    (foot, normal)
}

/// Returns the distance of a point outside of the bowl \[m\].
#[must_use]
pub fn outside_of_bowl(p: &Vec3) -> f64 {
    let walls = (0..WALLS).map(|number| {
        let (foot, normal) = wall(number);
        -normal.dot(&(p - foot))
    });
    walls.fold(-p.y, f64::max).max(0.0)
}

/// Returns balls in layers above the bowl, each a little beside its place.
fn poured(count: u32) -> Vec<Surface> {
    let mut directions = Directions(5);
    let ball = |number: u32| {
        let [x, z, y] = [number % 8, number / 8 % 8, number / 64].map(f64::from);
        let beside = Vec3::new(directions.signed(), 0.0, directions.signed()) * 0.005;
        let at = Vec3::new(x - 3.5, y + 1.0, z - 3.5) * (2.4 * RADIUS) + beside;
        let mut ball = icosphere(0, RADIUS);
        place(&mut ball, |p| p + at + Vec3::new(0.0, 3.0 * RADIUS, 0.0));
        ball
    };
    (0..count).map(ball).collect()
}

/// Builds balls above a bowl of planes.
///
/// # Errors
/// As [`incise_scene::Scene::with_backend`].
pub fn bowl(backend: &BackendRequest, count: u32) -> Result<ScriptedScene, SceneError> {
    let (balls, material) = (poured(count), sprung());
    let (mut scene, _) = grouped(backend, touching(), &balls, Grouping::Bodies, &material)?;
    let plane = |number| {
        let (foot, normal) = wall(number);
        Collider::Plane {
            point: to_f32(foot),
            normal: to_f32(normal),
        }
    };
    scene.colliders = (0..WALLS).map(plane).chain([GROUND]).collect();
    Ok(scene.into())
}

/// Builds ten models above each other, taken in turn from models of [one size](super::unit_size).
///
/// # Errors
/// As [`incise_scene::Scene::with_backend`].
pub fn heap(
    backend: &BackendRequest,
    models: &[Surface],
    grouping: Grouping,
) -> Result<ScriptedScene, SceneError> {
    let mut directions = Directions(7);
    let above = |(k, model): (u32, &Surface)| {
        let mut surface = model.clone();
        let beside = Vec3::new(directions.signed(), 0.0, directions.signed()) * (0.1 * SIZE);
        let at = beside + Vec3::new(0.0, f64::from(k) * 1.1 * SIZE, 0.0);
        place(&mut surface, |p| p * SIZE + at);
        surface
    };
    let surfaces: Vec<Surface> = (0..MODELS).zip(models.iter().cycle()).map(above).collect();
    let material = sprung();
    let (mut scene, _) = grouped(backend, touching(), &surfaces, grouping, &material)?;
    scene.colliders.push(GROUND);
    Ok(scene.into())
}
