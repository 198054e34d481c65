//! [`Bodies`]: the inputs of a simulation and their bodies in the scene.

use super::scene_file::SceneFile;
use crate::failure::Failure;
use crate::input::InputOptions;
use crate::json::lossy;
use crate::numbers::Numbers;
use incise_mesh::geometry::{to_f32, to_f64};
use incise_mesh::{Aabb, Surface, Vec3, VertexId, Warning};
use incise_pbd_gpu::{Collider, Material};
use incise_scene::{BodyId, Scene, SceneError};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Maximum distance of neighboring coordinates in single precision, relative to the diagonal of a
/// body's bounding box.
const MAX_SPACING: f64 = 0.01;

/// Maximum depth of a body in a plane at the start, relative to the diagonal of its bounding box:
/// eight roundings of single precision, as of a body that was moved onto the plane.
const MAX_DEPTH: f64 = 1e-6;

/// An input of a simulation.
#[derive(Serialize)]
pub(super) struct Input {
    #[serde(serialize_with = "lossy")]
    pub(super) file: PathBuf,
    /// Repairs made while reading.
    pub(super) warnings: Vec<Warning>,
}

/// Reads the bodies of a scene relative to the origin of the first one, and moves them by their
/// offsets.
pub(super) fn read(file: &SceneFile) -> Result<(Vec<Input>, Vec<Surface>), Failure> {
    let reading = InputOptions::new(file.repair);
    let (mut inputs, mut surfaces) = (Vec::new(), Vec::<Surface>::new());
    for body in &file.bodies {
        let (mut surface, warnings) = reading.read_open(&body.mesh)?;
        surface.sort_by_position();
        if let Some(first) = surfaces.first() {
            surface.move_origin(first.origin());
        }
        let Numbers(offset) = body.offset;
        if offset != [0.0; 3] {
            check_resolution(&surface, &body.mesh, offset.into())?;
            shift(&mut surface, offset.into());
        }
        inputs.push(Input {
            file: body.mesh.clone(),
            warnings,
        });
        surfaces.push(surface);
    }
    Ok((inputs, surfaces))
}

/// Moves a surface and its rest positions.
fn shift(surface: &mut Surface, by: Vec3) {
    for i in 0..surface.positions().len() {
        let v = VertexId::from_index(i);
        surface.rest_positions_mut()[i] = to_f32(surface.rest_position(v) + by);
        let [x, y, z, inv_mass] = surface.positions()[i];
        let [x, y, z] = to_f32(to_f64([x, y, z]) + by);
        surface.positions_mut()[i] = [x, y, z, inv_mass];
    }
}

/// Bounding box of all bodies at the start.
pub(super) struct StartBounds(Aabb);

/// Maximum distance from the center of the box, beyond a free fall \[diagonals of the box\].
///
/// A rebound rises by one at most; moving pins and colliders throw bodies farther.
const MAX_FLIGHT: f64 = 100.0;

impl StartBounds {
    /// Returns the box of bodies before the first frame.
    pub(super) fn new(surfaces: &[Surface]) -> Self {
        let corners = surfaces.iter().map(Surface::bounds);
        Self(Aabb::around(
            corners.flat_map(|bounds| [bounds.min, bounds.max]),
        ))
    }

    /// Refuses bodies that have left the box after a run of `seconds` with `gravity` [m/s^2].
    pub(super) fn check(
        &self,
        surfaces: &[(&Surface, &Path)],
        gravity: [f32; 3],
        seconds: f64,
    ) -> Result<(), Failure> {
        let fall = to_f64(gravity).norm() * seconds * seconds / 2.0;
        let farthest = MAX_FLIGHT * self.0.diagonal() + fall;
        for (surface, path) in surfaces {
            let bounds = surface.bounds();
            let corners = [bounds.min, bounds.max].map(to_f64);
            let center = self.0.center();
            let distances = corners.map(|corner| (corner - center).norm());
            let distance = f64::max(distances[0], distances[1]);
            if distance > farthest {
                return Err(Failure::LeftScene {
                    path: path.to_path_buf(),
                    distance,
                    seconds,
                });
            }
        }
        Ok(())
    }
}

/// Refuses an offset \[m\] at which single precision rounds the shape of a body away.
fn check_resolution(surface: &Surface, path: &Path, offset: Vec3) -> Result<(), Failure> {
    let bounds = surface.bounds();
    let corners = [bounds.min, bounds.max].map(|corner| to_f64(corner) + offset);
    let farthest = corners
        .into_iter()
        .fold(0.0, |far, p| f64::max(far, p.amax()));
    let spacing = farthest * f64::from(f32::EPSILON);
    if spacing < MAX_SPACING * bounds.diagonal() {
        return Ok(());
    }
    Err(Failure::FarOffset {
        path: path.to_owned(),
        spacing,
    })
}

/// Refuses a body that starts in a plane; both are relative to one origin.
pub(super) fn check_planes(
    surface: &Surface,
    path: &Path,
    colliders: &[Collider],
) -> Result<(), Failure> {
    for collider in colliders {
        let &Collider::Plane { point, normal } = collider else {
            continue;
        };
        let (point, normal) = (to_f64(point), to_f64(normal).normalize());
        let vertices = surface.topology().vertices();
        let heights = vertices.map(|v| normal.dot(&(surface.position(v) - point)));
        let depth = -heights.fold(f64::INFINITY, f64::min);
        if depth > MAX_DEPTH * surface.bounds().diagonal() {
            return Err(Failure::InPlane {
                path: path.to_owned(),
                depth,
            });
        }
    }
    Ok(())
}

/// The bodies of a scene, in the order of their inputs.
pub(super) struct Bodies {
    ids: Vec<BodyId>,
    /// The inputs' files, for errors.
    paths: Vec<PathBuf>,
    /// The origin that all surfaces share.
    pub(super) origin: [f64; 3],
}

impl Bodies {
    /// Adds the surfaces of inputs to a scene, each with its material or the default for it.
    pub(super) fn add(
        scene: &mut Scene,
        inputs: &[Input],
        surfaces: Vec<Surface>,
        materials: &[Option<Material>],
    ) -> Result<Self, Failure> {
        let origin = surfaces.first().map_or([0.0; 3], Surface::origin);
        let mut ids = Vec::new();
        for ((input, surface), material) in inputs.iter().zip(surfaces).zip(materials) {
            let material = material.unwrap_or_else(|| Material::for_surface(&surface));
            let id = scene.add_body(surface, &material);
            ids.push(id.map_err(|source| Failure::Scene {
                path: input.file.clone(),
                source,
            })?);
        }
        let paths = inputs.iter().map(|input| input.file.clone()).collect();
        Ok(Self { ids, paths, origin })
    }

    pub(super) fn ids(&self) -> &[BodyId] {
        &self.ids
    }

    /// Returns the files of all bodies, for a message about the scene.
    pub(super) fn all_paths(&self) -> PathBuf {
        let names: Vec<_> = self.paths.iter().map(|p| p.to_string_lossy()).collect();
        names.join(", ").into()
    }

    /// Returns the file of a body.
    pub(super) fn path(&self, id: BodyId) -> PathBuf {
        let found = self.ids.iter().position(|&own| own == id);
        found.map_or_else(|| self.all_paths(), |i| self.paths[i].clone())
    }

    /// Returns the error of a scene with the files of its bodies.
    pub(super) fn failed(&self, source: SceneError) -> Failure {
        Failure::Scene {
            path: self.all_paths(),
            source,
        }
    }

    /// Reads all bodies back and returns their surfaces, with their files.
    pub(super) fn surfaces<'a>(
        &'a self,
        scene: &'a mut Scene,
    ) -> Result<Vec<(&'a Surface, &'a Path)>, Failure> {
        for &id in &self.ids {
            scene.read_back(id).map_err(|source| self.failed(source))?;
        }
        let scene = &*scene;
        let surface = |(&id, path): (&BodyId, &'a PathBuf)| {
            let body = scene.body(id).map_err(|source| self.failed(source))?;
            Ok((body.surface(), path.as_path()))
        };
        self.ids.iter().zip(&self.paths).map(surface).collect()
    }
}
