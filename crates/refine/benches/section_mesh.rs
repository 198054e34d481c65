//! Time and quality of section meshes of smooth loops: median of many runs on one core.

use incise_refine::{
    Section, SectionMesh, SectionMeshParams, SectionMeshScratch, SectionMeshSize,
    triangulate_section,
};
use std::f64::consts::TAU;
use std::time::Instant;

/// Returns a wavy loop of `n` edges with lengths of about 0.3 to 1.2 of the even length.
fn wavy(n: u32, jitter: f64) -> Vec<[f64; 2]> {
    let mut state = 0x9e37_79b9_7f4a_7c15u64;
    let mut random = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f64 / f64::from(1u32 << 24)
    };
    let steps: Vec<f64> = (0..n).map(|_| 1.0 - jitter * random()).collect();
    let sum: f64 = steps.iter().sum();
    let mut a = 0.0;
    steps
        .iter()
        .map(|s| {
            let angle = a * TAU / sum;
            a += s;
            let r = 1.0 + 0.2 * (3.0 * angle).cos() + 0.05 * (7.0 * angle).sin();
            [r * angle.cos(), r * angle.sin()]
        })
        .collect()
}

fn distance(p: [f64; 2], q: [f64; 2]) -> f64 {
    (p[0] - q[0]).hypot(p[1] - q[1])
}

struct Quality {
    smallest: f64,
    fifth: f64,
    median: f64,
    mean: f64,
    longest: f64,
    shortest: f64,
}

/// Smallest angles \[degrees\] of triangles; lengths of inner edges over the target.
fn quality(points: &[[f64; 2]], mesh: &SectionMesh, length: f64) -> Quality {
    let at = |v: u32| match points.get(v as usize) {
        Some(&p) => p,
        None => mesh.steiner_points[v as usize - points.len()].position,
    };
    let (mut angles, mut edges) = (Vec::new(), Vec::new());
    for t in &mesh.triangles {
        let p = t.map(at);
        let sides = [0, 1, 2].map(|i| distance(p[i], p[(i + 1) % 3]));
        let angle = |i: usize| {
            let (a, b, c) = (sides[i], sides[(i + 1) % 3], sides[(i + 2) % 3]);
            ((b * b + c * c - a * a) / (2.0 * b * c))
                .clamp(-1.0, 1.0)
                .acos()
                .to_degrees()
        };
        angles.push(angle(0).min(angle(1)).min(angle(2)));
        for i in 0..3 {
            if t[i] < t[(i + 1) % 3] {
                edges.push(sides[i] / length);
            }
        }
    }
    angles.sort_unstable_by(f64::total_cmp);
    edges.sort_unstable_by(f64::total_cmp);
    Quality {
        smallest: angles[0],
        fifth: angles[angles.len() / 20],
        median: angles[angles.len() / 2],
        mean: edges.iter().sum::<f64>() / edges.len() as f64,
        longest: edges[edges.len() - 1],
        shortest: edges[0],
    }
}

#[expect(clippy::print_stdout, reason = "a benchmark says what it measured")]
fn main() {
    println!(
        "{:>6} {:>6} {:>9} {:>9} {:>9} {:>8}   angle: min 5% median   \
         edge/target: shortest mean longest",
        "rim", "jitter", "triangles", "ms", "best ms", "M tri/s"
    );
    let mut scratch = SectionMeshScratch::default();
    // Arguments restrict the run to a number of points and a multiple of the mean edge.
    let only: Vec<f64> = std::env::args().filter_map(|a| a.parse().ok()).collect();
    for (n, jitter, factor) in [
        (280, 0.7, Some(0.55)),
        (280, 0.7, Some(1.0)),
        (280, 0.0, Some(1.0)),
        (280, 0.9, Some(1.0)),
        (280, 0.7, Some(2.0)),
        (280, 0.7, Some(0.5)),
        (280, 0.7, Some(1.5)),
        (100, 0.7, Some(1.0)),
        (100, 0.9, Some(1.0)),
        (40, 0.7, Some(1.0)),
        (20, 0.7, Some(1.0)),
        (12, 0.7, Some(1.0)),
        (8, 0.0, Some(1.0)),
        (280, 0.7, Some(4.0)),
        (280, 0.7, Some(8.0)),
        (1000, 0.7, Some(1.0)),
        (2200, 0.7, Some(1.0)),
        (2200, 0.7, None),
        (6000, 0.7, None),
        (280, 0.7, None),
    ] {
        if only.first().is_some_and(|only| *only != f64::from(n))
            || only.get(1).is_some_and(|only| factor != Some(*only))
        {
            continue;
        }
        let points = wavy(n, jitter);
        let mean = (0..points.len())
            .map(|i| distance(points[i], points[(i + 1) % points.len()]))
            .sum::<f64>()
            / f64::from(n);
        let loops = [(0..n).collect::<Vec<u32>>()];
        let section = Section {
            points: &points,
            loops: &loops,
        };
        let params = SectionMeshParams {
            size: factor.map_or(SectionMeshSize::Any, |f| SectionMeshSize::Uniform(f * mean)),
            grading: 0.0,
            ..SectionMeshParams::default()
        };
        let mut times = Vec::new();
        let mut result = SectionMesh::default();
        let begin = Instant::now();
        while times.len() < 5 || begin.elapsed().as_millis() < 300 {
            let start = Instant::now();
            result = triangulate_section(&section, &params, |_, _| false, &mut scratch)
                .expect("a valid loop");
            times.push(start.elapsed().as_secs_f64() * 1e3);
        }
        times.sort_unstable_by(f64::total_cmp);
        let (median, best) = (times[times.len() / 2], times[0]);
        let q = quality(&points, &result, factor.unwrap_or(1.0) * mean);
        println!(
            "{n:>6} {jitter:>6} {:>9} {median:>9.3} {best:>9.3} {:>8.2}   \
                 {:>10.1} {:>5.1} {:>5.1}   {:>10.2} {:>5.2} {:>5.2}",
            result.triangles.len(),
            result.triangles.len() as f64 / median / 1e3,
            q.smallest,
            q.fifth,
            q.median,
            q.shortest,
            q.mean,
            q.longest
        );
    }
}
