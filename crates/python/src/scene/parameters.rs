//! Keyword arguments of a [`Scene`](super::Scene) as its parameters.

use crate::error::OrRaise;
use crate::params;
use incise::scene::SceneParams;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

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
        let options = options.map(|options| options.copy()).transpose()?;
        let mut undo_limit = None;
        if let Some(options) = &options
            && let Some(limit) = options.get_item("undo_limit")?
        {
            undo_limit = Some(limit.extract().map_err(|_| {
                PyTypeError::new_err("undo_limit is no count; pass an int of 0 or more")
            })?);
            options.del_item("undo_limit")?;
        }
        params::set(&mut params, options.as_ref())?;
        params.check().or_raise()?;
        Ok(Self { params, undo_limit })
    }
}
