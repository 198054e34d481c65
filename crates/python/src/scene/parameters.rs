//! Keyword arguments of a [`Scene`](super::Scene) as its parameters.

use crate::arrays::vector;
use crate::error::{OrRaise, refused};
use crate::options::{CUT_OPTIONS, CutOptions, count, flag};
use crate::solver_options::{contacts, real, some};
use incise::pbd::SolverParams;
use incise::scene::{SceneParams, SleepParams};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::num::NonZeroUsize;

/// Parameters that keyword arguments have changed.
pub(super) struct SceneOptions {
    pub(super) params: SceneParams,
    pub(super) undo_limit: Option<usize>,
}

impl SceneOptions {
    /// Changes parameters by keyword arguments, and checks them.
    pub(super) fn read(
        mut params: SceneParams,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let mut cut = CutOptions::new(params.cut);
        let mut undo_limit = None;
        for (key, value) in options.into_iter().flatten() {
            let key: String = key.extract()?;
            let solver = &mut params.solver;
            match key.as_str() {
                "dt" => params.dt = real(&value, &key)?,
                "iterations" => solver.iterations = repeats(&value, &key)?,
                "substeps" => solver.substeps = repeats(&value, &key)?,
                "gravity" => {
                    let gravity = some(&value, |value| vector(value, &key))?;
                    solver.gravity = gravity.unwrap_or(SolverParams::default().gravity);
                }
                "ground" => solver.ground = some(&value, |value| real(value, &key))?,
                "contacts" => params.contacts = contacts(&value)?,
                "sleep" => params.sleep = flag(&value, &key)?.then(SleepParams::default),
                "skip_far_sweeps" => params.skip_far_sweeps = flag(&value, &key)?,
                "threads" => solver.threads = some(&value, threads)?,
                "diagonal_scale" => solver.diagonal_scale = real(&value, &key)?,
                "attachments" => solver.attachments = flag(&value, &key)?,
                "undo_limit" => undo_limit = Some(count(&value, &key)?),
                _ if cut.set(&key, &value)? => {}
                _ => {
                    return Err(PyTypeError::new_err(format!(
                        "unknown option '{key}'; options of a scene are dt, iterations, substeps, \
                         gravity, ground, contacts, sleep, skip_far_sweeps, threads, \
                         diagonal_scale, attachments, undo_limit, and those of cuts: {CUT_OPTIONS}"
                    )));
                }
            }
        }
        params.cut = cut.finish()?;
        params.check().or_raise()?;
        Ok(Self { params, undo_limit })
    }
}

/// Reads a number of iterations or substeps.
fn repeats(value: &Bound<'_, PyAny>, name: &str) -> PyResult<u32> {
    let number: i64 = value
        .extract()
        .map_err(|_| PyTypeError::new_err(format!("{name} is no count; pass an int")))?;
    let most = SolverParams::MAX_COUNT;
    u32::try_from(number).map_err(|_| refused(format_args!("{name} is {number}; pass 1 to {most}")))
}

/// Reads a number of threads.
fn threads(value: &Bound<'_, PyAny>) -> PyResult<NonZeroUsize> {
    let number: i64 = value
        .extract()
        .map_err(|_| PyTypeError::new_err("threads is no count; pass an int or None"))?;
    let threads = usize::try_from(number).ok().and_then(NonZeroUsize::new);
    threads.ok_or_else(|| {
        refused(format_args!(
            "threads is {number}; pass 1 or more, or None for all"
        ))
    })
}
