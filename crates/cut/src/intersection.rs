//! Intersection of a sweep with a surface: the first step of a cut.
//!
//! [`facets`] decides every tie, [`order`] the order along an edge. [`trace`] follows the
//! intersection curves from triangle to triangle, and [`node`] holds a point of a curve.

pub(crate) mod continued_tip;
pub(crate) mod facets;
pub(crate) mod node;
mod order;
mod touch;
pub(crate) mod trace;

use crate::sweep::Sweep;
use facets::Facets;
use incise_mesh::Bvh;
use trace::Trace;

/// A sweep and its intersection curves with a surface.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Intersection<'a> {
    /// The BVH of the surface before the cut, if it fits.
    pub(crate) bvh: Option<&'a Bvh>,
    pub(crate) sweep: &'a Sweep,
    pub(crate) facets: &'a Facets,
    pub(crate) trace: &'a Trace,
    /// By piece, whether it is a sheet; empty if none is.
    pub(crate) is_sheet: &'a [bool],
    /// Whether the surface has walls of incisions, or gets some.
    pub(crate) may_share_walls: bool,
    /// Whether two threads share the work.
    pub(crate) is_shared: bool,
    /// Whether the cut ends without a change where the section has necks without width.
    pub(crate) stops_at_necks: bool,
}
