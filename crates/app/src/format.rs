//! Formats of written meshes.

use crate::failure::Failure;
use clap::ValueEnum;
use incise_mesh::{Surface, Warning, WriteError, write_glb, write_obj, write_ply, write_stl};
use serde::Deserialize;
use std::path::Path;

/// A format of mesh files that can be written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Format {
    /// Wavefront OBJ: texture coordinates, normals, materials, vertex colors.
    #[default]
    Obj,
    /// Binary PLY: all attributes.
    Ply,
    /// Binary STL: positions alone.
    Stl,
    /// Binary glTF: all attributes that glTF has a place for.
    Glb,
}

impl Format {
    pub(crate) const ALL: [Self; 4] = [Self::Obj, Self::Ply, Self::Stl, Self::Glb];

    /// Returns the format of a file's extension.
    pub(crate) fn of_file(path: &Path) -> Result<Self, Failure> {
        let extension = path
            .extension()
            .map(|e| e.to_string_lossy().to_ascii_lowercase());
        let extension = extension.unwrap_or_default();
        let found = Self::ALL
            .into_iter()
            .find(|format| format.extension() == extension);
        found.ok_or_else(|| Failure::OutputFormat {
            path: path.to_owned(),
        })
    }

    pub(crate) fn extension(self) -> &'static str {
        match self {
            Self::Obj => "obj",
            Self::Ply => "ply",
            Self::Stl => "stl",
            Self::Glb => "glb",
        }
    }

    /// Writes a surface and returns warnings about attributes that the format cannot hold.
    pub(crate) fn write(self, path: &Path, surface: &Surface) -> Result<Vec<Warning>, WriteError> {
        match self {
            Self::Obj => write_obj(path, surface),
            Self::Ply => write_ply(path, surface),
            Self::Stl => write_stl(path, surface),
            Self::Glb => {
                let name = path.file_stem().unwrap_or_default().to_string_lossy();
                write_glb(path, &[(&name, surface)])
            }
        }
    }
}
