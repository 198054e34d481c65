//! Intersection tests of segments with a sweep.

use incise_cut::Sweep;
use incise_mesh::{Aabb, Vec3};
use proptest::prelude::*;

proptest! {
    #[test]
    fn a_segment_meets_a_flat_sweep_if_its_ends_are_on_both_sides(
        from in [-1.0f32..1.0, -1.0..1.0, -1.0..1.0],
        to in [-1.0f32..1.0, -1.0..1.0, -1.0..1.0],
        n in [-1.0f64..1.0, -1.0..1.0, -1.0..1.0],
        d in -0.5f64..0.5,
    ) {
        let normal = Vec3::from(n);
        prop_assume!(normal.norm() > 0.1);
        let bounds = Aabb { min: [-1.0; 3], max: [1.0; 3] };
        let sweep = Sweep::from_plane(n, d * normal.norm(), &bounds).unwrap();
        let side = |p: [f32; 3]| normal.dot(&Vec3::from(p.map(f64::from))) / normal.norm() - d;
        let (a, b) = (side(from), side(to));
        prop_assume!(a.abs() > 1e-5 && b.abs() > 1e-5);
        prop_assert_eq!(sweep.intersects_segment(from, to), (a < 0.0) != (b < 0.0));
        prop_assert_eq!(sweep.intersects_segment(to, from), sweep.intersects_segment(from, to));
    }
}

#[test]
fn a_segment_beside_or_before_a_sweep_misses() {
    let sweep = Sweep::new(
        [[0.0; 3], [1.0, 0.0, 0.0]],
        [[0.0, 1.0, 0.0], [1.0, 1.0, 0.5]],
    );
    let sweep = sweep.unwrap();
    let through = |x: f32, y: f32| sweep.intersects_segment([x, y, -2.0], [x, y, 2.0]);
    assert!(through(0.2, 0.5) && through(0.8, 0.5), "both triangles");
    assert!(through(0.5, 0.5), "the crease");
    assert!(through(0.0, 0.0) && through(1.0, 0.5), "the border");
    assert!(!through(1.1, 0.5) && !through(0.5, -0.1), "beside it");
    assert!(
        !sweep.intersects_segment([0.5, 0.2, 1.0], [0.5, 0.2, 2.0]),
        "before it"
    );
}
