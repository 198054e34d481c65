//! Checks of cut surfaces that several tests share.

use incise_cut::{CutMethod, CutParams, ExactParams};
use incise_mesh::Surface;
use std::collections::{BTreeMap, BTreeSet};

/// Returns parameters of the exact method.
pub(crate) fn params(snap: f64) -> CutParams {
    CutParams {
        method: CutMethod::Exact(ExactParams {
            snap,
            ..ExactParams::default()
        }),
        ..CutParams::default()
    }
}

/// Returns the Euler characteristic, and checks that the surface is a closed manifold on which no
/// edge has more than two triangles, also by its vertices alone.
pub(crate) fn check(surface: &Surface) -> i64 {
    surface.validate().unwrap();
    let topology = surface.topology();
    assert!(topology.is_closed(), "the surface is open");
    let mut edges = BTreeMap::new();
    let mut vertices = BTreeSet::new();
    let mut faces = 0;
    for t in topology.triangles() {
        let [a, b, c] = topology.triangle(t);
        vertices.extend([a, b, c]);
        faces += 1;
        for (v, w) in [(a, b), (b, c), (c, a)] {
            *edges.entry((v.min(w), v.max(w))).or_insert(0) += 1;
        }
    }
    for (edge, count) in &edges {
        assert_eq!(*count, 2, "{edge:?} has {count} triangles");
    }
    let count = |n: usize| i64::try_from(n).unwrap();
    count(vertices.len()) - count(edges.len()) + faces
}
