//! The program: cuts, checks, fills, draws, shows and simulates meshes, draws the paper's figures, and lists devices.
//!
//! Exit codes: 0 done, 1 the input cannot be used or there is no device, 2 the command line is wrong, 3 the
//! output cannot be written.

#[cfg(feature = "gpu")]
mod apart;
mod check;
mod clock;
mod cut;
mod cut_options;
mod devices;
mod failure;
mod fill;
#[cfg(feature = "gpu")]
mod gallery;
#[cfg(feature = "gpu")]
mod input;
mod json;
mod numbers;
mod pieces;
#[cfg(feature = "gpu")]
mod render;
mod simulate;
mod teller;
#[cfg(feature = "view")]
mod view;

use clap::{CommandFactory, Parser, Subcommand};
use clap_complete::{Shell, generate};
use failure::Failure;
use std::io::{self, BufWriter, Write};
use std::process::ExitCode;
use teller::Teller;

/// Cuts soft bodies: closed triangle surfaces.
#[derive(Parser)]
#[command(version, after_help = AFTER_HELP)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
    /// Print nothing but warnings and errors, and what --json asks for.
    #[arg(short, long, global = true)]
    quiet: bool,
}

const AFTER_HELP: &str = "\
Examples:
  incise check bunny.obj
  incise cut bunny.obj --plane 0,1,0.2,0.05 -o pieces
  incise render pieces/piece_000.obj -o piece.png
  incise simulate bunny.obj --seconds 2 --ground -0.5 --volume --struts 1 -o pieces
  incise view bunny.obj

Exit codes: 0 done, 1 the input cannot be used or there is no device, 2 the command line is wrong, 3 the output cannot \
be written.";

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
    #[cfg(feature = "view")]
    View(view::ViewArguments),
    /// Prints what makes a shell complete commands and options.
    ///
    /// For bash, for example: incise completions bash > ~/.local/share/bash-completion/completions/incise
    Completions {
        /// The shell.
        shell: Shell,
    },
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let out = BufWriter::new(io::stdout().lock());
    let mut teller = Teller::new(out, arguments.quiet);
    let done = match &arguments.command {
        Command::Check(arguments) => check::run(arguments, &mut teller),
        Command::Cut(arguments) => cut::run(arguments, &mut teller),
        Command::Devices(arguments) => devices::run(arguments, &mut teller),
        Command::Fill(arguments) => fill::run(arguments, &mut teller),
        #[cfg(feature = "gpu")]
        Command::Gallery(arguments) => gallery::run(arguments, &mut teller),
        #[cfg(feature = "gpu")]
        Command::Render(arguments) => render::run(arguments, &mut teller),
        Command::Simulate(arguments) => simulate::run(arguments, &mut teller),
        #[cfg(feature = "view")]
        Command::View(arguments) => view::run(arguments),
        Command::Completions { shell } => complete(*shell, teller.output()),
    };
    // What was printed comes before the reason why it ended.
    let flushed = teller.flush().map_err(Failure::Output);
    match done.and(flushed) {
        Ok(()) => ExitCode::SUCCESS,
        // Who reads the output has seen enough.
        Err(Failure::Output(e)) if e.kind() == io::ErrorKind::BrokenPipe => ExitCode::SUCCESS,
        Err(failure) => {
            // Without an error output the exit code has to do.
            let _ = writeln!(io::stderr(), "incise: {failure}");
            ExitCode::from(failure.exit_code())
        }
    }
}

/// Writes a shell's completions.
fn complete(shell: Shell, out: &mut impl Write) -> Result<(), Failure> {
    // Into memory first: its writer panics where nobody reads.
    let mut script = Vec::new();
    generate(shell, &mut Arguments::command(), "incise", &mut script);
    Ok(out.write_all(&script)?)
}
