//! The built-in models of the paper's table.

use crate::error::refused;
use crate::mesh::Mesh;
use crate::mesh_arrays::MeshArrays;
use incise_models::{Model, build_model};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

/// Returns the names of the built-in models.
pub(crate) fn model_names(py: Python<'_>) -> PyResult<Bound<'_, PyTuple>> {
    PyTuple::new(py, Model::ALL.map(Model::name))
}

/// Builds one of the models of the paper's table, by its name in any case; see `MODELS`.
///
/// The models are generated and have the same bits on every machine. Spheres have a radius of
/// 0.5 m, the others a bounding box with a diagonal of 1 m around the origin.
#[pyfunction]
pub(crate) fn model(py: Python<'_>, name: &str) -> PyResult<Mesh> {
    let found = Model::ALL
        .into_iter()
        .find(|model| model.name().eq_ignore_ascii_case(name));
    let Some(model) = found else {
        let names = Model::ALL.map(Model::name).join(", ");
        return Err(refused(format_args!(
            "'{name}' is no built-in model; pass one of {names}"
        )));
    };
    Ok(py.detach(|| Mesh::from_arrays(MeshArrays::from_surface(&build_model(model)))))
}
