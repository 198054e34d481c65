//! [`Scene`]: a simulation of Python, stepped frame by frame.

mod blades;
mod bodies;
mod parameters;

use crate::error::{OrRaise, SceneError, refused};
use crate::frame_stats::FrameStats;
use incise::mesh::geometry::round_to_f32;
use incise::scene::{Scene as LibraryScene, SceneParams, UndoStack};
use parameters::SceneOptions;
use pyo3::IntoPyObjectExt;
use pyo3::exceptions::PyOverflowError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyMemoryView};
use std::fmt::Display;

pub(crate) use bodies::RayHit;

/// Number of cuts that a scene can undo unless the caller sets another one.
const UNDO_LIMIT: usize = 256;

/// A simulation of soft bodies and blades, stepped frame by frame on the CPU.
///
/// Lengths are in meters, times in seconds, masses in kilograms; the y axis points up. Bodies and
/// blades are numbers that `add_body` and `add_blade` return.
///
/// Keywords are the parameters `SceneParams` of `docs/parameters.md` by their names, for example
/// `Scene(iterations=2, contacts={"thickness": 0.2}, level="2x-finer")`, and
/// `undo_limit`, the number of cuts that `undo` can undo. Nested names have underscores,
/// `contacts_thickness`. None is the default of a parameter, and no value of an optional one. The
/// results do not depend on `threads`.
///
/// One thread at a time may use a scene. Other threads of Python run during `step`.
#[pyclass(module = "incise")]
pub(crate) struct Scene {
    scene: LibraryScene,
    undo: UndoStack,
}

fn unknown(kind: &str, number: impl Display) -> PyErr {
    SceneError::new_err(format!("{kind} {number} does not exist"))
}

/// The number of a body, blade, vertex or piece.
#[derive(Clone, Copy)]
struct Number(usize);

impl<'py> FromPyObject<'_, 'py> for Number {
    type Error = PyErr;

    /// Reads an int; a negative or huge one is a `SceneError`, as is that of no object.
    fn extract(value: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        let is_too_large = |error: &PyErr| error.is_instance_of::<PyOverflowError>(value.py());
        value
            .extract()
            .map(Self)
            .map_err(|error: PyErr| match error {
                error if is_too_large(&error) => unknown("number", &*value),
                error => error,
            })
    }
}

#[pymethods]
impl Scene {
    #[new]
    #[pyo3(signature = (**options))]
    fn new(options: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let mut scene = Self {
            scene: LibraryScene::new(SceneParams::default()),
            undo: UndoStack::new(UNDO_LIMIT),
        };
        scene.set_params(options)?;
        Ok(scene)
    }

    /// Changes parameters from the next frame on, by the keywords of the constructor.
    ///
    /// Others stay. Raises Error, and nothing has changed.
    #[pyo3(signature = (**options))]
    fn set_params(&mut self, options: Option<&Bound<'_, PyDict>>) -> PyResult<()> {
        let options = SceneOptions::read(self.scene.params, options)?;
        self.scene.params = options.params;
        if let Some(limit) = options.undo_limit {
            self.undo.set_limit(limit);
        }
        Ok(())
    }

    /// Returns the scene as bytes: bodies, blades, colliders and parameters.
    ///
    /// The cuts that can be undone and `failed_cuts` are not part of it.
    fn save<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = self
            .scene
            .save()
            .map_err(|error| SceneError::new_err(error.to_string()))?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// Makes a scene of the bytes of `save`. It goes on with the same bits.
    ///
    /// Bodies and blades keep their numbers. `undo_limit` is not part of the bytes, which may also
    /// be a bytearray or memoryview. Raises `FileError` for other or damaged bytes.
    #[staticmethod]
    #[pyo3(
        signature = (bytes, undo_limit=UNDO_LIMIT),
        text_signature = "(bytes, undo_limit=256)"
    )]
    fn load(py: Python<'_>, bytes: &Bound<'_, PyAny>, undo_limit: usize) -> PyResult<Self> {
        let bytes = PyMemoryView::from(bytes)?.call_method0("tobytes")?;
        let bytes: &[u8] = bytes.extract()?;
        Ok(Self {
            scene: py.detach(|| LibraryScene::load(bytes).or_raise())?,
            undo: UndoStack::new(undo_limit),
        })
    }

    /// Pickles and copies the scene by `save`, without the cuts that can be undone.
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        let bytes = slf.borrow_mut().save(py)?;
        let limit = slf.borrow().undo.limit();
        let load = slf.get_type().getattr("load")?;
        (load, (bytes, limit)).into_bound_py_any(py)
    }

    /// The point to which all coordinates of the scene are relative [m], (x, y, z): that of its
    /// first body; zero without bodies.
    #[getter]
    fn origin(&self) -> (f64, f64, f64) {
        self.scene.origin().into()
    }

    /// Steps by one frame of `dt` [s], by default that of the scene: cuts, then motion.
    ///
    /// Later frames have the `dt` of the scene again. A cut that fails raises nothing, see
    /// `failed_cuts`. Raises `SceneError` for a body that cannot be stepped; the cuts of the frame
    /// may be done then.
    #[pyo3(signature = (dt=None))]
    fn step(&mut self, py: Python<'_>, dt: Option<f64>) -> PyResult<FrameStats> {
        let usual = self.scene.params.dt;
        let params = SceneParams {
            dt: dt.map_or(usual, round_to_f32),
            ..self.scene.params
        };
        params.check().or_raise()?;
        self.scene.params = params;
        let Self { scene, undo } = self;
        let stats = py.detach(|| undo.step(scene).map(|stats| FrameStats(*stats)));
        scene.params.dt = usual;
        stats.or_raise()
    }

    /// Cuts that failed in the last frame: blade, body and reason.
    #[getter]
    fn failed_cuts(&self) -> Vec<(usize, usize, String)> {
        let failed = self.scene.failed_cuts().iter();
        let number = |cut: &incise::scene::FailedCut| {
            let blade = self.scene.blades().position(|blade| blade == cut.blade)?;
            Some((blade, cut.body.index(), cut.error.to_string()))
        };
        failed.filter_map(number).collect()
    }

    /// Undoes the last cut of a body, or the last cut of all. One frame of a blade is one cut.
    ///
    /// The faces from before the cut return. Vertices stay where they are, except that pieces that
    /// have moved apart move together. Incisions in the body end. Raises `SceneError`.
    #[pyo3(signature = (body=None))]
    fn undo(&mut self, py: Python<'_>, body: Option<Number>) -> PyResult<()> {
        let last = || self.undo.bodies().next_back();
        let body = match body {
            Some(body) => self.body_id(body)?,
            None => last().ok_or_else(|| refused("there is no cut to undo"))?,
        };
        let Self { scene, undo } = self;
        py.detach(|| undo.undo(scene, body)).or_raise()
    }

    /// Number of cuts that `undo` can undo, of all bodies or of one.
    #[pyo3(signature = (body=None))]
    fn undo_count(&self, body: Option<Number>) -> PyResult<usize> {
        let id = body.map(|body| self.body_id(body)).transpose()?;
        let cuts = self.undo.bodies();
        Ok(cuts.filter(|&of| id.is_none_or(|id| id == of)).count())
    }

    fn __repr__(&self) -> String {
        let (bodies, blades) = (self.scene.bodies().count(), self.scene.blades().count());
        format!("<incise.Scene: {bodies} bodies, {blades} blades>")
    }
}
