//! Benches that are run for the page.

use super::ReportArguments;
use crate::Arguments;
use clap::Parser;
use std::error::Error;
use std::io::Write;
use std::path::Path;

/// Runs a bench with its rows written to `file`.
///
/// # Errors
/// What the bench says, also when it ends with claims that do not hold; its rows are written then.
pub(super) fn measure(
    name: &str,
    how: &ReportArguments,
    file: &Path,
    out: &mut impl Write,
) -> Result<(), Box<dyn Error>> {
    writeln!(out, "report: {name}")?;
    let words = ["incise-bench", name];
    let words = words
        .iter()
        .chain(if how.quick { quick(name) } else { &[] });
    let words = words.chain(how.quiet.then_some(&"--quiet"));
    let words = words.map(|&word| word.into());
    let rows = ["--json".into(), file.as_os_str().to_owned()];
    crate::run(Arguments::try_parse_from(words.chain(rows))?, out)
}

/// What makes a bench take seconds instead of minutes.
fn quick(name: &str) -> &'static [&'static str] {
    match name {
        "table" => &[
            "--only",
            "Sphere20,Sphere80,Sphere768,Bunny",
            "--seconds",
            "4",
        ],
        "cut" => &["--planes", "5", "--max-triangles", "4000", "--cuts", "0"],
        "refine" => &["--planes", "3", "--max-triangles", "4000"],
        "step" => &[
            "--backend",
            "cpu",
            "--max-triangles",
            "4000",
            "--frames",
            "60",
        ],
        "accuracy" => &["--only", "chain", "--most", "8", "--most-iterations", "64"],
        _ => &["--quick"],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::page::rows::NAMES;

    #[test]
    fn what_is_run_is_on_the_command_line() {
        for name in NAMES {
            if name == "accuracy" && !cfg!(feature = "reference") {
                continue;
            }
            let words = ["incise-bench", name].into_iter();
            let words = words.chain(quick(name).iter().copied());
            let parsed = Arguments::try_parse_from(words.chain(["--json", "x"]));
            assert!(parsed.is_ok(), "{name}");
        }
    }
}
