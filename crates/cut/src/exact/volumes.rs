//! Volumes of the parts beside each curve, by rays from points of the section.
//!
//! From a point of the section to the surface, a ray stays in the part on its side. So the integral
//! of the rays' lengths over the section is at most the volume of that part, and for a layer it is
//! the volume. The points are on parallel lines across each curve, in the sweep laid flat.

use super::frames::Frames;
use crate::intersection::Intersection;
use crate::intersection::node::On;
use crate::intersection::trace::Curve;
use incise_mesh::{BoxScan, Bvh, Surface, TriangleId, Vec3};

/// Number of lines across a curve.
///
/// Lengths that are linear across the section have the right mean for any number. A part of the
/// section that is as wide as the distance of two lines is seen by one of them.
const LINES: usize = 8;

/// Number of points on each part of a line inside the section. As for the lines, any would do.
const POINTS: usize = 2;

/// Displacement of the points from one line to the next [distance of two points].
///
/// The golden ratio, so that no two lines have their points side by side.
const STAGGER: f64 = 0.618_033_988_749_895;

/// A line at a height, for one curve.
#[derive(Debug, Clone, Copy)]
struct Line {
    y: f64,
    curve: usize,
    /// Distance of the curve's lines \[m\].
    step: f64,
}

/// A point where a line crosses a curve.
#[derive(Debug, Clone, Copy)]
struct Crossing {
    line: usize,
    x: f64,
    /// Change of the winding number.
    turn: i32,
    curve: usize,
}

/// The rays along both directions of a normal from a point of the section.
#[derive(Debug, Clone, Copy)]
struct Ray {
    point: Vec3,
    normal: Vec3,
    curve: usize,
    /// Area of the section around the point \[m^2\].
    area: f64,
}

/// The triangles that rays may hit, for a surface without a BVH that fits. Kept for its memory.
#[derive(Debug, Clone, Default)]
pub(super) struct Column {
    scan: BoxScan,
    triangles: Vec<TriangleId>,
    bvh: Bvh,
}

impl Column {
    /// Returns a BVH of all triangles that the rays may hit. O(n + k log k) for k triangles.
    fn around(&mut self, surface: &Surface, rays: &[Ray]) -> &Bvh {
        let largest = f64::from(surface.largest_coordinate());
        let ends = rays.iter().flat_map(|ray| {
            // The surface ends within this distance.
            let reach = ray.normal * (ray.point.norm() + 3.0_f64.sqrt() * largest);
            [ray.point - reach, ray.point + reach]
        });
        let ends: Vec<Vec3> = ends.collect();
        self.triangles.clear();
        (self.scan).query_hull(surface, &ends, &mut self.triangles);
        let triangles = self.triangles.iter().copied();
        self.bvh.rebuild_with(surface, triangles);
        &self.bvh
    }
}

/// The smaller one of the parts below and above a curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SmallerPart {
    /// A lower bound of its volume \[m^3\].
    pub(super) volume: f64,
    /// Its mean thickness across the section \[m\]; infinite for sheets.
    pub(super) thickness: f64,
}

/// Returns the smaller part beside each curve, without a volume where `is_measured` is false.
///
/// The section between two curves counts to both by halves. A sheet counts as a strip that is one
/// edge wide and thick.
pub(super) fn smaller_parts(
    surface: &Surface,
    at: &Intersection<'_>,
    frames: &Frames,
    column: &mut Column,
    is_measured: impl Fn(&Curve) -> bool,
) -> Vec<SmallerPart> {
    let is_measured: Vec<bool> = at.trace.curves.iter().map(is_measured).collect();
    let bodies: Vec<usize> = (0..at.trace.curves.len())
        .filter(|&curve| is_body(surface, at, &at.trace.curves[curve]))
        .collect();
    let measured = bodies.iter().copied().filter(|&curve| is_measured[curve]);
    let lines = lines(at, frames, measured);
    let crossings = crossings(at, frames, &bodies, &lines);
    let mut areas = vec![0.0; at.trace.curves.len()];
    let mut rays = Vec::new();
    for own in crossings.chunk_by(|a, b| a.line == b.line) {
        let line = lines[own[0].line];
        let offset = (own[0].line as f64 * STAGGER).fract();
        let mut winding = 0;
        for pair in own.windows(2) {
            winding += pair[0].turn;
            let ends = pair.iter().filter(|c| c.curve == line.curve).count();
            let length = pair[1].x - pair[0].x;
            if winding == 0 || ends == 0 || length <= 0.0 {
                continue;
            }
            let area = line.step * length * ends as f64 / (2 * POINTS) as f64;
            for i in 0..POINTS {
                let x = pair[0].x + length * ((i as f64 + offset) / POINTS as f64);
                let Some((point, normal)) = frames.unfold(at.facets, [x, line.y]) else {
                    continue;
                };
                areas[line.curve] += area;
                rays.push(Ray {
                    point,
                    normal,
                    curve: line.curve,
                    area,
                });
            }
        }
    }
    let mut volumes = vec![[0.0; 2]; at.trace.curves.len()];
    let bvh = match at.bvh {
        Some(bvh) => bvh,
        None => column.around(surface, &rays),
    };
    for ray in rays {
        for (side, direction) in [-ray.normal, ray.normal].into_iter().enumerate() {
            let hit = bvh.cast(surface, ray.point, direction, |_| true);
            volumes[ray.curve][side] += ray.area * hit.map_or(0.0, |hit| hit.distance);
        }
    }
    let mut parts = Vec::with_capacity(volumes.len());
    for (curve, [below, above]) in volumes.into_iter().enumerate() {
        parts.push(if !is_measured[curve] {
            SmallerPart {
                volume: 0.0,
                thickness: f64::INFINITY,
            }
        } else if bodies.binary_search(&curve).is_ok() {
            let volume = f64::min(below, above);
            let thickness = volume / areas[curve];
            SmallerPart { volume, thickness }
        } else {
            let edges = frames.flat_edges(at.trace, &at.trace.curves[curve]);
            let lengths = edges.map(|[[ax, ay], [bx, by]]| (bx - ax).hypot(by - ay));
            SmallerPart {
                volume: lengths.sum::<f64>() * at.trace.mean_local().powi(2),
                thickness: f64::INFINITY,
            }
        });
    }
    parts
}

/// Returns whether a curve is closed by caps or walls and bounds the section of a closed piece.
fn is_body(surface: &Surface, at: &Intersection<'_>, curve: &Curve) -> bool {
    let own = &at.trace.nodes[curve.nodes.start as usize..curve.nodes.end as usize];
    let triangle = own.iter().find_map(|node| match node.on {
        On::Edge { exit, .. } => Some(exit.triangle()),
        On::Face { triangle, .. } => Some(triangle),
        On::Tip(_) => None,
    });
    let piece = triangle.map(|t| surface.piece(t) as usize);
    curve.is_capped && piece.is_none_or(|piece| at.is_sheet.get(piece) != Some(&true))
}

/// Returns the lines across some curves, in the order of their heights.
fn lines(at: &Intersection<'_>, frames: &Frames, curves: impl Iterator<Item = usize>) -> Vec<Line> {
    let mut lines = Vec::new();
    for curve in curves {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for [[_, y], _] in frames.flat_edges(at.trace, &at.trace.curves[curve]) {
            (low, high) = (low.min(y), high.max(y));
        }
        let step = (high - low) / LINES as f64;
        lines.extend((0..LINES).map(|k| Line {
            y: low + (k as f64 + 0.5) * step,
            curve,
            step,
        }));
    }
    lines.sort_by(|a, b| a.y.total_cmp(&b.y));
    lines
}

/// Returns the points where the lines cross the curves, along each line.
fn crossings(
    at: &Intersection<'_>,
    frames: &Frames,
    curves: &[usize],
    lines: &[Line],
) -> Vec<Crossing> {
    let mut crossings = Vec::new();
    for &curve in curves {
        for [[ax, ay], [bx, by]] in frames.flat_edges(at.trace, &at.trace.curves[curve]) {
            let from = lines.partition_point(|line| line.y < ay.min(by));
            let to = lines.partition_point(|line| line.y < ay.max(by));
            crossings.extend((from..to).map(|line| Crossing {
                line,
                x: ax + (bx - ax) * ((lines[line].y - ay) / (by - ay)),
                turn: if ay < by { 1 } else { -1 },
                curve,
            }));
        }
    }
    crossings.sort_by(|a, b| a.line.cmp(&b.line).then(a.x.total_cmp(&b.x)));
    crossings
}
