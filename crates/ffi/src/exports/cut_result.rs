//! Results of cuts: the cut surface, its pieces, caps and origins of vertices.

use crate::cutting::{CutObject, CutResult};
use crate::exports::mesh::put_new;
use crate::exports::parameters::number;
use crate::handles::{remove, with};
use crate::memory::{check_output, count, output, put, text};
use crate::mesh::{Mesh, MeshObject};
use crate::status::{Status, call};
use incise::mesh::geometry::round_to_f32;
use incise::params::Report;
use std::ffi::c_char;
use std::mem::MaybeUninit;

/// Counts of a cut.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct CutReport {
    /// Number of pieces.
    pub pieces: u32,
    /// Number of vertices of the cut mesh.
    pub vertices: u32,
    /// Number of triangles of the cut mesh.
    pub faces: u32,
    /// Number of triangles of caps and walls.
    pub cap_faces: u32,
    /// Number of vertices of the mesh before the cut.
    pub input_vertices: u32,
    /// Number of vertices that the cut created: rows of `incise_cut_result_origins`.
    pub created_vertices: u32,
    /// Number of steps that cut: 1 for a plane that hits, 0 for a miss.
    pub steps: u32,
    /// Number of triangles that the sweep crossed.
    pub hits: u32,
    /// Number of curves along which the sweep crossed the surface as a whole.
    pub loops: u32,
    /// Number of curves that end where the sweep ends inside.
    pub slits: u32,
    /// Number of vertices of the tip, where the blade stopped inside the body; 0 outside.
    pub tip_vertices: u32,
    /// Volume moved by snapping and remeshing in cubic meters.
    pub moved_volume: f64,
    /// Upper bound of the displacement by remeshing in meters.
    pub moved_surface: f64,
    /// Time of the cut, with its copy and search structure, in seconds.
    pub seconds: f64,
}

/// Frees a result; NULL is allowed. Meshes that were taken from it stay.
#[unsafe(no_mangle)]
pub extern "C" fn incise_cut_result_free(result: *mut CutResult) -> Status {
    call(|| remove::<CutObject>(result))
}

/// Writes the counts of a cut.
#[unsafe(no_mangle)]
pub extern "C" fn incise_cut_result_report(
    result: *mut CutResult,
    out: Option<&mut MaybeUninit<CutReport>>,
) -> Status {
    call(|| {
        with(result, |cut: &mut CutObject| {
            let (stroke, report) = (&cut.stroke, &cut.stroke.report);
            let values = CutReport {
                pieces: count(cut.pieces.len()),
                vertices: count(cut.surface.topology().vertex_count()),
                faces: count(cut.surface.topology().triangle_count()),
                cap_faces: count(cut.caps.iter().filter(|is_cap| **is_cap).count()),
                input_vertices: cut.lineage.input_count(),
                created_vertices: count(cut.lineage.parents().len()),
                steps: count(stroke.cutting_steps),
                hits: count(report.hits),
                loops: count(report.loops),
                slits: count(report.slits),
                tip_vertices: count(stroke.tip_vertices),
                moved_volume: report.moved_volume,
                moved_surface: report.moved_surface,
                seconds: cut.time.as_secs_f64(),
            };
            put(out, values, "out")
        })
    })
}

/// Writes a count or a time of a cut by name, such as `"merged_points"` or `"seconds.detection"`;
/// 1 or 0 for true and false. `docs/parameters.md` lists them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn incise_cut_result_statistic(
    result: *mut CutResult,
    name: *const c_char,
    out: Option<&mut MaybeUninit<f64>>,
) -> Status {
    call(|| {
        // SAFETY: the caller's contract, see the README.
        let name = unsafe { text(name, "name")? };
        with(result, |cut: &mut CutObject| {
            put(out, number(name, &cut.stroke.report.get(name)?)?, "out")
        })
    })
}

/// Copies the cut surface with all pieces to a new mesh.
#[unsafe(no_mangle)]
pub extern "C" fn incise_cut_result_mesh(
    result: *mut CutResult,
    out: Option<&mut MaybeUninit<*mut Mesh>>,
) -> Status {
    call(|| {
        with(result, |cut: &mut CutObject| {
            put_new(out, || Ok(MeshObject::new(cut.surface.clone())))
        })
    })
}

/// Copies one piece to a new mesh. `index` is below the number of pieces of the report.
///
/// The piece has those vertices and triangles of the cut mesh that belong to it, in their order.
#[unsafe(no_mangle)]
pub extern "C" fn incise_cut_result_piece(
    result: *mut CutResult,
    index: u32,
    out: Option<&mut MaybeUninit<*mut Mesh>>,
) -> Status {
    call(|| {
        with(result, |cut: &mut CutObject| {
            put_new(out, || Ok(MeshObject::new(cut.piece(index as usize)?)))
        })
    })
}

/// Copies the index of the piece of each triangle of the cut mesh.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn incise_cut_result_face_pieces(
    result: *mut CutResult,
    out: *mut u32,
    capacity: usize,
) -> Status {
    call(|| {
        with(result, |cut: &mut CutObject| {
            // SAFETY: the caller's contract, see the README.
            unsafe { output(&cut.face_pieces(), out, capacity, "out") }
        })
    })
}

/// Copies for each triangle of the cut mesh 1 if it belongs to a cap or wall, else 0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn incise_cut_result_caps(
    result: *mut CutResult,
    out: *mut u8,
    capacity: usize,
) -> Status {
    call(|| {
        with(result, |cut: &mut CutObject| {
            let caps: Vec<u8> = cut.caps.iter().map(|&is_cap| u8::from(is_cap)).collect();
            // SAFETY: the caller's contract, see the README.
            unsafe { output(&caps, out, capacity, "out") }
        })
    })
}

/// Copies the id of each vertex of the cut mesh.
///
/// An id below `input_vertices` is that vertex of the mesh before the cut. Id `input_vertices` + i
/// is row i of `incise_cut_result_origins`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn incise_cut_result_vertex_ids(
    result: *mut CutResult,
    out: *mut u32,
    capacity: usize,
) -> Status {
    call(|| {
        with(result, |cut: &mut CutObject| {
            // SAFETY: the caller's contract, see the README.
            unsafe { output(&cut.ids, out, capacity, "out") }
        })
    })
}

/// Copies the origin of each created vertex: the ids of 3 parents, and 3 weights whose sum is 1.
///
/// Parents have lower ids. To give the vertices of the cut mesh an attribute, append the weighted
/// sum of the parents' values for each row to the values of the mesh before the cut. Both
/// capacities count values: 3 per row.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn incise_cut_result_origins(
    result: *mut CutResult,
    parents: *mut u32,
    parent_capacity: usize,
    weights: *mut f32,
    weight_capacity: usize,
) -> Status {
    call(|| {
        with(result, |cut: &mut CutObject| {
            let rows = cut.lineage.parents().as_flattened();
            let shares = cut.lineage.weights().as_flattened().iter();
            let shares: Vec<f32> = shares.map(|&weight| round_to_f32(weight)).collect();
            check_output(&shares, weights, weight_capacity, "weights")?;
            // SAFETY: the caller's contract, see the README.
            unsafe {
                output(rows, parents, parent_capacity, "parents")?;
                output(&shares, weights, weight_capacity, "weights")
            }
        })
    })
}
