//! The benchmark: the paper's seven-model table, the solver's own speed, and what a cut costs.

#[cfg(feature = "reference")]
mod accuracy;
mod allocations;
mod backend;
mod columns;
mod cut;
mod directions;
mod front;
mod json;
mod machine;
mod method;
mod models;
mod motion;
mod options;
mod output;
mod pace;
mod page;
mod picture;
mod printout;
mod refine;
mod skip;
mod solver;
mod stability;
mod statistics;
mod step;
mod subdivide;
mod subject;
mod table;

use clap::{CommandFactory, Parser, Subcommand};
use clap_complete::{Shell, generate};
use options::OutputArguments;
use printout::Printout;
use std::error::Error;
use std::io::{self, Write};
use std::process::ExitCode;

/// Benchmarks of incise. Without a subcommand it prints the table.
#[derive(Parser)]
#[command(version, args_conflicts_with_subcommands = true)]
struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    table: table::TableArguments,
}

#[derive(Subcommand)]
enum Command {
    /// The paper's Table 1: frame rates with and without cutting, and the time of a cut.
    Table(table::TableArguments),
    /// Projections a second of the solver alone, on one thread and on all.
    Solver(solver::SolverArguments),
    /// Time of a frame of every model, and of spheres of up to a million triangles, on every backend.
    Step(step::StepArguments),
    /// Times of a cut, step by step, of every model, finer armadillos and spheres of up to a million triangles.
    Cut(cut::CutArguments),
    /// Time and quality of caps: what cuts of every model leave to be covered, covered again and again.
    Refine(refine::RefineArguments),
    /// Work and precision: what a frame costs for a given error, scene by scene.
    #[cfg(feature = "reference")]
    Accuracy(accuracy::AccuracyArguments),
    /// Torture: each case passes or fails by a stated law, with the worst number found.
    Stability(stability::StabilityArguments),
    /// What a scene does not need, and what that costs: each claim with its bound.
    Skip(skip::SkipArguments),
    /// One page of all results, for a browser and for paper.
    Report(page::ReportArguments),
    /// Prints what makes a shell complete the options of this program.
    Completions {
        /// The shell.
        shell: Shell,
    },
}

impl Arguments {
    /// Whether the run is for files as well as for a reader.
    fn writes_files(&self) -> bool {
        let has_rows = self.output().is_some_and(|rows| rows.json.is_some());
        has_rows
            || match &self.command {
                Some(Command::Refine(refine)) => refine.writes_more(),
                #[cfg(feature = "reference")]
                Some(Command::Accuracy(accuracy)) => accuracy.writes_more(),
                Some(Command::Stability(stability)) => stability.writes_more(),
                Some(Command::Report(_)) => true,
                _ => false,
            }
    }

    /// Whether nothing but errors is printed.
    fn is_quiet(&self) -> bool {
        match &self.command {
            Some(Command::Report(report)) => report.quiet,
            _ => self.output().is_some_and(|rows| rows.quiet),
        }
    }

    /// Where a bench's rows go.
    fn output(&self) -> Option<&OutputArguments> {
        match &self.command {
            None => Some(&self.table.rows),
            Some(Command::Table(table)) => Some(&table.rows),
            Some(Command::Solver(solver)) => Some(&solver.rows),
            Some(Command::Step(step)) => Some(&step.rows),
            Some(Command::Cut(cut)) => Some(&cut.rows),
            Some(Command::Refine(refine)) => Some(&refine.rows),
            #[cfg(feature = "reference")]
            Some(Command::Accuracy(accuracy)) => Some(&accuracy.run.rows),
            Some(Command::Stability(stability)) => Some(&stability.run.rows),
            Some(Command::Skip(skip)) => Some(&skip.run.rows),
            Some(Command::Report(_) | Command::Completions { .. }) => None,
        }
    }
}

/// Does what the command line says.
fn run(arguments: Arguments, out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    match arguments.command {
        Some(Command::Solver(solver)) => solver::run(&solver, out),
        Some(Command::Step(step)) => step::run(&step, out),
        Some(Command::Cut(cut)) => cut::run(&cut, out),
        Some(Command::Refine(refine)) => refine::run(&refine, out),
        #[cfg(feature = "reference")]
        Some(Command::Accuracy(accuracy)) => accuracy::run(&accuracy, out),
        Some(Command::Stability(stability)) => stability::run(&stability, out),
        Some(Command::Skip(skip)) => skip::run(&skip, out),
        Some(Command::Report(report)) => page::run(&report, out),
        Some(Command::Completions { shell }) => {
            // Into memory first: its writer panics where nobody reads.
            let mut script = Vec::new();
            generate(
                shell,
                &mut Arguments::command(),
                "incise-bench",
                &mut script,
            );
            Ok(out.write_all(&script)?)
        }
        Some(Command::Table(table)) => table::run(&table, out),
        None => table::run(&arguments.table, out),
    }
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let goes_on = arguments.writes_files();
    // Inside the pool: work that comes from outside is queued in memory that grows now and then,
    // and frames are shown to allocate nothing.
    rayon::scope(|_| {
        let to: Box<dyn Write> = if arguments.is_quiet() {
            Box::new(io::sink())
        } else {
            Box::new(io::stdout().lock())
        };
        let mut out = Printout::new(to, goes_on);
        let done = run(arguments, &mut out);
        match done {
            Ok(()) => ExitCode::SUCCESS,
            Err(_) if out.was_left() => ExitCode::SUCCESS,
            Err(error) => {
                // Without an error output the exit code has to do.
                let _ = writeln!(io::stderr(), "incise-bench: {error}");
                ExitCode::FAILURE
            }
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn a_table_has_what_the_paper_has_not_only_if_asked() {
        let has = |line: &str| {
            let parsed = Arguments::try_parse_from(line.split_whitespace()).unwrap();
            let table = match parsed.command {
                Some(Command::Table(table)) => table,
                _ => parsed.table,
            };
            [table.volume, table.struts, table.contacts]
        };
        assert_eq!(has("b"), [false; 3]);
        assert_eq!(has("b table --json x"), [false; 3]);
        assert_eq!(has("b --volume"), [true, false, false]);
        assert_eq!(has("b table --volume --struts --contacts"), [true; 3]);
    }

    #[test]
    fn the_options_of_step_are_lists_or_numbers() {
        let parse = |line: &str| Arguments::try_parse_from(line.split_whitespace());
        let all = "b step --backend cpu,gpu --adapter llvm --schedule auto,whole-body,colors --iterations 5 \
            --substeps 20 --max-triangles 1000 --seconds-per-row 1/2 --bodies 8 --only bunny --json x";
        assert!(parse(all).is_ok());
        assert!(parse("b step --frames 100 --backend cpu --backend gpu").is_ok());
        for bad in [
            "b step --backend tpu",
            "b step --schedule rows",
            "b step --iterations 0",
            "b step --bodies 0",
            "b step --frames 10 --seconds-per-row 1",
            "b step --seconds-per-row -1",
        ] {
            assert!(parse(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn the_options_of_cut_have_defaults() {
        let parse = |line: &str| Arguments::try_parse_from(line.split_whitespace());
        let all = "b cut --method rebuild --planes 0 --max-triangles 100 --only bunny --cuts 0 --level 0.7 --seed 3 --json x";
        assert!(parse("b cut").is_ok());
        assert!(parse(all).is_ok());
        assert!(
            parse("b cut --method fast").is_err(),
            "there are two methods"
        );
        assert!(parse("b cut --planes -1").is_err(), "planes are counted");
    }

    #[test]
    fn a_plot_of_refine_needs_its_tradeoff() {
        let parse = |line: &str| Arguments::try_parse_from(line.split_whitespace());
        assert!(parse("b refine --planes 0 --levels original,0.7 --json x").is_ok());
        assert!(parse("b refine --tradeoff --plot x.svg --only bunny").is_ok());
        assert!(parse("b refine --tradeoff --csv x.csv").is_ok());
        for file in ["--plot x.svg", "--csv x.csv"] {
            assert!(
                parse(&format!("b refine {file}")).is_err(),
                "nothing for {file}"
            );
        }
    }

    #[test]
    fn refine_writes_rims_or_compares_what_others_made_of_them() {
        let parse = |line: &str| Arguments::try_parse_from(line.split_whitespace());
        assert!(parse("b refine --rims x --planes 3 --only bunny").is_ok());
        assert!(parse("b refine --peers a.json b.json --json x").is_ok());
        for bad in [
            "b refine --rims x --peers a.json",
            "b refine --tradeoff --rims x",
            "b refine --tradeoff --peers a.json",
            "b refine --peers",
        ] {
            assert!(parse(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn skip_runs_on_what_is_named() {
        let parse = |line: &str| Arguments::try_parse_from(line.split_whitespace());
        assert!(parse("b skip --backend cpu,gpu --adapter llvm --json x").is_ok());
        assert!(parse("b skip --quick --only sleep,early-out").is_ok());
        assert!(parse("b skip --only slumber").is_err(), "no such claim");
        assert!(parse("b skip --backend auto").is_err(), "nothing chooses");
    }

    #[cfg(feature = "reference")]
    #[test]
    fn accuracy_knows_its_scenes() {
        let parse = |line: &str| Arguments::try_parse_from(line.split_whitespace());
        let all = "b accuracy --only chain,cut --backend cpu,gpu --most 8 --most-iterations 64 --json x --plot y";
        assert!(parse(all).is_ok());
        assert!(parse("b accuracy --cuts --json x").is_ok());
        for bad in [
            "b accuracy --cuts --only chain",
            "b accuracy --cuts --backend cpu",
            "b accuracy --schemes --json x",
            "b accuracy --schemes --adapter x",
            "b accuracy --only chains",
            "b accuracy --most 65",
            "b accuracy --backend auto",
        ] {
            assert!(parse(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn runs_for_files_are_told_from_those_for_a_reader() {
        let writes = |line: &str| {
            let parsed = Arguments::try_parse_from(line.split_whitespace());
            parsed.unwrap().writes_files()
        };
        for line in [
            "b",
            "b step",
            "b solver",
            "b refine",
            "b stability",
            "b skip",
        ] {
            assert!(!writes(line), "{line}");
        }
        for line in [
            "b --json x",
            "b table --json x",
            "b step --json x",
            "b cut --json x",
            "b refine --rims x",
            "b refine --tradeoff --csv x",
            "b stability --plot x",
            "b skip --json x",
            "b report -o x",
        ] {
            assert!(writes(line), "{line}");
        }
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
            "report -o x",
        ];
        let reference = cfg!(feature = "reference").then_some("accuracy");
        for bench in benches.into_iter().chain(reference) {
            for (more, expected) in [("", false), ("-q", true), ("--quiet", true)] {
                let line = format!("b {bench} {more}");
                let parsed = Arguments::try_parse_from(line.split_whitespace());
                assert_eq!(parsed.unwrap().is_quiet(), expected, "{line}");
            }
        }
    }

    #[test]
    fn shells_complete_every_bench() {
        let mut out = Vec::new();
        let line = Arguments::try_parse_from(["b", "completions", "bash"]).unwrap();
        run(line, &mut out).unwrap();
        let script = String::from_utf8(out).unwrap();
        for word in ["incise-bench", "stability", "max-triangles"] {
            assert!(script.contains(word), "{word}");
        }
    }

    #[test]
    fn a_report_knows_its_benches() {
        let parse = |line: &str| Arguments::try_parse_from(line.split_whitespace());
        assert!(parse("b report -o x --take a.json b.json --gallery g").is_ok());
        assert!(parse("b report -o x --run table,skip --quick").is_ok());
        assert!(parse("b report").is_err(), "nowhere to go");
        assert!(parse("b report -o x --run solver").is_err(), "no rows");
    }
}
