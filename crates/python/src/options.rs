//! Keyword arguments of cuts as [`CutParams`]. Names and values are those of `incise cut`.

use crate::error::{OrRaise, refused};
use incise::cut::{Caps, CutMethod, CutParams, ExactParams, PaperParams};
use incise::refine::{RefineMethod, RefinementLevel};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Names of the options of a cut.
pub(crate) const CUT_OPTIONS: &str =
    "level, method, refine_method, snap, remesh, grading, caps and max_triangles";

/// Reads the options of a cut.
pub(crate) fn cut_params(options: Option<&Bound<'_, PyDict>>) -> PyResult<CutParams> {
    let mut cut = CutOptions::new(CutParams::default());
    for (key, value) in options.into_iter().flatten() {
        let key: String = key.extract()?;
        if !cut.set(&key, &value)? {
            return Err(PyTypeError::new_err(format!(
                "unknown option '{key}'; options of a cut are {CUT_OPTIONS}"
            )));
        }
    }
    cut.finish()
}

/// Parameters of cuts while keyword arguments change them.
pub(crate) struct CutOptions {
    params: CutParams,
    exact: ExactParams,
    is_paper: bool,
    /// The last option that was given and the paper's method does not have.
    exact_only: Option<String>,
}

impl CutOptions {
    /// Starts with parameters, which options replace one by one.
    pub(crate) fn new(params: CutParams) -> Self {
        let (exact, is_paper) = match params.method {
            CutMethod::Exact(exact) => (exact, false),
            CutMethod::Paper(_) => (ExactParams::default(), true),
        };
        Self {
            params,
            exact,
            is_paper,
            exact_only: None,
        }
    }

    /// Reads an option; false if a cut has none of this name.
    pub(crate) fn set(&mut self, key: &str, value: &Bound<'_, PyAny>) -> PyResult<bool> {
        let Self { params, exact, .. } = self;
        let mut is_exact_only = false;
        match key {
            "level" => params.refine.level = level(value)?,
            "method" => self.is_paper = choice(value, key, &[("exact", false), ("paper", true)])?,
            "refine_method" => {
                let methods = [
                    ("delaunay", RefineMethod::Delaunay),
                    ("paper", RefineMethod::Paper),
                ];
                params.refine.method = choice(value, key, &methods)?;
                is_exact_only = params.refine.method == RefineMethod::Delaunay;
            }
            "snap" => (exact.snap, is_exact_only) = (number(value, key)?, true),
            "remesh" => (exact.remesh, is_exact_only) = (number(value, key)?, true),
            "grading" => (params.refine.grading, is_exact_only) = (number(value, key)?, true),
            "max_triangles" => params.refine.max_triangles = count(value, key)?,
            "caps" => {
                let caps = [
                    ("bodies", Caps::Bodies),
                    ("all-loops", Caps::AllLoops),
                    ("none", Caps::None),
                ];
                (params.caps, is_exact_only) = (choice(value, key, &caps)?, true);
            }
            _ => return Ok(false),
        }
        if is_exact_only {
            self.exact_only = Some(key.to_owned());
        }
        Ok(true)
    }

    /// Returns the parameters, which are checked.
    pub(crate) fn finish(self) -> PyResult<CutParams> {
        let mut params = self.params;
        params.method = match (self.is_paper, self.exact_only) {
            (true, Some(option)) => {
                return Err(refused(format_args!(
                    "{option} has no meaning with method 'paper'; leave it out"
                )));
            }
            (true, None) => CutMethod::Paper(PaperParams::default()),
            (false, _) => CutMethod::Exact(self.exact),
        };
        params.check().or_raise()?;
        Ok(params)
    }
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

/// Reads a yes or no.
pub(crate) fn flag(value: &Bound<'_, PyAny>, name: &str) -> PyResult<bool> {
    let flag = value.extract();
    flag.map_err(|_| PyTypeError::new_err(format!("{name} is no bool; pass True or False")))
}
