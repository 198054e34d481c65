//! Repair of loops that touch or cross: displacement, clipping, splitting, separation.
//!
//! 1. Loops that only touch, at a point or along edges, become disjoint when their corners move by
//!    far less than an edge. Only the triangulation uses the displaced corners.
//! 2. Corners at edges too short for that are clipped with a triangle of nearly no area.
//! 3. A loop that crosses itself is split at the crossing. The two crossing edges and two new ones
//!    form a bow tie of two triangles; a loop remains on either side.
//! 4. Loops that cannot be split, or not within the time limit, are filled as they are by
//!    [`super::ear_clipping`].

use super::loop_triangulation::{Intersection, LoopTriangulation, LoopValidity};
use super::loops::SectionLoops;
use incise_mesh::index_u32;

/// Maximum displacement of a corner, relative to the extent of the group.
///
/// 84 roundings of 32-bit positions: those of a corner and of the planes that make it add up.
pub(crate) const MAX_DISPLACEMENT: f64 = 1e-5;
/// Displacements to try, relative to the extent of the group.
const DISPLACEMENTS: [f64; 3] = [1e-9, 1e-7, MAX_DISPLACEMENT];
/// Maximum displacement of a corner, relative to its shorter edge.
const MAX_EDGE_FRACTION: f64 = 0.1;

/// The result of splitting an invalid group of loops.
#[derive(Debug, Default)]
pub(crate) struct GroupSplit {
    /// Groups still to triangulate.
    pub(crate) groups: Vec<Vec<u32>>,
    /// Loops to fill as they are.
    pub(crate) self_intersecting: Vec<u32>,
    /// Loops of three or four corners around a crossing, to fill as they are.
    pub(crate) bow_ties: Vec<Vec<u32>>,
    /// Triangles that clip corners at very short edges.
    pub(crate) clipped: Vec<[u32; 3]>,
    /// Number of loops that were moved to a group of their own.
    pub(crate) separated_loops: usize,
}

/// Triangulates a group, with displaced corners where that makes the loops disjoint.
///
/// `repair_budget` is the number of vertices that may still be triangulated for repairs.
pub(crate) fn triangulate(
    loops: &mut SectionLoops,
    triangulation: &mut LoopTriangulation,
    group: &[u32],
    mirrored: bool,
    repair_budget: &mut usize,
) -> LoopValidity {
    let validity = triangulation.build(loops, group, mirrored);
    let short = || intersecting_vertices(triangulation).any(|v| is_short(triangulation, v));
    if triangulation.intersections.is_empty() || crosses_deeply(triangulation) || short() {
        return validity;
    }
    let areas = areas(triangulation);
    // Vertices to displace and whether inward; unknown for a loop that touches itself.
    let mut moves: Vec<(u32, Option<bool>)> = Vec::new();
    'moves: for reach in DISPLACEMENTS {
        for inward in [true, false] {
            if *repair_budget < triangulation.corner_of.len() {
                break 'moves;
            }
            *repair_budget -= triangulation.corner_of.len();
            for &intersection in &triangulation.intersections {
                add_moves(triangulation, intersection, &areas, &mut moves);
            }
            moves.sort_unstable();
            moves.dedup_by_key(|mover| mover.0);
            if !inward && moves.iter().all(|mover| mover.1.is_some()) {
                continue;
            }
            loops.restore();
            move_corners(loops, triangulation, mirrored, reach, inward, &moves);
            let validity = triangulation.build(loops, group, mirrored);
            if triangulation.intersections.is_empty() {
                return validity;
            }
        }
    }
    loops.restore();
    triangulation.build(loops, group, mirrored)
}

/// Returns a length that exceeds every displacement.
fn limit(triangulation: &LoopTriangulation) -> f64 {
    let extent = [0, 1].map(|k| triangulation.high[k] - triangulation.low[k]);
    4.0 * MAX_DISPLACEMENT * extent[0].max(extent[1])
}

/// Returns the vertices of all intersections.
fn intersecting_vertices(triangulation: &LoopTriangulation) -> impl Iterator<Item = u32> {
    triangulation
        .intersections
        .iter()
        .flat_map(|&intersection| intersection.vertices(triangulation))
}

/// Returns whether an edge at a vertex is too short to displace the vertex.
fn is_short(triangulation: &LoopTriangulation, v: u32) -> bool {
    let p = triangulation.cdt.point(v);
    [triangulation.prev(v), triangulation.next[v as usize]]
        .into_iter()
        .any(|w| {
            let q = triangulation.cdt.point(w);
            (q[0] - p[0]).hypot(q[1] - p[1]) < limit(triangulation)
        })
}

/// Returns whether two edges cross by more than displacements can undo.
fn crosses_deeply(triangulation: &LoopTriangulation) -> bool {
    let limit = limit(triangulation);
    triangulation.intersections.iter().any(|&intersection| {
        let Intersection::Crossing(v, w) = intersection else {
            return false;
        };
        let [a, b] =
            [v, w].map(|v| [v, triangulation.next[v as usize]].map(|v| triangulation.cdt.point(v)));
        let off = |[p, q]: [[f64; 2]; 2], r: [f64; 2]| {
            let d = [q[0] - p[0], q[1] - p[1]];
            (d[0] * (r[1] - p[1]) - d[1] * (r[0] - p[0])).abs() / d[0].hypot(d[1])
        };
        let depths = [off(a, b[0]), off(a, b[1]), off(b, a[0]), off(b, a[1])];
        depths.into_iter().fold(f64::INFINITY, f64::min) > limit
    })
}

/// Returns twice the signed area of each loop.
fn areas(triangulation: &LoopTriangulation) -> Vec<f64> {
    let mut areas = vec![0.0; triangulation.intersecting.len()];
    for (v, &w) in triangulation.next.iter().enumerate() {
        let [p, q] = [triangulation.cdt.points[v], triangulation.cdt.point(w)]
            .map(|p| [p[0] - triangulation.low[0], p[1] - triangulation.low[1]]);
        areas[triangulation.loop_of[v] as usize] += p[0] * q[1] - p[1] * q[0];
    }
    areas
}

/// Adds the vertices of an intersection and the direction in which they move.
///
/// Material between a hole and the loop around it, or between two holes, must grow: both move
/// outward. A gap between islands, or between an island and the hole around it, must grow: both
/// move inward.
fn add_moves(
    triangulation: &LoopTriangulation,
    intersection: Intersection,
    areas: &[f64],
    moves: &mut Vec<(u32, Option<bool>)>,
) {
    let (Intersection::Coincident(a, b)
    | Intersection::VertexOnEdge(a, b)
    | Intersection::Crossing(a, b)) = intersection;
    let [i, j] = [a, b].map(|v| triangulation.loop_of[v as usize]);
    let inward = (i != j).then(|| {
        let (x, y) = (areas[i as usize], areas[j as usize]);
        let (large, small) = if x.abs() > y.abs() { (x, y) } else { (y, x) };
        // The larger loop encloses the smaller one, or they lie side by side.
        match (large > 0.0, small > 0.0) {
            (true, true) => true,
            (false, false) => false,
            (large_is_loop, _) => !large_is_loop || large == -small,
        }
    });
    moves.extend(intersection.vertices(triangulation).map(|v| (v, inward)));
}

/// Displaces corners along their normals.
fn move_corners(
    loops: &mut SectionLoops,
    triangulation: &LoopTriangulation,
    mirrored: bool,
    reach: f64,
    otherwise: bool,
    moves: &[(u32, Option<bool>)],
) {
    loops.remember();
    let extent = [0, 1].map(|k| triangulation.high[k] - triangulation.low[k]);
    let reach = reach * extent[0].max(extent[1]);
    let side = if mirrored { -1.0 } else { 1.0 };
    for &(v, inward) in moves {
        let [o, p, q] = [triangulation.prev(v), v, triangulation.next[v as usize]].map(|v| {
            let [x, y] = loops.original(triangulation.corner_of[v as usize]);
            [side * x, y]
        });
        let (d, e) = ([p[0] - o[0], p[1] - o[1]], [q[0] - p[0], q[1] - p[1]]);
        let (a, b) = (d[0].hypot(d[1]), e[0].hypot(e[1]));
        let normal = [-d[1] / a - e[1] / b, d[0] / a + e[0] / b];
        let size = normal[0].hypot(normal[1]);
        let direction = if inward.unwrap_or(otherwise) {
            1.0
        } else {
            -1.0
        };
        let step = direction * reach.min(MAX_EDGE_FRACTION * a.min(b)) / size;
        let at = [p[0] + step * normal[0], p[1] + step * normal[1]];
        if at[0].is_finite() && at[1].is_finite() {
            loops.points[triangulation.corner_of[v as usize] as usize] = [side * at[0], at[1]];
        }
    }
}

/// Splits an invalid group into groups that can be triangulated separately.
pub(crate) fn split_group(
    loops: &mut SectionLoops,
    triangulation: &LoopTriangulation,
    group: &[u32],
    has_edge: &impl Fn(u32, u32) -> bool,
    may_split: bool,
) -> GroupSplit {
    let mut parts = GroupSplit::default();
    let loop_of = |v: u32| triangulation.loop_of[v as usize] as usize;
    let mut removed = vec![false; group.len()];
    let mut remaining = Vec::new();
    if may_split {
        parts.clipped = clip_short_edges(
            loops,
            triangulation,
            group,
            has_edge,
            &mut removed,
            &mut remaining,
        );
    }
    if may_split && parts.clipped.is_empty() {
        for &intersection in &triangulation.intersections {
            let (Intersection::Coincident(v, w)
            | Intersection::VertexOnEdge(v, w)
            | Intersection::Crossing(v, w)) = intersection;
            let index = loop_of(v);
            if index == loop_of(w)
                && !removed[index]
                && let Some((parts_of_loop, bow_tie)) =
                    split(loops, triangulation, group[index], intersection, has_edge)
            {
                removed[index] = true;
                // Only the longer part stays in the group: together, both parts could share more
                // edges than those of the bow tie.
                let longer = parts_of_loop
                    .iter()
                    .copied()
                    .max_by_key(|&part| loops.corners(part as usize).len());
                remaining.extend(longer);
                let others = parts_of_loop
                    .into_iter()
                    .filter(|&part| Some(part) != longer);
                parts.groups.extend(others.map(|part| vec![part]));
                parts.bow_ties.extend(bow_tie);
            }
        }
        if remaining.is_empty() && !removed.contains(&true) {
            // Of two intersecting loops, the shorter one leaves the group.
            for &intersection in &triangulation.intersections {
                let (Intersection::Coincident(v, w)
                | Intersection::VertexOnEdge(v, w)
                | Intersection::Crossing(v, w)) = intersection;
                let (a, b) = (loop_of(v), loop_of(w));
                if a != b && !removed[a] && !removed[b] {
                    let length = |i: usize| loops.corners(group[i] as usize).len();
                    let out = if length(a) < length(b) { a } else { b };
                    removed[out] = true;
                    parts.separated_loops += 1;
                    parts.groups.push(vec![group[out]]);
                }
            }
        }
    }
    if !removed.contains(&true) {
        for (i, &index) in group.iter().enumerate() {
            if triangulation.intersecting[i] {
                removed[i] = true;
                parts.self_intersecting.push(index);
            }
        }
    }
    let rest = group.iter().zip(&removed).filter(|(_, removed)| !**removed);
    remaining.extend(rest.map(|(&index, _)| index));
    parts.groups.push(remaining);
    parts
}

/// Clips corners at short edges of intersections and returns the triangles.
///
/// The clipped loops are marked in `removed` and their replacements appended to `remaining`.
fn clip_short_edges(
    loops: &mut SectionLoops,
    triangulation: &LoopTriangulation,
    group: &[u32],
    has_edge: &impl Fn(u32, u32) -> bool,
    removed: &mut [bool],
    remaining: &mut Vec<u32>,
) -> Vec<[u32; 3]> {
    let mut taken = vec![false; triangulation.corner_of.len()];
    let mut left: Vec<usize> = group
        .iter()
        .map(|&r| loops.corners(r as usize).len())
        .collect();
    let mut triangles = Vec::new();
    let corner = |v: u32| triangulation.corner_of[v as usize];
    for v in intersecting_vertices(triangulation) {
        let (o, q) = (triangulation.prev(v), triangulation.next[v as usize]);
        let index = triangulation.loop_of[v as usize] as usize;
        let free = ![o, v, q].iter().any(|&w| taken[w as usize]);
        let ids = [o, q].map(|w| loops.point_ids[corner(w) as usize]);
        if free && left[index] > 3 && is_short(triangulation, v) && !has_edge(ids[0], ids[1]) {
            taken[v as usize] = true;
            left[index] -= 1;
            removed[index] = true;
            triangles.push([o, v, q].map(corner));
        }
    }
    for index in (0..group.len()).filter(|&i| removed[i]) {
        remaining.push(index_u32(loops.loop_count()));
        let kept = (0u32..).zip(&triangulation.corner_of).filter(|&(v, _)| {
            triangulation.loop_of[v as usize] as usize == index && !taken[v as usize]
        });
        loops.push_loop(kept.map(|(_, &corner)| corner));
    }
    triangles
}

/// Splits a loop at a self-intersection.
///
/// Returns the loops on either side and the bow tie around the intersection, or `None` if the
/// surrounding surface already has one of the new edges.
fn split(
    loops: &mut SectionLoops,
    triangulation: &LoopTriangulation,
    index: u32,
    intersection: Intersection,
    has_edge: &impl Fn(u32, u32) -> bool,
) -> Option<(Vec<u32>, Option<Vec<u32>>)> {
    let corners = loops.corners(index as usize).to_vec();
    let n = corners.len();
    let position = |v: u32| (v - triangulation.first_of_loop(v)) as usize;
    // Two arcs, each closed by an edge from its last position to its first, and the bow tie.
    let (arcs, bow_tie) = match intersection {
        Intersection::Coincident(v, w) => {
            let (v, w) = (position(v), position(w));
            ([[v, w], [w, v]], None)
        }
        Intersection::VertexOnEdge(v, w) => {
            let (v, w) = (position(v), position(w));
            let after = (v + 1) % n;
            ([[after, w], [w, v]], Some(vec![v, after, w]))
        }
        Intersection::Crossing(v, w) => {
            let (v, w) = (position(v), position(w));
            let ends = [(v + 1) % n, (w + 1) % n];
            (
                [[ends[0], w], [ends[1], v]],
                Some(vec![v, ends[0], w, ends[1]]),
            )
        }
    };
    let length = |[from, to]: [usize; 2]| (to + n - from) % n + 1;
    for arc in arcs {
        let [a, b] = arc.map(|i| loops.point_ids[corners[i] as usize]);
        // An arc of two is an edge of the loop; an arc of all corners would split off nothing.
        if length(arc) == n || a == b || (length(arc) > 2 && has_edge(a, b)) {
            return None;
        }
    }
    let mut parts_of_loop = Vec::new();
    for arc in arcs.into_iter().filter(|&arc| length(arc) > 2) {
        parts_of_loop.push(index_u32(loops.loop_count()));
        loops.push_loop((0..length(arc)).map(|k| corners[(arc[0] + k) % n]));
    }
    let bow_tie = bow_tie.map(|places| places.into_iter().map(|i| corners[i]).collect());
    Some((parts_of_loop, bow_tie))
}
