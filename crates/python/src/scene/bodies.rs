//! Bodies of a [`Scene`]: their materials, arrays, pins and rays.

use super::{Number, Scene, unknown};
use crate::arrays::{float_rows, point, vector, wrong_shape};
use crate::error::{IntoException, OrRaise};
use crate::mesh::Mesh;
use crate::mesh_arrays::MeshArrays;
use crate::params;
use incise::mesh::{Surface, Vec3, VertexId};
use incise::pbd::{ConstraintError, Material, Solver};
use incise::scene::{Body, BodyId, SceneError};
use numpy::{PyArray, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The first point of a body that a ray hits.
#[pyclass(frozen, module = "incise", get_all)]
#[derive(Debug)]
pub(crate) struct RayHit {
    /// Row of `Scene.faces`.
    face: usize,
    /// The corner of the face that is nearest to the point: a row of `Scene.positions`.
    vertex: usize,
    /// Distance in lengths of the ray's direction.
    distance: f64,
    /// The point [m], (x, y, z).
    point: (f64, f64, f64),
    /// Barycentric weights of the corners of the face, with the sum 1.
    weights: (f64, f64, f64),
    /// Whether the ray hits the back side of the face.
    from_inside: bool,
}

#[pymethods]
impl RayHit {
    fn __repr__(&self) -> String {
        format!(
            "<incise.RayHit: face {}, distance {:.6}>",
            self.face, self.distance
        )
    }
}

impl Scene {
    pub(super) fn body_id(&self, body: Number) -> PyResult<BodyId> {
        let id = self.scene.find_body(body.0);
        id.ok_or_else(|| unknown("body", body.0))
    }

    fn body(&self, body: Number) -> PyResult<&Body> {
        self.scene.body(self.body_id(body)?).or_raise()
    }

    fn surface(&self, body: Number) -> PyResult<&Surface> {
        Ok(self.body(body)?.surface())
    }

    /// Returns the solver and the surface of a body, to edit pins, velocities and materials.
    fn edit(&mut self, body: Number) -> PyResult<(&mut Solver, &mut Surface)> {
        let id = self.body_id(body)?;
        Ok(self.scene.edit(id).or_raise()?.solver_mut())
    }

    /// Returns the vertex of an index that a body has.
    fn vertex(&self, body: Number, vertex: Number) -> PyResult<VertexId> {
        let slots = self.surface(body)?.topology().vertex_slots();
        if vertex.0 < slots {
            return Ok(VertexId::from_index(vertex.0));
        }
        Err(unknown("vertex", vertex.0))
    }
}

/// Returns the exception of a change of a body.
fn constraint(error: ConstraintError) -> PyErr {
    SceneError::from(error).exception()
}

#[pymethods]
impl Scene {
    /// Adds a mesh as a body at rest and returns its number.
    ///
    /// `material` is a solid: "soft-body", "skin", "liver", "muscle", "jelly" or "rubber"; or
    /// "shell", "limp-shell" or "cloth". By default it is "soft-body", or "cloth" for a mesh with a
    /// boundary. The parameters `Material` of `docs/parameters.md` replace its values, for example
    /// `density={"per_volume": 900.0}`, `solid={"young_modulus": 5e4}` or `friction=0.3`. None
    /// removes bending or volume.
    ///
    /// All positions in a scene are relative to the `origin` of the first mesh; others are moved
    /// to it. Raises `TopologyError`, and `SceneError` for values out of range.
    #[pyo3(signature = (mesh, material=None, **keys))]
    fn add_body(
        &mut self,
        py: Python<'_>,
        mesh: &Mesh,
        material: Option<&Bound<'_, PyAny>>,
        keys: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<usize> {
        let preset = |name| params::choice(name, "material", &Material::PRESETS, Material::preset);
        let material = material.map(preset).transpose()?;
        let surface = py.detach(|| mesh.surface().or_raise().cloned())?;
        let mut material = material.unwrap_or_else(|| Material::for_surface(&surface));
        params::set(&mut material, keys)?;
        let scene = &mut self.scene;
        let body = py.detach(|| scene.add_body(surface, &material).or_raise())?;
        Ok(body.index())
    }

    /// Changes the material of a body from the next frame on, by the keys of `add_body`.
    ///
    /// Values without a key stay. The density and cells cannot change, bending cannot come or go:
    /// they are made with the body. Raises `SceneError`, and nothing has changed.
    #[pyo3(signature = (body, **keys))]
    fn set_material(&mut self, body: Number, keys: Option<&Bound<'_, PyDict>>) -> PyResult<()> {
        let mut material = *self.body(body)?.solver().material();
        params::set(&mut material, keys)?;
        let (solver, surface) = self.edit(body)?;
        solver.set_material(surface, &material).map_err(constraint)
    }

    /// Removes a body. Its number is not used again.
    fn remove_body(&mut self, body: Number) -> PyResult<()> {
        let id = self.body_id(body)?;
        self.scene.remove_body(id).or_raise()?;
        self.undo.forget(id);
        Ok(())
    }

    /// Numbers of the bodies of the scene, ascending.
    #[getter]
    fn bodies(&self) -> Vec<usize> {
        self.scene.bodies().map(BodyId::index).collect()
    }

    /// Returns the first point of a body that a ray hits, or None.
    ///
    /// `origin` [m] and `direction`, of any length, have three numbers each.
    fn cast_ray(
        &mut self,
        body: Number,
        origin: &Bound<'_, PyAny>,
        direction: &Bound<'_, PyAny>,
    ) -> PyResult<Option<RayHit>> {
        let origin = Vec3::from(point(origin, "origin")?);
        let direction = Vec3::from(point(direction, "direction")?);
        let id = self.body_id(body)?;
        let hit = self.scene.cast_ray(id, origin, direction).or_raise()?;
        let topology = self.surface(body)?.topology();
        Ok(hit.map(|hit| RayHit {
            face: topology
                .triangles()
                .take_while(|&t| t < hit.triangle)
                .count(),
            vertex: topology.triangle(hit.triangle)[hit.nearest_corner()].index(),
            distance: hit.distance,
            point: <[f64; 3]>::from(origin + hit.distance * direction).into(),
            weights: hit.weights.into(),
            from_inside: hit.from_inside,
        }))
    }

    /// Positions of a body [m], float32 of shape (vertices, 3): one copy.
    ///
    /// Cuts add rows. Rows of vertices that a cut removed are still there.
    fn positions<'py>(&self, py: Python<'py>, body: Number) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let positions = self.surface(body)?.positions().iter();
        rows(py, positions.map(|&[x, y, z, _]| [x, y, z]).collect())
    }

    /// Faces of a body, uint32 of shape (faces, 3), as indices of `positions`: one copy.
    fn faces<'py>(&self, py: Python<'py>, body: Number) -> PyResult<Bound<'py, PyArray2<u32>>> {
        let topology = self.surface(body)?.topology();
        let corners = topology
            .triangles()
            .map(|t| topology.triangle(t).map(|v| v.0));
        rows(py, corners.collect())
    }

    /// The piece of each face of `faces`: uint32 of shape (faces,).
    fn face_pieces<'py>(&self, py: Python<'py>, body: Number) -> PyResult<Bound<'py, PyAny>> {
        let surface = self.surface(body)?;
        let pieces = surface.topology().triangles().map(|t| surface.piece(t));
        Ok(PyArray::from_vec(py, pieces.collect()).into_any())
    }

    /// Velocities of a body [m/s], float32 of shape (vertices, 3): one copy.
    fn velocities<'py>(
        &self,
        py: Python<'py>,
        body: Number,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let velocities = self.body(body)?.solver().velocities().iter();
        rows(py, velocities.map(|&[x, y, z, _]| [x, y, z]).collect())
    }

    /// Sets the velocities of a body [m/s], shape (vertices, 3).
    fn set_velocities(&mut self, body: Number, velocities: &Bound<'_, PyAny>) -> PyResult<()> {
        let velocities = float_rows::<3>(velocities, "velocities")?;
        let topology = self.surface(body)?.topology();
        let slots = topology.vertex_slots();
        if velocities.len() != slots {
            let shape = [velocities.len(), 3];
            return Err(wrong_shape("velocities", &shape, &format!("({slots}, 3)")));
        }
        let used: Vec<VertexId> = topology.vertices().collect();
        let (solver, _) = self.edit(body)?;
        for v in used {
            solver
                .set_velocity(v, velocities[v.index()])
                .map_err(constraint)?;
        }
        Ok(())
    }

    /// Pins a vertex where it is.
    fn pin(&mut self, body: Number, vertex: Number) -> PyResult<()> {
        let v = self.vertex(body, vertex)?;
        let (solver, surface) = self.edit(body)?;
        solver.pin(surface, v).map_err(constraint)
    }

    /// Releases a pinned vertex.
    fn unpin(&mut self, body: Number, vertex: Number) -> PyResult<()> {
        let v = self.vertex(body, vertex)?;
        let (solver, surface) = self.edit(body)?;
        solver.unpin(surface, v).map_err(constraint)
    }

    /// Sets the position of a pinned vertex at the end of the next frame [m].
    fn set_pin_target(
        &mut self,
        body: Number,
        vertex: Number,
        target: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        let (v, target) = (self.vertex(body, vertex)?, vector(target, "target")?);
        self.scene
            .set_pin_target(self.body_id(body)?, v, target)
            .or_raise()
    }

    /// Numbers of the pieces of a body, ascending.
    fn piece_numbers(&self, body: Number) -> PyResult<Vec<u32>> {
        Ok(self.body(body)?.pieces())
    }

    /// The pieces of a body as meshes at their present positions, as in `piece_numbers`: copies.
    fn pieces(&self, py: Python<'_>, body: Number) -> PyResult<Vec<Mesh>> {
        let surface = self.surface(body)?;
        let mesh = |(_, piece): (u32, Surface)| Mesh::from_arrays(MeshArrays::from_surface(&piece));
        Ok(py.detach(|| surface.extract_pieces().map(mesh).collect()))
    }

    /// Enclosed volume of a body [m^3].
    fn volume(&self, body: Number) -> PyResult<f64> {
        Ok(self.surface(body)?.volume())
    }

    /// Whether a body sleeps.
    fn is_asleep(&self, body: Number) -> PyResult<bool> {
        self.scene.is_asleep(self.body_id(body)?).or_raise()
    }

    /// Wakes a body, or restarts the time until it may fall asleep.
    fn wake(&mut self, body: Number) -> PyResult<()> {
        self.scene.wake(self.body_id(body)?).or_raise()
    }

    /// Mean relative change of edge lengths of a body, weighted by rest length.
    fn stretch_error(&self, body: Number) -> PyResult<f64> {
        let body = self.body(body)?;
        Ok(body.solver().stretch_error(body.surface()))
    }
}

/// Returns rows as an array that takes their memory.
fn rows<T: numpy::Element, const N: usize>(
    py: Python<'_>,
    rows: Vec<[T; N]>,
) -> PyResult<Bound<'_, PyArray2<T>>> {
    let count = rows.len();
    let flat = PyArray::from_vec(py, rows.into_flattened());
    let array = flat.call_method1("reshape", ((count, N),))?;
    Ok(array.cast_into()?)
}
