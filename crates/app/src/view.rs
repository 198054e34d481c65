//! `incise view`: opens a window to cut and drag a soft body.

use crate::caps::CapsOption;
use crate::failure::Failure;
use crate::format::Format;
use crate::input::InputOptions;
use crate::numbers::counted;
use crate::picture::{Size, size};
use crate::pieces;
use crate::reporter::Reporter;
use crate::simulate::Backend;
use incise_scene::BackendRequest;
use incise_view::{Recording, RecordingError, WindowOptions};
use std::fs::File;
use std::io::{BufReader, Write};
use std::path::{Path, PathBuf};

/// Opens a window to cut and drag a soft body. Press ? there for the keys.
///
/// A line may end inside the body, and a held blade cuts as it moves. The paper's method cuts right
/// through the body only.
#[derive(clap::Args)]
pub(crate) struct ViewArguments {
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
    /// Curves along which caps close cuts (exact method).
    #[arg(
        long,
        value_enum,
        value_name = "CURVES",
        default_value_t = CapsOption::Bodies,
        conflicts_with = "replay"
    )]
    caps: CapsOption,
    /// Start paused; Space resumes.
    #[arg(long)]
    paused: bool,
    /// Folder for saved pieces.
    #[arg(
        short,
        long,
        value_name = "DIR",
        default_value = "pieces",
        value_parser = pieces::output_path()
    )]
    output: PathBuf,
    /// File for the saved recording.
    #[arg(
        long,
        value_name = "FILE",
        default_value = "recording.jsonl",
        value_parser = pieces::output_path()
    )]
    record: PathBuf,
    /// Replay a recording of the same body.
    #[arg(long, value_name = "FILE")]
    replay: Option<PathBuf>,
}

/// Runs the command until the window is closed.
pub(crate) fn run(
    arguments: &ViewArguments,
    reporter: &Reporter<impl Write>,
) -> Result<(), Failure> {
    let input = arguments.input.clone();
    let (mut body, warnings) = arguments.reading.read_open(&input)?;
    body.sort_by_position();
    for warning in &warnings {
        reporter.warn(format_args!("{}: {warning}", input.display()));
    }
    let replay = arguments.replay.as_deref().map(recording).transpose()?;
    let output = arguments.output.clone();
    let Size(pixels) = arguments.size;
    let options = WindowOptions {
        title: format!("incise: {}", input.display()),
        surface: body,
        backend: BackendRequest {
            choice: arguments.backend.choice(),
            adapter: arguments.adapter.clone(),
            allow_software: true,
            ..BackendRequest::default()
        },
        size: pixels,
        paused: arguments.paused,
        caps: arguments.caps.caps(),
        replay,
        record_to: arguments.record.clone(),
        save: Box::new(move |surface| {
            let written = pieces::write(&[(surface, &input)], &output, Format::Obj);
            let written = written?;
            let (count, folder) = (written.pieces.len(), output.display());
            Ok(format!("{folder}: {}", counted(count, "piece")))
        }),
    };
    Ok(incise_view::run(options)?)
}

fn recording(path: &Path) -> Result<Recording, Failure> {
    let failed = |source| Failure::Recording {
        path: path.to_owned(),
        source,
    };
    let file = File::open(path).map_err(|error| failed(RecordingError::Read(error)))?;
    Recording::read(BufReader::new(file)).map_err(failed)
}
