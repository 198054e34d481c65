//! [`Mesh`]: a triangle mesh of Python, its arrays, files and copies.

mod operations;

use crate::arrays;
use crate::error::{OrRaise, refused};
use crate::mesh_arrays::MeshArrays;
use crate::view;
use incise::mesh::{
    Domain, Surface, TopologyError, Warning, read_mesh, write_glb, write_obj, write_ply, write_stl,
};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;
use std::sync::OnceLock;

/// A triangle mesh at rest. Lengths are in meters, or in any one unit of yours.
///
/// Positions have 32 bits. Vertices of 64 bits that are more than 100 diagonals of the mesh away
/// from zero are stored relative to a near point, `origin`, so that they keep their digits. Then
/// everything else is relative to `origin`, too: planes, paths, and positions in scenes. For a
/// plane in the coordinates that were passed in, subtract `np.dot(normal, mesh.origin)` from d.
///
/// Meshes are immutable: the arrays that a mesh returns are read-only views of its memory, without
/// a copy, and every operation returns a new mesh. The arrays that are passed in are copied once.
///
/// Parameters
/// ----------
/// vertices : array of shape (n, 3)
///     Positions [m]. Other types than float32 are rounded once, relative to `origin`.
/// faces : array of integers of shape (m, 3)
///     Indices of vertices, counterclockwise seen from outside. They may form any mesh; cuts need
///     an oriented manifold, closed for bodies or with a boundary for sheets, see `check`.
/// uv : array of shape (n, 2) or (m, 3, 2), optional
///     Texture coordinates of vertices, or of the corners of faces.
/// attributes : dict of arrays, optional
///     Values of vertices, of shape (n,) or (n, k), or of corners, of shape (m, 3, k), with k up to
///     16. Cuts interpolate them. The one named "skin" holds joints and then their weights.
/// normals : array of shape (m, 3, 3), optional
///     Shading normals of the corners of faces.
/// materials : array of integers of shape (m,), optional
///     Material numbers of faces, 0 if absent.
/// origin : three numbers, optional
///     The point to which `vertices` are relative [m]. If absent it is found as above.
/// warnings : sequence of str
///     Texts for `warnings`.
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
    #[pyo3(signature = (
        vertices, faces, uv=None, attributes=None, *, normals=None, materials=None, origin=None,
        warnings=Vec::new()
    ))]
    #[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
    fn new(
        vertices: &Bound<'_, PyAny>,
        faces: &Bound<'_, PyAny>,
        uv: Option<&Bound<'_, PyAny>>,
        attributes: Option<&Bound<'_, PyDict>>,
        normals: Option<&Bound<'_, PyAny>>,
        materials: Option<&Bound<'_, PyAny>>,
        origin: Option<&Bound<'_, PyAny>>,
        warnings: Vec<String>,
    ) -> PyResult<Self> {
        let (positions, origin) = match origin {
            Some(origin) => {
                let origin = arrays::point(origin, "origin")?;
                (arrays::float_rows(vertices, "vertices")?, origin)
            }
            None => arrays::vertices(vertices)?,
        };
        let triangles = arrays::faces(faces, positions.len())?;
        let mut arrays = MeshArrays {
            materials: vec![0; triangles.len()],
            positions,
            triangles,
            origin,
            warnings,
            ..MeshArrays::default()
        };
        if let Some(normals) = normals {
            arrays.read_normals(normals)?;
        }
        if let Some(materials) = materials {
            arrays.materials = arrays::materials(materials, arrays.triangles.len())?;
        }
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
            let (surface, warnings) = data.repair(operations::REPAIR_ALL).or_raise()?;
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

    /// Makes a mesh of a `trimesh.Trimesh`, with its texture coordinates and attributes.
    ///
    /// Attributes of faces and those with text, bool, NaN or more than 16 columns are skipped. A
    /// warning names them.
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

    /// The point to which all coordinates of the mesh are relative [m], (x, y, z).
    ///
    /// Zero unless a file or array of 64 bits was far from zero compared to its size. Files are
    /// written in absolute coordinates, which are `vertices + origin`.
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

    /// Pickles and copies the mesh by the arguments of its constructor.
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let (py, mesh) = (slf.py(), slf.get());
        let keys = PyDict::new(py);
        keys.set_item("uv", Self::uv(slf)?)?;
        keys.set_item("attributes", Self::attributes(slf)?)?;
        keys.set_item("normals", Self::normals(slf)?)?;
        keys.set_item("materials", Self::materials(slf)?)?;
        keys.set_item("origin", mesh.origin())?;
        keys.set_item("warnings", mesh.warnings())?;
        let partial = py.import("functools")?.getattr("partial")?;
        let make = partial.call((slf.get_type(),), Some(&keys))?;
        let arrays = (Self::vertices(slf)?, Self::faces(slf)?);
        // The attributes of a subclass.
        let state = slf.getattr_opt("__dict__")?;
        (make, arrays, state).into_bound_py_any(py)
    }

    fn __repr__(&self) -> String {
        let (n, m) = (self.arrays.positions.len(), self.arrays.triangles.len());
        format!("<incise.Mesh: {n} vertices, {m} faces>")
    }
}

/// Returns the values of an attribute.
fn channel(mesh: &Mesh, i: usize) -> &[f32] {
    mesh.arrays.channels[i].values()
}
