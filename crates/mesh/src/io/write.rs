//! Writers of OBJ and PLY.

use crate::ids::{TriangleId, VertexId};
use crate::io::WriteError;
use crate::surface::Surface;
use std::borrow::Cow;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// Writes a surface as OBJ.
///
/// Positions have as many digits as `f32` needs; texture coordinates (`vt`) and normals (`vn`) are
/// written once for each distinct value. If triangles have different materials
/// ([`Surface::material`]), `usemtl material_N` lines precede them, without a material library.
/// Free slots are skipped. The surface's origin is added to positions, which then have the digits
/// of `f64`.
///
/// # Errors
/// [`WriteError`]; an existing file is then unchanged.
pub fn write_obj(path: &Path, surface: &Surface) -> Result<(), WriteError> {
    replace(path, |out| obj(&dense(surface), out))
}

/// Writes a surface as little-endian PLY, with texture coordinates as the faces' `texcoord`.
///
/// Normals and free slots are skipped. Coordinates are doubles if the surface's origin is not zero.
///
/// # Errors
/// [`WriteError`]; an existing file is then unchanged.
pub fn write_ply(path: &Path, surface: &Surface) -> Result<(), WriteError> {
    replace(path, |out| ply(&dense(surface), out))
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

/// Writes a temporary file in the same folder and renames it to `path`.
fn replace(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<(), WriteError> {
    let attempt = || {
        let mut name = path
            .file_name()
            .ok_or(io::ErrorKind::InvalidFilename)?
            .to_owned();
        name.push(format!(".{}.part", std::process::id()));
        let part = path.with_file_name(name);
        let mut out = BufWriter::new(File::create(&part)?);
        let written = write(&mut out)
            .and_then(|()| out.into_inner().map_err(io::IntoInnerError::into_error))
            .map(drop)
            .and_then(|()| std::fs::rename(&part, path));
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

fn obj(surface: &Surface, out: &mut impl Write) -> io::Result<()> {
    for &[x, y, z, _] in &surface.positions {
        match surface.file_position([x, y, z]) {
            None => writeln!(out, "v {x:?} {y:?} {z:?}")?,
            Some([x, y, z]) => writeln!(out, "v {x:?} {y:?} {z:?}")?,
        }
    }
    let uv = distinct(&surface.corners.uv);
    for [u, v] in uv.iter().map(|uv| uv.map(f32::from_bits)) {
        writeln!(out, "vt {u:?} {v:?}")?;
    }
    let normals = distinct(&surface.corners.normal);
    for [x, y, z] in normals.iter().map(|n| n.map(f32::from_bits)) {
        writeln!(out, "vn {x:?} {y:?} {z:?}")?;
    }
    let mut triangles = surface.topology().triangles();
    let first = triangles.next().map(|t| surface.material(t));
    let differ = triangles.any(|t| Some(surface.material(t)) != first);
    let mut material = None;
    for t in surface.topology().triangles() {
        let own = Some(surface.material(t));
        if differ && own != material {
            writeln!(out, "usemtl material_{}", surface.material(t))?;
            material = own;
        }
        write!(out, "f")?;
        for h in t.half_edges() {
            write!(out, " {}", surface.topology().origin(h).0 + 1)?;
            let index_of_uv = index_in(&uv, surface.corners.uv.get(h.index()));
            let index_of_normal = index_in(&normals, surface.corners.normal.get(h.index()));
            match (index_of_uv, index_of_normal) {
                (None, None) => {}
                (Some(uv), None) => write!(out, "/{uv}")?,
                (None, Some(normal)) => write!(out, "//{normal}")?,
                (Some(uv), Some(normal)) => write!(out, "/{uv}/{normal}")?,
            }
        }
        writeln!(out)?;
    }
    Ok(())
}

fn distinct<const N: usize>(values: &[[f32; N]]) -> Vec<[u32; N]> {
    let mut out: Vec<[u32; N]> = values.iter().map(|value| value.map(f32::to_bits)).collect();
    out.sort_unstable();
    out.dedup();
    out
}

/// Returns the OBJ index of a value, which counts from 1.
fn index_in<const N: usize>(distinct: &[[u32; N]], value: Option<&[f32; N]>) -> Option<usize> {
    let value = value?.map(f32::to_bits);
    distinct.binary_search(&value).ok().map(|i| i + 1)
}

fn ply(surface: &Surface, out: &mut impl Write) -> io::Result<()> {
    let topology = surface.topology();
    let uv = &surface.corners.uv;
    let kind = if surface.origin == [0.0; 3] {
        "float"
    } else {
        "double"
    };
    write!(
        out,
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty {kind} x\n\
         property {kind} y\nproperty {kind} z\nelement face {}\n\
         property list uchar uint vertex_indices\n",
        topology.vertex_slots(),
        topology.triangle_slots(),
    )?;
    if !uv.is_empty() {
        writeln!(out, "property list uchar float texcoord")?;
    }
    writeln!(out, "end_header")?;
    for &[x, y, z, _] in &surface.positions {
        match surface.file_position([x, y, z]) {
            None => {
                for x in [x, y, z] {
                    out.write_all(&x.to_le_bytes())?;
                }
            }
            Some(p) => {
                for x in p {
                    out.write_all(&x.to_le_bytes())?;
                }
            }
        }
    }
    for t in topology.triangles() {
        ply_face(topology.triangle(t), t, uv, out)?;
    }
    Ok(())
}

fn ply_face(
    corners: [VertexId; 3],
    t: TriangleId,
    uv: &[[f32; 2]],
    out: &mut impl Write,
) -> io::Result<()> {
    out.write_all(&[3])?;
    for v in corners {
        out.write_all(&v.0.to_le_bytes())?;
    }
    if !uv.is_empty() {
        out.write_all(&[6])?;
        for x in t.half_edges().iter().flat_map(|h| uv[h.index()]) {
            out.write_all(&x.to_le_bytes())?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::read_mesh;
    use proptest::prelude::*;

    fn tetrahedron(corners: [[f32; 3]; 4]) -> Surface {
        let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        Surface::from_triangles(&corners, &faces).unwrap()
    }

    fn any_coordinate() -> impl Strategy<Value = f32> {
        prop_oneof![any::<f32>(), -1.0f32..1.0].prop_filter("finite", |x| x.is_finite())
    }

    proptest! {
        #[test]
        fn files_keep_every_bit(
            points in prop::array::uniform4(prop::array::uniform3(any_coordinate())),
            uv in prop::array::uniform12(prop::array::uniform2(any_coordinate())),
        ) {
            let distinct = (0..4).all(|i| (0..i).all(|j| points[i] != points[j]));
            prop_assume!(distinct);
            let mut surface = tetrahedron(points);
            surface.corners.uv = uv.to_vec();
            let folder = tempfile::tempdir().unwrap();
            for (name, write) in [
                ("a.obj", write_obj as fn(&Path, &Surface) -> _),
                ("a.PLY", write_ply),
            ] {
                let path = folder.path().join(name);
                write(&path, &surface).unwrap();
                let data = read_mesh(&path).unwrap();
                let bits = |p: [f32; 3]| p.map(f32::to_bits);
                for (i, p) in data.positions.iter().enumerate() {
                    prop_assert_eq!(bits(*p), bits(points[i]));
                }
                let faces: Vec<[u32; 3]> = surface
                    .topology()
                    .triangles()
                    .map(|t| surface.topology().triangle(t).map(|v| v.0))
                    .collect();
                prop_assert_eq!(&data.triangles, &faces);
                let bits = |uv: &[f32; 2]| uv.map(f32::to_bits);
                prop_assert!(data.corners.uv.iter().map(bits).eq(uv.iter().map(bits)));
                prop_assert_eq!(data.file_vertices, surface.seam_split_vertices());
            }
        }
    }

    #[test]
    fn materials_are_named_where_they_change() {
        let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let mut surface = tetrahedron(corners);
        let lines = |surface: &Surface| {
            let mut out = Vec::new();
            obj(surface, &mut out).unwrap();
            let text = String::from_utf8(out).unwrap();
            let lines = text.lines().filter(|line| !line.starts_with('v'));
            lines.map(str::to_owned).collect::<Vec<_>>()
        };
        assert_eq!(lines(&surface).len(), 4, "one material needs no name");
        surface.set_material(TriangleId(1), 7);
        surface.set_material(TriangleId(2), 7);
        let (skin, cap) = ("usemtl material_0", "usemtl material_7");
        let expected = [skin, "f 1 3 2", cap, "f 1 2 4", "f 2 3 4", skin, "f 3 1 4"];
        assert_eq!(lines(&surface), expected);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.obj");
        write_obj(&path, &surface).unwrap();
        let (read, _) = read_mesh(&path).unwrap().into_surface().unwrap();
        let materials: Vec<u32> = (0..4).map(|t| read.material(TriangleId(t))).collect();
        assert_eq!(materials, [0, 7, 7, 0]);
    }

    #[test]
    fn free_slots_are_left_out() {
        let mut surface =
            tetrahedron([[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
        let unused = surface.remove_triangles(&[TriangleId(0)]);
        surface.remove_vertices(&unused);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.obj");
        write_obj(&path, &surface).unwrap();
        let data = read_mesh(&path).unwrap();
        assert_eq!(data.triangles.len(), 3);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_failed_write_leaves_no_file() {
        let surface = tetrahedron([[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
        let folder = tempfile::tempdir().unwrap();
        let taken = folder.path().join("taken.obj");
        std::fs::create_dir(&taken).unwrap();
        assert_eq!(write_obj(&taken, &surface).unwrap_err().path, taken);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
        assert!(write_ply(&folder.path().join("none/a.ply"), &surface).is_err());
    }
}
