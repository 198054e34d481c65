//! The paper's Algorithm 3: a new, even boundary between the old one and the intersection points.
//!
//! Deviations from the listing, where it is incomplete or wrong:
//!
//! - Line 6 computes half the difference of the ends; the center is half their sum.
//! - Lines 10 to 13 take the nearest of all intersection points, `minDist` never reset. Nearest in
//!   space may be across a thin limb or out of order, which folds the surface. The nearest is taken
//!   among the points of the same loop, from the previous edge's point to the end of the next
//!   edge's triangle. That keeps the order along the loop and tests only a few points for each
//!   edge.
//! - Points that are nearest to no edge would be omitted, and the rim would cut the corner. They
//!   are connected to the old vertex between the edges whose points precede and follow.
//! - A point close to a surviving old vertex would make a sliver in the cap. The vertex replaces
//!   the point, as in the merge of close points of Algorithm 2.
//! - Lines 20 to 22 remove an edge and its opposite. Edges are in loop order here, so the two are
//!   consecutive, and the sort of lines 23 to 27 is not needed.
//! - Line 30 measures a signed angle without saying about what: about the outward normal of the hit
//!   triangles at the common vertex.
//! - Line 31 may close an ear at an intersection point too. Such an ear lies in the cap, so only
//!   old vertices are closed.
//! - Lines 32 to 33 take both edges away but go on with the second; the listing goes on behind it
//!   here.
//! - An old vertex that the boundary of this side passes twice must not stay on the rim, where the
//!   cap would meet itself: its edges are always connected to points and its ear is always closed.
//!   An edge whose triangles are both hit is always connected too: nothing else would hold it.

use super::points::PointSet;
use super::sides::Side;
use super::{Corner, Listing, is_edge};
use incise_mesh::geometry::angle_between;
use incise_mesh::{Surface, Vec3, VertexId, index_u32};

/// The new boundary: triangles up to it, and the loop along which the cap runs.
#[derive(Debug, Default)]
pub(super) struct Boundary {
    pub(super) walls: Vec<[Corner; 3]>,
    pub(super) rim: Vec<Corner>,
}

/// Returns the boundary along all points, with every hit triangle cut along the sweep.
pub(super) fn along_points(side: &Side) -> Boundary {
    let count = side.points.len();
    let point = |rank: u32| Corner::Point(side.points[rank as usize % count]);
    let mut out = Boundary::default();
    for step in &side.steps {
        let (from, to) = (point(step.from), point(step.to));
        if let Some(end) = step.end {
            out.walls
                .push([Corner::Old(step.start), Corner::Old(end), to]);
        }
        if from != to {
            out.walls.push([from, Corner::Old(step.start), to]);
        }
    }
    out.rim = side.points.iter().map(|&p| Corner::Point(p)).collect();
    out
}

/// Returns the boundary of Algorithm 3.
pub(super) fn new_boundary(
    surface: &Surface,
    listing: &Listing<'_>,
    points: &PointSet,
    side: &Side,
) -> Boundary {
    let mut walls = Vec::new();
    let ring = connect(surface, listing, points, side, &mut walls);
    let ring = remove_duplicates(ring);
    let rim = close_ears(surface, listing, points, side, ring, &mut walls);
    Boundary { walls, rim }
}

/// A corner of the boundary and the outward normal of the hit triangles there.
#[derive(Debug, Clone, Copy)]
struct RingCorner {
    corner: Corner,
    normal: Vec3,
}

/// Lines 5 to 19: connects edges far from the plane to their nearest point.
fn connect(
    surface: &Surface,
    listing: &Listing<'_>,
    points: &PointSet,
    side: &Side,
    walls: &mut Vec<[Corner; 3]>,
) -> Vec<RingCorner> {
    let beta = listing.params.beta * listing.mean_edge;
    let (origin, plane_normal) = listing.sweep.plane();
    let distance = |v: VertexId| plane_normal.dot(&(surface.position(v) - origin)).abs();
    let count = index_u32(side.points.len());
    let id = |rank: u32| side.points[(rank % count) as usize];
    let point = |rank: u32| {
        let id = id(rank);
        let point = &points.points[id as usize];
        let v = match side.positive {
            true => surface.topology().target(point.entry),
            false => surface.topology().origin(point.entry),
        };
        let gap = (surface.position(v) - point.position).norm();
        let stays = distance(v) <= beta && !side.is_pinched(v);
        if stays && gap < listing.params.min_distance * listing.mean_edge {
            Corner::Old(v)
        } else {
            Corner::Point(id)
        }
    };
    let edges: Vec<(usize, VertexId, VertexId)> = side
        .steps
        .iter()
        .enumerate()
        .filter_map(|(j, s)| s.end.map(|end| (j, s.start, end)))
        .collect();
    // For every edge the rank of its point and what stands there, if it is connected.
    let mut connected: Vec<Option<(u32, Corner)>> = Vec::with_capacity(edges.len());
    let mut first = None;
    let mut previous = side.steps[edges[0].0].from;
    for (i, &(j, start, end)) in edges.iter().enumerate() {
        let far = distance(start) > beta && distance(end) > beta;
        if !far && !side.is_pinched(start) && !side.is_pinched(end) && !side.steps[j].is_loose {
            connected.push(None);
            continue;
        }
        let last = match edges.get(i + 1) {
            Some(&(next, ..)) => side.steps[next].to,
            None => first.map_or(count, |f: u32| f + count),
        };
        let center = (surface.position(start) + surface.position(end)) / 2.0;
        let gap = |rank: u32| (points.position(surface, point(rank)) - center).norm_squared();
        // Out along a loose edge and back: the vertex at its end needs two points.
        if side.steps[j].is_loose && i > 0 && side.steps[edges[i - 1].0].is_loose {
            previous += 1;
        }
        let own = side.steps[j].to.max(previous);
        let nearer = |best, rank| if gap(rank) < gap(best) { rank } else { best };
        let nearest = (previous..=last.max(own)).fold(own, nearer);
        first.get_or_insert(nearest);
        previous = nearest;
        // A side of loose edges alone would vanish if an old vertex stood for the point.
        let p = if side.steps[j].is_loose {
            Corner::Point(id(nearest))
        } else {
            point(nearest)
        };
        let own_end = p == Corner::Old(start) || p == Corner::Old(end);
        connected.push((!own_end).then_some((nearest, p)));
    }
    let mut ring = Vec::with_capacity(2 * edges.len());
    for (i, &(_, start, end)) in edges.iter().enumerate() {
        let v = Corner::Old(start);
        let before = connected[(i + edges.len() - 1) % edges.len()];
        let between = match (before, connected[i]) {
            (Some((r0, _)), Some((r1, _))) => r0 + 1..if i == 0 { r1 + count } else { r1 },
            _ => 0..0,
        };
        let fan: Vec<Corner> = before
            .into_iter()
            .map(|(_, p)| p)
            .chain(between.clone().map(point))
            .chain(connected[i].map(|(_, p)| p))
            .collect();
        // An old vertex in a point's place has a place on the ring already.
        let is_point = |c: &Corner| matches!(c, Corner::Point(_));
        let is_fan = !between.is_empty()
            && fan.iter().all(is_point)
            && (1..fan.len()).all(|k| !fan[..k].contains(&fan[k]));
        let normal = normal_before(side, &edges, i);
        if is_fan {
            walls.extend(fan.windows(2).map(|pair| [pair[0], v, pair[1]]));
            let corner = |&corner: &Corner| RingCorner { corner, normal };
            ring.extend(fan[1..fan.len() - 1].iter().map(corner));
        } else {
            ring.push(RingCorner { corner: v, normal });
        }
        if let Some((_, p)) = connected[i] {
            walls.push([v, Corner::Old(end), p]);
            let normal = Vec3::zeros();
            ring.push(RingCorner { corner: p, normal });
        }
    }
    ring
}

/// Returns the sum of the normals of the hit triangles around the start of edge `i`.
fn normal_before(side: &Side, edges: &[(usize, VertexId, VertexId)], i: usize) -> Vec3 {
    let n = side.steps.len();
    let to = edges[i].0;
    let mut at = edges[(i + edges.len() - 1) % edges.len()].0;
    let mut sum = side.steps[at].normal;
    while at != to {
        at = (at + 1) % n;
        sum += side.steps[at].normal;
    }
    sum
}

/// Lines 20 to 22: removes pairs of opposite edges.
fn remove_duplicates(ring: Vec<RingCorner>) -> Vec<RingCorner> {
    let mut out: Vec<RingCorner> = Vec::with_capacity(ring.len());
    for item in ring {
        out.push(item);
        let n = out.len();
        if n >= 3 && out[n - 1].corner == out[n - 3].corner {
            out.truncate(n - 2);
        }
    }
    while out.len() >= 3 {
        let n = out.len();
        if out[n - 2].corner == out[0].corner {
            out.truncate(n - 2);
        } else if out[n - 1].corner == out[1].corner {
            out.pop();
            out.remove(0);
        } else {
            break;
        }
    }
    out
}

/// Lines 28 to 35: closes sharp ears at old vertices.
fn close_ears(
    surface: &Surface,
    listing: &Listing<'_>,
    points: &PointSet,
    side: &Side,
    mut ring: Vec<RingCorner>,
    walls: &mut Vec<[Corner; 3]>,
) -> Vec<Corner> {
    let ear_angle = listing.params.ear_angle.to_radians();
    for forced in [false, true] {
        let n = ring.len();
        let mut keep = vec![true; n];
        let mut left = n;
        let mut i = 0;
        // The ear at position i has the corners before and behind it. Position i - 1 was kept:
        // after an ear the walk goes on two positions further.
        while i < n && left > 3 {
            let before = ring[(i + n - 1) % n].corner;
            let RingCorner { corner, normal } = ring[i];
            let behind = ring[(i + 1) % n].corner;
            let Corner::Old(v) = corner else {
                i += 1;
                continue;
            };
            let [p, x, q] = [before, corner, behind].map(|c| points.position(surface, c));
            let signed_area = (x - p).cross(&(q - p)).dot(&normal);
            let close = if forced {
                side.is_pinched(v)
            } else {
                signed_area > 0.0
                    && angle_between(p - x, q - x) < ear_angle
                    && !is_edge(surface, before, behind)
            };
            // The first corner is behind the last one: its ear must not take the same edge twice.
            let wraps = i + 1 == n && !keep[0];
            if close && before != behind && !wraps {
                walls.push([before, corner, behind]);
                keep[i] = false;
                left -= 1;
                i += 1;
            }
            i += 1;
        }
        let mut kept = keep.into_iter();
        ring.retain(|_| kept.next() == Some(true));
    }
    ring.into_iter().map(|r| r.corner).collect()
}
