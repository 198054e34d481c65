//! Cuts of meshes, and [`CutResult`]: the pieces with the origins of their vertices and faces.

use crate::arrays::{Numbers, floats, wrong_shape};
use crate::error::{CutError, OrRaise};
use crate::mesh::Mesh;
use crate::mesh_arrays::MeshArrays;
use crate::origins::{NEW_FACE, Origins};
use crate::{report, view};
use incise::cut::{CutParams, Cutter, Sweep};
use incise::mesh::geometry::round_to_f32;
use incise::mesh::{Surface, TriangleId, VertexId};
use numpy::{Element, PyArray};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The result of a cut.
///
/// Lists have one entry per piece, in the order of `pieces`. Their arrays are read-only views
/// without a copy. Vertices of the input have the ids 0 to n - 1. Vertices that the cut created
/// have the ids from n on, and lie between their parents.
#[pyclass(frozen, module = "incise")]
pub(crate) struct CutResult {
    pieces: Vec<Py<Mesh>>,
    origins: Vec<PieceOrigins>,
    parents: Vec<[u32; 3]>,
    weights: Vec<[f64; 3]>,
    report: Py<PyDict>,
    is_miss: bool,
    /// Number of vertices of the input.
    inputs: usize,
}

/// The origins of a piece's vertices and faces.
#[derive(Debug)]
struct PieceOrigins {
    is_new: Vec<bool>,
    faces: Vec<i64>,
    vertices: Vec<u32>,
}

#[pymethods]
impl CutResult {
    /// The pieces as meshes; those of the input if the cut missed.
    #[getter]
    fn pieces(&self, py: Python<'_>) -> Vec<Py<Mesh>> {
        self.pieces
            .iter()
            .map(|piece| piece.clone_ref(py))
            .collect()
    }

    /// Masks of the faces that are caps or walls of the cut: bool arrays of shape (m,).
    #[getter]
    fn cap_masks<'py>(slf: &Bound<'py, Self>) -> PyResult<Vec<Bound<'py, PyAny>>> {
        views(slf, |piece| &piece.is_new)
    }

    /// The face of the input in which each face lies: int64 arrays of shape (m,).
    ///
    /// -1 for caps and walls, for all new faces of method "paper", and with `remesh` for all faces
    /// that the cut changed.
    #[getter]
    fn face_origins<'py>(slf: &Bound<'py, Self>) -> PyResult<Vec<Bound<'py, PyAny>>> {
        views(slf, |piece| &piece.faces)
    }

    /// The id of each vertex: uint32 arrays of shape (n,).
    #[getter]
    fn vertex_ids<'py>(slf: &Bound<'py, Self>) -> PyResult<Vec<Bound<'py, PyAny>>> {
        views(slf, |piece| &piece.vertices)
    }

    /// Ids of the parents of created vertices: uint32 of shape (created, 3).
    ///
    /// Row k is that of id `n + k`, for n vertices of the input. Parents come before children.
    #[getter]
    fn parents<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let created = slf.get().parents.len();
        view::of(slf, |cut| cut.parents.as_flattened(), [created, 3])
    }

    /// Weights of the parents, with the sum 1: float64 of shape (created, 3).
    #[getter]
    fn weights<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let created = slf.get().weights.len();
        view::of(slf, |cut| cut.weights.as_flattened(), [created, 3])
    }

    /// Counts of the cut, and times in `seconds` [s]. Paths also have `steps`, `cutting_steps` and
    /// `tips`, the vertices of the tip at the end; 0 outside.
    #[getter]
    fn report(&self, py: Python<'_>) -> Py<PyDict> {
        self.report.clone_ref(py)
    }

    /// Whether nothing was cut.
    #[getter]
    fn is_miss(&self) -> bool {
        self.is_miss
    }

    /// Interpolates values of the input's vertices at the vertices of all pieces.
    ///
    /// `values` has the shape (n,) or (n, k). Returns one float32 array per piece. Vertices of the
    /// input keep their values, also where snapping moved them.
    fn interpolate<'py>(
        &self,
        py: Python<'py>,
        values: &Bound<'py, PyAny>,
    ) -> PyResult<Vec<Bound<'py, PyAny>>> {
        let Numbers { shape, values } = floats(values, "values")?;
        let width = match *shape.as_slice() {
            [rows] if rows == self.inputs => 1,
            [rows, width] if rows == self.inputs => width,
            _ => {
                let n = self.inputs;
                let expected = format!("({n},) or ({n}, k), a row per vertex of the input");
                return Err(wrong_shape("values", &shape, &expected));
            }
        };
        let mut all: Vec<f64> = values.iter().map(|&x| f64::from(x)).collect();
        for (parents, weights) in self.parents.iter().zip(&self.weights) {
            for column in 0..width {
                let value = |&p: &u32| all[p as usize * width + column];
                let sum = parents
                    .iter()
                    .map(value)
                    .zip(weights)
                    .map(|(x, w)| x * w)
                    .sum();
                all.push(sum);
            }
        }
        let of_piece = |piece: &PieceOrigins| {
            let row = |&id: &u32| &all[id as usize * width..][..width];
            let values = piece
                .vertices
                .iter()
                .flat_map(row)
                .map(|&x| round_to_f32(x));
            let flat = PyArray::from_vec(py, values.collect()).into_any();
            match shape.len() {
                1 => Ok(flat),
                _ => flat.call_method1("reshape", ((piece.vertices.len(), width),)),
            }
        };
        self.origins.iter().map(of_piece).collect()
    }

    fn __repr__(&self) -> String {
        let miss = if self.is_miss { ", a miss" } else { "" };
        format!("<incise.CutResult: {} pieces{miss}>", self.pieces.len())
    }
}

/// Returns a view for each piece.
fn views<'py, T: Element>(
    cut: &Bound<'py, CutResult>,
    values: impl Fn(&PieceOrigins) -> &Vec<T>,
) -> PyResult<Vec<Bound<'py, PyAny>>> {
    let pieces = 0..cut.get().origins.len();
    let view = |i: usize| {
        let count = values(&cut.get().origins[i]).len();
        view::of(cut, |cut| values(&cut.origins[i]).as_slice(), [count])
    };
    pieces.map(view).collect()
}

/// Cuts a mesh along a plane.
pub(crate) fn cut_by_plane(
    py: Python<'_>,
    mesh: &Mesh,
    normal: [f64; 3],
    d: f64,
    params: &CutParams,
) -> PyResult<CutResult> {
    let (cut, outcome) = py.detach(|| {
        let mut cut = Cut::new(mesh, params)?;
        let sweep = Sweep::from_plane(normal, d, &cut.surface.bounds()).or_raise()?;
        let mut cutter = Cutter::new(&cut.surface);
        let outcome = (cutter.cut(&mut cut.surface, &sweep, &cut.params)).or_raise()?;
        cut.origins.follow(&outcome);
        PyResult::Ok((cut.finish(mesh), outcome))
    })?;
    cut.result(py, report::of_cut(py, &outcome.report)?, outcome.is_miss())
}

/// Cuts a mesh along the path of a blade.
pub(crate) fn cut_by_path(
    py: Python<'_>,
    mesh: &Mesh,
    poses: &[&[[f32; 3]]],
    params: &CutParams,
) -> PyResult<CutResult> {
    let (cut, stroke) = py.detach(|| {
        let mut cut = Cut::new(mesh, params)?;
        let mut cutter = Cutter::new(&cut.surface);
        let (surface, origins) = (&mut cut.surface, &mut cut.origins);
        let poses = poses.iter().copied();
        let stroke = cutter.advance_along(surface, poses, &cut.params, |step| origins.follow(step));
        let stroke = stroke.map_err(|error| CutError::new_err(error.to_string()))?;
        PyResult::Ok((cut.finish(mesh), stroke))
    })?;
    let report = report::of_cut(py, &stroke.report)?;
    report.set_item("steps", poses.len() - 1)?;
    report.set_item("cutting_steps", stroke.cutting_steps)?;
    report.set_item("tips", stroke.tip_vertices)?;
    cut.result(py, report, stroke.cutting_steps == 0)
}

/// A copy of a mesh while it is cut.
struct Cut {
    surface: Surface,
    origins: Origins,
    /// Parameters that mark new faces.
    params: CutParams,
}

/// A cut mesh, before it becomes a Python object.
struct Finished {
    pieces: Vec<Mesh>,
    origins: Vec<PieceOrigins>,
    created: Origins,
    inputs: usize,
}

impl Cut {
    fn new(mesh: &Mesh, params: &CutParams) -> PyResult<Self> {
        let mut surface = mesh.surface().or_raise()?.clone();
        let origins = Origins::new(&mut surface, params.remesh > 0.0);
        Ok(Self {
            surface,
            origins,
            params: CutParams {
                cap_material: NEW_FACE,
                ..*params
            },
        })
    }

    /// Extracts the pieces, and gives their faces the materials of the input.
    fn finish(self, mesh: &Mesh) -> Finished {
        let (surface, created) = (self.surface, self.origins);
        let topology = surface.topology();
        let (mut pieces, mut origins) = (Vec::new(), Vec::new());
        let mut triangles: Vec<TriangleId> = topology.triangles().collect();
        triangles.sort_by_key(|&t| surface.piece(t));
        let mut of_pieces = triangles.chunk_by(|&s, &t| surface.piece(s) == surface.piece(t));
        for (_, piece) in surface.extract_pieces() {
            // Pieces come in the order of their numbers, their elements in the order of slots.
            let slots = of_pieces.next().unwrap_or_default();
            let mut vertices: Vec<VertexId> =
                slots.iter().flat_map(|&t| topology.triangle(t)).collect();
            vertices.sort_unstable();
            vertices.dedup();
            let of_piece = PieceOrigins {
                is_new: slots
                    .iter()
                    .map(|&t| surface.material(t) == NEW_FACE)
                    .collect(),
                faces: slots.iter().map(|&t| created.face(&surface, t)).collect(),
                vertices: vertices.iter().map(|&v| created.lineage.id(v)).collect(),
            };
            let mut arrays = MeshArrays::from_surface(&piece);
            restore_materials(&mut arrays.materials, &of_piece, &mesh.arrays().materials);
            pieces.push(Mesh::from_arrays(arrays));
            origins.push(of_piece);
        }
        Finished {
            pieces,
            origins,
            created,
            inputs: mesh.arrays().positions.len(),
        }
    }
}

/// Replaces numbers of faces by the materials of these faces.
fn restore_materials(materials: &mut [u32], origins: &PieceOrigins, inputs: &[u32]) {
    let faces = origins.is_new.iter().zip(&origins.faces);
    for (material, (&is_new, &face)) in materials.iter_mut().zip(faces) {
        let of_input = usize::try_from(face).ok().and_then(|face| inputs.get(face));
        if is_new {
            *material = CutParams::default().cap_material;
        } else if let Some(&of_input) = of_input {
            *material = of_input;
        }
    }
}

impl Finished {
    /// Makes the Python object.
    fn result(
        self,
        py: Python<'_>,
        report: Bound<'_, PyDict>,
        is_miss: bool,
    ) -> PyResult<CutResult> {
        let pieces = self.pieces.into_iter().map(|piece| Py::new(py, piece));
        Ok(CutResult {
            pieces: pieces.collect::<PyResult<_>>()?,
            origins: self.origins,
            parents: self.created.lineage.parents().to_vec(),
            weights: self.created.lineage.weights().to_vec(),
            report: report.unbind(),
            is_miss,
            inputs: self.inputs,
        })
    }
}
