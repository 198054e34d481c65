//! The command line of `incise-bench`.

#[cfg(feature = "reference")]
use crate::accuracy;
use crate::output::is_closed_pipe;
use crate::{cut, refine, skip, solver, stability, step, strokes, table};
use clap::{CommandFactory, Parser, Subcommand};
use clap_complete::{Shell, generate};
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
    /// Projections per second of the solver alone, on one thread and on all.
    Solver(solver::SolverArguments),
    /// Time of a frame on every backend, up to a million triangles.
    Step(step::StepArguments),
    /// Time of a cut, stage by stage, up to a million triangles.
    Cut(cut::CutArguments),
    /// Strokes of blades that cut step by step: refusals, pieces and quality by kind of stroke.
    Strokes(strokes::StrokesArguments),
    /// Time and quality of section meshes (caps).
    Refine(refine::RefineArguments),
    /// Time of a frame against error, scene by scene (work-precision Pareto fronts).
    #[cfg(feature = "reference")]
    Accuracy(accuracy::AccuracyArguments),
    /// Stress tests: an invariant per case, with the worst value found.
    Stability(stability::StabilityArguments),
    /// Cost of features that a scene does not use: each claim with its bound.
    Skip(skip::SkipArguments),
    /// Prints shell completions.
    Completions {
        /// The shell.
        shell: Shell,
    },
}

/// Runs the command.
fn run(arguments: Arguments, out: &mut dyn Write) -> Result<(), Box<dyn Error>> {
    match arguments.command {
        Some(Command::Solver(solver)) => solver::run(&solver, out),
        Some(Command::Step(step)) => step::run(&step, out),
        Some(Command::Cut(cut)) => cut::run(&cut, out),
        Some(Command::Strokes(strokes)) => strokes::run(&strokes, out),
        Some(Command::Refine(refine)) => refine::run(&refine, out),
        #[cfg(feature = "reference")]
        Some(Command::Accuracy(accuracy)) => accuracy::run(&accuracy, out),
        Some(Command::Stability(stability)) => stability::run(&stability, out),
        Some(Command::Skip(skip)) => skip::run(&skip, out),
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
    // Inside the thread pool: its queue of work from outside allocates now and then, and the table
    // counts allocations.
    rayon::scope(|_| match run(arguments, &mut io::stdout().lock()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) if is_closed_pipe(error.as_ref()) => ExitCode::SUCCESS,
        Err(error) => {
            // Without an error output the exit code tells.
            let _ = writeln!(io::stderr(), "incise-bench: {error}");
            ExitCode::FAILURE
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
}
