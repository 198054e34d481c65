//! Parameters and reports of hole filling.

use super::patch::HolePatch;
use crate::error::HoleError;
use crate::params::RefinementLevel;
use incise_mesh::geometry::{corner_angles, is_flat};
use incise_mesh::{AngleStats, Surface, TopologyDelta, TriangleId, Undo, VertexId};
use incise_params::Params;
use std::f64::consts::PI;

/// Angle below which a triangle counts as a sliver \[degrees\].
const SLIVER: f64 = 5.0;

incise_params::params! {
    /// Parameters of [`fill_holes`](crate::fill_holes).
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub struct HoleParams {
        /// Edge length of patches relative to the surface around the hole.
        level: RefinementLevel = RefinementLevel::Original;
        /// Whether patches continue the surrounding surface smoothly.
        ///
        /// A planar rim at a steep angle to the surface, such as the open end of a tube, stays
        /// planar.
        fair: bool = false;
        /// Maximum number of edges of a rim; holes with more stay open.
        max_rim_edges: usize = usize::MAX;
        /// Maximum number of triangles of all patches together.
        max_triangles: usize = 1_000_000;
        /// Material number of patches.
        material: u32 = 1;
    }
}

impl HoleParams {
    /// Checks the ranges.
    pub(super) fn check(&self) -> Result<(), HoleError> {
        Ok(self.check_ranges()?)
    }
}

/// The report of one filled hole.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct HoleReport {
    /// Number of edges of the rim.
    pub rim_edges: usize,
    /// A vertex of the rim.
    pub rim_vertex: VertexId,
    /// Whether the rim is planar and was filled in its plane.
    pub planar: bool,
    /// Whether the patch was faired.
    pub faired: bool,
    /// Whether the patch intersects itself.
    ///
    /// Set if a planar rim crosses or touches itself, or if triangles on the rim alone cross
    /// before refinement. Not tested for more than 20,000 such triangles.
    pub self_intersecting: bool,
    /// Triangles of the patch; empty if the two sides of a slit were joined.
    pub triangles: Vec<TriangleId>,
    /// Number of inserted vertices.
    pub new_vertices: usize,
    /// Number of triangles without area, within the rounding of stored positions.
    ///
    /// They are unavoidable where the rim is collinear or unfolded back.
    pub flat_triangles: usize,
    /// Number of other triangles with an angle below 5 degrees.
    ///
    /// They occur beside rim edges that are much longer than the level's target.
    pub slivers: usize,
    /// Angles of the patch.
    pub angles: AngleStats,
    /// Mean length of the patch's inner edges, or of its rim if there are none \[m\].
    pub mean_edge: f64,
    /// Mean target length over the rim \[m\].
    pub target_edge: f64,
}

/// The report of [`fill_holes`](crate::fill_holes).
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct FillReport {
    /// The filled holes, in the order of [`boundary_loops`](incise_mesh::Topology::boundary_loops).
    pub holes: Vec<HoleReport>,
    /// Number of holes left open because their rims have too many edges.
    pub left_open: usize,
    /// The change of the surface.
    pub delta: TopologyDelta,
    /// The undo record; `None` if there was nothing to fill.
    pub undo: Option<Undo>,
}

impl HoleReport {
    /// Returns the report of a hole before its patch exists.
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^53 vertices")]
    pub(super) fn new(rim: &[VertexId], sizes: &[f64]) -> Self {
        Self {
            rim_edges: rim.len(),
            rim_vertex: rim[0],
            planar: false,
            faired: false,
            self_intersecting: false,
            triangles: Vec::new(),
            new_vertices: 0,
            flat_triangles: 0,
            slivers: 0,
            angles: AngleStats::default(),
            mean_edge: 0.0,
            target_edge: sizes.iter().sum::<f64>() / sizes.len() as f64,
        }
    }

    /// Counts flat triangles and slivers at stored positions.
    pub(super) fn count_slivers(&mut self, surface: &Surface) {
        for &t in &self.triangles {
            let corners = surface.triangle_positions(t);
            let smallest = corner_angles(corners).into_iter().fold(PI, f64::min);
            if is_flat(corners) {
                self.flat_triangles += 1;
            } else if smallest.to_degrees() < SLIVER {
                self.slivers += 1;
            }
        }
    }

    /// Measures the patch's angles and edges.
    pub(super) fn measure(&mut self, patch: &HolePatch) {
        let at = |v: u32| patch.points[v as usize];
        self.new_vertices = patch.inner.len();
        self.angles = AngleStats::from_triangles(patch.triangles.iter().map(|t| t.map(at)));
        let count = patch.rim;
        let is_rim =
            |a: u32, b: u32| b as usize == (a as usize + 1) % count && (a as usize) < count;
        let (mut inside, mut all) = ((0.0, 0.0), (0.0, 0.0));
        for &[a, b, c] in &patch.triangles {
            for (a, b) in [(a, b), (b, c), (c, a)] {
                let length = (at(b) - at(a)).norm();
                all = (all.0 + length, all.1 + 1.0);
                if !is_rim(a, b) {
                    inside = (inside.0 + length, inside.1 + 1.0);
                }
            }
        }
        let (sum, sides) = if inside.1 > 0.0 { inside } else { all };
        self.mean_edge = sum / f64::max(sides, 1.0);
    }
}
