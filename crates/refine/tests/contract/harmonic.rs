//! Harmonic interpolation: known functions, the maximum principle, Dirichlet energy.

mod dense;

use dense::{energy, solve};
use incise_refine::{
    HarmonicScratch, Section, SectionMesh, SectionMeshParams, SectionMeshScratch, SectionMeshSize,
    interpolate_harmonic, triangulate_section,
};
use proptest::prelude::*;
use std::f64::consts::TAU;

struct Patch {
    points: Vec<[f64; 2]>,
    loops: Vec<Vec<u32>>,
    mesh: SectionMesh,
}

impl Patch {
    fn new(loops_of_points: &[Vec<[f64; 2]>], length: f64) -> Self {
        let points = loops_of_points.concat();
        let mut ends = 0..;
        let loops: Vec<Vec<u32>> = (loops_of_points.iter())
            .map(|ring| ends.by_ref().take(ring.len()).collect())
            .collect();
        let section = Section {
            points: &points,
            loops: &loops,
        };
        let params = SectionMeshParams {
            size: SectionMeshSize::Uniform(length),
            grading: 0.0,
            ..SectionMeshParams::default()
        };
        let mesh = triangulate_section(
            &section,
            &params,
            |_, _| false,
            &mut SectionMeshScratch::default(),
        )
        .unwrap();
        assert_eq!(mesh.report.self_intersecting_loops, 0, "a clean section");
        Self {
            points,
            loops,
            mesh,
        }
    }

    fn section(&self) -> Section<'_> {
        Section {
            points: &self.points,
            loops: &self.loops,
        }
    }

    fn rim(&self, f: impl Fn([f64; 2]) -> [f64; 3]) -> Vec<[f64; 3]> {
        self.points.iter().map(|&p| f(p)).collect()
    }

    /// Solves without the shortcut for affine values.
    fn solve(&self, values: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let mut scratch = HarmonicScratch::default();
        let found = interpolate_harmonic(&self.mesh, &self.section(), values, -1.0, &mut scratch);
        found.unwrap().values.to_vec()
    }

    fn linear(&self, values: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let inner = self.mesh.steiner_points.iter();
        inner
            .map(|inner| {
                [0, 1, 2].map(|k| {
                    let part = |i: usize| inner.weights[i] * values[inner.parents[i] as usize][k];
                    (0..3).map(part).sum()
                })
            })
            .collect()
    }
}

/// Returns a loop around `center`, clockwise for a hole.
fn ring(n: u32, center: [f64; 2], radius: impl Fn(f64) -> f64, hole: bool) -> Vec<[f64; 2]> {
    let mut points: Vec<_> = (0..n)
        .map(|i| f64::from(i) * TAU / f64::from(n))
        .map(|a| {
            [
                center[0] + radius(a) * a.cos(),
                center[1] + radius(a) * a.sin(),
            ]
        })
        .collect();
    if hole {
        points.reverse();
    }
    points
}

fn wavy(n: u32, length: f64) -> Patch {
    let outer = ring(n, [0.0; 2], |a| 1.0 + 0.2 * (3.0 * a).cos(), false);
    Patch::new(&[outer, ring(n / 4, [-0.3, 0.0], |_| 0.2, true)], length)
}

/// A bent and rippled shape.
fn bent([x, y]: [f64; 2]) -> [f64; 3] {
    let ripple = 0.05 * (20.0 * x).sin() * (20.0 * y).cos();
    [
        x + 0.1 * y * y,
        y + 0.05 * (4.0 * x).sin(),
        0.2 * (3.0 * x * y).sin() + ripple,
    ]
}

fn largest_difference(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    assert_eq!(a.len(), b.len(), "as many values");
    let pairs = a.iter().flatten().zip(b.iter().flatten());
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn affine_values_need_no_solve() {
    let patch = wavy(60, 0.1);
    let affine = |[x, y]: [f64; 2]| [x - 2.0 * y + 7.0, 0.5 * y, -3.0 * x];
    let values = patch.rim(affine);
    let mut scratch = HarmonicScratch::default();
    let found = interpolate_harmonic(&patch.mesh, &patch.section(), &values, 1e-14, &mut scratch);
    assert_eq!(found, None, "no equations are solved");
    let inner: Vec<_> = patch
        .mesh
        .steiner_points
        .iter()
        .map(|p| affine(p.position))
        .collect();
    assert!(largest_difference(&patch.linear(&values), &inner) < 1e-13);
    // One point off is enough.
    let mut values = values;
    values[17][1] += 1e-9;
    let found = interpolate_harmonic(&patch.mesh, &patch.section(), &values, 1e-14, &mut scratch);
    assert!(found.is_some(), "a point is off");
}

/// Adding an affine function to the values adds it to the result.
#[test]
fn affine_functions_are_reproduced() {
    let patch = wavy(60, 0.1);
    let affine = |[x, y]: [f64; 2]| [3.0 * x - y, 2.0 * y + 5.0, x + y];
    let plain = patch.solve(&patch.rim(bent));
    let both = patch.solve(&patch.rim(|p| [0, 1, 2].map(|k| bent(p)[k] + affine(p)[k])));
    let sum: Vec<_> = (plain.iter().zip(&patch.mesh.steiner_points))
        .map(|(value, inner)| [0, 1, 2].map(|k| value[k] + affine(inner.position)[k]))
        .collect();
    let off = largest_difference(&both, &sum);
    assert!(off < 1e-11, "off by {off}");
}

/// Real parts of complex powers are harmonic.
#[test]
fn harmonic_polynomials_are_found_in_a_disc() {
    let known = |[x, y]: [f64; 2]| [x * x - y * y, 2.0 * x * y, x * x * x - 3.0 * x * y * y];
    let mut errors = Vec::new();
    for (n, length) in [(60, 0.1), (240, 0.025)] {
        let patch = Patch::new(&[ring(n, [0.0; 2], |_| 1.0, false)], length);
        let exact: Vec<_> = patch
            .mesh
            .steiner_points
            .iter()
            .map(|p| known(p.position))
            .collect();
        let values = patch.rim(known);
        errors.push(largest_difference(&patch.solve(&values), &exact));
        let linear = largest_difference(&patch.linear(&values), &exact);
        assert!(linear > 0.2, "interpolation is {linear} off");
    }
    assert!(errors[0] < 6e-3 && errors[1] < 2e-3, "{errors:?}");
}

#[test]
fn a_dense_solver_agrees() {
    for n in [24, 60, 100] {
        let patch = wavy(n, 6.0 / f64::from(n));
        let values = patch.rim(bent);
        let (found, exact) = (
            patch.solve(&values),
            solve(&patch.mesh, &patch.points, &values),
        );
        let linear = patch.linear(&values);
        let off = largest_difference(&found, &exact);
        let before = largest_difference(&linear, &exact);
        assert!(off < 0.02 * before, "{off} off, interpolation {before}");
        let [least, smooth, interpolated] = [&exact, &found, &linear]
            .map(|inner| energy(&patch.mesh, &patch.points, &values, inner));
        assert!(
            least <= smooth * (1.0 + 1e-9),
            "{least} is the least, not {smooth}"
        );
        assert!(
            smooth - least < 1e-4 * (interpolated - least),
            "{least} {smooth} {interpolated}"
        );
    }
}

#[test]
fn used_scratch_memory_changes_no_bit() {
    let (patch, other) = (wavy(60, 0.1), wavy(100, 0.1));
    let values = patch.rim(bent);
    let mut scratch = HarmonicScratch::default();
    interpolate_harmonic(
        &other.mesh,
        &other.section(),
        &other.rim(bent),
        0.0,
        &mut scratch,
    )
    .unwrap();
    let found =
        interpolate_harmonic(&patch.mesh, &patch.section(), &values, 0.0, &mut scratch).unwrap();
    assert_eq!(found.values, patch.solve(&values), "a fresh one");
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 64,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    /// Extrema are at the rim, and the Dirichlet energy is at most that of interpolation.
    #[test]
    fn maximum_principle_holds(
        radii in prop::collection::vec(0.4f64..1.0, 8..60),
        heights in prop::collection::vec(-1.0f64..1.0, 60),
        length in 0.05f64..0.5,
        shift in prop::option::of(1e3f64..1e4),
    ) {
        let even = radii.len() - radii.len() % 2;
        let n = u32::try_from(even).unwrap();
        let mut outer = ring(n, [0.0; 2], |_| 1.0, false);
        for (p, radius) in outer.iter_mut().zip(&radii) {
            *p = p.map(|x| radius * x);
        }
        let patch = Patch::new(&[outer], length);
        let shift = shift.unwrap_or(0.0);
        let values: Vec<_> = (patch.points.iter().zip(&heights))
            .map(|(p, h)| [p[0] + shift, p[1] * h, *h])
            .collect();
        let found = patch.solve(&values);
        for k in 0..3 {
            let of = |values: &[[f64; 3]]| {
                let all = values.iter().map(|v| v[k]);
                all.fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(x), high.max(x)))
            };
            let (rim, inner) = (of(&values), of(&found));
            prop_assert!(rim.0 <= inner.0 && inner.1 <= rim.1, "{rim:?} {inner:?}");
        }
        let energy = |inner: &[[f64; 3]]| energy(&patch.mesh, &patch.points, &values, inner);
        let [smooth, interpolated] = [&found, &patch.linear(&values)].map(|inner| energy(inner));
        prop_assert!(smooth <= interpolated * (1.0 + 1e-5), "{smooth} {interpolated}");
    }
}
