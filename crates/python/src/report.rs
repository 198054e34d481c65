//! Reports of the libraries as Python dictionaries.

use incise::cut::CutReport;
use incise::refine::FillReport;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

/// Converts JSON to Python objects: the keys are those of the program's `--json`.
pub(crate) fn from_json<'py>(py: Python<'py>, json: &str) -> PyResult<Bound<'py, PyAny>> {
    py.import("json")?.call_method1("loads", (json,))
}

/// Returns counts and times of a cut; times are in seconds.
pub(crate) fn of_cut<'py>(py: Python<'py>, report: &CutReport) -> PyResult<Bound<'py, PyDict>> {
    let out = PyDict::new(py);
    for (key, count) in [
        ("candidates", report.candidates),
        ("triangles_hit", report.hits),
        ("loops", report.loops),
        ("slits", report.slits),
        ("snapped_vertices", report.snapped_vertices),
        ("merged_points", report.merged_nodes),
        ("flipped_edges", report.flipped_edges),
        ("collapsed_vertices", report.collapsed_vertices),
        ("collapsed_points", report.collapsed_nodes),
        ("short_rim_edges", report.short_rim_edges),
    ] {
        out.set_item(key, count)?;
    }
    out.set_item("moved_surface", report.moved_surface)?;
    out.set_item("moved_volume", report.moved_volume)?;
    out.set_item("refined", report.refined)?;
    let seconds = PyDict::new(py);
    for (key, time) in [
        ("detection", report.detection),
        ("split", report.split),
        ("remeshing", report.remeshing),
        ("cap", report.cap),
        ("refinement", report.refinement),
        ("separation", report.separation),
        ("commit", report.commit),
        ("bvh_update", report.bvh_update),
        ("total", report.total()),
    ] {
        seconds.set_item(key, time.as_secs_f64())?;
    }
    out.set_item("seconds", seconds)?;
    Ok(out)
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
            ("self_crossing", hole.self_intersecting),
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
