//! Files in and out: OBJ, PLY, STL and glTF are read, OBJ and PLY are written.
//!
//! A reader makes [`MeshData`], which is what the file says and requires nothing of it;
//! [`MeshData::into_surface`] then requires a body that can be cut. The readers are small enough to
//! be our own, so that every error names its line or element and no file, however broken, makes one
//! panic, allocate out of proportion to what it holds, or read a file outside its own folder.

mod build;
mod data;
mod error;
mod gltf;
mod obj;
mod ply;
mod polygon;
mod stl;
mod write;

pub use data::{MeshData, Warning};
pub use error::{ParseError, Place, ReadError, WriteError};
pub use gltf::read_gltf;
pub use obj::read_obj;
pub use ply::read_ply;
pub use stl::read_stl;
pub use write::{write_obj, write_ply};

use std::path::Path;

/// Reads a mesh. The file's extension, in any case, is its format: `obj`, `ply`, `stl`, `glb` or
/// `gltf`.
///
/// # Errors
/// [`ReadError`], which names the file and, where there is one, the line or element.
pub fn read_mesh(path: &Path) -> Result<MeshData, ReadError> {
    let extension = path
        .extension()
        .map(|e| e.to_string_lossy().to_ascii_lowercase());
    let parse: fn(&[u8], &Path) -> Result<MeshData, ParseError> = match extension.as_deref() {
        Some("obj") => |bytes, _| read_obj(bytes),
        Some("ply") => |bytes, _| read_ply(bytes),
        Some("stl") => |bytes, _| read_stl(bytes),
        Some("glb" | "gltf") => |bytes, folder| read_gltf(bytes, Some(folder)),
        _ => {
            return Err(ReadError::UnknownExtension {
                path: path.to_owned(),
            });
        }
    };
    let bytes = std::fs::read(path).map_err(|source| ReadError::File {
        path: path.to_owned(),
        source,
    })?;
    let folder = path.parent().unwrap_or(Path::new(""));
    parse(&bytes, folder).map_err(|source| ReadError::Parse {
        path: path.to_owned(),
        source,
    })
}

#[cfg(test)]
mod fuzz;
