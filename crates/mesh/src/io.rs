//! Mesh files: reads and writes OBJ, PLY, STL and glTF.
//!
//! A reader returns [`MeshData`], the welded content of the file; [`MeshData::into_surface`] then
//! requires a body that can be cut. Every error names its line or element. No file, however broken,
//! causes a panic, allocates out of proportion to its size, or makes a reader open a file outside
//! its folder.

mod build;
mod channels;
mod data;
mod error;
#[cfg(feature = "gltf")]
mod gltf;
mod obj;
mod origin;
mod ply;
mod polygon;
mod stl;
mod write;

pub use data::{MeshData, Warning};
pub use error::{ParseError, ReadError, SourceLocation, WriteError};
#[cfg(feature = "gltf")]
pub use gltf::read_gltf;
pub use obj::read_obj;
pub use origin::nearby_origin;
pub use ply::read_ply;
pub use stl::read_stl;
#[cfg(feature = "gltf")]
pub use write::{AnimatedSurface, write_glb, write_glb_animation, write_glb_to};
pub use write::{write_obj, write_obj_to, write_ply, write_stl};

use std::path::Path;

/// Reads a mesh in the format of the file's extension: `obj`, `ply`, `stl`, `glb` or `gltf`.
///
/// # Errors
/// [`ReadError`] with the file and, if known, the line or element.
pub fn read_mesh(path: &Path) -> Result<MeshData, ReadError> {
    let extension = path
        .extension()
        .map(|e| e.to_string_lossy().to_ascii_lowercase());
    let parse: fn(&[u8], &Path) -> Result<MeshData, ParseError> = match extension.as_deref() {
        Some("obj") => |bytes, _| read_obj(bytes),
        Some("ply") => |bytes, _| read_ply(bytes),
        Some("stl") => |bytes, _| read_stl(bytes),
        #[cfg(feature = "gltf")]
        Some("glb" | "gltf") => |bytes, folder| read_gltf(bytes, Some(folder)),
        #[cfg(not(feature = "gltf"))]
        Some("glb" | "gltf") => |_, _| {
            let what = "glTF without the feature `gltf` of incise-mesh";
            Err(ParseError::Unsupported { what })
        },
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
    if bytes.is_empty() {
        return Err(ReadError::Parse {
            path: path.to_owned(),
            source: ParseError::Empty,
        });
    }
    let folder = path.parent().unwrap_or(Path::new(""));
    parse(&bytes, folder).map_err(|source| ReadError::Parse {
        path: path.to_owned(),
        source,
    })
}

/// Returns the number in a material name of the writers, `material_N`; 0 for other names.
fn material_number(name: &[u8]) -> u32 {
    let digits = name.strip_prefix(b"material_");
    digits
        .and_then(|digits| std::str::from_utf8(digits).ok())
        .and_then(|digits| digits.parse().ok())
        .unwrap_or(0)
}

#[cfg(test)]
mod tests;
