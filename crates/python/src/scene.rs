//! [`Scene`]: bodies, blades and colliders of Python, stepped frame by frame.

use crate::arrays::{edge, float_rows, vector, wrong_shape};
use crate::error::{IntoException, OrRaise, SceneError};
use crate::frame_stats::FrameStats;
use crate::mesh::Mesh;
use crate::mesh_arrays::MeshArrays;
use crate::options::{choice, cut_params};
use crate::solver_options::{collider, contacts, material};
use incise::mesh::geometry::round_to_f32;
use incise::mesh::{Surface, VertexId};
use incise::pbd::{ConstraintError, Solver, SolverParams};
use incise::scene::{
    BladeId, BladeMode, Body, BodyId, Scene as LibraryScene, SceneError as LibrarySceneError,
    SceneParams, SleepParams,
};
use numpy::{PyArray, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::num::NonZeroUsize;

/// A simulation of soft bodies and blades, stepped frame by frame on the CPU.
///
/// Lengths are in meters, times in seconds, masses in kilograms; the y axis points up. Bodies and
/// blades are numbers that `add_body` and `add_blade` return.
///
/// Parameters
/// ----------
/// dt : float
///     Time step of a frame [s].
/// iterations, substeps : int
///     Solver iterations per substep, and substeps per frame.
/// gravity : three numbers
///     Acceleration [m/s^2].
/// ground : float, optional
///     Height of the ground plane [m].
/// contacts : bool or dict
///     Whether bodies, pieces and blade faces touch each other; `{"thickness": edge_lengths,
///     "self_collision": bool}` sets parameters.
/// sleep : bool
///     Whether bodies at rest are not stepped until something moves them.
/// `skip_far_sweeps` : bool
///     Whether a blade is tested only against bodies whose bounding box it meets.
/// threads : int, optional
///     Largest number of threads of a step. The results do not depend on it.
/// `diagonal_scale`, `attachments` : float, bool
///     See `SolverParams` of the Rust library; 1.0 and False are the paper's.
/// **options
///     Options of cuts, see `Mesh.cut`.
///
/// One thread at a time may use a scene. Other threads of Python run during `step`.
#[pyclass(module = "incise")]
pub(crate) struct Scene {
    scene: LibraryScene,
    bodies: Vec<BodyId>,
    blades: Vec<BladeId>,
}

impl Scene {
    fn body_id(&self, body: usize) -> PyResult<BodyId> {
        let id = self.bodies.get(body);
        id.copied()
            .ok_or_else(|| unknown("body", body, self.bodies.len()))
    }

    /// Returns the solver and the surface of a body, to edit pins and velocities.
    fn edit(&mut self, body: usize) -> PyResult<(&mut Solver, &mut Surface)> {
        let id = self.body_id(body)?;
        Ok(self.scene.edit(id).or_raise()?.solver_mut())
    }

    fn blade_id(&self, blade: usize) -> PyResult<BladeId> {
        let id = self.blades.get(blade);
        id.copied()
            .ok_or_else(|| unknown("blade", blade, self.blades.len()))
    }

    fn body(&self, body: usize) -> PyResult<&Body> {
        self.scene.body(self.body_id(body)?).or_raise()
    }

    fn surface(&self, body: usize) -> PyResult<&Surface> {
        Ok(self.body(body)?.surface())
    }

    /// Returns the vertex of an index that a body has.
    fn vertex(&self, body: usize, vertex: usize) -> PyResult<VertexId> {
        let slots = self.surface(body)?.topology().vertex_slots();
        if vertex < slots {
            return Ok(VertexId::from_index(vertex));
        }
        Err(unknown("vertex", vertex, slots))
    }
}

fn unknown(kind: &str, number: usize, count: usize) -> PyErr {
    SceneError::new_err(format!("{kind} {number} does not exist; there are {count}"))
}

/// Returns the exception of a change of a body.
fn constraint(error: ConstraintError) -> PyErr {
    LibrarySceneError::from(error).exception()
}

/// Returns the names of the modes of blades.
const MODES: [(&str, BladeMode); 2] = [
    ("progressive", BladeMode::Progressive),
    ("full-slices", BladeMode::FullSlices),
];

#[pymethods]
impl Scene {
    #[new]
    #[pyo3(signature = (
        *, dt=1.0 / 60.0, iterations=1, substeps=16, gravity=None, ground=None, contacts=None,
        sleep=true, skip_far_sweeps=true, threads=None, diagonal_scale=0.5, attachments=true,
        **options
    ))]
    #[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
    fn new(
        dt: f64,
        iterations: u32,
        substeps: u32,
        gravity: Option<&Bound<'_, PyAny>>,
        ground: Option<f64>,
        contacts: Option<&Bound<'_, PyAny>>,
        sleep: bool,
        skip_far_sweeps: bool,
        threads: Option<NonZeroUsize>,
        diagonal_scale: f64,
        attachments: bool,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let mut solver = SolverParams {
            iterations,
            substeps,
            ground: ground.map(round_to_f32),
            threads,
            diagonal_scale: round_to_f32(diagonal_scale),
            attachments,
            ..SolverParams::default()
        };
        if let Some(value) = gravity {
            solver.gravity = vector(value, "gravity")?;
        }
        let dt = round_to_f32(dt);
        let params = SceneParams {
            dt,
            solver,
            cut: cut_params(options)?,
            skip_far_sweeps,
            contacts: contacts.map(self::contacts).transpose()?.flatten(),
            sleep: sleep.then(SleepParams::default),
            ..SceneParams::default()
        };
        (solver.check(dt).map_err(LibrarySceneError::Frame)).or_raise()?;
        if let Some(contacts) = params.contacts {
            contacts.check().or_raise()?;
        }
        Ok(Self {
            scene: LibraryScene::new(params),
            bodies: Vec::new(),
            blades: Vec::new(),
        })
    }

    /// Adds a mesh as a body at rest and returns its number.
    ///
    /// `material` is "soft-body" (default), "shell", "limp-shell" or "cloth". Keys of scene files
    /// replace its values: `density`, `{"per_area": kg/m^2}` or `{"per_volume": kg/m^3}`;
    /// `stretch` and `bending`, `{"stiffness": 0 to 1}` or `{"compliance": m/N, rad/(N m)}`;
    /// `volume`, `{"compressibility": 1/Pa, "pressure": ratio}`; `interior_springs`, `{"density":
    /// per vertex, "stiffness": {...}}`; `damping` [1/s]; `friction`. None removes bending,
    /// volume or springs.
    ///
    /// Raises `TopologyError`, and `SceneError` for values out of range.
    #[pyo3(signature = (mesh, material=None, **keys))]
    fn add_body(
        &mut self,
        py: Python<'_>,
        mesh: &Mesh,
        material: Option<&Bound<'_, PyAny>>,
        keys: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<usize> {
        let soft_body = "soft-body".into_pyobject(py)?.into_any();
        let material = self::material(material.unwrap_or(&soft_body), keys)?;
        let scene = &mut self.scene;
        let body = py.detach(|| {
            let surface = mesh.surface().or_raise()?.clone();
            scene.add_body(surface, &material).or_raise()
        })?;
        self.bodies.push(body);
        Ok(self.bodies.len() - 1)
    }

    /// Adds a straight blade with its edge from start to end [m], shape (2, 3); returns its number.
    ///
    /// `mode` is "progressive", a blade that may stop inside a body, or "full-slices".
    #[pyo3(signature = (edge, mode=None))]
    fn add_blade(
        &mut self,
        edge: &Bound<'_, PyAny>,
        mode: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<usize> {
        let edge = self::edge(edge, "edge")?;
        let mode = mode.map(|mode| choice(mode, "mode", &MODES)).transpose()?;
        let blade = self.scene.add_blade(edge);
        if let Some(mode) = mode {
            self.scene.set_blade_mode(blade, mode).or_raise()?;
        }
        self.blades.push(blade);
        Ok(self.blades.len() - 1)
    }

    /// Moves a blade to a pose [m], shape (2, 3); the next step cuts along its sweep.
    fn set_blade(&mut self, blade: usize, edge: &Bound<'_, PyAny>) -> PyResult<()> {
        let edge = self::edge(edge, "edge")?;
        self.scene
            .move_blade(self.blade_id(blade)?, edge)
            .or_raise()
    }

    /// Moves a blade without a cut and ends its incisions.
    fn teleport_blade(&mut self, blade: usize, edge: &Bound<'_, PyAny>) -> PyResult<()> {
        let edge = self::edge(edge, "edge")?;
        self.scene
            .teleport_blade(self.blade_id(blade)?, edge)
            .or_raise()
    }

    /// Gives a blade a face, the vector from its edge to its back [m], which pushes bodies.
    ///
    /// None removes it. Faces need `contacts`.
    #[pyo3(signature = (blade, face))]
    fn set_blade_face(&mut self, blade: usize, face: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
        let face = face.map(|face| vector(face, "face")).transpose()?;
        self.scene
            .set_blade_face(self.blade_id(blade)?, face)
            .or_raise()
    }

    /// Restricts a blade to one piece of the bodies; None cuts all pieces.
    #[pyo3(signature = (blade, piece))]
    fn set_blade_piece(&mut self, blade: usize, piece: Option<u32>) -> PyResult<()> {
        self.scene
            .set_blade_piece(self.blade_id(blade)?, piece)
            .or_raise()
    }

    /// Replaces the rigid obstacles, a list of dictionaries with one shape each.
    ///
    /// {"plane": {"point", "normal"}}, {"sphere": {"center", "radius"}}, {"capsule": {"ends",
    /// "radius"}} or {"box": {"center", "half", "axes"}}. A list of the same length moves them
    /// within the next frame.
    fn set_colliders(&mut self, colliders: Vec<Bound<'_, PyAny>>) -> PyResult<()> {
        let read = colliders
            .iter()
            .enumerate()
            .map(|(i, value)| collider(value, i));
        self.scene.colliders = read.collect::<PyResult<_>>()?;
        Ok(())
    }

    /// Steps by one frame of `dt` [s], by default that of the scene: cuts, then motion.
    ///
    /// A cut that fails raises nothing, see `failed_cuts`. Raises `SceneError` for a body that
    /// cannot be stepped.
    #[pyo3(signature = (dt=None))]
    fn step(&mut self, py: Python<'_>, dt: Option<f64>) -> PyResult<FrameStats> {
        if let Some(dt) = dt.map(round_to_f32) {
            let params = &mut self.scene.params;
            (params.solver.check(dt).map_err(LibrarySceneError::Frame)).or_raise()?;
            params.dt = dt;
        }
        let scene = &mut self.scene;
        py.detach(|| scene.step().map(FrameStats::new)).or_raise()
    }

    /// Cuts that failed in the last frame: blade, body and reason.
    #[getter]
    fn failed_cuts(&self) -> Vec<(usize, usize, String)> {
        let failed = self.scene.failed_cuts().iter();
        let number = |cut: &incise::scene::FailedCut| {
            let blade = self.blades.iter().position(|&blade| blade == cut.blade)?;
            let body = self.bodies.iter().position(|&body| body == cut.body)?;
            Some((blade, body, cut.error.to_string()))
        };
        failed.filter_map(number).collect()
    }

    /// Positions of a body [m], float32 of shape (vertices, 3): one copy.
    ///
    /// Cuts add rows. Rows of vertices that a cut removed are still there.
    fn positions<'py>(&self, py: Python<'py>, body: usize) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let positions = self.surface(body)?.positions().iter();
        rows(py, positions.map(|&[x, y, z, _]| [x, y, z]).collect())
    }

    /// Faces of a body, uint32 of shape (faces, 3), as indices of `positions`: one copy.
    fn faces<'py>(&self, py: Python<'py>, body: usize) -> PyResult<Bound<'py, PyArray2<u32>>> {
        let topology = self.surface(body)?.topology();
        let corners = topology
            .triangles()
            .map(|t| topology.triangle(t).map(|v| v.0));
        rows(py, corners.collect())
    }

    /// The piece of each face of `faces`: uint32 of shape (faces,).
    fn face_pieces<'py>(&self, py: Python<'py>, body: usize) -> PyResult<Bound<'py, PyAny>> {
        let surface = self.surface(body)?;
        let pieces = surface.topology().triangles().map(|t| surface.piece(t));
        Ok(PyArray::from_vec(py, pieces.collect()).into_any())
    }

    /// Velocities of a body [m/s], float32 of shape (vertices, 3): one copy.
    fn velocities<'py>(&self, py: Python<'py>, body: usize) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let velocities = self.body(body)?.solver().velocities().iter();
        rows(py, velocities.map(|&[x, y, z, _]| [x, y, z]).collect())
    }

    /// Sets the velocities of a body [m/s], shape (vertices, 3).
    fn set_velocities(&mut self, body: usize, velocities: &Bound<'_, PyAny>) -> PyResult<()> {
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
    fn pin(&mut self, body: usize, vertex: usize) -> PyResult<()> {
        let v = self.vertex(body, vertex)?;
        let (solver, surface) = self.edit(body)?;
        solver.pin(surface, v).map_err(constraint)
    }

    /// Releases a pinned vertex.
    fn unpin(&mut self, body: usize, vertex: usize) -> PyResult<()> {
        let v = self.vertex(body, vertex)?;
        let (solver, surface) = self.edit(body)?;
        solver.unpin(surface, v).map_err(constraint)
    }

    /// Sets the position of a pinned vertex at the end of the next frame [m].
    fn set_pin_target(
        &mut self,
        body: usize,
        vertex: usize,
        target: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        let (v, target) = (self.vertex(body, vertex)?, vector(target, "target")?);
        self.scene
            .set_pin_target(self.body_id(body)?, v, target)
            .or_raise()
    }

    /// Numbers of the pieces of a body, ascending.
    fn piece_numbers(&self, body: usize) -> PyResult<Vec<u32>> {
        Ok(self.body(body)?.pieces())
    }

    /// The pieces of a body as meshes at their present positions, as in `piece_numbers`: copies.
    fn pieces(&self, py: Python<'_>, body: usize) -> PyResult<Vec<Mesh>> {
        let surface = self.surface(body)?;
        let mesh = |(_, piece): (u32, Surface)| Mesh::from_arrays(MeshArrays::from_surface(&piece));
        Ok(py.detach(|| surface.extract_pieces().map(mesh).collect()))
    }

    /// Enclosed volume of a body [m^3].
    fn volume(&self, body: usize) -> PyResult<f64> {
        Ok(self.surface(body)?.volume())
    }

    /// Whether a body sleeps.
    fn is_asleep(&self, body: usize) -> PyResult<bool> {
        self.scene.is_asleep(self.body_id(body)?).or_raise()
    }

    /// Mean relative change of edge lengths of a body, weighted by rest length.
    fn stretch_error(&self, body: usize) -> PyResult<f64> {
        let body = self.body(body)?;
        Ok(body.solver().stretch_error(body.surface()))
    }

    fn __repr__(&self) -> String {
        let (bodies, blades) = (self.bodies.len(), self.blades.len());
        format!("<incise.Scene: {bodies} bodies, {blades} blades>")
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
