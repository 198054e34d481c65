//! Quality of meshes of smooth sections with even rim edges.

use super::sections::{Shape, check_clean};
use incise_refine::{
    RefineError, SectionMeshParams, SectionMeshQuality, SectionMeshScratch, SectionMeshSize,
    triangulate_section,
};
use proptest::prelude::*;
use std::f64::consts::TAU;

/// Returns the curve `r(a)` in polar coordinates as `n` edges of nearly equal length.
fn even(n: usize, r: impl Fn(f64) -> f64) -> Vec<[f64; 2]> {
    let fine = 64 * n;
    let at = |i: usize| {
        let a = i as f64 * TAU / fine as f64;
        [r(a) * a.cos(), r(a) * a.sin()]
    };
    let mut along = vec![0.0];
    for i in 0..fine {
        along.push(along[i] + distance(at(i), at(i + 1)));
    }
    (0..n)
        .map(|k| {
            let way = along[fine] * k as f64 / n as f64;
            at(along.partition_point(|&w| w < way))
        })
        .collect()
}

fn distance(p: [f64; 2], q: [f64; 2]) -> f64 {
    (p[0] - q[0]).hypot(p[1] - q[1])
}

/// Returns z times the mean of the two edges at every point.
fn targets(shape: &Shape, z: f64) -> Vec<f64> {
    let mut lengths = vec![0.0; shape.points.len()];
    for points in &shape.loops {
        for (i, &b) in points.iter().enumerate() {
            let [a, c] = [i + points.len() - 1, i + 1].map(|k| points[k % points.len()]);
            let [p, q, r] = [a, b, c].map(|v| shape.points[v as usize]);
            lengths[b as usize] = z * (distance(p, q) + distance(q, r)) / 2.0;
        }
    }
    lengths
}

/// A cosine around a circle, which changes the radius.
struct Waves {
    /// Number of periods.
    lobes: f64,
    /// Amplitude times the number of periods [radii].
    depth: f64,
    /// Angle [rad].
    phase: f64,
}

/// Returns a section bounded by one or two curves with waves and even edges.
fn waved(n: usize, waves: &Waves, hole: bool) -> Shape {
    let &Waves { lobes, phase, .. } = waves;
    let depth = waves.depth / lobes;
    let mut shape = Shape::default();
    shape.add(even(n, |a| 1.0 + depth * (lobes * a + phase).cos()));
    if hole {
        let mut points = even(n.div_ceil(2), |a| {
            0.5 + 0.5 * depth * (lobes * a + phase).cos()
        });
        points.reverse();
        shape.add(points);
    }
    shape
}

/// Sections of [`waved`] with at least `min_points` points.
fn any_waved(min_points: usize) -> impl Strategy<Value = Shape> {
    let waves = ((1u32..6).prop_map(f64::from), 0.0f64..0.3, 0.0f64..TAU);
    (min_points..200, waves, any::<bool>()).prop_map(|(n, (lobes, depth, phase), hole)| {
        let waves = Waves {
            lobes,
            depth,
            phase,
        };
        waved(n, &waves, hole)
    })
}

/// Returns a circle with even edges, the first of which is split in the ratio `part`.
fn with_short_edge(n: usize, part: f64) -> Shape {
    let mut points = even(n, |_| 1.0);
    let [p, q] = [points[0], points[1]];
    points.insert(
        1,
        [0, 1].map(|i| p[i] + part / (1.0 + part) * (q[i] - p[i])),
    );
    let mut shape = Shape::default();
    shape.add(points);
    shape
}

/// Triangulates a section with z times the rim's edge lengths and measures the quality.
fn measure(shape: &Shape, z: f64) -> Result<SectionMeshQuality, RefineError> {
    measure_graded(shape, z, 0.0)
}

fn measure_graded(shape: &Shape, z: f64, grading: f64) -> Result<SectionMeshQuality, RefineError> {
    let lengths = targets(shape, z);
    let params = SectionMeshParams {
        size: SectionMeshSize::Local(&lengths),
        grading,
        ..SectionMeshParams::default()
    };
    let section = shape.section();
    let mesh = triangulate_section(
        &section,
        &params,
        |_, _| false,
        &mut SectionMeshScratch::default(),
    )?;
    check_clean(shape, &mesh);
    Ok(mesh.quality(&section, &params))
}

/// In narrow sections, fixed core points or missing points in a single row caused small angles.
#[test]
fn narrow_sections_have_few_small_angles() -> Result<(), RefineError> {
    for (n, waves, hole, z) in [
        (
            23,
            Waves {
                lobes: 1.0,
                depth: 0.173_502_854_708_146_36,
                phase: 1.703_371_917_034_840_5,
            },
            false,
            2.0,
        ),
        (
            22,
            Waves {
                lobes: 5.0,
                depth: 0.289_888_043_804_137_6,
                phase: 3.236_763_338_755_499,
            },
            false,
            2.0,
        ),
        (
            20,
            Waves {
                lobes: 4.0,
                depth: 0.208_647_974_053_864_76,
                phase: 3.194_041_280_048_085,
            },
            true,
            1.0 / 1.5,
        ),
        (
            37,
            Waves {
                lobes: 1.0,
                depth: 0.071_649_555_957_333_98,
                phase: 4.176_273_814_134_402,
            },
            true,
            2.0,
        ),
        (
            39,
            Waves {
                lobes: 4.0,
                depth: 0.009_681_685_653_645_284,
                phase: 2.694_134_393_690_991,
            },
            true,
            2.0,
        ),
    ] {
        let angles = measure(&waved(n, &waves, hole), z)?.angles;
        let [smallest, few] = [0, angles.len() / 20].map(|i| angles[i]);
        assert!(
            smallest >= 20.0 && few >= 30.0,
            "{n} points: smallest {smallest}, 5 percent {few}"
        );
    }
    Ok(())
}

/// The spiral between a short and a long edge stopped after one point, because the next point's
/// improvement was below the threshold.
#[test]
fn short_edges_get_complete_spirals() -> Result<(), RefineError> {
    for (n, part, z) in [
        (101, 0.110_832_614_782_974_63, 1.739_897_554_364_425_7),
        (150, 0.105_828_539_399_748_22, 1.769_890_287_451_696_6),
        (29, 0.104_964_675_842_516_13, 1.606_667_302_577_598_2),
    ] {
        let angles = measure(&with_short_edge(n, part), z)?.angles;
        assert!(angles[0] >= 18.0, "{n} points: smallest {}", angles[0]);
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// Narrow sections have too few triangles for bounds on the median and the mean.
    #[test]
    fn smooth_sections_have_good_triangles(
        shape in any_waved(20),
        z in prop::sample::select(vec![1.0 / 1.5, 1.0, 1.5, 2.0]),
    ) {
        let quality = measure(&shape, z)?;
        let (angles, count) = (&quality.angles, quality.angles.len());
        prop_assert!(angles[0] >= 20.0, "smallest {}", angles[0]);
        prop_assert!(angles[count / 20] >= 30.0, "5 percent {}", angles[count / 20]);
        prop_assert!(quality.long_edges.is_empty(), "longest {:?}", quality.edges.last());
        if shape.loops[0].len() >= 100 {
            prop_assert!(angles[count / 2] >= 45.0, "median {}", angles[count / 2]);
            prop_assert!(quality.is_size_met(), "mean {}", quality.mean_edge());
        }
    }

    /// The points of nested lattices give the same bounds of small angles.
    #[test]
    fn smooth_graded_sections_have_good_triangles(
        shape in any_waved(20),
        z in prop::sample::select(vec![1.0 / 1.5, 1.0, 1.5, 2.0]),
        grading in 0.05f64..1.0,
    ) {
        let quality = measure_graded(&shape, z, grading)?;
        let (angles, count) = (&quality.angles, quality.angles.len());
        prop_assert!(angles[0] >= 20.0, "smallest {}", angles[0]);
        prop_assert!(angles[count / 20] >= 30.0, "5 percent {}", angles[count / 20]);
        if shape.loops[0].len() >= 100 {
            prop_assert!(angles[count / 2] >= 40.0, "median {}", angles[count / 2]);
        }
    }

    /// A spiral of triangles leads to the short edge; below a fifth its angles are smaller.
    #[test]
    fn a_short_edge_causes_no_small_angles(
        (n, part) in (20usize..200, 0.1f64..1.0),
        z in 0.667f64..2.0,
    ) {
        let quality = measure(&with_short_edge(n, part), z)?;
        let bound = if part < 0.2 { 18.0 } else { 20.0 };
        prop_assert!(quality.angles[0] >= bound, "smallest {}", quality.angles[0]);
    }

    /// Rim edges are up to 2 targets long, so the few triangles at the rim have no bounds.
    #[test]
    fn smooth_sections_may_be_finer_than_their_rims(
        shape in any_waved(60),
        z in 0.5f64..0.667,
    ) {
        let quality = measure(&shape, z)?;
        let (angles, count) = (&quality.angles, quality.angles.len());
        prop_assert!(angles[count / 20] >= 30.0, "5 percent {}", angles[count / 20]);
        prop_assert!(angles[count / 2] >= 45.0, "median {}", angles[count / 2]);
        let mean = quality.mean_edge();
        prop_assert!((0.85..=1.15).contains(&mean), "mean {}", mean);
    }
}
