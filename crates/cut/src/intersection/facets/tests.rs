//! Ties of facets against facets that are displaced, and signs of sums of products.

use super::predicates::cross_sign;
use super::*;
use proptest::prelude::*;

fn lattice() -> impl Strategy<Value = [i8; 3]> {
    prop::array::uniform3(-2i8..=2)
}

fn vector(p: [i8; 3]) -> Vec3 {
    Vec3::from(p.map(f64::from))
}

proptest! {
    /// Signs of a degenerate sweep equal the plain signs of a sweep that is displaced a little.
    #[test]
    fn ties_are_those_of_a_moved_sweep(
        corners in prop::array::uniform4(lattice()),
        face in prop::array::uniform3(lattice()),
    ) {
        let sweep = |d: [f64; 3]| {
            let at = |p: [i8; 3]| incise_mesh::geometry::to_f32(vector(p) + Vec3::from(d));
            let [a, b, c, e] = corners.map(at);
            Sweep::new([a, b], [e, c])
        };
        // Powers of two, so that the moved corners are exact; far apart, as the symbolic ones
        // are.
        let moved = sweep([1.0 / 64.0, 1.0 / 8192.0, 1.0 / 1_048_576.0]);
        let (Ok(flush), Ok(moved)) = (sweep([0.0; 3]), moved) else { return Ok(()) };
        let [flush, moved] = [flush, moved].map(|sweep| {
            let mut facets = Facets::default();
            facets.read(&sweep, &ContinuedTip::default());
            facets
        });
        let face = face.map(vector);
        for i in [0, 1].into_iter().filter(|&i| flush.exists(i)) {
            let above = face.map(|p| flush.is_above(i, p));
            prop_assert_eq!(above, face.map(|p| moved.is_above(i, p)));
            for k in 0..3 {
                let (p, q) = (face[k], face[(k + 1) % 3]);
                if above[k] != above[(k + 1) % 3] {
                    let rises = above[(k + 1) % 3];
                    prop_assert_eq!(
                        flush.inside(i, p, q, rises),
                        moved.inside(i, p, q, rises)
                    );
                }
            }
            for edge in flush.edges_of(i) {
                prop_assert_eq!(flush.pierces(edge, face), moved.pierces(edge, face));
            }
        }
    }
}

#[test]
fn sums_of_products_keep_their_sign_where_rounding_loses_it() {
    // (2^60 + 1) and -(2^60), as products of f32 numbers.
    let big = 2.0_f64.powi(30);
    let u = Vec3::new(0.0, big, 0.0);
    let v = Vec3::new(0.0, 0.0, big);
    let one = (Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.0, 0.0, 1.0));
    assert_eq!(cross_sign(&[(u, v), one, (v, u)], 0), 1.0);
    assert_eq!(cross_sign(&[(u, v), (v, u)], 0), 0.0);
}
