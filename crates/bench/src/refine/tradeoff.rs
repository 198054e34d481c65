//! Run time against quality: the paper's refinement after so many rounds, the default with several bounds on
//! angles, on the same rims.

use super::cover::{REPEATS, fastest, percentile};
use super::plot::Chart;
use super::rims::{self, Rims};
use super::row::Stamp;
use super::{Files, RefineArguments};
use crate::columns;
use crate::columns::measured;
use crate::statistics::{mean, median};
use crate::subject::Subject;
use incise_mesh::Vec3;
use incise_refine::{
    Cover, CoverParams, CoverQuality, CoverScratch, CoverSize, RefineError, RefineParams, Section,
    fill,
};
use serde::Serialize;
use std::error::Error;
use std::io::Write;
use std::time::Instant;

/// The rounds that the paper's refinement gets.
const ROUNDS: [u32; 8] = [1, 2, 3, 4, 5, 6, 7, 8];
/// Angles below which the default improves triangles \[degrees\].
const SHARP: [f64; 7] = [0.0, 10.0, 20.0, 25.0, 30.0, 32.0, 35.0];
/// The model of the rows that sum up all.
const ALL: &str = "all";

/// What stands in the columns.
const LEGEND: &str = "\
Sections of one loop, each covered by every method: the paper's (triangulation, then so many rounds of subdividing and swapping, to the mean of \
the targets) and the default (targets point by point, triangles below so many degrees improved). ms: the sum over all sections of the fastest \
of five, triangulation and all; ms/1000: for a thousand triangles. Angles in degrees, the smallest of every triangle: the least, the 5th \
percentile, the median. Edge error: how far the mean of inner edges over their targets is from 1; longest: the longest of them.";

/// How sections are covered.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Way {
    /// The paper's Algorithms A2, 4 and A3 with so many rounds.
    Paper(u32),
    /// The default, with so large an angle asked for \[degrees\].
    Default(f64),
}

impl Way {
    fn all() -> impl Iterator<Item = Self> {
        let paper = ROUNDS.into_iter().map(Self::Paper);
        paper.chain(SHARP.into_iter().map(Self::Default))
    }
}

/// What covers of one kind came to.
#[derive(Debug, Clone, Default)]
struct Sum {
    covers: usize,
    ms: f64,
    angles: Vec<f64>,
    edges: Vec<f64>,
}

impl Sum {
    fn add(&mut self, ms: f64, quality: &CoverQuality) {
        self.covers += 1;
        self.ms += ms;
        self.angles.extend(&quality.angles);
        self.edges.extend(&quality.edges);
    }

    fn append(&mut self, other: &Self) {
        self.covers += other.covers;
        self.ms += other.ms;
        self.angles.extend(&other.angles);
        self.edges.extend(&other.edges);
    }
}

/// One method with one bound on one model's sections, or on all.
#[derive(Debug, Clone, Default, Serialize)]
pub(super) struct Row {
    pub(super) model: String,
    /// `paper` or `default`.
    pub(super) method: &'static str,
    /// Rounds, or degrees.
    pub(super) bound: f64,
    /// z.
    pub(super) level: f64,
    pub(super) covers: usize,
    pub(super) triangles: usize,
    pub(super) ms: f64,
    pub(super) ms_a_thousand_triangles: f64,
    pub(super) smallest_angle: f64,
    pub(super) angle_5: f64,
    pub(super) angle_median: f64,
    pub(super) edge_error: f64,
    pub(super) edge_longest: f64,
    #[serde(flatten)]
    pub(super) stamp: Stamp,
}

impl Row {
    const NAMES: [&'static str; 13] = [
        "model",
        "method",
        "bound",
        "z",
        "covers",
        "tris",
        "ms",
        "ms/1000",
        "min",
        "5%",
        "median",
        "edge error",
        "longest",
    ];

    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^53 triangles")]
    fn of(model: &str, way: Way, level: f64, sum: &Sum, stamp: &Stamp) -> Self {
        let (mut angles, mut edges) = (sum.angles.clone(), sum.edges.clone());
        angles.sort_unstable_by(f64::total_cmp);
        edges.sort_unstable_by(f64::total_cmp);
        let (method, bound) = match way {
            Way::Paper(rounds) => ("paper", f64::from(rounds)),
            Way::Default(degrees) => ("default", degrees),
        };
        Self {
            model: model.to_owned(),
            method,
            bound,
            level,
            covers: sum.covers,
            triangles: angles.len(),
            ms: sum.ms,
            ms_a_thousand_triangles: sum.ms / (angles.len() as f64 / 1e3),
            smallest_angle: angles.first().copied().unwrap_or(f64::NAN),
            angle_5: percentile(&angles, 5),
            angle_median: median(&angles),
            edge_error: (mean(&edges) - 1.0).abs(),
            edge_longest: edges.last().copied().unwrap_or(f64::NAN),
            stamp: stamp.clone(),
        }
    }

    fn cells(&self) -> [String; 13] {
        [
            self.model.clone(),
            self.method.to_owned(),
            measured(self.bound, 0),
            measured(self.level, 2),
            self.covers.to_string(),
            self.triangles.to_string(),
            measured(self.ms, 2),
            measured(self.ms_a_thousand_triangles, 3),
            measured(self.smallest_angle, 1),
            measured(self.angle_5, 1),
            measured(self.angle_median, 1),
            measured(self.edge_error, 3),
            measured(self.edge_longest, 2),
        ]
    }
}

/// Measures, prints and draws.
pub(super) fn run(
    arguments: &RefineArguments,
    subjects: &[Subject],
    stamp: &Stamp,
    mut files: Files,
    out: &mut impl Write,
) -> Result<(), Box<dyn Error>> {
    let ways: Vec<Way> = Way::all().collect();
    let mut rows = Vec::new();
    let mut all: Vec<(f64, Vec<Sum>)> = (arguments.levels.iter())
        .map(|level| (level.z(), vec![Sum::default(); ways.len()]))
        .collect();
    let (mut failures, mut nested) = (Vec::new(), 0);
    let progress = arguments.rows.progress(subjects.len(), 1);
    for subject in subjects {
        progress.begin(&subject.name);
        let mut sums = all.clone();
        for sum in sums.iter_mut().flat_map(|(_, sums)| sums) {
            *sum = Sum::default();
        }
        for (_, level, rims, failed) in
            rims::of(subject, &arguments.levels, arguments.planes, stamp)?
        {
            failures.extend(failed);
            let Some((_, sums)) = sums.iter_mut().find(|(z, _)| *z == level.z()) else {
                continue;
            };
            for rims in &rims {
                if !rims.is_one_loop() {
                    nested += 1;
                    continue;
                }
                for (way, sum) in ways.iter().zip(sums.iter_mut()) {
                    let (ms, quality) = cover(*way, rims, stamp)?;
                    sum.add(ms, &quality);
                }
            }
        }
        for ((z, sums), (_, all)) in sums.iter().zip(&mut all) {
            for ((way, sum), all) in ways.iter().zip(sums).zip(all) {
                rows.push(Row::of(&subject.name, *way, *z, sum, stamp));
                all.append(sum);
            }
        }
        progress.step();
    }
    progress.end();
    let first = rows.len();
    for (z, sums) in &all {
        let of = |(way, sum): (&Way, &Sum)| Row::of(ALL, *way, *z, sum, stamp);
        rows.extend(ways.iter().zip(sums).map(of));
    }
    let cells: Vec<_> = [Row::NAMES.map(str::to_owned)]
        .into_iter()
        .chain(rows[first..].iter().map(Row::cells))
        .collect();
    write!(out, "{}", columns::folded(&cells, 2))?;
    write!(out, "{}", columns::paragraphs(LEGEND))?;
    writeln!(
        out,
        "Left out: {nested} sections of several loops. Failed: {} cuts.",
        failures.len()
    )?;
    for failure in &failures {
        writeln!(out, "  {failure}")?;
    }
    let all = &rows[first..];
    if let Some(file) = &mut files.csv {
        file.write(csv(all))?;
    }
    if let Some(file) = &mut files.plot {
        file.draw(&Chart(all))?;
    }
    Ok(files.json.write(&rows)?)
}

/// Rows as a table for other programs.
fn csv(rows: &[Row]) -> String {
    let mut text =
        "method,bound,z,covers,triangles,ms,ms_a_thousand_triangles,smallest_angle,angle_5,\
        angle_median,edge_error,edge_longest,commit\n"
            .to_owned();
    for row in rows {
        let numbers = [
            row.ms,
            row.ms_a_thousand_triangles,
            row.smallest_angle,
            row.angle_5,
            row.angle_median,
            row.edge_error,
            row.edge_longest,
        ];
        let numbers = numbers.map(|x| measured(x, 4)).join(",");
        let (method, bound, level) = (row.method, row.bound, measured(row.level, 3));
        let (covers, triangles, commit) = (row.covers, row.triangles, &row.stamp.commit);
        text += &format!("{method},{bound},{level},{covers},{triangles},{numbers},{commit}\n");
    }
    text
}

/// Covers a section one way: the fastest time \[ms\] of several, and what came out.
fn cover(way: Way, rims: &Rims, stamp: &Stamp) -> Result<(f64, CoverQuality), RefineError> {
    let params = CoverParams {
        size: rims.size(),
        grading: stamp.grading,
        ..CoverParams::default()
    };
    match way {
        Way::Default(sharp) => {
            let params = CoverParams { sharp, ..params };
            let (ms, cover) = fastest(rims, &params, &mut CoverScratch::default())?;
            Ok((ms, cover.quality(&rims.section(), &params)))
        }
        Way::Paper(rounds) => paper(rounds, rims, &params),
    }
}

/// The paper's way. Its patch is judged as a cover: by the same targets, of which it knows the mean.
fn paper(
    rounds: u32,
    rims: &Rims,
    params: &CoverParams<'_>,
) -> Result<(f64, CoverQuality), RefineError> {
    let (rim, mut lengths) = rims.only_loop();
    let refine = RefineParams {
        rim_length: Some(mean(&lengths)),
        max_rounds: rounds,
        ..RefineParams::default()
    };
    let (mut best, mut patch) = (f64::INFINITY, None);
    for _ in 0..REPEATS {
        let begin = Instant::now();
        let filled = fill(&rim, Vec3::z(), &refine, |_, _| false)?;
        best = best.min(begin.elapsed().as_secs_f64() * 1e3);
        patch = Some(filled);
    }
    let Some(patch) = patch else {
        return Ok((best, CoverQuality::default()));
    };
    for parents in &patch.inner {
        let sum: f64 = parents.iter().map(|&p| lengths[p as usize]).sum();
        lengths.push(sum / 3.0);
    }
    let points: Vec<[f64; 2]> = patch.points.iter().map(|p| [p.x, p.y]).collect();
    let section = Section {
        points: &points,
        loops: &[(0..).take(patch.rim).collect()],
        crease: false,
    };
    let cover = Cover {
        triangles: patch.triangles,
        ..Cover::default()
    };
    let params = CoverParams {
        size: CoverSize::Local(&lengths),
        ..*params
    };
    Ok((best, cover.quality(&section, &params)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn circle(n: u32, length: f64) -> Rims {
        let angles = (0..n).map(|i| f64::from(i) * TAU / f64::from(n));
        let points: Vec<[f64; 2]> = angles.map(|a| [a.cos(), a.sin()]).collect();
        let lengths = vec![length; points.len()];
        Rims::of_loop(points, lengths)
    }

    #[test]
    fn a_hexagon_is_cut_by_three_diagonals_or_gets_a_point() {
        let rims = circle(6, 100.0);
        for way in Way::all() {
            let (ms, quality) = cover(way, &rims, &Stamp::default()).unwrap();
            assert!(ms > 0.0, "{way:?} takes time");
            let counts = (quality.angles.len(), quality.edges.len());
            // The default takes targets no longer than the rim's edges, which are 1.
            if matches!(way, Way::Default(_)) {
                assert_eq!(counts, (6, 6), "{way:?}: a point");
                continue;
            }
            assert_eq!(counts, (4, 3), "{way:?}: diagonals");
            assert!((quality.angles[0] - 30.0).abs() < 1e-9, "{way:?}");
            assert!((quality.edges[0] - 3.0f64.sqrt()).abs() < 1e-9, "{way:?}");
        }
    }

    #[test]
    fn a_table_has_as_many_cells_in_every_line() {
        let row = Row {
            method: "paper",
            bound: 3.0,
            level: 2.0 / 3.0,
            covers: 5,
            triangles: 70,
            ms: 1.5,
            edge_longest: f64::NAN,
            ..Row::default()
        };
        let text = csv(&[row.clone(), row]);
        let lines: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
        assert_eq!(lines.len(), 3, "{text}");
        assert!(lines.iter().all(|cells| cells.len() == 13), "{text}");
        assert_eq!(lines[1][..6], ["paper", "3", "0.667", "5", "70", "1.5000"]);
        let cell = lines[0].iter().position(|name| *name == "edge_longest");
        assert_eq!(lines[1][cell.unwrap()], "-", "not measured");
    }

    #[test]
    fn more_rounds_make_more_and_shorter_edges_until_the_target_is_met() {
        let rims = circle(60, TAU / 60.0);
        let of = |rounds| {
            cover(Way::Paper(rounds), &rims, &Stamp::default())
                .unwrap()
                .1
        };
        let [mut count, mut mean] = [0.0, f64::INFINITY];
        for rounds in ROUNDS {
            let quality = of(rounds);
            let triangles = quality.angles.len() as f64;
            assert!(triangles >= count, "{rounds} rounds: {triangles}");
            assert!(quality.mean_edge() <= mean, "{rounds} rounds");
            [count, mean] = [triangles, quality.mean_edge()];
        }
        assert!(count > 4.0 * 58.0, "refined, not only triangulated");
        assert!((mean - 1.0).abs() < 0.3, "to about the target: {mean}");
    }
}
