//! Section meshes with local target lengths: random targets, grading and limits.

use super::properties::{any_loops, is_clean, nested, star};
use super::sections::{Shape, check_any, check_clean};
use incise_mesh::index_u32;
use incise_refine::{
    RefineError, SectionMesh, SectionMeshParams, SectionMeshScratch, SectionMeshSize,
    triangulate_section,
};
use proptest::prelude::*;
use std::collections::HashSet;

/// Maximum number of triangles per squared least target of area; equilateral ones have 2.31.
const PER_SQUARE: f64 = 3.0;
/// Maximum number of additional triangles per point of a loop.
///
/// Beside short rim edges, triangles grow to the target within a few rows.
const PER_POINT: f64 = 6.0;

/// Targets of the points of a section, and how to use them.
#[derive(Debug, Clone)]
pub(crate) struct Sizes {
    lengths: Vec<f64>,
    grading: f64,
    min_angle: f64,
}

impl Sizes {
    pub(crate) fn params(&self) -> SectionMeshParams<'_> {
        SectionMeshParams {
            size: SectionMeshSize::Local(&self.lengths),
            grading: self.grading,
            min_angle: self.min_angle,
            ..SectionMeshParams::default()
        }
    }

    fn run(&self, shape: &Shape) -> Result<SectionMesh, RefineError> {
        let mut scratch = SectionMeshScratch::default();
        triangulate_section(&shape.section(), &self.params(), |_, _| false, &mut scratch)
    }

    /// Returns the maximum number of triangles.
    fn max_triangles(&self, shape: &Shape) -> f64 {
        let least = self.lengths.iter().copied().fold(f64::INFINITY, f64::min);
        PER_SQUARE * shape.area() / (least * least) + PER_POINT * shape.points.len() as f64
    }
}

/// Nested loops with targets that differ by up to 20 times from point to point.
fn sized() -> impl Strategy<Value = (Shape, Sizes)> {
    let spread = prop_oneof![Just(1.0f64), 1.0f64..3.0, 3.0f64..20.0];
    let targets = (prop::collection::vec(0.0f64..1.0, 16), 0.15f64..3.0, spread);
    let grading = prop_oneof![Just(0.0), 0.0f64..2.0];
    (nested(), targets, grading, 0.0f64..40.0).prop_map(
        |(shape, (random, least, spread), grading, min_angle)| {
            let lengths = (0..shape.points.len())
                .map(|i| least * spread.powf(random[i * 7 % 16]))
                .collect();
            let sizes = Sizes {
                lengths,
                grading,
                min_angle,
            };
            (shape, sizes)
        },
    )
}

/// Returns the Euler characteristic of a mesh.
fn euler(shape: &Shape, mesh: &SectionMesh) -> i64 {
    let mut edges = HashSet::new();
    for &[a, b, c] in &mesh.triangles {
        edges.extend([(a, b), (b, c), (c, a)].map(|(a, b)| (a.min(b), a.max(b))));
    }
    let count = |n: usize| i64::from(index_u32(n));
    count(shape.points.len()) + count(mesh.steiner_points.len()) - count(edges.len())
        + count(mesh.triangles.len())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn any_targets_give_a_mesh_of_bounded_size((shape, sizes) in sized()) {
        prop_assume!(is_clean(&shape));
        let mesh = sizes.run(&shape)?;
        check_clean(&shape, &mesh);
        prop_assert_eq!(euler(&shape, &mesh), 0, "three annuli");
        let (count, most) = (mesh.triangles.len() as f64, sizes.max_triangles(&shape));
        prop_assert!(count <= most, "{} triangles, at most {}", count, most);
    }

    #[test]
    fn any_loops_with_targets_give_a_manifold(
        shape in any_loops(),
        lengths in prop::collection::vec(0.05f64..1.0, 100),
        grading in 0.0f64..2.0,
        min_angle in 0.0f64..40.0,
    ) {
        let sizes = Sizes { lengths, grading, min_angle };
        check_any(&shape, &sizes.run(&shape)?);
    }

    /// A clockwise loop is triangulated like its mirror image, point by point.
    #[test]
    fn a_mirrored_section_has_the_mirrored_mesh(
        radii in prop::collection::vec(0.3f64..1.0, 5..60),
        lengths in prop::collection::vec(0.05f64..0.5, 120),
        grading in 0.0f64..2.0,
        min_angle in 0.0f64..40.0,
    ) {
        let mut shape = Shape::default();
        shape.add(star([0.0, 0.0], &radii, true));
        let sizes = Sizes { lengths, grading, min_angle };
        let backward = sizes.run(&shape)?;
        let mirror = |p: [f64; 2]| [-p[0], p[1]];
        let image = shape.clone().map(mirror);
        let forward = sizes.run(&image)?;
        prop_assert_eq!(&backward.triangles, &forward.triangles);
        for (p, q) in backward.steiner_points.iter().zip(&forward.steiner_points) {
            prop_assert_eq!(p.position, mirror(q.position));
            prop_assert_eq!((p.parents, p.weights), (q.parents, q.weights));
        }
    }

    /// A limit either fails or changes nothing.
    #[test]
    fn limits_do_not_change_the_mesh(
        (shape, sizes) in sized(),
        less in 0usize..400,
        more in 0usize..400,
    ) {
        prop_assume!(is_clean(&shape));
        let free = sizes.run(&shape)?;
        let count = free.triangles.len();
        let mut scratch = SectionMeshScratch::default();
        let mut limited = |max_triangles| {
            let params = SectionMeshParams { max_triangles, ..sizes.params() };
            triangulate_section(&shape.section(), &params, |_, _| false, &mut scratch)
        };
        prop_assert_eq!(limited(count + more), Ok(free));
        let limit = count.saturating_sub(1 + less);
        prop_assert_eq!(limited(limit), Err(RefineError::TooManyTriangles { limit }));
    }

    #[test]
    fn used_scratch_memory_changes_no_bit(
        (first, sizes) in sized(),
        (second, others) in sized(),
    ) {
        let mut scratch = SectionMeshScratch::default();
        let mut run = |shape: &Shape, sizes: &Sizes| {
            let section = shape.section();
            triangulate_section(&section, &sizes.params(), |_, _| false, &mut scratch)
        };
        run(&second, &others)?;
        prop_assert_eq!(&run(&first, &sizes)?, &sizes.run(&first)?);
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
        min_angle: 30.0,
    };
    let with = |at: usize, length: f64| {
        let mut sizes = good.clone();
        sizes.lengths[at] = length;
        sizes.run(&shape)
    };
    assert!(with(0, 1e300).is_ok(), "a target may exceed the section");
    for length in [0.0, -0.0, -1.0, f64::INFINITY, f64::NEG_INFINITY] {
        let error = Err(RefineError::NonPositiveLength { length });
        assert_eq!(with(n - 1, length), error, "the last length is {length}");
    }
    let error = with(3, f64::NAN).expect_err("NaN is not a length");
    assert!(
        matches!(error, RefineError::NonPositiveLength { length } if length.is_nan()),
        "{error}"
    );
    let mut few = good.clone();
    few.lengths.truncate(n - 2);
    let point = index_u32(n - 2);
    assert_eq!(few.run(&shape), Err(RefineError::MissingTarget { point }));
    for grading in [-1e-9, f64::NEG_INFINITY, f64::INFINITY] {
        let sizes = Sizes {
            grading,
            ..good.clone()
        };
        let error = Err(RefineError::NegativeGrading { grading });
        assert_eq!(sizes.run(&shape), error, "grading {grading}");
    }
    for min_angle in [-1.0, 60.1, f64::INFINITY] {
        let sizes = Sizes {
            min_angle,
            ..good.clone()
        };
        let error = Err(RefineError::InvalidMinAngle { degrees: min_angle });
        assert_eq!(sizes.run(&shape), error, "minimum angle {min_angle}");
    }
    for sizes in [
        Sizes {
            grading: f64::NAN,
            ..good.clone()
        },
        Sizes {
            min_angle: f64::NAN,
            ..good.clone()
        },
    ] {
        let error = sizes.run(&shape).expect_err("NaN is an error");
        let expected = matches!(
            error,
            RefineError::NegativeGrading { .. } | RefineError::InvalidMinAngle { .. }
        );
        assert!(expected, "{error}");
    }
}

/// Equal and different targets that are too fine fail early instead of filling memory.
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
                    min_angle: 30.0,
                };
                let params = SectionMeshParams {
                    max_triangles: 5000,
                    ..sizes.params()
                };
                let mut scratch = SectionMeshScratch::default();
                let found =
                    triangulate_section(&shape.section(), &params, |_, _| false, &mut scratch);
                let error = Err(RefineError::TooManyTriangles { limit: 5000 });
                assert_eq!(found, error, "{tiny} to {spread} times, grading {grading}");
            }
        }
    }
}
