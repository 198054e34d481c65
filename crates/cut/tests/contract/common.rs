//! Checks of cut surfaces that several tests share.

use incise_cut::CutParams;
use incise_mesh::geometry::to_f32;
use incise_mesh::{HalfEdge, Surface};
use std::collections::BTreeMap;

/// Returns parameters with a snapping distance.
pub(crate) fn params(snap: f64) -> CutParams {
    CutParams {
        snap,
        ..CutParams::default()
    }
}

/// Returns the Euler characteristic and checks that the surface is a closed manifold, see
/// [`check_manifold`].
pub(crate) fn check(surface: &Surface) -> i64 {
    assert!(surface.topology().is_closed(), "the surface is open");
    check_manifold(surface)
}

/// Returns the Euler characteristic and checks that the surface is an oriented manifold on which no
/// edge has more than two triangles, also by its vertices alone.
pub(crate) fn check_manifold(surface: &Surface) -> i64 {
    surface.validate().unwrap();
    let topology = surface.topology();
    let mut edges = BTreeMap::new();
    for t in topology.triangles() {
        let [a, b, c] = topology.triangle(t);
        for (v, w) in [(a, b), (b, c), (c, a)] {
            let uses: &mut [u32; 2] = edges.entry((v.min(w), v.max(w))).or_default();
            uses[usize::from(v < w)] += 1;
        }
    }
    for (edge, uses) in &edges {
        assert!(
            uses.iter().all(|&n| n <= 1),
            "{edge:?} has {uses:?} triangles"
        );
    }
    let vertices = topology.vertices();
    let used = vertices
        .filter(|&v| !topology.outgoing(v).is_null())
        .count();
    let count = |n: usize| i64::try_from(n).unwrap();
    count(used) - count(edges.len()) + count(topology.triangle_count())
}

/// Returns the length of the shortest edge at rest \[m\].
pub(crate) fn shortest_edge(surface: &Surface) -> f64 {
    let topology = surface.topology();
    let lengths = topology.edges().map(|h| {
        let [a, b] = [topology.origin(h), topology.target(h)].map(|v| surface.rest_position(v));
        (b - a).norm()
    });
    lengths.fold(f64::INFINITY, f64::min)
}

/// Returns the surface of a box of `counts` cells along each axis, two triangles a face.
///
/// `map` takes points of the unit cube to positions.
pub(crate) fn lattice_box(counts: [u16; 3], map: impl Fn([f64; 3]) -> [f64; 3]) -> Surface {
    let mut ids = BTreeMap::new();
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for (end, is_far) in [(0, false), (counts[axis], true)] {
            for (i, j) in (0..counts[u]).flat_map(|i| (0..counts[v]).map(move |j| (i, j))) {
                let corners = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]].map(|[i, j]| {
                    let mut cell = [end; 3];
                    (cell[u], cell[v]) = (i, j);
                    *ids.entry(cell).or_insert_with(|| {
                        let part = [0, 1, 2].map(|k| f64::from(cell[k]) / f64::from(counts[k]));
                        positions.push(to_f32(map(part).into()));
                        u32::try_from(positions.len() - 1).unwrap()
                    })
                });
                let [a, b, c, d] = corners;
                triangles.extend(if is_far {
                    [[a, b, c], [a, c, d]]
                } else {
                    [[a, c, b], [a, d, c]]
                });
            }
        }
    }
    Surface::from_triangles(&positions, &triangles).unwrap()
}

/// Returns the edges at which the skin is folded flat at rest.
///
/// Walls meet like this at their tips.
pub(crate) fn skin_folds(surface: &Surface) -> Vec<HalfEdge> {
    let is_skin = |h: HalfEdge| surface.material(h.triangle()) != CutParams::default().cap_material;
    let is_between_skin = |&h: &HalfEdge| is_skin(h) && is_skin(surface.topology().twin(h));
    surface.rest_folds().filter(is_between_skin).collect()
}
