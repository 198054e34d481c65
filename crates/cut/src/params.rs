//! What a user of a cut can choose.

use incise_refine::RefineParams;

/// How a surface is opened.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum CutMethod {
    /// Split the triangles that the blade hits along the sweep: no surface is lost, any cross-section is
    /// closed, and the time is that of what the blade touches.
    #[default]
    Exact,
    /// The paper's: delete the triangles that the blade hits, rebuild the rim from the intersection
    /// points, patch and refine the hole (Algorithms 2, 3, A2, 4 and A3). [`incise_refine::RefineMethod`] is not
    /// asked: caps are always the paper's.
    Rebuild,
}

/// How to cut. Lengths are relative to the mean edge of the triangles that the blade hits, so that
/// one set of numbers serves models of any size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CutParams {
    /// How the surface is opened.
    pub method: CutMethod,
    /// How caps are refined. With [`incise_refine::RefineMethod::Paper`] the exact method's caps are made by the
    /// paper's listings, on the same rims.
    pub refine: RefineParams,
    /// The exact method's shortest edges along the rim [local edge lengths], 0 up to 0.5: an intersection
    /// point closer to a vertex than this takes the vertex into the rim, two that are closer to each other
    /// merge. No piece comes or goes by that. 0 keeps the exact geometry and leaves slivers.
    pub snap: f64,
    /// The exact method: by how far the old surface may move around the rim so that slivers that the blade made in
    /// it go, by flipped edges and contracted vertices [local edge lengths], 0 up to 0.5. Rim and cap stay where
    /// they are. The default 0 leaves the surface as it was split and snapped.
    pub remesh: f64,
    /// The material of caps.
    pub cap_material: u32,
    /// The paper's method: intersection points closer than this merge (the alpha of Algorithm 2, line 24) \[mean edges\].
    /// Larger values make rims more even and move more volume. The paper gives no number; at the
    /// default 0.5 a rim's mean edge is about that of the surface.
    pub min_distance: f64,
    /// The paper's method: a rim edge with an end closer to the plane than this stays (the beta of Algorithm 3) [mean
    /// edges]; the paper gives no number.
    pub beta: f64,
    /// The paper's method: an ear of the new boundary is closed below this angle (Algorithm 3, line 31) \[degrees\]. The
    /// paper's is 120.
    pub ear_angle: f64,
    /// Cut only this piece of the surface; the sweep passes through the others.
    pub only_piece: Option<u32>,
}

impl Default for CutParams {
    fn default() -> Self {
        Self {
            method: CutMethod::default(),
            refine: RefineParams::default(),
            snap: 0.1,
            remesh: 0.0,
            cap_material: 1,
            min_distance: 0.5,
            beta: 0.15,
            ear_angle: 120.0,
            only_piece: None,
        }
    }
}
