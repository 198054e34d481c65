//! Verdicts of a quick run, names of cases, and the files of `--plot`.

use super::*;

/// Invariants that fail today in a quick run; one that is mended leaves this list.
///
/// Full runs fail in more, see `docs/benchmarks.md`.
const OPEN: [(&str, &str); 4] = [
    // Ten iterations do not carry a million times the mass of a vertex on springs.
    ("T3", "limits of every motion"),
    ("contradiction", "largest strain 10 s after"),
    ("T20", "distance from the state of the first order"),
    // The plates press a ball that cannot change its shape to half its size.
    ("closing", "speed"),
];

#[test]
fn a_part_of_every_case_has_the_verdict_of_the_whole() {
    let setting = Setting {
        effort: Effort::Quick,
        subjects: subjects::load(None).unwrap().into(),
        samples: None,
        matching: None,
    };
    let all: Vec<Case> = cases().collect();
    let (rows, _) = verdicts(&all, Runner::new(setting, None), |_| {});
    let failed = rows.iter().filter(|row| !row.passed);
    let failed: Vec<_> = failed
        .map(|row| (row.id.as_str(), row.invariant.as_str()))
        .collect();
    let is = |one: &(&str, &str), open: &(&str, &str)| one.0 == open.0 && one.1.starts_with(open.1);
    let known = failed.len() == OPEN.len() && failed.iter().zip(&OPEN).all(|(a, b)| is(a, b));
    assert!(known, "{failed:#?}");
}

#[test]
fn cases_are_found_by_their_names() {
    let only = |names: &[&str]| {
        let names: Vec<String> = names.iter().map(|&s| s.to_owned()).collect();
        chosen(&names)
    };
    assert_eq!(only(&[]).unwrap().len(), cases().count());
    assert!(only(&["t1", "T2"]).unwrap().len() >= 2);
    let told = only(&["T99"]).unwrap_err();
    for id in ["contradiction", "T10", "map"] {
        assert_eq!(told.matches(id).count(), 1, "{told}");
    }
}

#[test]
fn a_map_that_is_not_made_is_not_drawn() {
    #[derive(clap::Parser)]
    struct Line {
        #[command(flatten)]
        arguments: StabilityArguments,
    }
    let place = tempfile::tempdir().unwrap();
    let files = |line: &str| {
        let path = place.path().join("m.svg").display().to_string();
        let words = ["b", "--plot", &path].into_iter();
        let line = <Line as clap::Parser>::parse_from(words.chain(line.split_whitespace()));
        let opened = plots(&line.arguments, &chosen(&line.arguments.only).unwrap())?;
        let names = std::fs::read_dir(place.path()).unwrap();
        let mut names: Vec<_> = names.map(|f| f.unwrap().file_name()).collect();
        names.sort_unstable();
        drop(opened);
        Ok::<_, Box<dyn Error>>(names)
    };
    assert!(files("--only T1").is_err(), "nothing to draw");
    assert!(files("--only map").unwrap().contains(&"m.svg".into()));
    let both = files("--backend cpu,gpu").unwrap();
    assert!(both.contains(&"m-cpu.svg".into()) && both.contains(&"m-gpu.svg".into()));
}

#[test]
fn backends_agree_when_every_verdict_is_the_same() {
    let row = |backend: &str, passed| {
        let worst = case::Worst {
            value: if passed { 0.0 } else { f64::INFINITY },
            at: String::new(),
            runs: 1,
            all: Vec::new(),
            limits: None,
        };
        let case = cases().next().unwrap();
        Row {
            backend: backend.to_owned(),
            ..Row::new(&case, Ok(worst), 0.0)
        }
    };
    assert!(disagreements(&[row("cpu", false), row("gpu", false)]).is_empty());
    assert_eq!(
        disagreements(&[row("cpu", true), row("gpu", false)]),
        ["T1"]
    );
}
