//! [`MeshReport`]: the measures and defects of a mesh, before it is cut.

use incise::mesh::{MeshData, RepairParams, check_with};
use wasm_bindgen::prelude::wasm_bindgen;

/// The repairs that meshes get: boundaries are allowed, sheets are separated.
pub(crate) const REPAIR: RepairParams = RepairParams {
    allow_boundaries: true,
    separate_sheets: true,
};

/// Measures and defects of a mesh. It can be cut if it has no defects.
#[wasm_bindgen(getter_with_clone)]
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct MeshReport {
    /// Number of vertices, after those of equal positions are welded.
    #[wasm_bindgen(readonly)]
    pub vertices: usize,
    /// Number of triangles.
    #[wasm_bindgen(readonly)]
    pub triangles: usize,
    /// Number of parts that share no vertex.
    #[wasm_bindgen(readonly)]
    pub components: usize,
    /// Whether every edge has at least two triangles.
    #[wasm_bindgen(readonly)]
    pub closed: bool,
    /// Whether no edge has more than two triangles and every vertex has one fan.
    #[wasm_bindgen(readonly)]
    pub manifold: bool,
    /// Whether adjacent triangles have consistent orientations.
    #[wasm_bindgen(readonly)]
    pub oriented: bool,
    /// Area \[m^2\].
    #[wasm_bindgen(readonly)]
    pub area: f64,
    /// Volume \[m^3\]; meaningless unless the mesh is closed and oriented.
    #[wasm_bindgen(readonly)]
    pub volume: f64,
    /// Parts that would be skipped or repaired, one text each.
    #[wasm_bindgen(readonly)]
    pub warnings: Vec<String>,
    /// Reasons why the mesh cannot be cut, one text each.
    #[wasm_bindgen(readonly)]
    pub defects: Vec<String>,
}

impl MeshReport {
    pub(crate) fn new(data: &MeshData) -> Self {
        let report = check_with(data, REPAIR);
        Self {
            vertices: report.vertices,
            triangles: report.triangles,
            components: report.components,
            closed: report.closed,
            manifold: report.manifold,
            oriented: report.oriented,
            area: report.area,
            volume: report.volume,
            warnings: report.warnings.iter().map(ToString::to_string).collect(),
            defects: report.defects.iter().map(ToString::to_string).collect(),
        }
    }
}
