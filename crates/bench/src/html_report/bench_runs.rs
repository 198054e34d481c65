//! Runs benches for the report.

use super::ReportArguments;
use crate::program::{self, Arguments};
use clap::Parser;
use std::error::Error;
use std::io::Write;
use std::path::Path;

/// Runs a bench and writes its rows to `file`.
///
/// # Errors
/// The bench's error; a bench whose claims fail has written its rows.
pub(super) fn run_bench(
    name: &str,
    arguments: &ReportArguments,
    file: &Path,
    out: &mut impl Write,
) -> Result<(), Box<dyn Error>> {
    writeln!(out, "report: {name}")?;
    let quick = if arguments.quick { quick(name) } else { "" };
    let words = ["incise-bench", name].into_iter();
    let words = words.chain(quick.split_whitespace());
    let words = words.chain(arguments.quiet.then_some("--quiet"));
    let rows = ["--json".into(), file.as_os_str().to_owned()];
    program::run(
        Arguments::try_parse_from(words.map(Into::into).chain(rows))?,
        out,
    )
}

/// Returns the options of a run of seconds instead of minutes.
fn quick(name: &str) -> &'static str {
    match name {
        "table" => "--only Sphere20,Sphere80,Sphere768,Bunny --seconds 4",
        "cut" => "--planes 5 --max-triangles 4000 --cuts 0",
        "refine" => "--planes 3 --max-triangles 4000",
        "step" => "--backend cpu --max-triangles 4000 --frames 60",
        "accuracy" => "--only chain --most 8 --most-iterations 64",
        "stability" => "--only T3,T8,T12,T20,bars,block,drape,knot,plate",
        _ => "--quick",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::html_report::sources::NAMES;

    #[test]
    fn quick_options_exist() {
        for name in NAMES {
            if name == "accuracy" && !cfg!(feature = "reference") {
                continue;
            }
            let words = ["incise-bench", name].into_iter();
            let words = words.chain(quick(name).split_whitespace());
            let parsed = Arguments::try_parse_from(words.chain(["--json", "x"]));
            assert!(parsed.is_ok(), "{name}");
        }
    }
}
