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
#[cfg(feature = "view")]
mod view;

use clap::{Parser, Subcommand};
use failure::Failure;
use std::io::{self, BufWriter, Write};
use std::process::ExitCode;

/// Cuts soft bodies: closed triangle surfaces.
#[derive(Parser)]
#[command(
    version,
    after_help = "Exit codes: 0 done, 1 the input cannot be used or there is no device, 2 the command line is wrong, \
                  3 the output cannot be written."
)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

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
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let mut out = BufWriter::new(io::stdout().lock());
    let done = match &arguments.command {
        Command::Check(arguments) => check::run(arguments, &mut out),
        Command::Cut(arguments) => cut::run(arguments, &mut out),
        Command::Devices(arguments) => devices::run(arguments, &mut out),
        Command::Fill(arguments) => fill::run(arguments, &mut out),
        #[cfg(feature = "gpu")]
        Command::Gallery(arguments) => gallery::run(arguments, &mut out),
        #[cfg(feature = "gpu")]
        Command::Render(arguments) => render::run(arguments, &mut out),
        Command::Simulate(arguments) => simulate::run(arguments, &mut out),
        #[cfg(feature = "view")]
        Command::View(arguments) => view::run(arguments),
    };
    // What was printed comes before the reason why it ended.
    let flushed = out.flush().map_err(Failure::Output);
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
