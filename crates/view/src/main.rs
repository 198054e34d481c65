//! The program `incise-view`: a window to cut and drag a soft body.
//!
//! Exit codes: 0 the window was closed, 1 unusable input or no window, 2 wrong command line.

use clap::Parser;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use incise_cli::{Backend, InputOptions, Size, output_path, read_surface, size, write_pieces};
use incise_cut::Caps;
use incise_scene::BackendRequest;
use incise_view::{Recording, RecordingError, WindowOptions};
use std::error::Error;
use std::fs::File;
use std::io::{self, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Opens a window to cut and drag a soft body. Press ? there for the keys.
///
/// A line may end inside the body, and a held blade cuts as it moves.
#[derive(Parser)]
#[command(version)]
struct Arguments {
    /// A mesh, closed or a sheet (obj, ply, stl, glb or gltf; units are meters), or a built-in
    /// model: Sphere20, Sphere80, Sphere768, Bunny, Octopus, Banana or Armadillo. A file of the
    /// same name takes precedence.
    #[arg(value_name = "FILE|MODEL", default_value = "Sphere768")]
    input: PathBuf,
    #[command(flatten)]
    reading: InputOptions,
    /// Backend that steps the body.
    #[arg(long, value_enum, default_value_t = Backend::Auto)]
    backend: Backend,
    /// GPU that steps and draws: a part of its name, as listed by `incise devices`.
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
    /// Size of the window [pixels].
    #[arg(long, value_name = "WxH", default_value = "1280x800", value_parser = size)]
    size: Size,
    /// Curves along which caps close cuts.
    #[arg(
        long,
        value_name = "CURVES",
        default_value = Caps::default().name(),
        value_parser = caps(),
        conflicts_with = "replay"
    )]
    caps: Caps,
    /// Start paused; Space resumes.
    #[arg(long)]
    paused: bool,
    /// Folder for saved pieces.
    #[arg(
        short,
        long,
        value_name = "DIR",
        default_value = "pieces",
        value_parser = output_path()
    )]
    output: PathBuf,
    /// File for the saved recording.
    #[arg(
        long,
        value_name = "FILE",
        default_value = "recording.jsonl",
        value_parser = output_path()
    )]
    record: PathBuf,
    /// Replay a recording of the same body.
    #[arg(long, value_name = "FILE")]
    replay: Option<PathBuf>,
}

/// Parses the curves along which caps close cuts.
fn caps() -> impl TypedValueParser<Value = Caps> {
    let names = PossibleValuesParser::new(Caps::NAMES.iter().copied());
    names.map(|name| Caps::from_name(&name).unwrap_or_default())
}

/// The recording cannot be read.
#[derive(Debug, thiserror::Error)]
#[error("{}: {source}", path.display())]
struct UnreadableRecording {
    path: PathBuf,
    source: RecordingError,
}

fn main() -> ExitCode {
    match run(Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            print_message(error);
            ExitCode::FAILURE
        }
    }
}

/// Shows the window until it is closed.
fn run(arguments: Arguments) -> Result<(), Box<dyn Error>> {
    let input = arguments.input;
    let (mut body, warnings) = read_surface(&input, arguments.reading)?;
    body.sort_by_position();
    for warning in &warnings {
        print_message(format_args!("{}: {warning}", input.display()));
    }
    let replay = arguments.replay.as_deref().map(recording).transpose()?;
    let Size(pixels) = arguments.size;
    let folder = arguments.output;
    let options = WindowOptions {
        title: format!("incise: {}", input.display()),
        surface: body,
        backend: BackendRequest {
            choice: arguments.backend.choice(),
            adapter: arguments.adapter,
            allow_software: true,
            ..BackendRequest::default()
        },
        size: pixels,
        paused: arguments.paused,
        caps: arguments.caps,
        replay,
        record_to: arguments.record,
        save: Box::new(move |surface| {
            let count = write_pieces(surface, &input, &folder)?;
            let noun = if count == 1 { "piece" } else { "pieces" };
            Ok(format!("{}: {count} {noun}", folder.display()))
        }),
    };
    Ok(incise_view::run(options)?)
}

fn recording(path: &Path) -> Result<Recording, UnreadableRecording> {
    let failed = |source| UnreadableRecording {
        path: path.to_owned(),
        source,
    };
    let file = File::open(path).map_err(|error| failed(RecordingError::Read(error)))?;
    Recording::read(BufReader::new(file)).map_err(failed)
}

/// Prints a warning or an error to the standard error.
fn print_message(message: impl std::fmt::Display) {
    // A closed standard error leaves the exit code.
    let _ = writeln!(io::stderr(), "incise-view: {message}");
}
