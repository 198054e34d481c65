//! Invariants of the exact method, also for bodies that intersect themselves.

use super::section::Section;
use super::{assert_delta_matches, assert_same_bits};
use incise_cut::{CutOutcome, CutParams, Cutter, Sweep};
use incise_mesh::geometry::area_vector;
use incise_mesh::{AddedVertex, HalfEdge, Surface, TriangleId, Vec3, VertexId, VertexOrigin};
use std::collections::{BTreeMap, BTreeSet};

/// Lengths and areas of a cut, for tolerances of rounding.
struct Scale {
    /// Rounding error of a new vertex \[m\], from its coordinates and its parameter on the edge.
    shift: f64,
    /// Area of the removed triangles \[m^2\].
    strip: f64,
    /// Sum of their perimeters \[m\].
    perimeters: f64,
    /// Diagonal of the bounding box \[m\].
    diagonal: f64,
    /// Area of the body \[m^2\].
    area: f64,
}

impl Scale {
    fn of(before: &Surface, outcome: &CutOutcome) -> Self {
        let bounds = before.bounds();
        let coordinates = bounds.min.iter().chain(&bounds.max);
        let largest = coordinates.fold(0.0, |m, x| f64::from(x.abs()).max(m));
        let (mut strip, mut perimeters, mut longest) = (0.0, 0.0, 0.0_f64);
        for (_, corners) in &outcome.delta.triangles_removed {
            let [a, b, c] = corners.map(|v| before.position(v));
            strip += area_vector([a, b, c]).norm() / 2.0;
            for edge in [b - a, c - b, a - c] {
                perimeters += edge.norm();
                longest = longest.max(edge.norm());
            }
        }
        Self {
            shift: f64::from(f32::EPSILON) * (largest + longest),
            strip,
            perimeters,
            diagonal: bounds.diagonal(),
            area: before.area(),
        }
    }
}

/// Asserts all invariants of the cut of `before` along `sweep` with result `after`.
pub(super) fn assert_exact(
    before: &Surface,
    after: &Surface,
    sweep: &Sweep,
    params: &CutParams,
    outcome: &CutOutcome,
) {
    let scale = Scale::of(before, outcome);
    assert_caps_are_mirrored(after, outcome);
    assert_caps_are_on_the_sweep(after, sweep, outcome, &scale);
    assert_volume_is_kept(before, after, outcome, &scale);
    assert_short_edges_are_counted(before, after, params.snap, outcome, &scale);
    assert_pieces_lie_on_one_side(after, sweep, outcome, &scale);
    if params.snap == 0.0 && params.remesh == 0.0 {
        assert_surface_is_kept(before, after, outcome, &scale);
    }
    assert!(
        (outcome.cap.iter()).all(|&t| after.material(t) == params.cap_material),
        "a cap is of another material"
    );
    assert_undo_and_redo(before, after, sweep, params, outcome);
}

/// Returns the caps of the two sides, each half of the triangles, the lower side first.
fn sides(outcome: &CutOutcome) -> [&[TriangleId]; 2] {
    let (lower, upper) = outcome.cap.split_at(outcome.cap.len() / 2);
    [lower, upper]
}

/// Asserts that the caps have the same triangles with opposite orientation, in any order.
fn assert_caps_are_mirrored(after: &Surface, outcome: &CutOutcome) {
    let [lower, upper] = sides(outcome);
    assert_eq!(lower.len(), upper.len(), "the caps differ");
    let corners = |t: TriangleId| {
        let of = |v: VertexId| after.positions()[v.index()];
        (after.topology().triangle(t)).map(|v| [0, 1, 2].map(|k| of(v)[k].to_bits()))
    };
    let turned = |[a, b, c]: [[u32; 3]; 3]| [[a, b, c], [b, c, a], [c, a, b]].into_iter().min();
    let mut expected: Vec<_> = (lower.iter())
        .map(|&t| corners(t))
        .map(|[a, b, c]| turned([a, c, b]))
        .collect();
    let mut found: Vec<_> = upper.iter().map(|&t| turned(corners(t))).collect();
    expected.sort_unstable();
    found.sort_unstable();
    assert!(expected == found, "the caps are not mirror images");
}

fn assert_caps_are_on_the_sweep(
    after: &Surface,
    sweep: &Sweep,
    outcome: &CutOutcome,
    scale: &Scale,
) {
    let planes = sweep.triangles().map(|t| (t[0], area_vector(t)));
    let planes: Vec<_> = planes.map(|(p, n)| (p, n.try_normalize(0.0))).collect();
    for &t in &outcome.cap {
        for p in after.triangle_positions(t) {
            let distance = planes
                .iter()
                .filter_map(|(o, n)| Some(n.as_ref()?.dot(&(p - o)).abs()))
                .fold(f64::INFINITY, f64::min);
            assert!(
                distance <= 4.0 * scale.shift,
                "a cap's corner is {distance} off the sweep, rounding is {}",
                scale.shift
            );
        }
    }
}

/// Asserts that the volume changes only by snapping, remeshing and rounding; mirrored caps cancel.
fn assert_volume_is_kept(before: &Surface, after: &Surface, outcome: &CutOutcome, scale: &Scale) {
    // The same apex for both surfaces.
    let apex = before.bounds().center();
    let volume = |s: &Surface| -> f64 {
        let cone = |p: [Vec3; 3]| (p[0] - apex).dot(&area_vector(p)) / 6.0;
        let triangles = s.topology().triangles();
        triangles.map(|t| cone(s.triangle_positions(t))).sum()
    };
    let error = (volume(after) - volume(before)).abs();
    let moved = outcome.report.moved_volume;
    let bound = moved + 4.0 * scale.shift * scale.strip + 1e-12 * scale.area * scale.diagonal;
    assert!(
        error <= bound,
        "the volume changed by {error}, of which {moved} was reported, to {bound}"
    );
}

/// Returns the mean edge length of the triangles on which a vertex of the rim was created.
fn local_edge(before: &Surface, origin: &VertexOrigin) -> Option<f64> {
    let topology = before.topology();
    let triangles: Vec<TriangleId> = match *origin {
        VertexOrigin::OnEdge { a, b, .. } => [(a, b), (b, a)]
            .iter()
            .filter_map(|&(a, b)| Some(topology.find_half_edge(a, b)?.triangle()))
            .collect(),
        VertexOrigin::InFace {
            corners: [a, b, c], ..
        } => [(a, b), (b, a)]
            .iter()
            .filter_map(|&(a, b)| topology.find_half_edge(a, b))
            .filter(|h| topology.origin(h.prev()) == c)
            .map(HalfEdge::triangle)
            .collect(),
        _ => return None,
    };
    let perimeter = |t: &TriangleId| {
        let [a, b, c] = before.triangle_positions(*t);
        (b - a).norm() + (c - b).norm() + (a - c).norm()
    };
    Some(triangles.iter().map(perimeter).sum::<f64>() / (3 * triangles.len()) as f64)
}

/// Asserts that the report counts the edges of one rim that are shorter than requested.
fn assert_short_edges_are_counted(
    before: &Surface,
    after: &Surface,
    snap: f64,
    outcome: &CutOutcome,
    scale: &Scale,
) {
    let added = |v: VertexId| -> Option<&AddedVertex> {
        outcome.delta.vertices_added.iter().find(|a| a.vertex == v)
    };
    let origins: BTreeMap<VertexId, &VertexOrigin> = (outcome.delta.vertices_added.iter())
        .map(|a| (a.vertex, &a.origin))
        .collect();
    let topology = after.topology();
    for cap in sides(outcome) {
        let own: BTreeSet<TriangleId> = cap.iter().copied().collect();
        let mut short = [0, 0];
        for h in cap.iter().flat_map(|t| t.half_edges()) {
            if own.contains(&topology.twin(h).triangle()) {
                continue;
            }
            let ends = [topology.origin(h), topology.target(h)];
            let local = ends.map(|v| {
                let origin = origins.get(&v).unwrap_or_else(|| {
                    panic!("{v} of the rim is not new: {:?}", added(v));
                });
                local_edge(before, origin).expect("the rim's vertices are on edges and in faces")
            });
            let [a, b] = ends.map(|v| after.position(v));
            let limit = snap * local[0].min(local[1]);
            // Both ends are rounded, so an edge near the limit may be counted or not.
            let rounding = 2.0 * scale.shift;
            short[0] += usize::from((b - a).norm() < limit - rounding);
            short[1] += usize::from((b - a).norm() < limit + rounding);
        }
        let said = outcome.report.short_rim_edges;
        assert!(
            short[0] <= said && said <= short[1],
            "{said} short edges were reported, between {} and {} are there",
            short[0],
            short[1]
        );
    }
}

/// Asserts that every triangle outside of caps is on one side of a flat sweep.
fn assert_pieces_lie_on_one_side(
    after: &Surface,
    sweep: &Sweep,
    outcome: &CutOutcome,
    scale: &Scale,
) {
    let Some((origin, normal)) = flat(sweep) else {
        return;
    };
    let caps: BTreeSet<TriangleId> = outcome.cap.iter().copied().collect();
    for t in outcome.delta.triangles_added.iter() {
        if caps.contains(t) {
            continue;
        }
        let heights = (after.triangle_positions(*t)).map(|p| normal.dot(&(p - origin)));
        let is_below = heights.iter().all(|&h| h <= 4.0 * scale.shift);
        let is_above = heights.iter().all(|&h| h >= -4.0 * scale.shift);
        assert!(is_below || is_above, "{t} is on both sides: {heights:?}");
    }
}

/// Returns origin and normal of a sweep of one triangle.
fn flat(sweep: &Sweep) -> Option<(Vec3, Vec3)> {
    let [c, d] = [0, 1].map(|i| sweep.current()[i]);
    (c == d).then(|| sweep.plane())
}

/// Asserts that the area of every material is kept, in space and in the texture.
fn assert_surface_is_kept(before: &Surface, after: &Surface, outcome: &CutOutcome, scale: &Scale) {
    let report = &outcome.report;
    assert_eq!(
        (report.snapped_vertices, report.merged_points),
        (0, 0),
        "nothing is snapped"
    );
    assert!(
        outcome.delta.vertices_removed.is_empty(),
        "a vertex is gone"
    );
    let caps: BTreeSet<TriangleId> = outcome.cap.iter().copied().collect();
    let mut areas: BTreeMap<u32, [f64; 2]> = BTreeMap::new();
    let mut largest_uv = 0.0_f64;
    let mut add = |s: &Surface, t: TriangleId, sign: f64| {
        let corners = t.half_edges().map(HalfEdge::index);
        let uv = corners.map(|h| s.corner_uvs().get(h).copied().unwrap_or_default());
        let [a, b, c] = uv.map(|uv| uv.map(f64::from));
        let chart = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        largest_uv = uv
            .iter()
            .flatten()
            .fold(largest_uv, |m, x| m.max(f64::from(x.abs())));
        let sums = areas.entry(s.material(t)).or_default();
        sums[0] += sign * area_vector(s.triangle_positions(t)).norm() / 2.0;
        sums[1] += sign * chart / 2.0;
    };
    for &(t, _) in &outcome.delta.triangles_removed {
        add(before, t, -1.0);
    }
    for &t in &outcome.delta.triangles_added {
        if !caps.contains(&t) {
            add(after, t, 1.0);
        }
    }
    let count = outcome.delta.triangles_added.len() as f64;
    for (material, [area, chart]) in areas {
        let bound = 4.0 * scale.shift * scale.perimeters;
        assert!(
            area.abs() <= bound,
            "{area} of material {material} too much"
        );
        let bound = 4.0 * f64::from(f32::EPSILON) * count * largest_uv.powi(2);
        assert!(
            chart.abs() <= bound,
            "{chart} of the chart of material {material} too much"
        );
    }
}

/// Asserts that an undo restores every bit, and that another cutter repeats the cut bit for bit.
fn assert_undo_and_redo(
    before: &Surface,
    after: &Surface,
    sweep: &Sweep,
    params: &CutParams,
    outcome: &CutOutcome,
) {
    let undo = outcome.undo.clone().expect("a cut has an undo");
    let mut surface = after.clone();
    undo.revert(&mut surface)
        .expect("nothing has happened since");
    assert_same_bits(before, &surface);
    let again = Cutter::new(&surface)
        .cut(&mut surface, sweep, params)
        .expect("it was cut before");
    assert_same_bits(after, &surface);
    assert_eq!(outcome.delta, again.delta, "the deltas differ");
    assert_eq!(outcome.cap, again.cap, "the caps differ");
    assert_delta_matches(before, &surface, &again.delta);
}

/// Asserts that the caps of a flat sweep have the area, outlines and holes of the section.
///
/// For bodies without self-intersections, and without snapping, which may join parts of the
/// section.
///
/// # Panics
/// If they do not.
pub fn assert_caps_cover_section(
    before: &Surface,
    after: &Surface,
    sweep: &Sweep,
    params: &CutParams,
    outcome: &CutOutcome,
) {
    let Some((origin, normal)) = flat(sweep) else {
        return;
    };
    let section = Section::of(before, params.only_piece, [origin, normal]);
    if !section.is_clear {
        return;
    }
    let scale = Scale::of(before, outcome);
    for cap in sides(outcome) {
        let area = |&t: &TriangleId| area_vector(after.triangle_positions(t)).norm() / 2.0;
        let area: f64 = cap.iter().map(area).sum();
        let bound = 4.0 * scale.shift * section.length + 1e-12 * section.area;
        assert!(
            (area - section.area).abs() <= bound,
            "a cap of {area} for a section of {}, to {bound}",
            section.area
        );
        assert_eq!(
            super::euler_characteristic_of(after, cap),
            section.outlines - section.holes,
            "{} outlines with {} holes",
            section.outlines,
            section.holes
        );
    }
}
