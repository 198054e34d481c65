//! [`FrameStats`]: counters and times of a frame for Python.

use crate::report::to_python;
use incise::params::{Field, Kind, Report, all_fields};
use incise::scene::FrameStats as LibraryStats;
use pyo3::exceptions::PyAttributeError;
use pyo3::prelude::*;

/// Counters and times [s] of one frame, by the names of the Rust library.
#[pyclass(frozen, module = "incise")]
#[derive(Debug)]
pub(crate) struct FrameStats(pub(crate) LibraryStats);

#[pymethods]
impl FrameStats {
    /// Time of everything that a cut needs [s].
    #[getter]
    fn cutting(&self) -> f64 {
        self.0.cutting().as_secs_f64()
    }

    fn __getattr__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let value = (self.0.get(name)).map_err(|e| PyAttributeError::new_err(e.to_string()))?;
        to_python(py, &value)
    }

    fn __dir__(&self) -> Vec<&'static str> {
        let all = all_fields(LibraryStats::FIELDS).into_iter();
        let is_value = |field: &&Field| !matches!(field.kind, Kind::Struct(_));
        let values = all.map(|(_, field)| field).filter(is_value);
        values.map(|field| field.name).chain(["cutting"]).collect()
    }

    fn __repr__(&self) -> String {
        format!(
            "<incise.FrameStats: {} cuts, {:.3} ms>",
            self.0.cuts,
            self.0.total().as_secs_f64() * 1e3
        )
    }
}
