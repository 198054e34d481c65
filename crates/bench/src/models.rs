//! The seven models: built in, or from files.

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

/// Returns the model of a name, in any case.
pub(crate) fn named(name: &str) -> Option<Model> {
    Model::ALL
        .into_iter()
        .find(|m| m.name().eq_ignore_ascii_case(name.trim()))
}

/// Loads the models that `only` names, or all; from `folder` where it has a file.
pub(crate) fn load(folder: Option<&Path>, only: &[String]) -> Result<Vec<Loaded>, Box<dyn Error>> {
    let mut wanted = Vec::new();
    for name in only {
        let names: Vec<&str> = Model::ALL.iter().map(|m| m.name()).collect();
        wanted
            .push(named(name).ok_or_else(|| {
                format!("'{name}' is not one of the models {}", names.join(", "))
            })?);
    }
    Model::ALL
        .into_iter()
        .filter(|m| wanted.is_empty() || wanted.contains(m))
        .map(|model| match folder {
            Some(folder) => from_folder(folder, model),
            None => Ok(built_in(model)),
        })
        .collect()
}

/// Prints the models, given by name and source, that a folder has no file for.
pub(crate) fn warn_built_in<'a>(
    folder: Option<&Path>,
    used: impl Iterator<Item = (&'a str, &'a str)>,
) {
    if let Some(told) = folder.and_then(|folder| built_in_of(folder, used)) {
        // Without an error output the column of sources tells.
        let _ = writeln!(io::stderr(), "incise-bench: {told}");
    }
}

fn built_in_of<'a>(
    folder: &Path,
    used: impl Iterator<Item = (&'a str, &'a str)>,
) -> Option<String> {
    let (built_in, files): (Vec<_>, Vec<_>) = used.partition(|&(_, source)| source == BUILT_IN);
    let names: Vec<&str> = built_in.iter().map(|&(name, _)| name).collect();
    (!names.is_empty()).then(|| {
        format!(
            "{}: {} for {}: built-in models are taken; a file's name has to begin with the \
             model's and to end with obj, ply, stl, glb or gltf",
            folder.display(),
            if files.is_empty() {
                "no usable file at all"
            } else {
                "no file"
            },
            names.join(", ")
        )
    })
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
    Ok(Loaded {
        model,
        source: path
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned(),
        vertices,
        surface,
    })
}

/// Returns the mesh files of a folder by name.
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
        let names = ["sphere20".to_owned(), "Sphere80".to_owned()];
        let loaded = load(Some(folder.path()), &names).unwrap();
        assert_eq!(loaded[0].source, "sphere_20.obj");
        assert_eq!(loaded[0].surface.topology().triangle_count(), 20);
        assert_eq!(loaded[1].source, "built-in", "no file is named sphere80");
        assert!(load(None, &["cow".to_owned()]).is_err());
        let used = |loaded: &[Loaded]| {
            let used = loaded.iter().map(|l| (l.model.name(), l.source.as_str()));
            built_in_of(folder.path(), used)
        };
        let told = used(&loaded).unwrap();
        assert!(told.contains(": no file for Sphere80: built-in"), "{told}");
        assert_eq!(used(&loaded[..1]), None, "nothing to tell");
        let told = used(&loaded[1..]).unwrap();
        assert!(
            told.contains("no usable file at all for Sphere80"),
            "{told}"
        );
    }
}
