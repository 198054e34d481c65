//! [`Curves`]: the intersection curves of a sweep and a surface, point by point.

use crate::intersection::node::{Node, On};
use crate::intersection::trace::Trace;
use incise_mesh::{HalfEdge, Surface, TriangleId, Vec3, VertexId};

/// The intersection curves of a sweep and a surface.
///
/// [`Cutter::intersect`](crate::Cutter::intersect) finds them.
#[derive(Debug)]
pub struct Curves<'a> {
    trace: &'a Trace,
    candidates: usize,
    /// By piece, whether it is a sheet; empty if none is.
    is_sheet: Vec<bool>,
}

/// One intersection curve.
///
/// It is closed, or it has two ends on the sweep's boundary or on that of the surface.
#[derive(Debug, Clone, Copy)]
pub struct Curve<'a> {
    nodes: &'a [Node],
    is_closed: bool,
}

/// A point of an intersection curve.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct CurvePoint {
    /// Position \[m\].
    pub position: Vec3,
    /// The edge that the sweep crosses there; none within a triangle, where the sweep bends or
    /// ends.
    pub crossing: Option<EdgeCrossing>,
}

/// A point at which a sweep crosses an edge of a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct EdgeCrossing {
    /// The half-edge that runs from below the sweep to above it. On a boundary of the surface it is
    /// the one that exists.
    pub half_edge: HalfEdge,
    /// The ends of the edge, the smaller id first.
    pub ends: [VertexId; 2],
    /// Position along the edge, from 0 at the first end to 1 at the second.
    pub t: f32,
}

impl<'a> Curves<'a> {
    pub(crate) fn new(trace: &'a Trace, candidates: usize, is_sheet: Vec<bool>) -> Self {
        Self {
            trace,
            candidates,
            is_sheet,
        }
    }

    /// Returns the number of triangles whose bounding boxes touch the sweep.
    #[must_use]
    pub fn candidates(&self) -> usize {
        self.candidates
    }

    /// Iterates over the curves, open ones before closed ones.
    pub fn iter(&self) -> impl Iterator<Item = Curve<'a>> + use<'a> {
        let trace = self.trace;
        trace.curves.iter().map(move |curve| Curve {
            nodes: &trace.nodes[curve.nodes.start as usize..curve.nodes.end as usize],
            is_closed: curve.is_closed,
        })
    }

    /// Returns a triangle in which a curve ends because the sweep ends inside the body.
    #[must_use]
    pub fn end(&self, surface: &Surface) -> Option<TriangleId> {
        self.trace.open_end(surface)
    }

    /// Returns a triangle of a sheet that a curve crosses: of a piece with a boundary.
    #[must_use]
    pub fn sheet(&self, surface: &Surface) -> Option<TriangleId> {
        let mut first = self.iter().map(|curve| curve.nodes[0].triangle(surface));
        first.find(|&t| self.is_sheet.get(surface.piece(t) as usize) == Some(&true))
    }
}

impl<'a> Curve<'a> {
    /// Returns whether the last point is connected to the first one.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.is_closed
    }

    /// Iterates over the points, in order along the curve.
    pub fn points(&self) -> impl Iterator<Item = CurvePoint> + use<'a> {
        self.nodes.iter().map(|node| CurvePoint {
            position: node.position,
            crossing: match node.on {
                On::Edge {
                    exit,
                    ends: [a, b],
                    t,
                    ..
                } => {
                    let (ends, t) = if a < b {
                        ([a, b], t)
                    } else {
                        ([b, a], 1.0 - t)
                    };
                    Some(EdgeCrossing {
                        half_edge: exit,
                        ends,
                        t,
                    })
                }
                On::Face { .. } | On::Tip(_) => None,
            },
        })
    }
}
