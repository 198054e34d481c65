//! Triangulation and refinement of a patch, one function per listing.
//!
//! | Listing | Function |
//! |---|---|
//! | Algorithm A2, triangulation | [`triangulate`] |
//! | Algorithm 4, refinement; Formula 1 | [`refine`], [`mean_rim_length`] |
//! | Algorithm A3, edge swap | called by [`refine`] |
//! | all three, with Formula 2 | [`fill`] |
//!
//! Each file lists where it departs from its listing.

mod ear_clipping;
mod edge_swap;
mod subdivision;

pub use ear_clipping::triangulate;
pub use subdivision::{mean_rim_length, refine};

use crate::error::PaperError;
use crate::params::PaperParams;
use incise_mesh::Vec3;
use incise_params::Params;
use incise_refine::RefineError;

/// Counters of one refinement.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct RefineReport {
    /// Rounds of subdivision and swaps that changed something.
    pub rounds: u32,
    /// Number of swapped edges.
    pub swaps: usize,
    /// Whether every triangle's mean edge is within the threshold.
    pub converged: bool,
}

/// A triangulated hole. Vertices `0..rim_len` are the rim's, in its order; the rest lie inside.
#[derive(Debug, Clone, PartialEq)]
pub struct Patch {
    /// Number of rim vertices.
    pub rim_len: usize,
    /// Positions \[m\], rim first.
    pub points: Vec<Vec3>,
    /// The three vertices whose mean is vertex `rim_len + i`; parents precede children.
    pub parents: Vec<[u32; 3]>,
    /// Triangles with the rim's winding: rim edge i runs from vertex i to vertex i + 1.
    pub triangles: Vec<[u32; 3]>,
    /// Counters of the refinement.
    pub report: RefineReport,
}

/// Fills the hole inside a closed rim with a triangulated and refined patch.
///
/// `rim` lists positions \[m\], counterclockwise seen against `normal`. `has_edge(i, j)` returns
/// whether the surface already has an edge between two rim vertices; the patch adds no second one.
///
/// A rim whose projection along `normal` is a simple polygon is covered exactly once. For any other
/// rim the triangles still form a manifold whose boundary is the rim.
///
/// # Errors
/// [`PaperError`] on fewer than 3 vertices, a non-finite coordinate, a non-positive z or a patch
/// over the size limit.
pub fn fill(
    rim: &[Vec3],
    normal: Vec3,
    params: &PaperParams,
    has_edge: impl Fn(u32, u32) -> bool,
) -> Result<Patch, PaperError> {
    if rim.len() < 3 {
        return Err(PaperError::RimTooShort {
            vertices: rim.len(),
        });
    }
    if let Some(vertex) = rim.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
        return Err(RefineError::NonFinite { vertex }.into());
    }
    params.check_ranges()?;
    let mut patch = triangulate(rim, normal, &has_edge);
    // Formula 2, on the mean length of Formula 1.
    let alpha = params.rim_length.unwrap_or_else(|| mean_rim_length(rim)) * params.level.z();
    refine(&mut patch, normal, alpha, params, &has_edge)?;
    Ok(patch)
}
