//! `incise view`: a window to cut, pull and watch a soft body in.

use crate::failure::Failure;
use crate::input::surface;
use crate::pieces;
use crate::render::{Size, size};
use crate::simulate::Backend;
use incise_scene::BackendRequest;
use incise_view::{Options, Recording, RecordingError};
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

/// Opens a window with a soft body in it, to cut it, pull it and watch it; `?` there shows the keys.
///
/// Slices are full ones: a line that ends inside the body cuts nothing, and a blade cuts when it comes out.
#[derive(clap::Args)]
pub(crate) struct ViewArguments {
    /// A closed mesh (obj, ply, stl, glb or gltf; units are meters), or a built-in model: Sphere20, Sphere80, Sphere768,
    /// Bunny, Octopus, Banana or Armadillo. A file goes before a model of the same name.
    #[arg(value_name = "FILE|MODEL", default_value = "Sphere768")]
    input: PathBuf,
    /// What moves the body.
    #[arg(long, value_enum, default_value_t = Backend::Auto)]
    backend: Backend,
    /// A part of the name of the GPU to take, see `incise devices`; it draws too.
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
    /// How large the window is.
    #[arg(long, value_name = "WxH", default_value = "1280x800", value_parser = size)]
    size: Size,
    /// Begin with time standing still; Space lets it go on.
    #[arg(long)]
    paused: bool,
    /// Where pieces go when they are saved.
    #[arg(short, long, value_name = "DIR", default_value = "pieces")]
    output: PathBuf,
    /// Where the recording goes when it is saved.
    #[arg(long, value_name = "FILE", default_value = "recording.jsonl")]
    record: PathBuf,
    /// Does a recording of the same body again.
    #[arg(long, value_name = "FILE")]
    replay: Option<PathBuf>,
}

/// Shows the window until it is closed.
pub(crate) fn run(arguments: &ViewArguments) -> Result<(), Failure> {
    let input = arguments.input.clone();
    let body = surface(&input, true)?;
    let replay = arguments.replay.as_deref().map(recording).transpose()?;
    let output = arguments.output.clone();
    let Size(pixels) = arguments.size;
    let options = Options {
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
        replay,
        record_to: arguments.record.clone(),
        save: Box::new(move |surface| {
            let written = pieces::write(surface, &input, &output);
            let written = written.map_err(|failure| failure.to_string())?;
            let (count, folder) = (written.pieces.len(), output.display());
            Ok(format!("{folder}: {count} pieces"))
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
