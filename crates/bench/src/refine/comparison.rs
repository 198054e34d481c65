//! Covers of the same sections by several programs, side by side.

use super::cover::percentile;
use super::ours::Ours;
use super::peers::{Peer, Pool, Theirs};
use super::row::Stamp;
use crate::columns::measured;
use crate::statistics::{mean, median};
use serde::Serialize;

/// What a program made of one model's sections.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Line {
    model: String,
    program: String,
    /// Covered here, of so many.
    sections: usize,
    of: usize,
    triangles: usize,
    /// Median and fastest \[ms\], summed over sections.
    ms: f64,
    ms_fastest: f64,
    /// How many times incise's.
    times: f64,
    times_fastest: f64,
    smallest_angle: f64,
    angle_5: f64,
    angle_median: f64,
    edge_mean: f64,
    edge_longest: f64,
    keeps_rims: bool,
    #[serde(flatten)]
    stamp: Stamp,
}

impl Line {
    pub(super) const NAMES: [&str; 15] = [
        "model", "program", "sections", "tris", "ms", "fastest", "ms/1000", "x", "x fast", "min",
        "5%", "median", "edge", "longest", "rims",
    ];

    pub(super) fn cells(&self) -> [String; 15] {
        [
            self.model.clone(),
            self.program.clone(),
            format!("{}/{}", self.sections, self.of),
            self.triangles.to_string(),
            measured(self.ms, 2),
            measured(self.ms_fastest, 2),
            measured(self.ms / (self.triangles as f64 / 1e3), 3),
            measured(self.times, 1),
            measured(self.times_fastest, 1),
            measured(self.smallest_angle, 2),
            measured(self.angle_5, 1),
            measured(self.angle_median, 1),
            measured(self.edge_mean, 3),
            measured(self.edge_longest, 2),
            if self.keeps_rims { "kept" } else { "changed" }.to_owned(),
        ]
    }
}

/// A model's sections, each by the program that was faster on it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Faster {
    model: String,
    sections: usize,
    /// Medians, fastest runs \[ms\].
    ours: [f64; 2],
    theirs: [f64; 2],
}

impl Faster {
    pub(super) const NAMES: [&str; 8] = [
        "model", "sections", "ms", "theirs", "x", "fastest", "theirs", "x",
    ];

    pub(super) fn cells(&self) -> [String; 8] {
        let [[ours, ours_fast], [theirs, theirs_fast]] = [self.ours, self.theirs];
        [
            self.model.clone(),
            self.sections.to_string(),
            measured(ours, 2),
            measured(theirs, 2),
            measured(theirs / ours, 1),
            measured(ours_fast, 2),
            measured(theirs_fast, 2),
            measured(theirs_fast / ours_fast, 1),
        ]
    }
}

/// A model's comparison.
#[derive(Debug, Clone)]
pub(super) struct Compared {
    pub(super) lines: Vec<Line>,
    /// Nothing where no program that keeps the rims can be compared.
    pub(super) faster: Option<Faster>,
    /// Which results are of other rims.
    pub(super) warnings: Vec<String>,
}

/// Sets the results of others beside covers of the same sections. Programs that covered the same of them make
/// a block, after incise's covers of just those.
pub(super) fn compare(model: &str, ours: &[Ours], peers: &[Peer], stamp: &Stamp) -> Compared {
    let mut compared = Compared {
        lines: Vec::new(),
        faster: None,
        warnings: Vec::new(),
    };
    let mut blocks: Vec<(Vec<usize>, Vec<Line>)> = Vec::new();
    let mut best = vec![[f64::INFINITY; 2]; ours.len()];
    for peer in peers {
        let (pairs, pool) = match same(model, ours, peer) {
            Ok(Some(found)) => found,
            Ok(None) => continue,
            Err(warning) => {
                compared.warnings.push(warning);
                continue;
            }
        };
        let sections: Vec<usize> = pairs.iter().map(|&(k, _)| k).collect();
        let line = theirs(peer, pool, &pairs, ours, stamp);
        if peer.keeps_rims {
            for (k, theirs) in pairs {
                let [ms, fastest] = best[k];
                best[k] = [ms.min(theirs.ms), fastest.min(theirs.ms_fastest)];
            }
        }
        match blocks.iter_mut().find(|(set, _)| *set == sections) {
            Some((_, lines)) => lines.push(line),
            None => blocks.push((sections, vec![line])),
        }
    }
    for (sections, lines) in blocks {
        compared.lines.push(of_ours(model, ours, &sections, stamp));
        compared.lines.extend(lines);
    }
    let covered: Vec<usize> = (0..ours.len())
        .filter(|&k| best[k][0].is_finite())
        .collect();
    if !covered.is_empty() {
        compared.faster = Some(Faster {
            model: model.to_owned(),
            sections: covered.len(),
            ours: [0, 1].map(|i| covered.iter().map(|&k| ours[k].ms[i]).sum()),
            theirs: [0, 1].map(|i| covered.iter().map(|&k| best[k][i]).sum()),
        });
    }
    compared
}

/// A section by its place in ours, and what others made of it.
type Pair<'a> = (usize, &'a Theirs);

/// The sections of a model that a program covered, in our order, and all of them together. Nothing where it
/// covered none; the error says which are not those that we covered.
fn same<'a>(
    model: &str,
    ours: &[Ours],
    peer: &'a Peer,
) -> Result<Option<(Vec<Pair<'a>>, &'a Pool)>, String> {
    let mut pairs = Vec::new();
    for theirs in peer.sections.iter().filter(|theirs| theirs.model == model) {
        let name = format!("{model} {} {:03}", theirs.planes, theirs.section);
        let found = (ours.iter())
            .position(|ours| ours.planes == theirs.planes && ours.section == theirs.section);
        let Some(k) = found else {
            return Err(format!(
                "{}: {name} was not cut here: same --planes?",
                peer.program
            ));
        };
        if ours[k].rims != theirs.rims {
            return Err(format!(
                "{}: the rims of {name} are others, of {} points, not {}: write them again with --rims",
                peer.program, theirs.points, ours[k].points
            ));
        }
        pairs.push((k, theirs));
    }
    pairs.sort_unstable_by_key(|&(k, _)| k);
    if let Some(twice) = pairs.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        let Theirs {
            planes, section, ..
        } = twice[0].1;
        return Err(format!(
            "{}: {model} {planes} {section:03} is there twice",
            peer.program
        ));
    }
    let Some(pool) = peer.models.iter().find(|pool| pool.model == model) else {
        return match pairs.is_empty() {
            true => Ok(None),
            false => Err(format!("{}: no sum for {model}", peer.program)),
        };
    };
    if pool.sections != pairs.len() {
        return Err(format!(
            "{}: {} sections of {model}, but a sum of {}",
            peer.program,
            pairs.len(),
            pool.sections
        ));
    }
    Ok(Some((pairs, pool)))
}

fn theirs(peer: &Peer, pool: &Pool, pairs: &[Pair<'_>], ours: &[Ours], stamp: &Stamp) -> Line {
    let sum = |ms: &dyn Fn(&Pair<'_>) -> f64| pairs.iter().map(ms).sum::<f64>();
    let [ms, ms_fastest] = [
        sum(&|(_, theirs)| theirs.ms),
        sum(&|(_, theirs)| theirs.ms_fastest),
    ];
    Line {
        model: pool.model.clone(),
        program: peer.program.clone(),
        sections: pairs.len(),
        of: ours.len(),
        triangles: pool.triangles,
        ms,
        ms_fastest,
        times: ms / sum(&|(k, _)| ours[*k].ms[0]),
        times_fastest: ms_fastest / sum(&|(k, _)| ours[*k].ms[1]),
        smallest_angle: pool.smallest_angle,
        angle_5: pool.angle_5,
        angle_median: pool.angle_median,
        edge_mean: pool.edge_mean,
        edge_longest: pool.edge_longest,
        keeps_rims: peer.keeps_rims,
        stamp: stamp.clone(),
    }
}

fn of_ours(model: &str, ours: &[Ours], sections: &[usize], stamp: &Stamp) -> Line {
    let pooled = |values: &dyn Fn(&Ours) -> &[f64]| {
        let mut all: Vec<f64> = (sections.iter())
            .flat_map(|&k| values(&ours[k]).iter().copied())
            .collect();
        all.sort_unstable_by(f64::total_cmp);
        all
    };
    let [angles, edges] = [pooled(&|ours| &ours.angles), pooled(&|ours| &ours.edges)];
    let [ms, ms_fastest] = [0, 1].map(|i| sections.iter().map(|&k| ours[k].ms[i]).sum());
    Line {
        model: model.to_owned(),
        program: "incise".to_owned(),
        sections: sections.len(),
        of: ours.len(),
        triangles: angles.len(),
        ms,
        ms_fastest,
        times: 1.0,
        times_fastest: 1.0,
        smallest_angle: angles.first().copied().unwrap_or(f64::NAN),
        angle_5: percentile(&angles, 5),
        angle_median: median(&angles),
        edge_mean: mean(&edges),
        edge_longest: edges.last().copied().unwrap_or(f64::NAN),
        keeps_rims: true,
        stamp: stamp.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ours() -> Vec<Ours> {
        let of = |section, ms, angle| Ours {
            planes: "seeded",
            section,
            rims: format!("r{section}"),
            points: 10,
            ms: [ms, ms / 2.0],
            angles: vec![angle, angle + 1.0],
            edges: vec![1.0],
        };
        vec![of(0, 1.0, 30.0), of(1, 3.0, 40.0), of(2, 4.0, 50.0)]
    }

    /// A program with these times of sections.
    fn peer(program: &str, times: &[(usize, f64)]) -> Peer {
        let section = |&(section, ms): &(usize, f64)| {
            format!(
                r#"{{"model": "Bunny", "planes": "seeded", "section": {section}, "rims": "r{section}",
                "points": 10, "loops": 1, "ms": {ms}, "ms_fastest": {}}}"#,
                ms / 4.0
            )
        };
        let sections: Vec<String> = times.iter().map(section).collect();
        let text = format!(
            r#"{{"program": "{program}", "setting": "", "keeps_rims": true, "sections": [{}],
            "models": [{{"model": "Bunny", "sections": {}, "triangles": 6, "smallest_angle": 1,
            "angle_5": 2, "angle_median": 3, "edge_mean": 4, "edge_longest": 5}}]}}"#,
            sections.join(","),
            times.len()
        );
        serde_json::from_str(&text).unwrap()
    }

    fn of(peers: &[Peer]) -> Compared {
        compare("Bunny", &ours(), peers, &Stamp::default())
    }

    #[test]
    fn a_program_is_compared_over_the_sections_that_it_covered() {
        let all = peer("all", &[(2, 8.0), (0, 2.0), (1, 6.0)]);
        let some = peer("some", &[(0, 10.0), (2, 5.0)]);
        let compared = of(&[all, some]);
        assert!(compared.warnings.is_empty(), "{:?}", compared.warnings);
        let names: Vec<_> = (compared.lines.iter())
            .map(|line| (line.program.as_str(), line.sections, line.of))
            .collect();
        assert_eq!(
            names,
            [
                ("incise", 3, 3),
                ("all", 3, 3),
                ("incise", 2, 3),
                ("some", 2, 3)
            ]
        );
        let times: Vec<_> = (compared.lines.iter())
            .map(|line| (line.ms, line.times, line.times_fastest))
            .collect();
        // 16 over 8 and 15 over 5; the fastest runs are a quarter over a half.
        assert_eq!(
            times,
            [
                (8.0, 1.0, 1.0),
                (16.0, 2.0, 1.0),
                (5.0, 1.0, 1.0),
                (15.0, 3.0, 1.5)
            ]
        );
        let least: Vec<f64> = compared.lines.iter().map(|l| l.angle_median).collect();
        assert_eq!(
            least,
            [40.0, 3.0, 31.0, 3.0],
            "30 31 40 41 50 51 and 30 31 50 51"
        );
        assert_eq!(
            compared.lines[1].cells()[6],
            "2666.667",
            "16 ms, 6 triangles"
        );
    }

    #[test]
    fn the_faster_one_counts_section_by_section() {
        let mut bent = peer("bent", &[(0, 0.1)]);
        bent.keeps_rims = false;
        let peers = [
            peer("a", &[(0, 2.0), (1, 6.0)]),
            peer("b", &[(1, 9.0), (0, 1.5)]),
            bent,
        ];
        let faster = of(&peers).faster.unwrap();
        let expected = Faster {
            model: "Bunny".to_owned(),
            sections: 2,
            ours: [4.0, 2.0],
            theirs: [7.5, 1.875],
        };
        assert_eq!(faster, expected);
        assert!(of(&peers[2..]).faster.is_none(), "none that keeps the rims");
    }

    #[test]
    fn other_rims_are_not_compared() {
        let same = peer("a", &[(0, 2.0)]);
        let mut moved = same.clone();
        moved.sections[0].rims = "r9".to_owned();
        moved.sections[0].points = 11;
        let unknown = peer("a", &[(3, 2.0)]);
        let twice = peer("a", &[(0, 2.0), (0, 2.0)]);
        let mut short = same.clone();
        short.models[0].sections = 2;
        let mut bare = same.clone();
        bare.models.clear();
        for (peer, what) in [
            (moved, "of 11 points, not 10"),
            (unknown, "seeded 003 was not cut here"),
            (twice, "seeded 000 is there twice"),
            (short, "1 sections of Bunny, but a sum of 2"),
            (bare, "no sum for Bunny"),
        ] {
            let compared = of(&[peer, same.clone()]);
            assert_eq!(compared.lines.len(), 2, "{what}: only the same");
            let [warning] = &compared.warnings[..] else {
                panic!("{what}: {:?}", compared.warnings)
            };
            assert!(warning.contains(what), "{warning}");
        }
        let mut other = same;
        other.sections[0].model = "Banana".to_owned();
        other.models[0].model = "Banana".to_owned();
        let compared = of(&[other]);
        assert!(
            compared.lines.is_empty() && compared.warnings.is_empty(),
            "not of this model: {compared:?}"
        );
    }
}
