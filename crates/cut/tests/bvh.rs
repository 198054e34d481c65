//! The search tree against looking at every triangle.

use incise_cut::{Bvh, Sweep};
use incise_mesh::{Surface, TriangleId, Vec3, torus};
use proptest::prelude::*;

/// Every triangle that straddles the plane, and every one whose box reaches it.
fn brute_force(surface: &Surface, n: Vec3, d: f64) -> (Vec<TriangleId>, Vec<TriangleId>) {
    let (mut straddles, mut reaches) = (Vec::new(), Vec::new());
    for t in surface.topology().triangles() {
        let corners = surface.triangle_positions(t);
        let heights = corners.map(|p| n.dot(&p) - d);
        if heights.iter().any(|&h| h > 1e-6) && heights.iter().any(|&h| h < -1e-6) {
            straddles.push(t);
        }
        let [low, high] = [f64::min, f64::max]
            .map(|pick| Vec3::from_fn(|k, _| corners.iter().map(|p| p[k]).reduce(pick).unwrap()));
        let reach = n.abs().dot(&((high - low) / 2.0));
        if (n.dot(&((high + low) / 2.0)) - d).abs() <= reach + 1e-6 {
            reaches.push(t);
        }
    }
    (straddles, reaches)
}

proptest! {
    #[test]
    fn a_query_finds_all_and_little_more(
        n in [-1.0f64..1.0, -1.0..1.0, -1.0..1.0],
        d in -1.5f64..1.5,
        push in [0.01f32..0.3, 0.01..0.3, 0.01..0.3],
    ) {
        prop_assume!(Vec3::from(n).norm() > 0.1);
        let mut surface = torus(1.0, 0.4, 40, 20);
        let mut bvh = Bvh::build(&surface);
        bvh.validate(&surface).unwrap();
        for (i, p) in surface.positions.iter_mut().enumerate() {
            p[i % 3] += push[i % 3];
        }
        prop_assert!(bvh.validate(&surface).is_err(), "it no longer fits");
        bvh.refit(&surface);
        bvh.validate(&surface).unwrap();
        let length = Vec3::from(n).norm();
        let sweep = Sweep::across_box(n, d * length, &surface.bounds()).unwrap();
        let mut found = Vec::new();
        bvh.query(&surface, &sweep, &mut found);
        found.sort_unstable();
        let (straddles, reaches) = brute_force(&surface, Vec3::from(n) / length, d);
        prop_assert!(straddles.iter().all(|t| found.binary_search(t).is_ok()));
        prop_assert!(found.iter().all(|t| reaches.binary_search(t).is_ok()));
    }
}

#[test]
fn an_empty_surface_has_an_empty_tree() {
    let surface = Surface::default();
    let bvh = Bvh::build(&surface);
    bvh.validate(&surface).unwrap();
    let sweep = Sweep::new(
        [[0.0; 3], [1.0, 0.0, 0.0]],
        [[0.0, 1.0, 0.0], [1.0, 1.0, 0.0]],
    );
    let mut found = Vec::new();
    bvh.query(&surface, &sweep.unwrap(), &mut found);
    assert!(found.is_empty());
}
