//! The seven models: built in, or from files.

use crate::options::ModelArguments;
use incise_mesh::{MeshData, Surface, read_mesh};
use incise_models::{Model, build_model};
use std::error::Error;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Source of a built-in model.
pub(crate) const BUILT_IN: &str = "built-in";

/// A model with its surface.
pub(crate) struct Loaded {
    pub(crate) model: Model,
    /// `built-in`, or the file's name.
    pub(crate) source: String,
    /// Number of vertices with normals and texture seams, as a renderer counts them.
    pub(crate) vertices: usize,
    /// In the order of [`Surface::sort_by_position`].
    pub(crate) surface: Surface,
}

/// Keeps the items that `only` names in any case, or all without names.
///
/// # Errors
/// A message for an unknown name.
pub(crate) fn named<T>(
    mut all: Vec<T>,
    name: impl Fn(&T) -> String,
    only: &[String],
) -> Result<Vec<T>, String> {
    let is = |item: &T, wanted: &String| name(item).eq_ignore_ascii_case(wanted.trim());
    if let Some(unknown) = (only.iter()).find(|wanted| !all.iter().any(|item| is(item, wanted))) {
        let names: Vec<String> = all.iter().map(&name).collect();
        return Err(format!("'{unknown}' is none of {}", names.join(", ")));
    }
    all.retain(|item| only.is_empty() || only.iter().any(|wanted| is(item, wanted)));
    Ok(all)
}

/// Loads the named models, or all; from the folder where it has a file.
///
/// # Errors
/// A message for an unknown name or an unreadable file.
pub(crate) fn load(arguments: &ModelArguments) -> Result<Vec<Loaded>, Box<dyn Error>> {
    let models = named(
        Model::ALL.to_vec(),
        |m| m.name().to_owned(),
        &arguments.only,
    )?;
    let folder = arguments.models.as_deref();
    let loaded = models.into_iter().map(|model| load_model(folder, model));
    loaded.collect()
}

/// Loads a model; from the folder if it has a file.
///
/// # Errors
/// A message for an unreadable file.
pub(crate) fn load_model(folder: Option<&Path>, model: Model) -> Result<Loaded, Box<dyn Error>> {
    let Some(folder) = folder else {
        return Ok(built_in(model));
    };
    let loaded = from_folder(folder, model)?;
    if loaded.source == BUILT_IN {
        // Without an error output the field `source` tells.
        let (folder, name) = (folder.display(), model.name());
        let _ = writeln!(
            io::stderr(),
            "incise-bench: {folder}: no file for {name}: the built-in model is taken; a file's \
             name has to begin with the model's and to end with obj, ply, stl, glb or gltf"
        );
    }
    Ok(loaded)
}

fn built_in(model: Model) -> Loaded {
    let mut surface = build_model(model);
    surface.sort_by_position();
    Loaded {
        model,
        source: BUILT_IN.to_owned(),
        vertices: surface.seam_split_vertices(),
        surface,
    }
}

/// Loads the file whose name begins with the model's and whose triangle count is closest to the
/// paper's, then vertex count, then name; the built-in model without one.
fn from_folder(folder: &Path, model: Model) -> Result<Loaded, Box<dyn Error>> {
    let mut candidates = Vec::new();
    for path in files(folder)? {
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        if !plain(&stem).starts_with(&plain(model.name())) {
            continue;
        }
        let data = read_mesh(&path)?;
        let off = |have: usize, want: usize| have.abs_diff(want);
        candidates.push((
            off(data.triangles.len(), model.triangles()),
            off(data.file_vertices, model.vertices()),
            path,
            data,
        ));
    }
    candidates.sort_by(|x, y| (x.0, x.1, &x.2).cmp(&(y.0, y.1, &y.2)));
    match candidates.into_iter().next() {
        Some((_, _, path, data)) => from_data(model, &path, data),
        None => Ok(built_in(model)),
    }
}

fn from_data(model: Model, path: &Path, data: MeshData) -> Result<Loaded, Box<dyn Error>> {
    let vertices = data.file_vertices;
    let (mut surface, _) = data
        .into_surface()
        .map_err(|error| format!("{}: {error}", path.display()))?;
    surface.sort_by_position();
    let file = path.file_name().unwrap_or_default();
    Ok(Loaded {
        model,
        source: file.to_string_lossy().into_owned(),
        vertices,
        surface,
    })
}

/// Returns the mesh files of a folder by name.
///
/// # Errors
/// A message for an unreadable folder.
pub(crate) fn files(folder: &Path) -> Result<Vec<PathBuf>, Box<dyn Error>> {
    let entries =
        std::fs::read_dir(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let mut paths = Vec::new();
    for entry in entries {
        let path = entry?.path();
        let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
        if ["obj", "ply", "stl", "glb", "gltf"]
            .iter()
            .any(|e| extension == *e)
        {
            paths.push(path);
        }
    }
    paths.sort();
    Ok(paths)
}

/// Removes case and punctuation: `sphere_20.obj` matches Sphere20, and so does `sphere_20k.obj`,
/// which has another triangle count.
fn plain(name: &str) -> String {
    name.chars()
        .filter(char::is_ascii_alphanumeric)
        .map(|c| c.to_ascii_lowercase())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use incise_mesh::write_obj;

    #[test]
    fn the_file_with_the_right_count_is_taken() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, model| {
            write_obj(&folder.path().join(name), &build_model(model)).unwrap();
        };
        write("sphere_20.obj", Model::Sphere20);
        write("sphere_20_fine.obj", Model::Sphere80);
        write("other.obj", Model::Sphere80);
        let [few, many] =
            [Model::Sphere20, Model::Sphere80].map(|m| load_model(Some(folder.path()), m).unwrap());
        assert_eq!(few.source, "sphere_20.obj");
        assert_eq!(few.surface.topology().triangle_count(), 20);
        assert_eq!(many.source, BUILT_IN, "no file is named sphere80");
    }
}
