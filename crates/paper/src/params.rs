//! [`PaperParams`]: the parameters of the listings.

use incise_params::Range;
use incise_refine::RefinementLevel;

incise_params::params! {
    /// Parameters of the paper's method.
    ///
    /// Distances of the listings are relative to the mean edge of the hit triangles.
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub struct PaperParams {
        /// Distance below which intersection points merge: the alpha of Algorithm 2, line 24.
        ///
        /// Larger values make rims more even and move more volume. The paper gives no number; at
        /// the default a rim's mean edge is about that of the surface.
        min_distance: f64 = 0.5, range: Range::NOT_NEGATIVE, unit: "mean edge lengths";
        /// Distance from the plane below which an edge of the old boundary stays: the beta of
        /// Algorithm 3. The paper gives no number.
        beta: f64 = 0.15, range: Range::NOT_NEGATIVE, unit: "mean edge lengths";
        /// Angle below which an ear of the new boundary is closed: Algorithm 3, line 31. The
        /// paper's value is 120.
        ear_angle: f64 = 120.0, range: Range::NOT_NEGATIVE, unit: "degrees";
        /// Edge length of a patch relative to its rim's edges: the z of Formula 2.
        level: RefinementLevel = RefinementLevel::Original;
        /// The t of Formula 2 for all patches; `None`: the mean edge of each rim, by Formula 1.
        rim_length: Option<f64> = None, range: Range::POSITIVE, unit: "m";
        /// Maximum rounds of subdivision and edge swaps: n of Algorithm 4.
        ///
        /// A round divides edge lengths by about the root of 3. Refinement ends earlier when no
        /// triangle is too large.
        max_rounds: u32 = 24;
        /// Maximum number of triangles of a patch; a patch that needs more is an error.
        max_triangles: usize = 4_000_000;
        /// The material of caps.
        cap_material: u32 = 1;
        /// Cuts only this piece of the surface; the sweep passes through the others.
        only_piece: Option<u32> = None;
    }
}
