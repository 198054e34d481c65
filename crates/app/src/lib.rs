//! The program `incise`: its subcommands check, cut, fill, simulate and render meshes.
//!
//! [`program`] is its command line. Exit codes: 0 done, 1 unusable input or no GPU, 2 wrong command
//! line, 3 unwritable output, 4 the cut misses the mesh.
//!
//! The program `incise-view` shares its options: [`InputOptions`], [`Backend`], [`Size`].

mod blade_path;
mod check;
mod clock;
mod cut;
mod cut_method;
mod cut_options;
mod devices;
#[cfg(feature = "gpu")]
mod explode;
mod failure;
mod fill;
mod format;
#[cfg(feature = "gpu")]
mod gallery;
mod input;
mod json;
mod numbers;
mod param_options;
#[cfg(feature = "gpu")]
mod picture;
mod pieces;
#[cfg(feature = "gpu")]
mod render;
mod reporter;
mod simulate;
mod stroke;

use clap::{CommandFactory, Parser, Subcommand};
use clap_complete::{Shell, generate};
use failure::{Failure, WRONG_COMMAND_LINE};
use incise_mesh::{Surface, Warning};
use json::ErrorReport;
use reporter::{OutputOptions, Reporter};
use std::error::Error;
use std::io::{self, BufWriter, Write};
use std::path::Path;
use std::process::ExitCode;

pub use input::InputOptions;
#[cfg(feature = "gpu")]
pub use picture::{Size, size};
pub use pieces::output_path;
pub use simulate::Backend;

/// Cuts triangle meshes, closed or open, and checks, fills, simulates and draws them.
#[derive(Parser)]
#[command(version, after_help = AFTER_HELP)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
    /// Print nothing but warnings, errors and the JSON report.
    #[arg(short, long, global = true)]
    quiet: bool,
    /// Print the report as JSON, and an error as JSON on the standard error; no progress.
    #[arg(long, global = true)]
    json: bool,
}

const AFTER_HELP: &str = "\
Examples:
  incise check bunny.obj
  incise cut bunny.obj --plane 0,1,0.2,0.05 -o pieces
  incise render pieces/piece_000.obj -o piece.png
  incise simulate bunny.obj --seconds 2 --ground -0.5 -o pieces

Exit codes:
  0  done
  1  the input cannot be used, or there is no GPU
  2  the command line is wrong
  3  the output cannot be written
  4  the cut misses the mesh; the uncut mesh is written or drawn";

#[derive(Subcommand)]
enum Command {
    Check(check::CheckArguments),
    Cut(cut::CutArguments),
    Devices(devices::DevicesArguments),
    Fill(fill::FillArguments),
    #[cfg(feature = "gpu")]
    Gallery(gallery::GalleryArguments),
    #[cfg(feature = "gpu")]
    Render(render::RenderArguments),
    Simulate(simulate::SimulateArguments),
    /// Prints a completion script for a shell.
    ///
    /// For bash: incise completions bash > ~/.local/share/bash-completion/completions/incise
    Completions {
        /// The shell.
        shell: Shell,
    },
}

/// Runs the program `incise` with the arguments of the process.
#[must_use]
pub fn program() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => return refuse_command_line(&error),
    };
    let options = OutputOptions {
        is_quiet: arguments.quiet,
        is_json: arguments.json,
    };
    let mut reporter = Reporter::new(BufWriter::new(io::stdout().lock()), options);
    let done = run(&arguments.command, &mut reporter);
    // The report comes before the error that ended the command.
    let flushed = reporter.flush().map_err(Failure::Output);
    match done.and(flushed) {
        Ok(()) => ExitCode::SUCCESS,
        // The reader of a pipe has closed it.
        Err(Failure::Output(e)) if e.kind() == io::ErrorKind::BrokenPipe => ExitCode::SUCCESS,
        Err(failure) => {
            let error = failure.to_string();
            if options.is_json {
                ErrorReport::new(&error, failure.exit_code(), reporter.warnings()).print();
            } else {
                reporter::print_message(error);
            }
            ExitCode::from(failure.exit_code())
        }
    }
}

/// Reads a mesh that may have holes, or builds the model of that name.
///
/// Returns the warnings of its repair, too.
///
/// # Errors
/// An error that names the file, its defects and the next step.
pub fn read_surface(
    input: &Path,
    options: InputOptions,
) -> Result<(Surface, Vec<Warning>), Box<dyn Error>> {
    Ok(options.read_open(input)?)
}

/// Writes every piece of a surface as an OBJ file in a folder and returns the number of pieces.
///
/// Surplus pieces of an earlier run are removed. `input` is the file that must not be overwritten.
///
/// # Errors
/// An error that names the path that cannot be written.
pub fn write_pieces(
    surface: &Surface,
    input: &Path,
    folder: &Path,
) -> Result<usize, Box<dyn Error>> {
    let written = pieces::write(&[(surface, input)], folder, format::Format::Obj)?;
    Ok(written.pieces.len())
}

fn run(command: &Command, reporter: &mut Reporter<impl Write>) -> Result<(), Failure> {
    match command {
        Command::Check(arguments) => check::run(arguments, reporter),
        Command::Cut(arguments) => cut::run(arguments, reporter),
        Command::Devices(arguments) => devices::run(arguments, reporter),
        Command::Fill(arguments) => fill::run(arguments, reporter),
        #[cfg(feature = "gpu")]
        Command::Gallery(arguments) => gallery::run(arguments, reporter),
        #[cfg(feature = "gpu")]
        Command::Render(arguments) => render::run(arguments, reporter),
        Command::Simulate(arguments) => simulate::run(arguments, reporter),
        Command::Completions { shell } => complete(*shell, reporter.output()),
    }
}

/// Prints help, the version or the error of a command line, and returns the exit code.
fn refuse_command_line(error: &clap::Error) -> ExitCode {
    let is_json = std::env::args_os().any(|argument| argument == "--json");
    if is_json && error.use_stderr() {
        let text = error.to_string();
        let text = text.strip_prefix("error: ").unwrap_or(&text);
        let (text, _) = text
            .split_once("\n\nFor more information")
            .unwrap_or((text, ""));
        ErrorReport::new(text, WRONG_COMMAND_LINE, Vec::new()).print();
        return ExitCode::from(WRONG_COMMAND_LINE);
    }
    error.exit()
}

/// Writes the completion script of a shell.
fn complete(shell: Shell, out: &mut impl Write) -> Result<(), Failure> {
    // Into memory first: the generator panics on a closed pipe.
    let mut script = Vec::new();
    generate(shell, &mut Arguments::command(), "incise", &mut script);
    Ok(out.write_all(&script)?)
}
