//! Checks of meshes that may not be cuttable yet, from arrays and files.

use crate::exports::mesh::arrays;
use crate::memory::{count, output_text, text};
use crate::mesh::{REPAIRS, lines};
use crate::status::{Error, Status, call};
use incise::mesh::{self, MeshData, check_with, read_mesh};
use std::ffi::c_char;
use std::mem::MaybeUninit;
use std::path::Path;

/// Properties of a mesh as given, with equal positions welded.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct MeshReport {
    /// 1 if `incise_mesh_repair` or `incise_mesh_read` makes a mesh of it that can be cut.
    pub cuttable: u32,
    /// 1 if every edge has at least two triangles.
    pub closed: u32,
    /// 1 if no edge has more than two triangles and every vertex has one fan.
    pub manifold: u32,
    /// 1 if adjacent triangles have consistent orientations.
    pub oriented: u32,
    /// Number of welded vertices.
    pub vertices: u32,
    /// Number of triangles.
    pub faces: u32,
    /// Number of connected components.
    pub components: u32,
    /// Number of edges with one triangle.
    pub open_edges: u32,
    /// Number of edges with more than two triangles.
    pub nonmanifold_edges: u32,
    /// Number of vertices with more than one fan of triangles.
    pub nonmanifold_vertices: u32,
    /// Number of directed edges of more than one triangle.
    pub winding_conflicts: u32,
    /// Number of triangles without area.
    pub degenerate_faces: u32,
    /// Area in square meters.
    pub area: f64,
    /// Volume in cubic meters; meaningless unless closed and oriented.
    pub volume: f64,
}

/// Checks arrays of any quality. Takes the arrays of `incise_mesh_new` without `uv`.
///
/// A line for each repair and each defect is copied to `text`, as by `incise_mesh_warnings`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn incise_check(
    vertices: *const f32,
    vertex_count: usize,
    faces: *const u32,
    face_count: usize,
    out: Option<&mut MaybeUninit<MeshReport>>,
    text: *mut c_char,
    capacity: usize,
    length: Option<&mut MaybeUninit<usize>>,
) -> Status {
    call(|| {
        let out = out.ok_or_else(|| Error::null("out"))?;
        let none = std::ptr::null();
        // SAFETY: the caller's contract, see the README.
        let arrays = unsafe { arrays(vertices, vertex_count, faces, face_count, none, 0)? };
        let (report, lines) = report(&arrays.data()?);
        // SAFETY: the caller's contract, see the README.
        unsafe { output_text(&lines, text, capacity, length)? };
        out.write(report);
        Ok(())
    })
}

/// Checks a mesh file; otherwise as `incise_check`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn incise_check_file(
    path: *const c_char,
    out: Option<&mut MaybeUninit<MeshReport>>,
    text: *mut c_char,
    capacity: usize,
    length: Option<&mut MaybeUninit<usize>>,
) -> Status {
    call(|| {
        let out = out.ok_or_else(|| Error::null("out"))?;
        // SAFETY: the caller's contract, see the README.
        let path = unsafe { self::text(path, "path")? };
        let data = read_mesh(Path::new(path)).map_err(Error::from)?;
        let (report, lines) = report(&data);
        // SAFETY: the caller's contract, see the README.
        unsafe { output_text(&lines, text, capacity, length)? };
        out.write(report);
        Ok(())
    })
}

/// Returns the report of a mesh, and its warnings and defects as lines.
fn report(data: &MeshData) -> (MeshReport, String) {
    let report: mesh::MeshReport = check_with(data, REPAIRS);
    let mut text = lines(&report.warnings);
    for defect in &report.defects {
        text.push_str(&format!("{defect}\n"));
    }
    let counts = MeshReport {
        cuttable: u32::from(report.is_cuttable().is_ok()),
        closed: u32::from(report.closed),
        manifold: u32::from(report.manifold),
        oriented: u32::from(report.oriented),
        vertices: count(report.vertices),
        faces: count(report.triangles),
        components: count(report.components),
        open_edges: count(report.open_edges),
        nonmanifold_edges: count(report.nonmanifold_edges),
        nonmanifold_vertices: count(report.nonmanifold_vertices),
        winding_conflicts: count(report.winding_conflicts),
        degenerate_faces: count(report.degenerate_triangles),
        area: report.area,
        volume: report.volume,
    };
    (counts, text)
}
