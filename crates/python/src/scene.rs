//! [`Scene`]: a simulation of Python, stepped frame by frame.

mod blades;
mod bodies;
mod parameters;

use crate::error::{OrRaise, SceneError, refused};
use crate::frame_stats::FrameStats;
use incise::mesh::geometry::round_to_f32;
use incise::scene::{Scene as LibraryScene, SceneParams, UndoStack};
use parameters::SceneOptions;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

pub(crate) use bodies::RayHit;

/// Number of cuts that a scene can undo unless the caller sets another one.
const UNDO_LIMIT: usize = 256;

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
/// `undo_limit` : int
///     Number of cuts that `undo` can undo.
/// **options
///     Options of cuts, see `Mesh.cut`.
///
/// One thread at a time may use a scene. Other threads of Python run during `step`.
#[pyclass(module = "incise")]
pub(crate) struct Scene {
    scene: LibraryScene,
    undo: UndoStack,
}

fn unknown(kind: &str, number: usize) -> PyErr {
    SceneError::new_err(format!("{kind} {number} does not exist"))
}

#[pymethods]
impl Scene {
    #[new]
    #[pyo3(
        signature = (**options),
        text_signature = "(*, dt=1/60, iterations=1, substeps=16, gravity=None, ground=None, \
            contacts=None, sleep=True, skip_far_sweeps=True, threads=None, diagonal_scale=0.5, \
            attachments=True, undo_limit=256, **options)"
    )]
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
    /// Bodies and blades keep their numbers. Raises `FileError` for other or damaged bytes.
    #[staticmethod]
    fn load(py: Python<'_>, bytes: &[u8]) -> PyResult<Self> {
        Ok(Self {
            scene: py.detach(|| LibraryScene::load(bytes).or_raise())?,
            undo: UndoStack::new(UNDO_LIMIT),
        })
    }

    /// Pickles and copies the scene by `save`, without the cuts that can be undone.
    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, PyBytes>,))> {
        let bytes = slf.borrow_mut().save(slf.py())?;
        Ok((slf.get_type().getattr("load")?, (bytes,)))
    }

    /// Steps by one frame of `dt` [s], by default that of the scene: cuts, then motion.
    ///
    /// A cut that fails raises nothing, see `failed_cuts`. Raises `SceneError` for a body that
    /// cannot be stepped.
    #[pyo3(signature = (dt=None))]
    fn step(&mut self, py: Python<'_>, dt: Option<f64>) -> PyResult<FrameStats> {
        if let Some(dt) = dt.map(round_to_f32) {
            let params = SceneParams {
                dt,
                ..self.scene.params
            };
            params.check().or_raise()?;
            self.scene.params = params;
        }
        let Self { scene, undo } = self;
        py.detach(|| undo.step(scene).map(FrameStats::new))
            .or_raise()
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
    fn undo(&mut self, py: Python<'_>, body: Option<usize>) -> PyResult<()> {
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
    fn undo_count(&self, body: Option<usize>) -> PyResult<usize> {
        let id = body.map(|body| self.body_id(body)).transpose()?;
        let cuts = self.undo.bodies();
        Ok(cuts.filter(|&of| id.is_none_or(|id| id == of)).count())
    }

    fn __repr__(&self) -> String {
        let (bodies, blades) = (self.scene.bodies().count(), self.scene.blades().count());
        format!("<incise.Scene: {bodies} bodies, {blades} blades>")
    }
}
