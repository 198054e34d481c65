//! Cuts of meshes: along a plane, and along the path of a blade.

use crate::cutting::CutResult;
use crate::cutting::{CutObject, cut_path, cut_plane};
use crate::handles::{insert, with};
use crate::memory::{fixed, input_rows, put};
use crate::mesh::{Mesh, MeshObject};
use crate::params::{CutParams, FillParams};
use crate::status::{Error, Status, call};
use incise::cut;
use incise::mesh::Surface;
use incise::refine::HoleParams;
use std::mem::MaybeUninit;

/// Writes the default parameters of cuts.
#[unsafe(no_mangle)]
pub extern "C" fn incise_cut_params_init(out: Option<&mut MaybeUninit<CutParams>>) -> Status {
    call(|| put(out, CutParams::from(&cut::CutParams::default()), "out"))
}

/// Writes the default parameters of the filling of holes.
#[unsafe(no_mangle)]
pub extern "C" fn incise_fill_params_init(out: Option<&mut MaybeUninit<FillParams>>) -> Status {
    call(|| put(out, FillParams::from(&HoleParams::default()), "out"))
}

/// Cuts a copy of a mesh along the plane `normal . x = d`, relative to the origin of the mesh.
///
/// `normal` has 3 numbers of any length above 0. `params` may be NULL for the defaults. A plane
/// that misses is no error: the report then has no hits. Free the result with
/// `incise_cut_result_free`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn incise_mesh_cut_plane(
    mesh: *mut Mesh,
    normal: *const f64,
    d: f64,
    params: Option<&CutParams>,
    out: Option<&mut MaybeUninit<*mut CutResult>>,
) -> Status {
    call(|| {
        // SAFETY: the caller's contract, see the README.
        let normal = unsafe { fixed::<f64, 3>(normal, "normal")? };
        if !d.is_finite() || normal.iter().any(|x| !x.is_finite()) {
            let text = "normal or d is NaN or infinite; pass finite numbers";
            return Err(Error::argument(text));
        }
        cut_mesh(mesh, params, out, |surface, params| {
            cut_plane(surface, normal, d, params)
        })
    })
}

/// Cuts a copy of a mesh by a blade that moves from pose to pose, and may stop inside.
///
/// The blade's edge is a polyline of `point_count` points, at least 2. `poses` has `pose_count`
/// times `point_count` rows of 3 floats (meters), relative to the origin of the mesh. A blade
/// that starts inside a body has to leave it first. Motions of less than half an edge length add
/// up.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn incise_mesh_cut_path(
    mesh: *mut Mesh,
    poses: *const f32,
    pose_count: usize,
    point_count: usize,
    params: Option<&CutParams>,
    out: Option<&mut MaybeUninit<*mut CutResult>>,
) -> Status {
    call(|| {
        if point_count < 2 || pose_count < 2 {
            return Err(Error::argument(format_args!(
                "{pose_count} poses of {point_count} points; pass at least 2 of each"
            )));
        }
        let rows = pose_count.saturating_mul(point_count);
        // SAFETY: the caller's contract, see the README.
        let poses = unsafe { input_rows(poses, rows, "poses")? };
        crate::memory::check_finite(poses.as_flattened(), "poses")?;
        cut_mesh(mesh, params, out, |surface, params| {
            cut_path(surface, poses, point_count, params)
        })
    })
}

fn cut_mesh(
    mesh: *mut Mesh,
    params: Option<&CutParams>,
    out: Option<&mut MaybeUninit<*mut CutResult>>,
    cut: impl FnOnce(&Surface, &cut::CutParams) -> Result<CutObject, Error>,
) -> Result<(), Error> {
    let Some(out) = out else {
        return Err(Error::null("out"));
    };
    let base = cut::CutParams::default();
    let params = params.map(|params| params.check(base)).transpose()?;
    let result = with(mesh, |mesh: &mut MeshObject| {
        cut(&mesh.surface, &params.unwrap_or_default())
    })?;
    out.write(insert(result));
    Ok(())
}
