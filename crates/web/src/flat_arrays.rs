//! [`FlatArrays`]: a surface as arrays without free slots.

use incise::mesh::{Surface, index_u32};

/// The first material of caps, the default of [`incise::cut::CutParams::cap_material`].
const CAP_MATERIAL: u32 = 1;

/// The vertices and triangles of a surface, numbered in the order of their slots.
#[derive(Debug, Default)]
pub(crate) struct FlatArrays {
    /// Positions \[m\], shape \[vertices\].
    pub(crate) positions: Vec<[f32; 3]>,
    /// Vertices, shape \[triangles\].
    pub(crate) triangles: Vec<[u32; 3]>,
    /// Piece numbers, shape \[triangles\].
    pub(crate) pieces: Vec<u32>,
    /// 1 for triangles of caps, else 0, shape \[triangles\].
    pub(crate) caps: Vec<u8>,
}

impl FlatArrays {
    pub(crate) fn new(surface: &Surface) -> Self {
        let topology = surface.topology();
        let mut out = Self::default();
        let mut numbers = vec![0; topology.vertex_slots()];
        for v in topology.vertices() {
            numbers[v.index()] = index_u32(out.positions.len());
            let [x, y, z, _] = surface.positions()[v.index()];
            out.positions.push([x, y, z]);
        }
        for t in topology.triangles() {
            out.triangles
                .push(topology.triangle(t).map(|v| numbers[v.index()]));
            out.pieces.push(surface.piece(t));
            out.caps.push(u8::from(surface.material(t) >= CAP_MATERIAL));
        }
        out
    }
}
