//! Checks of cut surfaces that several tests share.

use incise_cut::CutParams;
use incise_mesh::Surface;
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
