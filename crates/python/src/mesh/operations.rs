//! Checks, repairs and cuts of a [`Mesh`]. Each returns new meshes.

use super::Mesh;
use crate::arrays;
use crate::cut::{CutResult, cut_by_path, cut_by_plane};
use crate::error::{OrRaise, refused};
use crate::mesh_arrays::MeshArrays;
use crate::params::{self, cut_params};
use crate::report;
use incise::mesh::{RepairParams, check_with};
use incise::refine::{HoleParams, fill_holes};
use pyo3::prelude::*;
use pyo3::types::PyDict;

pub(super) const REPAIR_ALL: RepairParams = RepairParams {
    allow_boundaries: true,
    separate_sheets: true,
};

#[pymethods]
impl Mesh {
    /// Measures the mesh and lists its defects, as `incise check --json` does.
    ///
    /// Returns a dictionary with counts, `area` [m^2], `volume` [m^3], `closed`, `manifold`,
    /// `oriented`, `warnings`, and `defects`, which is empty for a mesh that can be cut as a body.
    /// With `allow_boundaries` holes are no defects. Raises Error for a mesh without faces.
    #[pyo3(signature = (allow_boundaries=false))]
    fn check<'py>(&self, py: Python<'py>, allow_boundaries: bool) -> PyResult<Bound<'py, PyAny>> {
        let json = py.detach(|| {
            let params = RepairParams {
                allow_boundaries,
                ..REPAIR_ALL
            };
            let report = check_with(&self.arrays.data()?, params);
            serde_json::to_string(&report).map_err(refused)
        })?;
        report::from_json(py, &json)
    }

    /// Returns a mesh that can be cut, if there is one way to repair this one.
    ///
    /// Equal positions are welded; duplicate and collapsed faces are removed, orientations made
    /// consistent, and with `separate_sheets` sheets and bodies that share edges are separated.
    /// `warnings` of the result lists the repairs. Without `allow_boundaries` holes are refused.
    /// Attributes of vertices become those of corners where positions were welded.
    ///
    /// Raises `RepairError` with all defects.
    #[pyo3(signature = (allow_boundaries=true, separate_sheets=true))]
    fn repair(
        &self,
        py: Python<'_>,
        allow_boundaries: bool,
        separate_sheets: bool,
    ) -> PyResult<Self> {
        py.detach(|| {
            let repaired = self.arrays.data()?.repair(RepairParams {
                allow_boundaries,
                separate_sheets,
            });
            let (surface, warnings) = repaired.or_raise()?;
            let arrays = MeshArrays::from_surface(&surface).with_warnings(&warnings);
            Ok(Self::from_arrays(arrays))
        })
    }

    /// Closes every hole and returns the new mesh and a report.
    ///
    /// The outer boundary of a sheet is a hole too. Old vertices and faces come first, in their
    /// order; vertices that no face uses are dropped. Faces of patches have the material 1. Options
    /// are the `HoleParams` of `docs/parameters.md`: `level`, `fair`, `max_rim_edges`,
    /// `max_triangles` and `material`. The report has `holes`, a dictionary each, and `left_open`.
    ///
    /// Raises `FillError` and `TopologyError`.
    #[pyo3(signature = (**options))]
    fn fill<'py>(
        &self,
        py: Python<'py>,
        options: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<(Self, Bound<'py, PyDict>)> {
        let mut params = HoleParams::default();
        params::set(&mut params, options)?;
        let (mesh, report) = py.detach(|| {
            let mut surface = self.surface().or_raise()?.clone();
            let report = fill_holes(&mut surface, &params).or_raise()?;
            surface.compact();
            PyResult::Ok((
                Self::from_arrays(MeshArrays::from_surface(&surface)),
                report,
            ))
        })?;
        Ok((mesh, report::of_fill(py, &report)?))
    }

    /// Returns the mesh with vertices and faces in an order that is near in space and in memory.
    ///
    /// It speeds up scenes with large bodies. Raises `TopologyError`.
    fn sort_by_position(&self, py: Python<'_>) -> PyResult<Self> {
        py.detach(|| {
            let mut surface = self.surface().or_raise()?.clone();
            surface.sort_by_position();
            Ok(Self::from_arrays(MeshArrays::from_surface(&surface)))
        })
    }

    /// Cuts along the plane `normal . x = d` [m], relative to `origin`, and caps the pieces.
    ///
    /// `normal` has any length. A plane that misses is no error, see `CutResult.is_miss`. Other
    /// threads of Python run meanwhile.
    ///
    /// Options are the parameters `CutParams` of `docs/parameters.md` by their names, for example
    /// `level="2x-finer"` or `snap=0.2`. Faces of caps are in `cap_masks`, so `cap_material` has no
    /// effect.
    ///
    /// Raises `CutError`, `TopologyError`, and Error for an option out of range.
    #[pyo3(signature = (normal, d=0.0, **options))]
    fn cut(
        &self,
        py: Python<'_>,
        normal: &Bound<'_, PyAny>,
        d: f64,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<CutResult> {
        let normal = arrays::point(normal, "normal")?;
        if !d.is_finite() {
            return Err(refused(format_args!("d is {d}; pass a finite number")));
        }
        let params = cut_params(options)?;
        cut_by_plane(py, self, normal, d, &params)
    }

    /// Moves a blade through the mesh, pose by pose, as `incise cut --path` does.
    ///
    /// `path` has the shape (poses, points, 3) [m], relative to `origin`: at least two poses of the
    /// blade's edge, a polyline of two or more points. The cut may end inside: where the blade
    /// stops the mesh has two walls that coincide. Motions of less than half an edge length inside
    /// a body add up. Options are those of `cut`; method "paper" cuts full slices only.
    ///
    /// Raises `CutError`, also for a blade that starts inside and does not leave, `TopologyError`
    /// and Error.
    #[pyo3(signature = (path, **options))]
    fn cut_path(
        &self,
        py: Python<'_>,
        path: &Bound<'_, PyAny>,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<CutResult> {
        let numbers = arrays::floats(path, "path")?;
        let points = match *numbers.shape.as_slice() {
            [poses, points, 3] if poses >= 2 && points >= 2 => points,
            _ => {
                let expected = "(poses, points, 3) with 2 or more poses and points";
                return Err(arrays::wrong_shape("path", &numbers.shape, expected));
            }
        };
        let rows = numbers.values.as_chunks::<3>().0;
        let poses: Vec<&[[f32; 3]]> = rows.chunks(points).collect();
        let params = cut_params(options)?;
        cut_by_path(py, self, &poses, &params)
    }
}
