//! The quality of covers of smooth sections whose rims have even edges.

use crate::sections::{Shape, check_clean};
use incise_refine::{CoverParams, CoverQuality, CoverScratch, CoverSize, RefineError, cover};
use proptest::prelude::*;
use std::f64::consts::TAU;

/// A closed curve around the middle, `r(a)` away in the direction a, as `n` edges of nearly the same length.
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

/// The mean of the two edges at every point, z times.
fn targets(shape: &Shape, z: f64) -> Vec<f64> {
    let mut lengths = vec![0.0; shape.points.len()];
    for ring in &shape.loops {
        for (i, &b) in ring.iter().enumerate() {
            let [a, c] = [i + ring.len() - 1, i + 1].map(|k| ring[k % ring.len()]);
            let [p, q, r] = [a, b, c].map(|v| shape.points[v as usize]);
            lengths[b as usize] = z * (distance(p, q) + distance(q, r)) / 2.0;
        }
    }
    lengths
}

/// A section between two such curves, or inside of one: edges of one length, `lobes` waves of some depth.
fn waved(n: usize, (lobes, depth, phase): (f64, f64, f64), hole: bool) -> Shape {
    let depth = depth / lobes;
    let mut shape = Shape::default();
    shape.add(even(n, |a| 1.0 + depth * (lobes * a + phase).cos()));
    if hole {
        let mut ring = even(n.div_ceil(2), |a| {
            0.5 + 0.5 * depth * (lobes * a + phase).cos()
        });
        ring.reverse();
        shape.add(ring);
    }
    shape
}

/// Such sections of at least so many points, and whether they have a crease.
fn round(least: usize) -> impl Strategy<Value = (Shape, bool)> {
    let waves = ((1u32..6).prop_map(f64::from), 0.0f64..0.3, 0.0f64..TAU);
    (least..200, waves, any::<bool>(), any::<bool>())
        .prop_map(|(n, waves, hole, crease)| (waved(n, waves, hole), crease))
}

/// A round section with edges of one length, the first of which has a point that makes it two, one `part` times as long
/// as the other.
fn with_short_edge(n: usize, part: f64) -> Shape {
    let mut ring = even(n, |_| 1.0);
    let [p, q] = [ring[0], ring[1]];
    ring.insert(
        1,
        [0, 1].map(|i| p[i] + part / (1.0 + part) * (q[i] - p[i])),
    );
    let mut shape = Shape::default();
    shape.add(ring);
    shape
}

/// Covers the section with edges of z times the rim's and measures.
fn judge(shape: &Shape, crease: bool, z: f64) -> Result<CoverQuality, RefineError> {
    let lengths = targets(shape, z);
    let params = CoverParams {
        size: CoverSize::Local(&lengths),
        ..CoverParams::default()
    };
    let section = shape.section(crease);
    let cover = cover(
        &section,
        &params,
        |_, _| false,
        &mut CoverScratch::default(),
    )?;
    // A loop that reaches y = 0 in between two of its points has an edge across the crease.
    check_clean(shape, &cover, false);
    Ok(cover.quality(&section, &params))
}

/// A point beside a crease that the rim crosses between two of its points was refused where its parents lie a
/// little on the other side.
#[test]
fn a_crease_between_points_of_the_rim_makes_no_long_edges() -> Result<(), RefineError> {
    for (n, waves, hole, z) in [
        (
            113,
            (1.0, 0.278_256_642_040_613_9, 5.919_153_333_000_914),
            false,
            2.0,
        ),
        (
            166,
            (2.0, 0.021_343_197_302_260_114, 2.131_362_920_977_734),
            false,
            1.0 / 1.5,
        ),
        (
            160,
            (4.0, 0.201_220_460_221_438_6, 5.600_674_668_260_396),
            true,
            1.5,
        ),
    ] {
        let quality = judge(&waved(n, waves, hole), true, z)?;
        assert!(
            quality.long_edges.is_empty(),
            "longest {:?}",
            quality.edges.last()
        );
    }
    Ok(())
}

/// Sections a few triangles wide whose sharp triangles were at points of the core, which do not move, or in a single
/// row that had room for another point.
#[test]
fn sections_a_few_triangles_wide_have_few_sharp_ones() -> Result<(), RefineError> {
    for (n, waves, hole, crease, z) in [
        (
            23,
            (1.0, 0.173_502_854_708_146_36, 1.703_371_917_034_840_5),
            false,
            false,
            2.0,
        ),
        (
            22,
            (5.0, 0.289_888_043_804_137_6, 3.236_763_338_755_499),
            false,
            false,
            2.0,
        ),
        (
            20,
            (4.0, 0.208_647_974_053_864_76, 3.194_041_280_048_085),
            true,
            true,
            1.0 / 1.5,
        ),
        (
            37,
            (1.0, 0.071_649_555_957_333_98, 4.176_273_814_134_402),
            true,
            true,
            2.0,
        ),
        (
            39,
            (4.0, 0.009_681_685_653_645_284, 2.694_134_393_690_991),
            true,
            false,
            2.0,
        ),
    ] {
        let angles = judge(&waved(n, waves, hole), crease, z)?.angles;
        let [smallest, few] = [0, angles.len() / 20].map(|i| angles[i]);
        assert!(
            smallest >= 20.0 && few >= 30.0,
            "{n} points: smallest {smallest}, 5 percent {few}"
        );
    }
    Ok(())
}

/// Between the short edge and the long one was a single point, and the next made its triangles less sharp by less than
/// what a point had to be worth.
#[test]
fn a_short_edge_has_a_row_of_points_to_the_long_one() -> Result<(), RefineError> {
    for (n, part, z) in [
        (101, 0.110_832_614_782_974_63, 1.739_897_554_364_425_7),
        (150, 0.105_828_539_399_748_22, 1.769_890_287_451_696_6),
        (29, 0.104_964_675_842_516_13, 1.606_667_302_577_598_2),
    ] {
        let angles = judge(&with_short_edge(n, part), false, z)?.angles;
        assert!(angles[0] >= 18.0, "{n} points: smallest {}", angles[0]);
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// Sections a few triangles wide have too few of them for laws on the middle ones.
    #[test]
    fn round_sections_have_good_triangles((shape, crease) in round(20), z in prop::sample::select(vec![1.0 / 1.5, 1.0, 1.5, 2.0])) {
        let quality = judge(&shape, crease, z)?;
        let (angles, count) = (&quality.angles, quality.angles.len());
        prop_assert!(angles[0] >= 20.0, "smallest {}", angles[0]);
        prop_assert!(angles[count / 20] >= 30.0, "5 percent {}", angles[count / 20]);
        prop_assert!(quality.long_edges.is_empty(), "longest {:?}", quality.edges.last());
        if shape.loops[0].len() >= 100 {
            prop_assert!(angles[count / 2] >= 45.0, "median {}", angles[count / 2]);
            prop_assert!(quality.is_size_met(), "mean {}", quality.mean_edge());
        }
    }

    /// Beside an edge ten times as long triangles wind down to the short one, edge by edge; few of them
    /// come out below 20 degrees where it is shorter than a fifth.
    #[test]
    fn a_short_edge_makes_no_sharp_triangles((n, part) in (20usize..200, 0.1f64..1.0), z in 0.667f64..2.0) {
        let quality = judge(&with_short_edge(n, part), false, z)?;
        let bound = if part < 0.2 { 18.0 } else { 20.0 };
        prop_assert!(quality.angles[0] >= bound, "smallest {}", quality.angles[0]);
    }

    /// Twice finer the rim's own edges are 2 targets long: triangles on them have other bounds, and they
    /// are few.
    #[test]
    fn round_sections_may_be_finer_than_their_rims((shape, crease) in round(60), z in 0.5f64..0.667) {
        let quality = judge(&shape, crease, z)?;
        let (angles, count) = (&quality.angles, quality.angles.len());
        prop_assert!(angles[count / 20] >= 30.0, "5 percent {}", angles[count / 20]);
        prop_assert!(angles[count / 2] >= 45.0, "median {}", angles[count / 2]);
        let mean = quality.mean_edge();
        prop_assert!((0.85..=1.15).contains(&mean), "mean {}", mean);
    }
}
