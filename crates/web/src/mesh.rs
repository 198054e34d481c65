//! [`Mesh`]: a surface at rest, from arrays or files, cut by planes.

use crate::arguments::{
    VECTOR, copy_f32, copy_f64, copy_u8, copy_u32, cut_params, finite, model, read, rows, to_js,
    value, vector,
};
use crate::error::WebError;
use crate::flat_arrays::FlatArrays;
use crate::memory_views::{view_f32, view_u8, view_u32};
use crate::report::{MeshReport, REPAIR};
use incise::cut::{Cutter, Sweep};
use incise::mesh::{MeshData, Surface, Undo, Warning, write_glb_to, write_obj_to};
use incise::params::{Parameter, Report, Value};
use incise_models::build_model;
use js_sys::{Float32Array, Float64Array, Uint8Array, Uint32Array};
use wasm_bindgen::JsValue;
use wasm_bindgen::prelude::wasm_bindgen;

/// A triangle surface of any number of pieces, which planes cut.
///
/// Coordinates are relative to `origin`, which is zero unless a file is far from zero.
///
/// Arrays are views into the memory of the module, without a copy. The next call of any function
/// of the module may make them invalid: use a view at once, or copy it with `slice()`.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Mesh {
    surface: Surface,
    /// Built by the first cut.
    cutter: Option<Cutter>,
    undo: Vec<Undo>,
    /// The arrays of the present surface, if they were asked for.
    arrays: Option<FlatArrays>,
    warnings: Vec<Warning>,
}

impl From<Surface> for Mesh {
    fn from(surface: Surface) -> Self {
        Self {
            surface,
            cutter: None,
            undo: Vec::new(),
            arrays: None,
            warnings: Vec::new(),
        }
    }
}

impl Mesh {
    /// Makes a mesh of positions \[m\], shape \[vertices, 3\], and triangles, shape
    /// \[triangles, 3\].
    ///
    /// # Errors
    /// [`WebError::ArrayLength`], [`WebError::Parse`] and [`WebError::NotCuttable`].
    pub fn from_slices(positions: &[f32], triangles: &[u32]) -> Result<Self, WebError> {
        let positions = rows("positions", positions)?;
        Self::repaired(MeshData::from_triangles(
            positions,
            rows("triangles", triangles)?,
        )?)
    }

    /// Reads a mesh from the bytes of a file, see [`Mesh::read`].
    ///
    /// # Errors
    /// [`WebError::UnknownName`], [`WebError::Parse`] and [`WebError::NotCuttable`].
    pub fn from_bytes(bytes: &[u8], format: &str) -> Result<Self, WebError> {
        Self::repaired(read(bytes, format)?)
    }

    fn repaired(data: MeshData) -> Result<Self, WebError> {
        let (surface, warnings) = data.repair(REPAIR)?;
        let mut mesh = Self::from(surface);
        mesh.warnings = warnings;
        Ok(mesh)
    }

    /// Returns the surface.
    #[must_use]
    pub fn surface(&self) -> &Surface {
        &self.surface
    }

    fn arrays(&mut self) -> &FlatArrays {
        (self.arrays).get_or_insert_with(|| FlatArrays::new(&self.surface))
    }
}

#[wasm_bindgen]
impl Mesh {
    /// Makes a mesh of positions \[m\], three a vertex, and vertex numbers, three a triangle.
    ///
    /// Vertices at equal positions are welded. The mesh is repaired as files are, see `warnings`.
    ///
    /// # Errors
    /// Throws if an index is out of range, a position is not finite, or the mesh cannot be cut.
    #[wasm_bindgen(constructor)]
    pub fn new(positions: &Float32Array, triangles: &Uint32Array) -> Result<Self, WebError> {
        let positions = copy_f32("positions", positions, None)?;
        Self::from_slices(&positions, &copy_u32("triangles", triangles, None)?)
    }

    /// Reads a mesh from the bytes of a file: `obj`, `ply`, `stl`, `glb` or `gltf`.
    ///
    /// # Errors
    /// Throws with the line or element if the file is broken or the mesh cannot be cut.
    pub fn read(bytes: &Uint8Array, format: &str) -> Result<Self, WebError> {
        Self::from_bytes(&copy_u8("bytes", bytes, None)?, format)
    }

    /// Measures the mesh of a file and lists its defects, without an error for them.
    ///
    /// # Errors
    /// Throws with the line or element if the file is broken.
    #[wasm_bindgen(js_name = checkFile)]
    pub fn check_file(bytes: &Uint8Array, format: &str) -> Result<MeshReport, WebError> {
        Ok(MeshReport::new(&read(
            &copy_u8("bytes", bytes, None)?,
            format,
        )?))
    }

    /// Generates a model: `Sphere20`, `Sphere80`, `Sphere768`, `Bunny`, `Octopus`,
    /// `Banana` or `Armadillo`.
    ///
    /// # Errors
    /// Throws for other names.
    pub fn model(name: &str) -> Result<Self, WebError> {
        Ok(build_model(model(name)?).into())
    }

    /// Cuts along the plane `normal . x = d` \[m\], relative to `origin`, and caps both sides.
    ///
    /// `params` are parameters of a cut by name, such as `{ level: 0.7, snap: 0.2 }`, or absent.
    /// `docs/parameters.md` lists them, and the values of the report: counts such as `hits`, and
    /// times `seconds` \[s\]. The report also has `is_miss`, `pieces_added` and `cap_triangles`.
    ///
    /// # Errors
    /// Throws if the cut is refused; the mesh is then unchanged.
    #[wasm_bindgen(js_name = cut)]
    pub fn cut_by_array(
        &mut self,
        normal: &Float64Array,
        d: f64,
        params: &JsValue,
    ) -> Result<JsValue, WebError> {
        let normal = copy_f64("the normal", normal, Some(VECTOR))?;
        Ok(to_js(&self.cut(&normal, d, &value(params)?)?))
    }
}

impl Mesh {
    /// Cuts along the plane `normal . x = d` \[m\], see [`Mesh::cut_by_array`]. Returns the report.
    ///
    /// # Errors
    /// [`WebError`] if the cut is refused; the mesh is then unchanged.
    pub fn cut(&mut self, normal: &[f64], d: f64, params: &Value) -> Result<Value, WebError> {
        let params = cut_params(params)?;
        let normal = vector("the normal", normal)?;
        finite("the normal", &normal)?;
        finite("d", &[d])?;
        let plane = Sweep::from_plane(normal, d, &self.surface.bounds())?;
        let cutter = (self.cutter).get_or_insert_with(|| Cutter::new(&self.surface));
        let outcome = cutter.cut(&mut self.surface, &plane, &params)?;
        let counts = [
            ("is_miss", outcome.is_miss().value()),
            ("pieces_added", outcome.delta.pieces_added.len().value()),
            ("cap_triangles", outcome.cap.len().value()),
        ];
        let mut report = counts
            .map(|(name, value)| (name.to_owned(), value))
            .to_vec();
        if let Value::Map(entries) = Report::value(&outcome.report) {
            report.extend(entries);
        }
        if let Some(undo) = outcome.undo {
            self.undo.push(undo);
            self.arrays = None;
        }
        Ok(Value::Map(report))
    }
}

#[wasm_bindgen]
impl Mesh {
    /// Returns the number of cuts that can be undone.
    #[wasm_bindgen(getter, js_name = undoCount)]
    pub fn undo_count(&self) -> usize {
        self.undo.len()
    }

    /// Undoes the last cut, bit for bit.
    ///
    /// # Errors
    /// Throws if there is none.
    pub fn undo(&mut self) -> Result<(), WebError> {
        let undo = self.undo.pop().ok_or(WebError::NothingToUndo)?;
        let cutter = (self.cutter).get_or_insert_with(|| Cutter::new(&self.surface));
        cutter.undo(&mut self.surface, undo)?;
        self.arrays = None;
        Ok(())
    }

    /// Returns a view of the positions \[m\], three a vertex.
    pub fn positions(&mut self) -> Float32Array {
        view_f32(self.arrays().positions.as_flattened())
    }

    /// Returns a view of the vertex numbers, three a triangle.
    pub fn triangles(&mut self) -> Uint32Array {
        view_u32(self.arrays().triangles.as_flattened())
    }

    /// Returns a view of the cap mask: 1 for a triangle of a cap, else 0.
    #[wasm_bindgen(js_name = capMask)]
    pub fn cap_mask(&mut self) -> Uint8Array {
        view_u8(&self.arrays().caps)
    }

    /// Returns a view of the piece number of each triangle.
    #[wasm_bindgen(js_name = trianglePieces)]
    pub fn triangle_pieces(&mut self) -> Uint32Array {
        view_u32(&self.arrays().pieces)
    }

    /// Returns the number of vertices.
    #[wasm_bindgen(getter, js_name = vertexCount)]
    pub fn vertex_count(&self) -> usize {
        self.surface.topology().vertex_count()
    }

    /// Returns the number of triangles.
    #[wasm_bindgen(getter, js_name = triangleCount)]
    pub fn triangle_count(&self) -> usize {
        self.surface.topology().triangle_count()
    }

    /// Returns the number of pieces.
    #[wasm_bindgen(getter, js_name = pieceCount)]
    pub fn piece_count(&self) -> usize {
        self.surface.piece_count()
    }

    /// Returns the numbers of the pieces, ascending.
    #[wasm_bindgen(js_name = pieceNumbers)]
    pub fn piece_numbers(&self) -> Vec<u32> {
        let numbers = 0..self.surface.piece_bound();
        numbers
            .filter(|&piece| self.surface.piece_triangles(piece) > 0)
            .collect()
    }

    /// Returns a piece as a mesh of its own.
    ///
    /// # Errors
    /// Throws for the number of no piece.
    pub fn piece(&self, piece: f64) -> Result<Self, WebError> {
        let mut numbers = self.piece_numbers().into_iter();
        let found = numbers.find(|&number| f64::from(number) == piece);
        let number = found.ok_or(WebError::UnknownPiece { piece })?;
        Ok(self.surface.extract_piece(number).into())
    }

    /// Returns the bounding box \[m\]: minimum, then maximum.
    pub fn bounds(&self) -> Vec<f32> {
        let bounds = self.surface.bounds();
        [bounds.min, bounds.max].concat()
    }

    /// Returns the point to which all coordinates are relative \[m\]: positions, planes, bounds.
    ///
    /// It is zero unless the mesh is from a file whose coordinates are far from zero compared to
    /// its size. Written files have absolute coordinates. In a scene all coordinates are relative
    /// to the origin of its first body.
    #[wasm_bindgen(getter)]
    pub fn origin(&self) -> Vec<f64> {
        self.surface.origin().to_vec()
    }

    /// Returns the warnings of reading and repairs, one text each.
    #[wasm_bindgen(getter)]
    pub fn warnings(&self) -> Vec<String> {
        self.warnings.iter().map(ToString::to_string).collect()
    }

    /// Measures the mesh as a file of it would be read.
    ///
    /// # Errors
    /// Throws if a position is not finite.
    pub fn check(&mut self) -> Result<MeshReport, WebError> {
        let arrays = self.arrays();
        let data = MeshData::from_triangles(&arrays.positions, &arrays.triangles)?;
        Ok(MeshReport::new(&data))
    }

    /// Returns the bytes of an OBJ file; caps have the material `material_1`.
    ///
    /// # Errors
    /// Throws if memory is too small.
    #[wasm_bindgen(js_name = toObj)]
    pub fn to_obj(&self) -> Result<Vec<u8>, WebError> {
        let mut bytes = Vec::new();
        write_obj_to(&mut bytes, &self.surface)?;
        Ok(bytes)
    }

    /// Returns the bytes of a binary glTF file with a node for each piece.
    ///
    /// # Errors
    /// Throws for 4 GiB and more.
    #[wasm_bindgen(js_name = toGlb)]
    pub fn to_glb(&self) -> Result<Vec<u8>, WebError> {
        let pieces: Vec<_> = (self.surface.extract_pieces())
            .map(|(piece, surface)| (format!("piece_{piece}"), surface))
            .collect();
        let named: Vec<_> = (pieces.iter())
            .map(|(name, surface)| (name.as_str(), surface))
            .collect();
        let mut bytes = Vec::new();
        write_glb_to(&mut bytes, &named)?;
        Ok(bytes)
    }
}

#[cfg(test)]
mod tests;
