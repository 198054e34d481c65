//! Properties of every cover, whatever the section.

use crate::sections::{
    Shape, check_any, check_clean, corners, cross, index, polygon_area, run, run_joined,
};
use incise_refine::{CoverParams, CoverScratch, CoverSize, cover};
use proptest::prelude::*;
use std::f64::consts::TAU;

/// A star-shaped ring around `center`, between `inner` and `outer`, clockwise where `hole`.
/// Vertices where the ring crosses y = 0 are put exactly there.
pub(crate) fn star(center: [f64; 2], radii: &[f64], hole: bool) -> Vec<[f64; 2]> {
    let n = radii.len();
    let ring: Vec<[f64; 2]> = radii
        .iter()
        .enumerate()
        .map(|(i, r)| {
            let a = i as f64 * TAU / n as f64;
            [center[0] + r * a.cos(), center[1] + r * a.sin()]
        })
        .collect();
    let mut ring = split_at_crease(&ring);
    if hole {
        ring.reverse();
    }
    ring
}

fn split_at_crease(ring: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut out = Vec::new();
    for (i, &p) in ring.iter().enumerate() {
        let q = ring[(i + 1) % ring.len()];
        out.push(p);
        if p[1] * q[1] < 0.0 {
            out.push([p[0] + (q[0] - p[0]) * p[1] / (p[1] - q[1]), 0.0]);
        }
    }
    out
}

/// An outer ring, a hole in it, an island in the hole with a hole, and two holes beside.
pub(crate) fn nested() -> impl Strategy<Value = Shape> {
    let ring = |from: f64, to: f64| prop::collection::vec(from..to, 5..40);
    (
        ring(8.0, 10.0),
        ring(4.0, 5.0),
        ring(2.0, 3.5),
        ring(0.3, 1.5),
        ring(0.2, 1.2),
        -0.5f64..0.5,
    )
        .prop_map(|(a, b, c, d, e, shift)| {
            let mut shape = Shape::default();
            shape.add(star([0.0, shift], &a, false));
            shape.add(star([0.1, shift], &b, true));
            shape.add(star([0.0, shift], &c, false));
            shape.add(star([0.1, shift], &d, true));
            shape.add(star([14.0, shift], &e, false));
            shape.add(star(
                [6.3, shift],
                &e.iter().map(|r| r * 0.5).collect::<Vec<_>>(),
                true,
            ));
            shape
        })
}

/// Whether rings of [`nested`] with few corners cut through others: then the shape is not clean.
pub(crate) fn is_clean(shape: &Shape) -> bool {
    let edges: Vec<[[f64; 2]; 2]> = (0..shape.loops.len())
        .flat_map(|i| {
            let p = shape.loop_points(i);
            (0..p.len())
                .map(move |k| [p[k], p[(k + 1) % p.len()]])
                .collect::<Vec<_>>()
        })
        .collect();
    edges.iter().enumerate().all(|(i, [a, b])| {
        edges[..i].iter().all(|[c, d]| {
            [a, b].into_iter().any(|p| p == c || p == d)
                || cross(*a, *b, *c) * cross(*a, *b, *d) > 0.0
                || cross(*c, *d, *a) * cross(*c, *d, *b) > 0.0
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn nested_rings_are_covered_exactly(shape in nested(), length in prop::option::of(0.15f64..3.0), crease: bool, scale in -30i32..=30, offset in prop::option::of(-1e5f64..1e5)) {
        prop_assume!(is_clean(&shape));
        // The crease stays where it is: only x moves far.
        let x = offset.unwrap_or(0.0);
        let shape = shape.map(|p| [p[0] + x, p[1]]);
        let cover_ = run(&shape, length, crease)?;
        check_clean(&shape, &cover_, crease);
        // Any power of ten, the same triangles or, where rounding makes others, as good ones.
        let scale = 10f64.powi(scale);
        let shape = shape.map(|p| p.map(|x| x * scale));
        let cover_ = run(&shape, length.map(|l| l * scale), crease)?;
        check_clean(&shape, &cover_, crease);
    }

    #[test]
    fn anything_is_covered(loops in prop::collection::vec(prop::collection::vec([-1.0f64..1.0, -1.0..1.0], 3..24), 1..5), length in prop::option::of(0.05f64..1.0), crease: bool) {
        let mut shape = Shape::default();
        for ring in loops {
            shape.add(ring);
        }
        check_any(&shape, &run(&shape, length, crease)?);
    }

    /// Few places: duplicates, spikes, touching edges and loops of no area everywhere.
    #[test]
    fn loops_on_a_coarse_grid_are_covered(loops in prop::collection::vec(prop::collection::vec([-2i32..3, -2i32..3], 3..16), 1..6), length in prop::option::of(0.05f64..1.0), crease: bool) {
        let mut shape = Shape::default();
        for ring in loops {
            shape.add(ring.into_iter().map(|p| p.map(f64::from)));
        }
        check_any(&shape, &run(&shape, length, crease)?);
    }

    /// Magnitudes of all sizes in one section.
    #[test]
    fn numbers_of_any_size_are_covered(ring in prop::collection::vec(([-1.0f64..1.0, -1.0..1.0], [-300i32..300, -300i32..300]), 3..20), fine in prop::option::of(0.05f64..1.0), crease: bool) {
        let mut shape = Shape::default();
        shape.add(ring.into_iter().map(|(p, e)| [p[0] * 10f64.powi(e[0]), p[1] * 10f64.powi(e[1])]));
        let cover_ = run(&shape, fine.map(|l| l * shape.extent()), crease)?;
        prop_assert!(cover_.validate(&shape.section(crease), f64::MAX).is_ok());
    }

    /// Positions rounded to less than the distance of neighbors, as those of 32 bits are: loops that
    /// cross themselves by a rounding keep their core and cover nothing twice.
    #[test]
    fn rounding_costs_no_core(radii in prop::collection::vec(0.8f64..1.0, 40..80), twins in prop::collection::vec([-2e-7f64..2e-7, -2e-7..2e-7], 1..20), hole: bool) {
        let mut ring = star([0.0, 0.0], &radii, false);
        for (i, d) in twins.iter().enumerate() {
            let at = i * 7 % ring.len();
            let p = ring[at];
            ring.insert(at, [p[0] + d[0], p[1] + d[1]]);
        }
        let mut shape = Shape::default();
        shape.add(ring);
        if hole {
            shape.add(star([0.1, 0.0], &[0.3; 30], true));
        }
        let shape = shape.map(|p| p.map(|x| (x * 1e7).round() * 1e-7));
        let cover_ = run(&shape, Some(0.1), false)?;
        check_any(&shape, &cover_);
        let covered: f64 = cover_.triangles.iter().map(|&t| polygon_area(&corners(&shape, &cover_, t)).abs()).sum();
        prop_assert!((covered - shape.area()).abs() < 1e-4 * shape.area(), "{} {:?}", covered - shape.area(), cover_.report);
        prop_assert!(cover_.inner.len() > 100, "{:?}", cover_.report);
    }

    #[test]
    fn edges_of_the_surface_are_not_made_again(shape in nested(), length in prop::option::of(0.3f64..3.0), salt: u32, share in 1u32..4) {
        let joined = |a: u32, b: u32| a.min(b).wrapping_mul(0x9e37_79b9).wrapping_add(a.max(b) ^ salt).wrapping_mul(0x85eb_ca6b) >> 30 < share;
        let cover_ = run_joined(&shape, length, false, joined)?;
        check_any(&shape, &cover_);
        let n = index(shape.points.len());
        let mut rim = std::collections::HashSet::new();
        for ring in &shape.loops {
            for i in 0..ring.len() {
                rim.insert([ring[i], ring[(i + 1) % ring.len()]]);
            }
        }
        for &[a, b, c] in &cover_.triangles {
            for [v, w] in [[a, b], [b, c], [c, a]] {
                prop_assert!(v >= n || w >= n || rim.contains(&[v, w]) || rim.contains(&[w, v]) || !joined(v, w), "{v} {w}");
            }
        }
    }

    #[test]
    fn the_same_section_gives_the_same_bits(shape in nested(), length in prop::option::of(0.15f64..3.0)) {
        let size = length.map_or(CoverSize::Any, CoverSize::Uniform);
        let params = CoverParams { size, ..CoverParams::default() };
        let mut scratch = CoverScratch::default();
        let first = cover(&shape.section(true), &params, |_, _| false, &mut scratch)?;
        let second = cover(&shape.section(true), &params, |_, _| false, &mut scratch)?;
        prop_assert_eq!(&first, &second);
        prop_assert_eq!(&first, &run(&shape, length, true)?);
    }
}
