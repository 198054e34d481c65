#![doc = include_str!("../README.md")]

mod arrays;
mod colliders;
mod cut;
mod error;
mod frame_stats;
mod mesh;
mod mesh_arrays;
mod model;
mod origins;
mod params;
mod report;
mod scene;
mod view;

use pyo3::prelude::*;

/// The compiled part of the Python package `incise`.
#[pymodule]
fn _incise(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add("__version__", env!("CARGO_PKG_VERSION"))?;
    m.add("MODELS", model::model_names(m.py())?)?;
    m.add_function(wrap_pyfunction!(model::model, m)?)?;
    m.add_class::<mesh::Mesh>()?;
    m.add_class::<cut::CutResult>()?;
    m.add_class::<scene::Scene>()?;
    m.add_class::<scene::RayHit>()?;
    m.add_class::<frame_stats::FrameStats>()?;
    error::add(m)
}
