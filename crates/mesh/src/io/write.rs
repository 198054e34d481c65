//! Writers of OBJ, PLY, STL and binary glTF.

#[cfg(feature = "gltf")]
mod glb;
mod obj;
mod ply;
mod stl;

#[cfg(feature = "gltf")]
pub use glb::AnimatedSurface;

use crate::io::{Warning, WriteError};
use crate::surface::Surface;
use std::borrow::Cow;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// Writes a surface as OBJ and returns warnings about the channels that OBJ cannot hold.
///
/// Positions have as many digits as `f32` needs; texture coordinates (`vt`) and normals (`vn`) are
/// written once for each distinct value. A channel `color` of vertices follows the coordinates, as
/// many programs read it, without alpha. If triangles have different materials
/// ([`Surface::material`]), `usemtl material_N` lines precede them, without a material library.
/// Free slots are skipped. The surface's origin is added to positions, which then have the digits
/// of `f64`.
///
/// # Errors
/// [`WriteError`]; an existing file is then unchanged.
pub fn write_obj(path: &Path, surface: &Surface) -> Result<Vec<Warning>, WriteError> {
    replace(path, |out| write_obj_to(out, surface))
}

/// Writes a surface as OBJ into memory or a stream, see [`write_obj`].
///
/// # Errors
/// Those of `out`; memory has none.
pub fn write_obj_to(out: &mut impl Write, surface: &Surface) -> io::Result<Vec<Warning>> {
    obj::write(&dense(surface), out)?;
    Ok(obj::dropped(surface))
}

/// Writes a surface as little-endian PLY with all attributes.
///
/// Positions, texture coordinates, normals, materials and channels keep every bit if
/// [`read_ply`](crate::read_ply) reads the file. Channels of vertices are properties of vertices:
/// `red green blue alpha` for `color`, `NAME_joint_I` and `NAME_weight_I` for skin weights, else
/// `NAME_I`, or `NAME` for a single number. Attributes of corners are lists of faces. Free slots
/// are skipped. Coordinates are doubles if the surface's origin is not zero. Channels whose names
/// have another meaning in PLY are left out; returns a warning about each.
///
/// # Errors
/// [`WriteError`]; an existing file is then unchanged.
pub fn write_ply(path: &Path, surface: &Surface) -> Result<Vec<Warning>, WriteError> {
    replace(path, |out| {
        ply::write(&dense(surface), out)?;
        Ok(ply::dropped(surface))
    })
}

/// Writes the triangles of a surface as binary STL, which holds positions alone.
///
/// The surface's origin is added to positions, which are then rounded to 32 bits. Returns warnings
/// about that and about all other attributes.
///
/// # Errors
/// [`WriteError`]; an existing file is then unchanged.
pub fn write_stl(path: &Path, surface: &Surface) -> Result<Vec<Warning>, WriteError> {
    replace(path, |out| {
        stl::write(surface, out)?;
        Ok(stl::dropped(surface))
    })
}

/// Writes surfaces as binary glTF 2.0 (`.glb`), a node of the given name each.
///
/// Vertices are split where attributes differ. Every material has a primitive and the name
/// `material_N`. The channel `color` becomes `COLOR_0`, `uv1` and further ones `TEXCOORD_1` and so
/// on, `skin` becomes `JOINTS_0` and `WEIGHTS_0`, and other channels of up to four numbers become
/// `_NAME`. Surfaces without normals and corners whose normal is zero get those of
/// [`RenderBuffers`](crate::RenderBuffers). The surface's origin is the translation of its node.
/// Returns warnings about channels that do not fit.
///
/// # Errors
/// [`WriteError`]; an existing file is then unchanged.
#[cfg(feature = "gltf")]
pub fn write_glb(path: &Path, surfaces: &[(&str, &Surface)]) -> Result<Vec<Warning>, WriteError> {
    replace(path, |out| write_glb_to(out, surfaces))
}

/// Writes surfaces as binary glTF 2.0 into memory or a stream, see [`write_glb`].
///
/// # Errors
/// Those of `out`, and [`io::ErrorKind::Other`] for 4 GiB and more; memory has no others.
#[cfg(feature = "gltf")]
pub fn write_glb_to(
    out: &mut impl Write,
    surfaces: &[(&str, &Surface)],
) -> io::Result<Vec<Warning>> {
    let nodes = surfaces.iter();
    let nodes = nodes.map(|&(name, surface)| AnimatedSurface::still(name, surface));
    glb::write(&nodes.collect::<Vec<_>>(), out)
}

/// Writes moving surfaces as binary glTF 2.0 (`.glb`) with one animation.
///
/// Nodes are those of [`write_glb`]. Shapes after the first one are morph targets with linear
/// interpolation, and a node is scaled to 0 while it is invisible. Surfaces with times have the
/// normals of [`RenderBuffers`](crate::RenderBuffers), since their own ones do not follow.
///
/// # Errors
/// [`WriteError`]; an existing file is then unchanged.
#[cfg(feature = "gltf")]
pub fn write_glb_animation(
    path: &Path,
    surfaces: &[AnimatedSurface<'_>],
) -> Result<Vec<Warning>, WriteError> {
    replace(path, |out| glb::write(surfaces, out))
}

/// Returns the surface without free slots and unused vertices.
fn dense(surface: &Surface) -> Cow<'_, Surface> {
    let topology = surface.topology();
    if topology.triangle_count() == topology.triangle_slots()
        && topology.vertices().count() == topology.vertex_slots()
    {
        return Cow::Borrowed(surface);
    }
    let mut surface = surface.clone();
    surface.compact();
    Cow::Owned(surface)
}

/// Writes a temporary file in the same folder, renames it to `path` and returns the result of
/// `write`.
fn replace<T>(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> io::Result<T>,
) -> Result<T, WriteError> {
    let attempt = || {
        let mut name = path
            .file_name()
            .ok_or(io::ErrorKind::InvalidFilename)?
            .to_owned();
        name.push(format!(".{}.part", std::process::id()));
        let part = path.with_file_name(name);
        let mut out = BufWriter::new(File::create(&part)?);
        let written = write(&mut out).and_then(|written| {
            out.into_inner().map_err(io::IntoInnerError::into_error)?;
            std::fs::rename(&part, path)?;
            Ok(written)
        });
        if written.is_err() {
            // Report the first error.
            let _ = std::fs::remove_file(&part);
        }
        written
    };
    attempt().map_err(|source| WriteError {
        path: path.to_owned(),
        source,
    })
}

#[cfg(test)]
mod tests;
