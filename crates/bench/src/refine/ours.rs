//! Covers of single sections, timed and judged as other programs' are.

use super::COMPARED;
use super::rims::{self, Rims};
use super::row::Stamp;
use crate::statistics::median;
use crate::subject::Subject;
use incise_refine::{Cover, CoverParams, CoverScratch, cover};
use std::error::Error;
use std::time::Instant;

/// How often each section is covered.
const RUNS: usize = 15;

/// A section and its cover.
#[derive(Debug, Clone, Default)]
pub(super) struct Ours {
    /// `middle` or `seeded`.
    pub(super) planes: &'static str,
    /// The how manieth of these planes.
    pub(super) section: usize,
    /// The section's fingerprint.
    pub(super) rims: String,
    /// Of the rims.
    pub(super) points: usize,
    /// Median and fastest \[ms\].
    pub(super) ms: [f64; 2],
    /// The smallest of every triangle \[degrees\].
    pub(super) angles: Vec<f64>,
    /// Lengths of inner edges over the mean target of the rims.
    pub(super) edges: Vec<f64>,
}

/// Covers all sections of a model. Runs of a section are apart, all others between: a slow minute of the
/// machine is then not all that one saw.
pub(super) fn of(
    subject: &Subject,
    planes: u32,
    stamp: &Stamp,
) -> Result<Vec<Ours>, Box<dyn Error>> {
    let mut sections: Vec<(&'static str, usize, Rims)> = Vec::new();
    for (planes, _, all, _) in rims::of(subject, &[COMPARED], planes, stamp)? {
        let numbered = all.into_iter().enumerate();
        sections.extend(numbered.map(|(k, rims)| (planes, k, rims)));
    }
    let mut scratch = CoverScratch::default();
    let mut results = vec![(Vec::new(), Cover::default()); sections.len()];
    for _ in 0..RUNS {
        for ((_, _, rims), (times, result)) in sections.iter().zip(&mut results) {
            let params = params(rims, stamp);
            let begin = Instant::now();
            let covered = cover(&rims.section(), &params, |_, _| false, &mut scratch)?;
            times.push(begin.elapsed().as_secs_f64() * 1e3);
            *result = covered;
        }
    }
    let judged = sections.iter().zip(results);
    Ok(judged
        .map(|((planes, section, rims), (mut times, cover))| {
            times.sort_unstable_by(f64::total_cmp);
            Ours {
                planes,
                section: *section,
                rims: rims.fingerprint(),
                points: rims.points(),
                ms: [median(&times), times.first().copied().unwrap_or(f64::NAN)],
                angles: cover.quality(&rims.section(), &params(rims, stamp)).angles,
                edges: edges(rims, &cover),
            }
        })
        .collect())
}

fn params<'a>(rims: &'a Rims, stamp: &Stamp) -> CoverParams<'a> {
    CoverParams {
        size: rims.size(),
        grading: stamp.grading,
        ..CoverParams::default()
    }
}

/// Inner edges over one target for all: others know no other.
fn edges(rims: &Rims, cover: &Cover) -> Vec<f64> {
    let section = rims.section();
    let at = |v: u32| match section.points.get(v as usize) {
        Some(&point) => point,
        None => cover.inner[v as usize - section.points.len()].at,
    };
    let mut sides: Vec<[u32; 2]> = (cover.triangles.iter())
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
        .collect();
    sides.sort_unstable();
    // An inner edge is the side of two triangles, once in each direction.
    let inner = sides
        .iter()
        .filter(|&&[a, b]| a < b && sides.binary_search(&[b, a]).is_ok());
    let target = rims.target();
    inner
        .map(|&[a, b]| {
            let ([ax, ay], [bx, by]) = (at(a), at(b));
            (ax - bx).hypot(ay - by) / target
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::subject;
    use std::f64::consts::TAU;

    #[test]
    fn every_section_is_covered_and_judged() {
        let subjects = subject::list(None, &["Sphere768".to_owned()], 1000).unwrap();
        let stamp = Stamp {
            snap: 0.1,
            seed: 1,
            ..Stamp::default()
        };
        let all = of(&subjects[0], 3, &stamp).unwrap();
        let names: Vec<_> = all.iter().map(|ours| (ours.planes, ours.section)).collect();
        assert_eq!(
            names,
            [("middle", 0), ("seeded", 0), ("seeded", 1), ("seeded", 2)]
        );
        for ours in &all {
            let [median, fastest] = ours.ms;
            assert!(0.0 < fastest && fastest <= median, "{:?}", ours.ms);
            // A disc of t triangles has 3 t sides: every inner edge is two of them, every rim edge one.
            let sides = 2 * ours.edges.len() + ours.points;
            assert_eq!(
                3 * ours.angles.len(),
                sides,
                "{} {}",
                ours.planes,
                ours.section
            );
        }
    }

    #[test]
    fn edges_are_measured_in_mean_targets() {
        let angles = (0..6).map(|i| f64::from(i) * TAU / 6.0);
        let points: Vec<[f64; 2]> = angles.map(|a| [a.cos(), a.sin()]).collect();
        let rims = Rims::of_loop(points, vec![0.3, 0.7, 0.4, 0.6, 0.2, 0.8]);
        let cover = Cover {
            triangles: vec![[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]],
            ..Cover::default()
        };
        let mut lengths = edges(&rims, &cover);
        lengths.sort_unstable_by(f64::total_cmp);
        // Diagonals of a hexagon of side 1, over 0.5.
        let diagonals = [2.0 * 3.0f64.sqrt(), 2.0 * 3.0f64.sqrt(), 4.0];
        assert_eq!(lengths.len(), 3);
        for (length, diagonal) in lengths.iter().zip(diagonals) {
            assert!((length - diagonal).abs() < 1e-12, "{length}, {diagonal}");
        }
    }
}
