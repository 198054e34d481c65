//! The command line.

use super::*;

fn parse(line: &str) -> Result<Arguments, clap::Error> {
    Arguments::try_parse_from(line.split_whitespace())
}

#[test]
fn the_command_line_is_consistent() {
    Arguments::command().debug_assert();
}

#[test]
fn options_of_every_bench_are_parsed() {
    for line in [
        "b step --backend cpu,gpu --adapter llvm --schedule auto,whole-body,colors --iterations 5",
        "b step --substeps 20 --max-triangles 1000 --seconds-per-row 1/2 --bodies 8 --json x",
        "b step --frames 100 --backend cpu --backend gpu",
        "b cut --method paper --planes 0 --max-triangles 100 --only bunny --cuts 0 --level 0.7",
        "b cut --progressive --only torus30000,armadillo --level 0.7 --json x",
        "b cut --progressive --steps 100000",
        "b refine --planes 0 --levels original,0.7 --json x",
        "b skip --backend cpu,gpu --adapter llvm --json x",
        "b skip --quick --only sleep,early-out",
        "b report -o x --take a.json b.json --gallery g",
        "b report -o x --run table,skip --quick",
    ] {
        assert!(parse(line).is_ok(), "{line}");
    }
    for line in [
        "b step --backend tpu",
        "b step --schedule rows",
        "b step --iterations 0",
        "b step --frames 10 --seconds-per-row 1",
        "b step --seconds-per-row -1",
        "b cut --method fast",
        "b cut --planes -1",
        "b cut --steps 10",
        "b cut --progressive --method paper",
        "b skip --only slumber",
        "b skip --backend auto",
        "b report",
        "b report -o x --run solver",
    ] {
        assert!(parse(line).is_err(), "{line}");
    }
}

#[cfg(feature = "reference")]
#[test]
fn accuracy_knows_its_scenes() {
    assert!(parse("b accuracy --only chain,cut --backend cpu,gpu --most 8 --plot y").is_ok());
    assert!(parse("b accuracy --cuts --json x").is_ok());
    assert!(parse("b accuracy --after-cut --json x --plot y").is_ok());
    for bad in [
        "b accuracy --cuts --only chain",
        "b accuracy --after-cut --cuts",
        "b accuracy --after-cut --only chain",
        "b accuracy --cuts --backend cpu",
        "b accuracy --only chains",
        "b accuracy --most 65",
        "b accuracy --backend auto",
    ] {
        assert!(parse(bad).is_err(), "{bad}");
    }
}

#[test]
fn a_table_has_the_paper_s_bodies_by_default() {
    let has = |line: &str| {
        let parsed = parse(line).unwrap();
        let table = match parsed.command {
            Some(Command::Table(table)) => table,
            _ => parsed.table,
        };
        [table.volume, table.interior_springs, table.contacts]
    };
    assert_eq!(has("b"), [false; 3]);
    assert_eq!(has("b table --json x"), [false; 3]);
    assert_eq!(has("b --volume"), [true, false, false]);
}

#[test]
fn runs_with_files_do_not_end_with_their_reader() {
    let writes = |line: &str| parse(line).unwrap().writes_files();
    for line in [
        "b",
        "b step",
        "b solver",
        "b refine",
        "b stability",
        "b skip",
    ] {
        assert!(!writes(line), "{line}");
        assert!(writes(&format!("{line} --json x")), "{line}");
    }
    assert!(writes("b report -o x"));
}

#[test]
fn every_bench_can_be_quiet() {
    let benches = [
        "",
        "table",
        "solver",
        "step",
        "cut",
        "refine",
        "stability",
        "skip",
    ];
    for bench in benches.into_iter().chain(["report -o x"]) {
        for (more, expected) in [("", false), ("-q", true), ("--quiet", true)] {
            let line = format!("b {bench} {more}");
            assert_eq!(parse(&line).unwrap().is_quiet(), expected, "{line}");
        }
    }
}

#[test]
fn shells_complete_every_bench() {
    let mut out = Vec::new();
    run(parse("b completions bash").unwrap(), &mut out).unwrap();
    let script = String::from_utf8(out).unwrap();
    for word in ["incise-bench", "stability", "max-triangles"] {
        assert!(script.contains(word), "{word}");
    }
}
