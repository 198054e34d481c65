//! Meshes: from arrays and files, counts, copies, measures, filling of holes.

use crate::handles::{insert, remove, with};
use crate::memory::{count, input_rows, output, output_text, put, text};
use crate::mesh::Mesh;
use crate::mesh::{Arrays, MeshObject, faces};
use crate::params::FillParams;
use crate::status::{Error, Status, call};
use incise::mesh::TriangleId;
use std::ffi::c_char;
use std::mem::MaybeUninit;

/// Counts of a mesh.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct MeshCounts {
    /// Number of vertices: rows of 3 floats of `incise_mesh_vertices`.
    pub vertices: u32,
    /// Number of triangles: rows of 3 indices of `incise_mesh_faces`.
    pub faces: u32,
    /// Rows of 2 floats of `incise_mesh_uv`: three per triangle, or 0.
    pub uv: u32,
    /// Number of connected pieces.
    pub pieces: u32,
    /// Number of edges with one triangle: 0 for a closed body, more for a sheet.
    pub boundary_edges: u32,
}

/// Measures of a mesh.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct MeshMeasures {
    /// Area in square meters.
    pub area: f64,
    /// Enclosed volume in cubic meters; meaningless with boundary edges.
    pub volume: f64,
    /// Mean edge length in meters.
    pub mean_edge: f64,
    /// Corners of the bounding box in meters.
    pub low: [f32; 3],
    /// The other corner.
    pub high: [f32; 3],
    /// The point to which all coordinates of the mesh are relative, in meters: vertices, `low`,
    /// `high`, planes and poses of cuts. Zero unless the mesh is from a file whose coordinates are
    /// far from zero compared to its size; the file is read relative to a near point then, so that
    /// 32 bits keep its precision. `incise_mesh_write` adds it.
    pub origin: [f64; 3],
}

/// Report of `incise_mesh_fill`.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct FillReport {
    /// Number of filled holes.
    pub filled: u32,
    /// Number of holes left open because of `max_rim_edges`.
    pub left_open: u32,
    /// Number of new triangles.
    pub new_faces: u32,
    /// Number of patches that intersect themselves.
    pub self_intersecting: u32,
}

/// Makes a mesh from arrays and keeps their indices. The triangles must form an oriented manifold;
/// boundaries are allowed.
///
/// `vertices` has `vertex_count` rows of 3 floats (meters), `faces` has `face_count` rows of 3
/// indices. `uv` has `uv_count` rows of 2 floats: none (NULL), one per vertex, or one per corner
/// (3 * `face_count`). Its origin is zero: of vertices in 64 bits far from zero subtract a near
/// point before they are rounded. Free the mesh with `incise_mesh_free`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn incise_mesh_new(
    vertices: *const f32,
    vertex_count: usize,
    faces: *const u32,
    face_count: usize,
    uv: *const f32,
    uv_count: usize,
    out: Option<&mut MaybeUninit<*mut Mesh>>,
) -> Status {
    call(|| {
        // SAFETY: the caller's contract, see the README.
        let arrays = unsafe { arrays(vertices, vertex_count, faces, face_count, uv, uv_count)? };
        put_new(out, || Ok(MeshObject::new(arrays.surface()?)))
    })
}

/// Makes a mesh from arrays of any quality: welds equal positions and repairs all that has a unique
/// repair. `incise_mesh_warnings` lists the repairs.
///
/// Takes the arrays of `incise_mesh_new`. Vertices get other indices. Use it for meshes of
/// renderers and games, which repeat vertices at seams.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn incise_mesh_repair(
    vertices: *const f32,
    vertex_count: usize,
    faces: *const u32,
    face_count: usize,
    uv: *const f32,
    uv_count: usize,
    out: Option<&mut MaybeUninit<*mut Mesh>>,
) -> Status {
    call(|| {
        // SAFETY: the caller's contract, see the README.
        let arrays = unsafe { arrays(vertices, vertex_count, faces, face_count, uv, uv_count)? };
        put_new(out, || MeshObject::repair(arrays.data()?))
    })
}

/// Builds one of the models of the paper by name: "Sphere20", "Sphere80", "Sphere768", "Bunny",
/// "Octopus", "Banana", "Armadillo".
#[unsafe(no_mangle)]
pub unsafe extern "C" fn incise_mesh_model(
    name: *const c_char,
    out: Option<&mut MaybeUninit<*mut Mesh>>,
) -> Status {
    call(|| {
        // SAFETY: the caller's contract, see the README.
        let name = unsafe { text(name, "name")? };
        put_new(out, || MeshObject::model(name))
    })
}

/// Reads a mesh file (obj, ply, stl, glb or gltf) and repairs it like `incise_mesh_repair`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn incise_mesh_read(
    path: *const c_char,
    out: Option<&mut MaybeUninit<*mut Mesh>>,
) -> Status {
    call(|| {
        // SAFETY: the caller's contract, see the README.
        let path = unsafe { text(path, "path")? };
        put_new(out, || MeshObject::read(path))
    })
}

/// Writes a mesh file in the format of its extension: obj, ply, stl or glb.
///
/// `incise_mesh_warnings` then lists the attributes that the format cannot hold.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn incise_mesh_write(mesh: *mut Mesh, path: *const c_char) -> Status {
    call(|| {
        // SAFETY: the caller's contract, see the README.
        let path = unsafe { text(path, "path")? };
        with(mesh, |mesh: &mut MeshObject| {
            mesh.warnings = mesh.write(path)?;
            Ok(())
        })
    })
}

/// Frees a mesh; NULL is allowed.
#[unsafe(no_mangle)]
pub extern "C" fn incise_mesh_free(mesh: *mut Mesh) -> Status {
    call(|| remove::<MeshObject>(mesh))
}

/// Counts vertices, triangles, pieces and boundary edges.
#[unsafe(no_mangle)]
pub extern "C" fn incise_mesh_count(
    mesh: *mut Mesh,
    out: Option<&mut MaybeUninit<MeshCounts>>,
) -> Status {
    call(|| {
        with(mesh, |mesh: &mut MeshObject| {
            let surface = &mesh.surface;
            let topology = surface.topology();
            let half_edges = topology.triangles().flat_map(TriangleId::half_edges);
            let is_open = |&h: &_| topology.twin(h).is_null();
            let counts = MeshCounts {
                vertices: count(topology.vertex_slots()),
                faces: count(topology.triangle_count()),
                uv: count(surface.corner_uvs().len()),
                pieces: count(surface.piece_count()),
                boundary_edges: count(half_edges.filter(is_open).count()),
            };
            put(out, counts, "out")
        })
    })
}

/// Measures area, volume, edges and bounding box.
#[unsafe(no_mangle)]
pub extern "C" fn incise_mesh_measure(
    mesh: *mut Mesh,
    out: Option<&mut MaybeUninit<MeshMeasures>>,
) -> Status {
    call(|| {
        with(mesh, |mesh: &mut MeshObject| {
            let surface = &mesh.surface;
            let bounds = surface.bounds();
            let measures = MeshMeasures {
                area: surface.area(),
                volume: surface.volume(),
                mean_edge: surface.mean_edge_length(),
                low: bounds.min,
                high: bounds.max,
                origin: surface.origin(),
            };
            put(out, measures, "out")
        })
    })
}

/// Copies all positions (meters): 3 floats per vertex. `capacity` counts floats.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn incise_mesh_vertices(
    mesh: *mut Mesh,
    out: *mut f32,
    capacity: usize,
) -> Status {
    call(|| {
        with(mesh, |mesh: &mut MeshObject| {
            // SAFETY: the caller's contract, see the README.
            unsafe { output(mesh.vertices().as_flattened(), out, capacity, "out") }
        })
    })
}

/// Copies all triangles: 3 vertex indices each. `capacity` counts indices.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn incise_mesh_faces(
    mesh: *mut Mesh,
    out: *mut u32,
    capacity: usize,
) -> Status {
    call(|| {
        with(mesh, |mesh: &mut MeshObject| {
            // SAFETY: the caller's contract, see the README.
            unsafe { output(faces(&mesh.surface).as_flattened(), out, capacity, "out") }
        })
    })
}

/// Copies the texture coordinates of all corners: 2 floats each, three corners per triangle.
/// Copies nothing for a mesh without. `capacity` counts floats.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn incise_mesh_uv(mesh: *mut Mesh, out: *mut f32, capacity: usize) -> Status {
    call(|| {
        with(mesh, |mesh: &mut MeshObject| {
            let uvs = mesh.surface.corner_uvs().as_flattened();
            // SAFETY: the caller's contract, see the README.
            unsafe { output(uvs, out, capacity, "out") }
        })
    })
}

/// Copies the warnings of the reader, of the repair or of the last writer: a line each.
///
/// `length` (may be NULL) gets the number of bytes without the final zero. A capacity of 0 only
/// asks for the length.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn incise_mesh_warnings(
    mesh: *mut Mesh,
    out: *mut c_char,
    capacity: usize,
    length: Option<&mut MaybeUninit<usize>>,
) -> Status {
    call(|| {
        with(mesh, |mesh: &mut MeshObject| {
            // SAFETY: the caller's contract, see the README.
            unsafe { output_text(&mesh.warnings, out, capacity, length) }
        })
    })
}

/// Fills the holes of a mesh with patches. `params` may be NULL for the defaults, `out` NULL for no
/// report.
#[unsafe(no_mangle)]
pub extern "C" fn incise_mesh_fill(
    mesh: *mut Mesh,
    params: Option<&FillParams>,
    out: Option<&mut MaybeUninit<FillReport>>,
) -> Status {
    call(|| {
        let params = params
            .map(FillParams::check)
            .transpose()?
            .unwrap_or_default();
        with(mesh, |mesh: &mut MeshObject| {
            let report = incise::refine::fill_holes(&mut mesh.surface, &params)?;
            mesh.surface.compact();
            let holes = &report.holes;
            let filled = FillReport {
                filled: count(holes.len()),
                left_open: count(report.left_open),
                new_faces: count(holes.iter().map(|hole| hole.triangles.len()).sum()),
                self_intersecting: count(holes.iter().filter(|h| h.self_intersecting).count()),
            };
            match out {
                Some(_) => put(out, filled, "out"),
                None => Ok(()),
            }
        })
    })
}

/// Returns the arrays of a caller.
///
/// # Safety
/// Each pointer is NULL or valid for reads of its count of rows.
pub(crate) unsafe fn arrays<'a>(
    vertices: *const f32,
    vertex_count: usize,
    faces: *const u32,
    face_count: usize,
    uv: *const f32,
    uv_count: usize,
) -> Result<Arrays<'a>, Error> {
    // SAFETY: the caller's promise is that of `input_rows`, three times.
    unsafe {
        Ok(Arrays {
            vertices: input_rows(vertices, vertex_count, "vertices")?,
            faces: input_rows(faces, face_count, "faces")?,
            uv: input_rows(uv, uv_count, "uv")?,
        })
    }
}

/// Makes a mesh if there is a place for its handle.
pub(crate) fn put_new(
    out: Option<&mut MaybeUninit<*mut Mesh>>,
    make: impl FnOnce() -> Result<MeshObject, Error>,
) -> Result<(), Error> {
    let Some(out) = out else {
        return Err(Error::null("out"));
    };
    out.write(insert(make()?));
    Ok(())
}
