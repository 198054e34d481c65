//! The contract of covers whose edges have a target at every point: any targets, any grading, any bound.

use crate::properties::{is_clean, nested, star};
use crate::sections::{Shape, check_any, check_clean, index};
use incise_refine::{Cover, CoverParams, CoverScratch, CoverSize, RefineError, cover};
use proptest::prelude::*;
use std::collections::HashSet;

/// Triangles of a cover for every square of the least target and for every point of the rim, at most.
/// Equilateral triangles with edges of the target are 2.31 a square; around a rim whose edges are shorter
/// they grow to the target within a few rows, as many as there are points times a constant.
const A_SQUARE: f64 = 3.0;
const A_POINT: f64 = 6.0;

/// Targets of the points of a section, and how to use them.
#[derive(Debug, Clone)]
pub(crate) struct Sizes {
    lengths: Vec<f64>,
    grading: f64,
    sharp: f64,
}

impl Sizes {
    pub(crate) fn params(&self) -> CoverParams<'_> {
        CoverParams {
            size: CoverSize::Local(&self.lengths),
            grading: self.grading,
            sharp: self.sharp,
            ..CoverParams::default()
        }
    }

    fn run(&self, shape: &Shape, crease: bool) -> Result<Cover, RefineError> {
        let mut scratch = CoverScratch::default();
        cover(
            &shape.section(crease),
            &self.params(),
            |_, _| false,
            &mut scratch,
        )
    }

    /// The bound on the number of triangles.
    fn most(&self, shape: &Shape) -> f64 {
        let least = self.lengths.iter().copied().fold(f64::INFINITY, f64::min);
        A_SQUARE * shape.area() / (least * least) + A_POINT * shape.points.len() as f64
    }
}

/// Rings within rings and targets that differ by up to 20 times from point to point.
fn sized() -> impl Strategy<Value = (Shape, Sizes)> {
    let spread = prop_oneof![Just(1.0f64), 1.0f64..3.0, 3.0f64..20.0];
    let targets = (prop::collection::vec(0.0f64..1.0, 16), 0.15f64..3.0, spread);
    let grading = prop_oneof![Just(0.0), 0.0f64..2.0];
    (nested(), targets, grading, 0.0f64..40.0).prop_map(
        |(shape, (random, least, spread), grading, sharp)| {
            let lengths = (0..shape.points.len())
                .map(|i| least * spread.powf(random[i * 7 % 16]))
                .collect();
            let sizes = Sizes {
                lengths,
                grading,
                sharp,
            };
            (shape, sizes)
        },
    )
}

/// Vertices less edges plus triangles.
fn euler(shape: &Shape, cover: &Cover) -> i64 {
    let mut edges = HashSet::new();
    for &[a, b, c] in &cover.triangles {
        edges.extend([(a, b), (b, c), (c, a)].map(|(a, b)| (a.min(b), a.max(b))));
    }
    let count = |n: usize| i64::from(index(n));
    count(shape.points.len()) + count(cover.inner.len()) - count(edges.len())
        + count(cover.triangles.len())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn any_targets_give_a_cover_of_bounded_size((shape, sizes) in sized(), crease: bool) {
        prop_assume!(is_clean(&shape));
        let cover = sizes.run(&shape, crease)?;
        check_clean(&shape, &cover, crease);
        prop_assert_eq!(euler(&shape, &cover), 0, "three rings with a hole each");
        let (count, most) = (cover.triangles.len() as f64, sizes.most(&shape));
        prop_assert!(count <= most, "{} triangles, at most {}", count, most);
    }

    /// Loops that cross, touch and wind backward take targets of their own as well.
    #[test]
    fn any_targets_on_any_loops(loops in prop::collection::vec(prop::collection::vec([-1.0f64..1.0, -1.0..1.0], 3..24), 1..5), lengths in prop::collection::vec(0.05f64..1.0, 100), grading in 0.0f64..2.0, sharp in 0.0f64..40.0, crease: bool) {
        let mut shape = Shape::default();
        for ring in loops {
            shape.add(ring);
        }
        let sizes = Sizes { lengths, grading, sharp };
        check_any(&shape, &sizes.run(&shape, crease)?);
    }

    /// A loop that winds backward is covered as its mirror image is, point by point.
    #[test]
    fn a_mirrored_section_has_the_mirrored_cover(radii in prop::collection::vec(0.3f64..1.0, 5..60), random in prop::collection::vec(0.05f64..0.5, 120), grading in 0.0f64..2.0, sharp in 0.0f64..40.0, crease: bool) {
        let mut shape = Shape::default();
        shape.add(star([0.0, 0.0], &radii, true));
        let sizes = Sizes { lengths: random, grading, sharp };
        let backward = sizes.run(&shape, crease)?;
        let mirror = |p: [f64; 2]| [-p[0], p[1]];
        let image = shape.clone().map(mirror);
        let forward = sizes.run(&image, crease)?;
        prop_assert_eq!(&backward.triangles, &forward.triangles);
        for (p, q) in backward.inner.iter().zip(&forward.inner) {
            prop_assert_eq!((p.at, p.parents, p.weights), (mirror(q.at), q.parents, q.weights));
        }
    }

    /// The limit is one on what comes out: a cover that keeps it is the same without it.
    #[test]
    fn the_limit_is_kept((shape, sizes) in sized(), less in 0usize..400, more in 0usize..400) {
        prop_assume!(is_clean(&shape));
        let free = sizes.run(&shape, false)?;
        let count = free.triangles.len();
        let mut scratch = CoverScratch::default();
        let mut limited = |max_triangles| {
            let params = CoverParams { max_triangles, ..sizes.params() };
            cover(&shape.section(false), &params, |_, _| false, &mut scratch)
        };
        prop_assert_eq!(limited(count + more), Ok(free));
        let limit = count.saturating_sub(1 + less);
        prop_assert_eq!(limited(limit), Err(RefineError::TooManyTriangles { limit }));
    }

    #[test]
    fn used_memory_changes_no_bit((first, sizes) in sized(), (second, others) in sized(), crease: bool) {
        let mut scratch = CoverScratch::default();
        cover(&second.section(crease), &others.params(), |_, _| false, &mut scratch)?;
        let used = cover(&first.section(crease), &sizes.params(), |_, _| false, &mut scratch)?;
        prop_assert_eq!(&used, &sizes.run(&first, crease)?);
    }
}

#[test]
fn bad_targets_are_errors() {
    let mut shape = Shape::default();
    shape.add(star([0.0, 0.0], &[1.0; 12], false));
    let n = shape.points.len();
    let good = Sizes {
        lengths: vec![0.2; n],
        grading: 0.0,
        sharp: 30.0,
    };
    let with = |at: usize, length: f64| {
        let mut sizes = good.clone();
        sizes.lengths[at] = length;
        sizes.run(&shape, false)
    };
    assert!(with(0, 1e300).is_ok(), "as long as they come out");
    for length in [0.0, -0.0, -1.0, f64::INFINITY, f64::NEG_INFINITY] {
        let error = Err(RefineError::NonPositiveLength { length });
        assert_eq!(with(n - 1, length), error, "the last length is {length}");
    }
    let error = with(3, f64::NAN).expect_err("no number is no length");
    assert!(
        matches!(error, RefineError::NonPositiveLength { length } if length.is_nan()),
        "{error}"
    );
    let mut few = good.clone();
    few.lengths.truncate(n - 2);
    let point = index(n - 2);
    assert_eq!(few.run(&shape, false), Err(RefineError::NoLength { point }));
    for grading in [-1e-9, f64::NEG_INFINITY, f64::INFINITY] {
        let sizes = Sizes {
            grading,
            ..good.clone()
        };
        let error = Err(RefineError::NegativeGrading { grading });
        assert_eq!(sizes.run(&shape, false), error, "grading {grading}");
    }
    for sharp in [-1.0, 60.1, f64::INFINITY] {
        let sizes = Sizes {
            sharp,
            ..good.clone()
        };
        let error = Err(RefineError::SharpAngle { degrees: sharp });
        assert_eq!(sizes.run(&shape, false), error, "sharp below {sharp}");
    }
    for sizes in [
        Sizes {
            grading: f64::NAN,
            ..good.clone()
        },
        Sizes {
            sharp: f64::NAN,
            ..good.clone()
        },
    ] {
        let error = sizes.run(&shape, false).expect_err("no number");
        let expected = matches!(
            error,
            RefineError::NegativeGrading { .. } | RefineError::SharpAngle { .. }
        );
        assert!(expected, "{error}");
    }
}

/// Targets so fine that nothing but the limit ends the work, alike and all different.
#[test]
fn targets_too_fine_are_an_error() {
    let mut shape = Shape::default();
    shape.add(star([0.0, 0.0], &[1.0; 40], false));
    for tiny in [1e-4, 1e-12, 1e-300] {
        for spread in [1.0, 3.0, 20.0] {
            for grading in [0.0, 1e-3] {
                let length = |i: usize| tiny * f64::powf(spread, (i % 8) as f64 / 7.0);
                let sizes = Sizes {
                    lengths: (0..shape.points.len()).map(length).collect(),
                    grading,
                    sharp: 30.0,
                };
                let params = CoverParams {
                    max_triangles: 5000,
                    ..sizes.params()
                };
                let mut scratch = CoverScratch::default();
                let found = cover(&shape.section(true), &params, |_, _| false, &mut scratch);
                let error = Err(RefineError::TooManyTriangles { limit: 5000 });
                assert_eq!(found, error, "{tiny} to {spread} times, grading {grading}");
            }
        }
    }
}
