//! Reports of the libraries as Python dictionaries.

use incise::cut::CutReport;
use incise::params::{Report, Value};
use incise::refine::FillReport;
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

/// Converts JSON to Python objects: the keys are those of the program's `--json`.
pub(crate) fn from_json<'py>(py: Python<'py>, json: &str) -> PyResult<Bound<'py, PyAny>> {
    py.import("json")?.call_method1("loads", (json,))
}

/// Converts a value to an object of Python.
pub(crate) fn to_python<'py>(py: Python<'py>, value: &Value) -> PyResult<Bound<'py, PyAny>> {
    match value {
        Value::None => Ok(py.None().into_bound(py)),
        Value::Flag(flag) => flag.into_bound_py_any(py),
        Value::Count(count) => count.into_bound_py_any(py),
        Value::Number(number) => number.into_bound_py_any(py),
        Value::Text(text) => text.into_bound_py_any(py),
        Value::List(values) => {
            let values = values.iter().map(|value| to_python(py, value));
            PyList::new(py, values.collect::<PyResult<Vec<_>>>()?)?.into_bound_py_any(py)
        }
        Value::Map(entries) => {
            let out = PyDict::new(py);
            for (name, value) in entries {
                out.set_item(name, to_python(py, value)?)?;
            }
            out.into_bound_py_any(py)
        }
    }
}

/// Returns counts and times of a cut; times are in seconds.
pub(crate) fn of_cut<'py>(py: Python<'py>, report: &CutReport) -> PyResult<Bound<'py, PyDict>> {
    Ok(to_python(py, &report.value())?.cast_into()?)
}

/// Returns the filled holes.
pub(crate) fn of_fill<'py>(py: Python<'py>, report: &FillReport) -> PyResult<Bound<'py, PyDict>> {
    let holes = PyList::empty(py);
    for hole in &report.holes {
        let out = PyDict::new(py);
        for (key, count) in [
            ("rim_edges", hole.rim_edges),
            ("triangles", hole.triangles.len()),
            ("inserted_vertices", hole.new_vertices),
            ("flat_triangles", hole.flat_triangles),
            ("slivers", hole.slivers),
        ] {
            out.set_item(key, count)?;
        }
        for (key, is_true) in [
            ("planar", hole.planar),
            ("faired", hole.faired),
            ("self_intersecting", hole.self_intersecting),
        ] {
            out.set_item(key, is_true)?;
        }
        for (key, number) in [
            ("min_angle_deg", hole.angles.min),
            ("median_angle_deg", hole.angles.median),
            ("mean_edge", hole.mean_edge),
            ("target", hole.target_edge),
        ] {
            out.set_item(key, number)?;
        }
        holes.append(out)?;
    }
    let out = PyDict::new(py);
    out.set_item("holes", holes)?;
    out.set_item("left_open", report.left_open)?;
    Ok(out)
}
