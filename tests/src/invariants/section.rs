//! An independent plane section: rounded heights above the plane, one segment per triangle.

use incise_mesh::{HalfEdge, Surface, TriangleId, Vec3};
use std::collections::BTreeMap;

/// The section of a surface with a plane.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Section {
    /// Signed area of the curves, seen against the normal \[m^2\].
    pub(super) area: f64,
    /// Length of the curves \[m\].
    pub(super) length: f64,
    /// Number of counterclockwise curves.
    pub(super) outlines: i64,
    /// Number of clockwise curves.
    pub(super) holes: i64,
    /// True if no vertex is near the plane and no curve is as narrow as rounding.
    pub(super) is_clear: bool,
}

impl Section {
    /// Computes the section of a surface, or of one of its pieces.
    pub(super) fn of(surface: &Surface, only: Option<u32>, [origin, normal]: [Vec3; 2]) -> Self {
        let topology = surface.topology();
        let diagonal = surface.bounds().diagonal();
        let height = |h: HalfEdge| normal.dot(&(surface.position(topology.origin(h)) - origin));
        let mut section = Self {
            is_clear: true,
            ..Self::default()
        };
        // The half-edge at which the curve leaves each triangle.
        let mut exits: BTreeMap<TriangleId, HalfEdge> = BTreeMap::new();
        let parts = |t: &TriangleId| only.is_none_or(|piece| surface.piece(*t) == piece);
        for t in topology.triangles().filter(parts) {
            let corners = t.half_edges();
            let heights = corners.map(height);
            section.is_clear &= heights.iter().all(|h| h.abs() > 1e-7 * diagonal);
            let Some(exit) = (0..3).find(|&k| heights[k] < 0.0 && heights[(k + 1) % 3] >= 0.0)
            else {
                continue;
            };
            exits.insert(t, corners[exit]);
        }
        let crossing = |h: HalfEdge| {
            let [p, q] = [topology.origin(h), topology.target(h)].map(|v| surface.position(v));
            let [hp, hq] = [p, q].map(|x| normal.dot(&(x - origin)));
            (p - origin) * (hq / (hq - hp)) - (q - origin) * (hp / (hq - hp))
        };
        while let Some((_, first)) = exits.pop_first() {
            let (mut area, mut length) = (0.0, 0.0);
            let mut exit = first;
            let start = crossing(first);
            let mut from = start;
            loop {
                let next = exits.remove(&topology.twin(exit).triangle());
                exit = next.unwrap_or(first);
                let to = crossing(exit);
                // Relative to the start of the curve, for precision far from the origin.
                area += normal.dot(&(from - start).cross(&(to - start))) / 2.0;
                length += (to - from).norm();
                from = to;
                if next.is_none() {
                    break;
                }
            }
            section.area += area;
            section.length += length;
            if area > 0.0 {
                section.outlines += 1;
            } else {
                section.holes += 1;
            }
            section.is_clear &= area.abs() > 1e-5 * diagonal * length;
        }
        section
    }
}
