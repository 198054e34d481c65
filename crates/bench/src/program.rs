//! The command line of `incise-bench`.

#[cfg(test)]
mod tests;

#[cfg(feature = "reference")]
use crate::accuracy;
use crate::options::OutputArguments;
use crate::printout::Printout;
use crate::{cut, html_report, refine, skip, solver, stability, step, table};
use clap::{CommandFactory, Parser, Subcommand};
use clap_complete::{Shell, generate};
use std::error::Error;
use std::io::{self, Write};
use std::process::ExitCode;

/// Benchmarks of incise. Without a subcommand it prints the table.
#[derive(Parser)]
#[command(version, args_conflicts_with_subcommands = true)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    table: table::TableArguments,
}

#[derive(Subcommand)]
enum Command {
    /// The paper's Table 1: frame rates with and without cutting, and the time of a cut.
    Table(table::TableArguments),
    /// Projections per second of the solver alone, on one thread and on all.
    Solver(solver::SolverArguments),
    /// Time of a frame on every backend, up to a million triangles.
    Step(step::StepArguments),
    /// Time of a cut, stage by stage, up to a million triangles.
    Cut(cut::CutArguments),
    /// Time and quality of section meshes (caps).
    Refine(refine::RefineArguments),
    /// Time of a frame against error, scene by scene (work-precision Pareto fronts).
    #[cfg(feature = "reference")]
    Accuracy(accuracy::AccuracyArguments),
    /// Stress tests: an invariant per case, with the worst value found.
    Stability(stability::StabilityArguments),
    /// Cost of features that a scene does not use: each claim with its bound.
    Skip(skip::SkipArguments),
    /// All results on one HTML page.
    Report(html_report::ReportArguments),
    /// Prints shell completions.
    Completions {
        /// The shell.
        shell: Shell,
    },
}

impl Arguments {
    /// Returns whether the run writes files besides printing.
    fn writes_files(&self) -> bool {
        let has_rows = self.output().is_some_and(|rows| rows.json.is_some());
        has_rows
            || match &self.command {
                #[cfg(feature = "reference")]
                Some(Command::Accuracy(accuracy)) => accuracy.writes_more(),
                Some(Command::Report(_)) => true,
                _ => false,
            }
    }

    /// Returns whether nothing but errors is printed.
    fn is_quiet(&self) -> bool {
        match &self.command {
            Some(Command::Report(report)) => report.quiet,
            _ => self.output().is_some_and(|rows| rows.quiet),
        }
    }

    /// Returns the output options of a bench.
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

/// Runs the command.
pub(crate) fn run(arguments: Arguments, out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    match arguments.command {
        Some(Command::Solver(solver)) => solver::run(&solver, out),
        Some(Command::Step(step)) => step::run(&step, out),
        Some(Command::Cut(cut)) => cut::run(&cut, out),
        Some(Command::Refine(refine)) => refine::run(&refine, out),
        #[cfg(feature = "reference")]
        Some(Command::Accuracy(accuracy)) => accuracy::run(&accuracy, out),
        Some(Command::Stability(stability)) => stability::run(&stability, out),
        Some(Command::Skip(skip)) => skip::run(&skip, out),
        Some(Command::Report(report)) => html_report::run(&report, out),
        Some(Command::Completions { shell }) => {
            // Into memory first: its writer panics on a closed pipe.
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

/// Runs the program `incise-bench` with the arguments of the process.
#[must_use]
pub fn program() -> ExitCode {
    let arguments = Arguments::parse();
    let goes_on = arguments.writes_files();
    // Inside the thread pool: its queue of work from outside allocates now and then, and the table
    // counts allocations.
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
                // Without an error output the exit code tells.
                let _ = writeln!(io::stderr(), "incise-bench: {error}");
                ExitCode::FAILURE
            }
        }
    })
}
