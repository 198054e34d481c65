//! What a user of a cut can choose.

use incise_refine::RefineParams;

/// How a surface is opened.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum CutMethod {
    /// The paper's: delete the triangles that the blade hits, rebuild the rim from the intersection
    /// points, patch and refine the hole (Algorithms 2, 3, A2, 4 and A3).
    #[default]
    Rebuild,
}

/// How to cut. Lengths are relative to the mean edge of the triangles that the blade hits, so that
/// one set of numbers serves models of any size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CutParams {
    /// How the surface is opened.
    pub method: CutMethod,
    /// How caps are refined.
    pub refine: RefineParams,
    /// Intersection points closer than this merge (the alpha of Algorithm 2, line 24) \[mean edges\].
    /// Larger values make rims more even and move more volume. The paper gives no number; at the
    /// default 0.5 a rim's mean edge is about that of the surface.
    pub min_distance: f64,
    /// A rim edge with an end closer to the plane than this stays (the beta of Algorithm 3) [mean
    /// edges]; the paper gives no number.
    pub beta: f64,
    /// An ear of the new boundary is closed below this angle (Algorithm 3, line 31) \[degrees\]. The
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
            min_distance: 0.5,
            beta: 0.15,
            ear_angle: 120.0,
            only_piece: None,
        }
    }
}
