//! [`Mesh`]: a triangle mesh of Python, and the built-in models.

use crate::arrays;
use crate::cut::{CutResult, cut_by_path, cut_by_plane};
use crate::error::{OrRaise, refused};
use crate::mesh_arrays::MeshArrays;
use crate::options::{count, cut_params, level as level_of};
use crate::{report, view};
use incise::mesh::{
    Domain, RepairParams, Surface, TopologyError, Warning, check_with, read_mesh, write_glb,
    write_obj, write_ply, write_stl,
};
use incise::refine::{HoleParams, fill_holes};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;
use std::sync::OnceLock;

/// A triangle mesh at rest. Lengths are in meters, or in any one unit of yours.
///
/// Meshes are immutable: the arrays that a mesh returns are read-only views of its memory, without
/// a copy, and every operation returns a new mesh. The arrays that are passed in are copied once.
///
/// Parameters
/// ----------
/// vertices : array of shape (n, 3)
///     Positions [m]. Other types than float32 are rounded once.
/// faces : array of integers of shape (m, 3)
///     Indices of vertices, counterclockwise seen from outside. They may form any mesh; cuts need
///     an oriented manifold, closed for bodies or with a boundary for sheets, see `check`.
/// uv : array of shape (n, 2) or (m, 3, 2), optional
///     Texture coordinates of vertices, or of the corners of faces.
/// attributes : dict of arrays, optional
///     Values of vertices, of shape (n,) or (n, k), or of corners, of shape (m, 3, k), with k up to
///     16. Cuts interpolate them. The one named "skin" holds joints and then their weights.
///
/// Raises
/// ------
/// Error
///     For a wrong shape or type, NaN, infinity, or an index out of range.
#[pyclass(frozen, module = "incise", subclass)]
pub(crate) struct Mesh {
    arrays: MeshArrays,
    surface: OnceLock<Result<Surface, TopologyError>>,
}

impl Mesh {
    /// Makes a mesh of arrays that fit each other.
    pub(crate) fn from_arrays(arrays: MeshArrays) -> Self {
        Self {
            arrays,
            surface: OnceLock::new(),
        }
    }

    pub(crate) fn arrays(&self) -> &MeshArrays {
        &self.arrays
    }

    /// Returns the surface, which is built by the first call.
    ///
    /// # Errors
    /// [`TopologyError`] if the faces are no oriented manifold.
    pub(crate) fn surface(&self) -> Result<&Surface, TopologyError> {
        let surface = self.surface.get_or_init(|| self.arrays.surface());
        surface.as_ref().map_err(Clone::clone)
    }
}

#[pymethods]
impl Mesh {
    #[new]
    #[pyo3(signature = (vertices, faces, uv=None, attributes=None))]
    fn new(
        vertices: &Bound<'_, PyAny>,
        faces: &Bound<'_, PyAny>,
        uv: Option<&Bound<'_, PyAny>>,
        attributes: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let positions = arrays::float_rows(vertices, "vertices")?;
        let triangles = arrays::faces(faces, positions.len())?;
        let mut arrays = MeshArrays {
            materials: vec![0; triangles.len()],
            positions,
            triangles,
            ..MeshArrays::default()
        };
        if let Some(uv) = uv {
            arrays.read_uv(uv)?;
        }
        if let Some(attributes) = attributes {
            arrays.read_attributes(attributes)?;
        }
        Ok(Self::from_arrays(arrays))
    }

    /// Reads a mesh file: obj, ply, stl, glb or gltf.
    ///
    /// Equal positions are welded. With `repair`, the default, whatever has a unique repair is
    /// repaired, as by `repair`. `warnings` lists all changes.
    ///
    /// Raises `OSError` for a file that cannot be opened, `FileError` for one that is no mesh, and
    /// `RepairError` for defects without a unique repair.
    #[staticmethod]
    #[pyo3(signature = (path, repair=true))]
    fn load(py: Python<'_>, path: PathBuf, repair: bool) -> PyResult<Self> {
        py.detach(|| {
            let data = read_mesh(&path).or_raise()?;
            if !repair {
                return Ok(Self::from_arrays(MeshArrays::from_data(data)));
            }
            let (surface, warnings) = data.repair(REPAIR_ALL).or_raise()?;
            Ok(Self::from_arrays(
                MeshArrays::from_surface(&surface).with_warnings(&warnings),
            ))
        })
    }

    /// Writes a mesh file in the format of the extension: obj, ply, stl or glb.
    ///
    /// Returns the names of attributes for which the format has no place, as texts. Raises
    /// `TopologyError` for a mesh that is no oriented manifold.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<Vec<String>> {
        let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
        py.detach(|| {
            let surface = self.surface().or_raise()?;
            let name = path.file_stem().unwrap_or_default().to_string_lossy();
            let written = match extension.to_str() {
                Some("obj") => write_obj(&path, surface),
                Some("ply") => write_ply(&path, surface),
                Some("stl") => write_stl(&path, surface),
                Some("glb") => write_glb(&path, &[(&name, surface)]),
                _ => {
                    return Err(refused(format_args!(
                        "{}: unknown extension, expected obj, ply, stl or glb",
                        path.display()
                    )));
                }
            };
            Ok(written.or_raise()?.iter().map(Warning::to_string).collect())
        })
    }

    /// Makes a mesh of a `trimesh.Trimesh`, with its texture coordinates and attributes of
    /// vertices.
    #[staticmethod]
    fn from_trimesh(py: Python<'_>, mesh: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
        let module = py.import("incise._trimesh")?;
        Ok(module.call_method1("from_trimesh", (mesh,))?.unbind())
    }

    /// Returns the mesh as a `trimesh.Trimesh`, with float64 copies of its vertices.
    ///
    /// Attributes become `vertex_attributes` and `face_attributes`, texture coordinates the face
    /// attribute "uv" of shape (m, 3, 2).
    fn to_trimesh<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let module = slf.py().import("incise._trimesh")?;
        module.call_method1("to_trimesh", (slf,))
    }

    /// Positions [m], float32 of shape (n, 3). A read-only view without a copy.
    #[getter]
    fn vertices<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let n = slf.get().arrays.positions.len();
        view::of(slf, |mesh| mesh.arrays.positions.as_flattened(), [n, 3])
    }

    /// Indices of vertices, uint32 of shape (m, 3). A read-only view without a copy.
    #[getter]
    fn faces<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let m = slf.get().arrays.triangles.len();
        view::of(slf, |mesh| mesh.arrays.triangles.as_flattened(), [m, 3])
    }

    /// Texture coordinates of corners, float32 of shape (m, 3, 2), or None. A read-only view.
    #[getter]
    fn uv<'py>(slf: &Bound<'py, Self>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let m = slf.get().arrays.triangles.len();
        (!slf.get().arrays.uv.is_empty())
            .then(|| view::of(slf, |mesh| mesh.arrays.uv.as_flattened(), [m, 3, 2]))
            .transpose()
    }

    /// Shading normals of corners, float32 of shape (m, 3, 3), or None. A read-only view.
    ///
    /// Only files and built-in models have them.
    #[getter]
    fn normals<'py>(slf: &Bound<'py, Self>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let m = slf.get().arrays.triangles.len();
        (!slf.get().arrays.normals.is_empty())
            .then(|| view::of(slf, |mesh| mesh.arrays.normals.as_flattened(), [m, 3, 3]))
            .transpose()
    }

    /// Attributes by name: float32 of shape (n,) or (n, k) for vertices, (m, 3, k) for corners.
    ///
    /// The dictionary is new, its arrays are read-only views.
    #[getter]
    fn attributes<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyDict>> {
        let arrays = &slf.get().arrays;
        let (n, m) = (arrays.positions.len(), arrays.triangles.len());
        let out = PyDict::new(slf.py());
        for (i, own) in arrays.channels.iter().enumerate() {
            let view = match (own.domain(), own.width()) {
                (Domain::Corner, width) => view::of(slf, |mesh| channel(mesh, i), [m, 3, width])?,
                (Domain::Vertex, 1) => view::of(slf, |mesh| channel(mesh, i), [n])?,
                (Domain::Vertex, width) => view::of(slf, |mesh| channel(mesh, i), [n, width])?,
            };
            out.set_item(own.name(), view)?;
        }
        Ok(out)
    }

    /// Material numbers of faces, uint32 of shape (m,); caps of cuts have 1. A read-only view.
    #[getter]
    fn materials<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let m = slf.get().arrays.triangles.len();
        view::of(slf, |mesh| mesh.arrays.materials.as_slice(), [m])
    }

    /// Origin of the vertices in the coordinates of their file [m], (x, y, z).
    ///
    /// Zero unless the file is far from its origin compared to its size. Files are written relative
    /// to it; planes of cuts are relative to the vertices.
    #[getter]
    fn origin(&self) -> (f64, f64, f64) {
        self.arrays.origin.into()
    }

    /// Warnings of the reader and of repairs.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.arrays.warnings.clone()
    }

    /// Enclosed volume [m^3]; meaningless for sheets. Raises `TopologyError`.
    #[getter]
    fn volume(&self, py: Python<'_>) -> PyResult<f64> {
        py.detach(|| Ok(self.surface().or_raise()?.volume()))
    }

    /// Area [m^2]. Raises `TopologyError`.
    #[getter]
    fn area(&self, py: Python<'_>) -> PyResult<f64> {
        py.detach(|| Ok(self.surface().or_raise()?.area()))
    }

    /// Whether no edge has just one face. Raises `TopologyError`.
    #[getter]
    fn is_closed(&self, py: Python<'_>) -> PyResult<bool> {
        py.detach(|| Ok(self.surface().or_raise()?.topology().is_closed()))
    }

    /// The connected components as meshes, in the order of their first faces. Raises
    /// `TopologyError`.
    #[getter]
    fn pieces(&self, py: Python<'_>) -> PyResult<Vec<Self>> {
        py.detach(|| {
            let pieces = self.surface().or_raise()?.extract_pieces();
            let mesh = |(_, piece): (u32, Surface)| MeshArrays::from_surface(&piece);
            Ok(pieces.map(mesh).map(Self::from_arrays).collect())
        })
    }

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
    /// order; vertices that no face uses are dropped. Faces of patches have the material 1. `level`
    /// is the ratio of the patches' edge length to that of the surface, a number or a name as in
    /// `cut`. Holes of more than `max_edges` edges stay open. The report has `holes`, a dictionary
    /// each, and `left_open`. Patches are not faired.
    ///
    /// Raises `FillError` and `TopologyError`.
    #[pyo3(signature = (*, level=None, max_edges=None, max_triangles=None))]
    fn fill<'py>(
        &self,
        py: Python<'py>,
        level: Option<&Bound<'py, PyAny>>,
        max_edges: Option<&Bound<'py, PyAny>>,
        max_triangles: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<(Self, Bound<'py, PyDict>)> {
        let mut params = HoleParams::default();
        if let Some(value) = level {
            params.level = level_of(value)?;
        }
        if let Some(value) = max_edges {
            params.max_rim_edges = count(value, "max_edges")?;
        }
        if let Some(value) = max_triangles {
            params.max_triangles = count(value, "max_triangles")?;
        }
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

    /// Cuts along the plane `normal . x = d` [m] and caps the pieces.
    ///
    /// `normal` has any length. A plane that misses is no error, see `CutResult.is_miss`. Other
    /// threads of Python run meanwhile.
    ///
    /// Options, as those of `incise cut`:
    ///     `level`: edge length of caps relative to the surface: "2x-coarser", "1.5x-coarser",
    ///         "original" (default), "1.5x-finer", "2x-finer", or a number.
    ///     `method`: "exact" (default) or "paper".
    ///     `refine_method`: "delaunay" (default) or "paper", the meshing of caps.
    ///     `snap`: shortest edge along the rim [local edge lengths], 0 to 0.5, default 0.1.
    ///     `remesh`: largest motion of the surface that removes slivers [local edge lengths], 0.
    ///     `grading`: growth of the caps' edge length with the distance from the rim [m/m], 0.3.
    ///     `caps`: "bodies" (default), "all-loops" or "none".
    ///     `max_triangles`: largest number of triangles of a cap.
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
        let normal: [f64; 3] = plane_normal(normal)?;
        let params = cut_params(options)?;
        cut_by_plane(py, self, normal, d, &params)
    }

    /// Moves a blade through the mesh, pose by pose, as `incise cut --path` does.
    ///
    /// `path` has the shape (poses, points, 3) [m]: at least two poses of the blade's edge, a
    /// polyline of two or more points. The cut may end inside: where the blade stops the mesh has
    /// two walls that coincide. Motions of less than half an edge length inside a body add up.
    /// Options are those of `cut`; method "paper" cuts full slices only.
    ///
    /// Raises `CutError`, also if the blade starts inside, `TopologyError` and Error.
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

    fn __repr__(&self) -> String {
        let (n, m) = (self.arrays.positions.len(), self.arrays.triangles.len());
        format!("<incise.Mesh: {n} vertices, {m} faces>")
    }
}

const REPAIR_ALL: RepairParams = RepairParams {
    allow_boundaries: true,
    separate_sheets: true,
};

/// Returns the values of an attribute.
fn channel(mesh: &Mesh, i: usize) -> &[f32] {
    mesh.arrays.channels[i].values()
}

/// Reads the normal of a plane in 64 bits.
fn plane_normal(value: &Bound<'_, PyAny>) -> PyResult<[f64; 3]> {
    let numpy = value.py().import("numpy")?;
    let list = numpy.call_method1("asarray", (value, "float64"));
    let list = list.and_then(|array| array.call_method0("tolist"));
    let normal = list.and_then(|list| list.extract::<[f64; 3]>());
    normal.map_err(|_| refused("normal is no vector; pass three numbers"))
}
