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
    name: impl Fn(&T) -> &str,
    only: &[String],
) -> Result<Vec<T>, String> {
    let is = |item: &T, wanted: &String| name(item).eq_ignore_ascii_case(wanted.trim());
    if let Some(unknown) = (only.iter()).find(|wanted| !all.iter().any(|item| is(item, wanted))) {
        let mut names: Vec<&str> = all.iter().map(&name).collect();
        names.dedup();
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
    let models = named(Model::ALL.to_vec(), |m| m.name(), &arguments.only)?;
    let folder = arguments.models.as_deref();
    let loaded = models.into_iter().map(|model| load_model(folder, model));
    loaded.collect()
}

/// Loads a model; from the folder if it has a file.
///
/// # Errors
/// A message for an unreadable file.
pub(crate) fn load_model(folder: Option<&Path>, model: Model) -> Result<Loaded, Box<dyn Error>> {
    let found = folder.map(|folder| find_file(folder, model)).transpose()?;
    if let Some((path, data)) = found.flatten() {
        let vertices = data.file_vertices;
        let (mut surface, _) = data
            .into_surface()
            .map_err(|error| format!("{}: {error}", path.display()))?;
        surface.sort_by_position();
        let file = path.file_name().unwrap_or_default();
        return Ok(Loaded {
            model,
            source: file.to_string_lossy().into_owned(),
            vertices,
            surface,
        });
    }
    if let Some(folder) = folder {
        // Without an error output the field `source` tells.
        let (folder, name) = (folder.display(), model.name());
        let _ = writeln!(
            io::stderr(),
            "incise-bench: {folder}: no file for {name}: the built-in model is taken; a file's \
             name has to begin with the model's and to end with obj, ply, stl, glb or gltf"
        );
    }
    let mut surface = build_model(model);
    surface.sort_by_position();
    Ok(Loaded {
        model,
        source: BUILT_IN.to_owned(),
        vertices: surface.seam_split_vertices(),
        surface,
    })
}

/// Reads the file whose name begins with the model's and whose triangle count is closest to the
/// paper's, then vertex count, then name.
fn find_file(folder: &Path, model: Model) -> Result<Option<(PathBuf, MeshData)>, Box<dyn Error>> {
    let mut candidates = Vec::new();
    for path in files(folder)? {
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        if plain(&stem).starts_with(&plain(model.name())) {
            let data = read_mesh(&path)?;
            candidates.push((path, data));
        }
    }
    // Files are in the order of their names, and the first of several minima is taken.
    Ok(candidates.into_iter().min_by_key(|(_, data)| {
        let triangles = data.triangles.len().abs_diff(model.triangles());
        let vertices = data.file_vertices.abs_diff(model.vertices());
        (triangles, vertices)
    }))
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
        let known = ["obj", "ply", "stl", "glb", "gltf"];
        if known.iter().any(|e| extension == *e) {
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
