//! Keyword arguments of cuts as [`CutParams`]. Names and values are those of `incise cut`.

use crate::error::refused;
use incise::cut::{Caps, CutMethod, CutParams, ExactParams, PaperParams};
use incise::refine::{RefineMethod, RefineParams, RefinementLevel};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Names of the options that only the exact method has.
const EXACT_ONLY: [&str; 4] = ["snap", "remesh", "grading", "caps"];

/// Reads the options of a cut.
pub(crate) fn cut_params(options: Option<&Bound<'_, PyDict>>) -> PyResult<CutParams> {
    let mut params = CutParams::default();
    let Some(options) = options else {
        return Ok(params);
    };
    let (mut exact, mut is_paper) = (ExactParams::default(), false);
    let mut refine_method = None;
    for (key, value) in options {
        let key: String = key.extract()?;
        match key.as_str() {
            "level" => params.refine.level = level(&value)?,
            "method" => is_paper = choice(&value, &key, &[("exact", false), ("paper", true)])?,
            "refine_method" => {
                let methods = [
                    ("delaunay", RefineMethod::Delaunay),
                    ("paper", RefineMethod::Paper),
                ];
                refine_method = Some(choice(&value, &key, &methods)?);
            }
            "snap" => exact.snap = number(&value, &key)?,
            "remesh" => exact.remesh = number(&value, &key)?,
            "grading" => params.refine.grading = number(&value, &key)?,
            "max_triangles" => params.refine.max_triangles = count(&value, &key)?,
            "caps" => {
                let caps = [
                    ("bodies", Caps::Bodies),
                    ("all-loops", Caps::AllLoops),
                    ("none", Caps::None),
                ];
                params.caps = choice(&value, &key, &caps)?;
            }
            _ => {
                return Err(PyTypeError::new_err(format!(
                    "unknown option '{key}'; options of a cut are level, method, refine_method, \
                     snap, remesh, grading, caps and max_triangles"
                )));
            }
        }
    }
    if is_paper {
        for option in EXACT_ONLY {
            if options.contains(option)? {
                return Err(refused(format_args!(
                    "{option} has no meaning with method 'paper'; leave it out"
                )));
            }
        }
        if refine_method == Some(RefineMethod::Delaunay) {
            return Err(refused(
                "method 'paper' has the paper's refinement; leave refine_method out",
            ));
        }
    }
    check_grading(&params.refine)?;
    params.refine.method = refine_method.unwrap_or_default();
    params.method = if is_paper {
        CutMethod::Paper(PaperParams::default())
    } else {
        CutMethod::Exact(exact)
    };
    Ok(params)
}

fn check_grading(refine: &RefineParams) -> PyResult<()> {
    if refine.grading >= 0.0 && refine.grading.is_finite() {
        return Ok(());
    }
    Err(refused(format_args!(
        "grading is {}; pass 0 or a positive number",
        refine.grading
    )))
}

/// Reads a refinement level: a name or a number.
pub(crate) fn level(value: &Bound<'_, PyAny>) -> PyResult<RefinementLevel> {
    let text = match value.extract::<f64>() {
        Ok(z) => z.to_string(),
        Err(_) => value.extract::<String>().map_err(|_| {
            PyTypeError::new_err("level is neither a name nor a number; pass 'original' or 1.0")
        })?,
    };
    text.parse().map_err(refused)
}

/// Reads a number.
pub(crate) fn number(value: &Bound<'_, PyAny>, name: &str) -> PyResult<f64> {
    let number = value.extract();
    number.map_err(|_| PyTypeError::new_err(format!("{name} is no number; pass a float")))
}

/// Reads a count.
pub(crate) fn count(value: &Bound<'_, PyAny>, name: &str) -> PyResult<usize> {
    let count = value.extract();
    count.map_err(|_| PyTypeError::new_err(format!("{name} is no count; pass an int of 0 or more")))
}

/// Reads one of a few names.
pub(crate) fn choice<T: Copy>(
    value: &Bound<'_, PyAny>,
    option: &str,
    choices: &[(&str, T)],
) -> PyResult<T> {
    let text: String = value
        .extract()
        .map_err(|_| PyTypeError::new_err(format!("{option} is no text; pass a str")))?;
    if let Some(&(_, found)) = choices.iter().find(|(name, _)| *name == text) {
        return Ok(found);
    }
    let names: Vec<&str> = choices.iter().map(|(name, _)| *name).collect();
    Err(refused(format_args!(
        "{option} is '{text}'; pass one of {}",
        names.join(", ")
    )))
}
