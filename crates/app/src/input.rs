//! Meshes and models by name.

use crate::failure::Failure;
use incise_mesh::{Model, Surface, build_model, read_mesh};
use std::io::{self, Write};
use std::path::Path;

/// A mesh by the name of its file, or a model by its own. What is to be cut has to be fit for it, anything else may have
/// holes.
pub(crate) fn surface(input: &Path, is_to_be_cut: bool) -> Result<Surface, Failure> {
    let named = |model: &Model| {
        let name = input.to_str();
        name.is_some_and(|name| name.eq_ignore_ascii_case(model.name()))
    };
    if let Some(model) = Model::ALL.into_iter().find(named)
        && !input.exists()
    {
        return Ok(build_model(model));
    }
    if !input.exists() && input.extension().is_none() {
        let path = input.to_owned();
        return Err(Failure::NoInput { path });
    }
    let data = read_mesh(input)?;
    let surface = if is_to_be_cut {
        data.into_surface()
    } else {
        data.into_open_surface()
    };
    let (surface, warnings) = surface.map_err(|source| Failure::NotFit {
        path: input.to_owned(),
        source,
    })?;
    for warning in &warnings {
        // Without an error output nobody is told.
        let _ = writeln!(io::stderr(), "incise: {}: {warning}", input.display());
    }
    Ok(surface)
}
