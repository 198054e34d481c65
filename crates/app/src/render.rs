//! `incise render`: draws meshes, optionally cut, as a PNG.

mod bodies;

use crate::clock::{milliseconds, timed};
use crate::cut_method::MethodOptions;
use crate::cut_options::CutOptions;
use crate::failure::Failure;
use crate::input::InputOptions;
use crate::json::{all_lossy, lossy};
use crate::numbers::{counted, positive};
use crate::picture::PictureOptions;
use crate::pieces::{check_target, output_path};
use crate::reporter::Reporter;
pub(crate) use bodies::Bodies;
use bodies::InputWarning;
use incise_mesh::geometry::round_to_f32;
use incise_pbd_gpu::{AdapterRequest, Context};
use incise_render::{
    BodyView, Color, DrawList, Image, Line, Offscreen, Overlay, OverlayTriangle, RenderError,
    Renderer,
};
use serde::Serialize;
use std::io::{self, Write};
use std::path::PathBuf;

/// Draws meshes, optionally cut, and writes the image as PNG.
///
/// Caps have their own color, also in files that `incise cut` wrote.
#[derive(clap::Args)]
#[command(
    group = clap::ArgGroup::new("cutter").args(["plane", "blade"]),
    after_long_help = AFTER_HELP
)]
pub(crate) struct RenderArguments {
    /// Meshes (obj, ply, stl, glb or gltf), or built-in models: Sphere20, Sphere80, Sphere768,
    /// Bunny, Octopus, Banana or Armadillo. A file of the same name takes precedence.
    #[arg(required = true, value_name = "FILE|MODEL")]
    inputs: Vec<PathBuf>,
    #[command(flatten)]
    reading: InputOptions,
    /// The file for the image.
    #[arg(short, long, value_name = "PNG", value_parser = output_path())]
    output: PathBuf,
    #[command(flatten)]
    cut: CutOptions,
    #[command(flatten)]
    method: MethodOptions,
    #[command(flatten)]
    look: LookOptions,
    /// GPU to use: a part of its name, as listed by `incise devices`. By default the first one,
    /// software adapters included.
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
}

const AFTER_HELP: &str = "\
Examples:
  incise render scan.ply --wireframe -o scan.png
  incise render Armadillo --plane 0.45,1,0.35,0.06 --explode 0.12 --level 2x-coarser -o cut.png

JSON report (--json): inputs, warnings, output, width, height, device, samples, hits,
pieces, triangles, cap_triangles, seconds.

Exit code 4: the cut misses every mesh; the uncut meshes are drawn.";

/// Appearance of the image.
#[derive(clap::Args)]
struct LookOptions {
    #[command(flatten)]
    picture: PictureOptions,
    /// Move pieces apart by this many diagonals: along the cut's normal or, without a cut, away
    /// from the center.
    #[arg(long, value_name = "X", value_parser = positive, allow_hyphen_values = true)]
    explode: Option<f64>,
    /// Hide pieces. They are numbered from 0, input by input, in the order of the files that
    /// `incise cut` writes.
    #[arg(long, value_name = "N,..", value_delimiter = ',')]
    without: Vec<usize>,
    /// Hide pieces in front of a cut: show those behind all planes, whose normals point away.
    #[arg(long, requires = "cutter")]
    behind: bool,
    /// Draw the blade's sweep, or the part of the plane within the body's box, translucent.
    #[arg(long, requires = "cutter")]
    show_sweep: bool,
    /// Draw a checkerboard on texture coordinates: squares per unit of them.
    #[arg(long, value_name = "N", value_parser = positive)]
    checkers: Option<f64>,
}

/// Color of the sweep.
const SWEEP: Color = Color::rgb(70, 130, 210);

/// The report as JSON.
#[derive(Serialize)]
struct Report {
    #[serde(serialize_with = "all_lossy")]
    inputs: Vec<PathBuf>,
    /// Repairs made while reading.
    warnings: Vec<InputWarning>,
    #[serde(serialize_with = "lossy")]
    output: PathBuf,
    width: u32,
    height: u32,
    /// Name of the GPU.
    device: String,
    /// Samples per pixel.
    samples: u32,
    /// Triangles that the sweep crosses; none without a cut.
    hits: Option<usize>,
    pieces: usize,
    /// Visible triangles, caps included.
    triangles: usize,
    cap_triangles: usize,
    seconds: Times,
}

/// Times of the stages \[s\].
#[derive(Serialize)]
struct Times {
    /// Time of reading and cutting.
    prepare: f64,
    /// Time of opening the GPU.
    open: f64,
    draw: f64,
    write: f64,
}

/// Runs the command.
pub(crate) fn run(
    arguments: &RenderArguments,
    reporter: &mut Reporter<impl Write>,
) -> Result<(), Failure> {
    let output = &arguments.output;
    if !output
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("png"))
    {
        let path = output.clone();
        return Err(Failure::ImageFormat { path });
    }
    for input in &arguments.inputs {
        check_target(output, input)?;
    }
    let progress = reporter.stages(3);
    progress.begin("read and cut");
    let (prepare, bodies) = timed(|| arguments.read(reporter));
    let mut bodies = bodies?;
    progress.step();
    progress.begin("draw");
    let (open, context) = timed(|| Context::open(&AdapterRequest::any(arguments.adapter.clone())));
    let context = context?;
    let (draw, drawn) = timed(|| {
        let renderer = Renderer::offscreen(context.device(), context.queue())?;
        let picture = arguments.draw(&renderer, &bodies)?;
        Ok::<_, RenderError>((renderer.samples(), picture))
    });
    let (samples, picture) = drawn?;
    context.check()?;
    progress.step();
    progress.begin("write");
    let (write, written) = timed(|| picture.write_png(output));
    written?;
    progress.end();
    let (triangles, cap_triangles) = bodies.count();
    let report = Report {
        inputs: arguments.inputs.clone(),
        warnings: std::mem::take(&mut bodies.warnings),
        output: output.clone(),
        width: picture.width(),
        height: picture.height(),
        device: context.adapter().name.clone(),
        samples,
        hits: bodies.hits,
        pieces: bodies.pieces(),
        triangles,
        cap_triangles,
        seconds: Times {
            prepare: prepare.as_secs_f64(),
            open: open.as_secs_f64(),
            draw: draw.as_secs_f64(),
            write: write.as_secs_f64(),
        },
    };
    reporter.report(&report, print)?;
    if bodies.hits == Some(0) {
        let path = arguments.inputs[0].clone();
        return Err(Failure::Missed {
            path,
            bounds: bodies.file_bounds(),
            output: "the image shows it uncut",
        });
    }
    Ok(())
}

impl RenderArguments {
    /// Reads, cuts, hides and moves the meshes.
    pub(crate) fn read(&self, reporter: &Reporter<impl Write>) -> Result<Bodies, Failure> {
        let plan = (self.cut.is_cut())
            .then(|| self.method.plan(&self.cut))
            .transpose()?;
        let mut bodies = Bodies::read(&self.inputs, self.reading, plan, reporter)?;
        bodies.hide(&self.look.without)?;
        if self.look.behind {
            bodies.hide_front();
        }
        bodies.explode(self.look.explode.unwrap_or(0.0));
        Ok(bodies)
    }

    /// Draws the meshes.
    pub(crate) fn draw(&self, renderer: &Renderer, bodies: &Bodies) -> Result<Image, RenderError> {
        let picture = &self.look.picture;
        let views = bodies.bodies.iter().map(|body| {
            let mut view = BodyView::from_surface(renderer, &body.surface, |t| {
                let piece = body.piece_of(t)?;
                Some(picture.triangle_color(body.is_cap(t), piece))
            })?;
            if let Some(squares) = self.look.checkers {
                view.set_checkers(renderer, &body.surface, round_to_f32(squares))?;
            }
            Ok(view)
        });
        let views: Vec<BodyView> = views.collect::<Result<_, RenderError>>()?;
        let sheets = if self.look.show_sweep {
            bodies.sheets(self.cut.is_plane())
        } else {
            Vec::new()
        };
        let overlay = overlay(renderer, &sheets)?;
        // The image contains a visible plane, but not a blade's sweep, which may be much larger
        // than the body.
        let framed: &[_] = if self.cut.is_plane() { &sheets } else { &[] };
        let content = DrawList {
            bodies: &views.iter().collect::<Vec<_>>(),
            overlays: &[&overlay],
        };
        let [width, height] = picture.size();
        let view = picture.view(|| bodies.points(framed));
        Offscreen::new(renderer, width, height)?.render(renderer, &view, &content)
    }
}

/// Returns translucent quadrilaterals with outlines.
fn overlay(renderer: &Renderer, sheets: &[[[f32; 3]; 4]]) -> Result<Overlay, RenderError> {
    let triangles = sheets.iter().flat_map(|&[a, b, c, d]| {
        [[a, b, c], [a, c, d]].map(|corners| OverlayTriangle {
            corners,
            color: SWEEP.with_alpha(70),
        })
    });
    let lines = sheets.iter().flat_map(|&[a, b, c, d]| {
        [[a, b], [b, c], [c, d], [d, a]].map(|ends| Line {
            ends,
            color: SWEEP.with_alpha(200),
            width: 1.5,
        })
    });
    let (triangles, lines): (Vec<OverlayTriangle>, Vec<Line>) =
        (triangles.collect(), lines.collect());
    Overlay::new(renderer, &triangles, &lines)
}

fn print(report: &Report, out: &mut impl Write) -> io::Result<()> {
    writeln!(
        out,
        "{}: {} x {} pixels of {} samples, {}, {} of them caps, {}",
        report.output.display(),
        report.width,
        report.height,
        report.samples,
        counted(report.triangles, "triangle"),
        report.cap_triangles,
        counted(report.pieces, "piece")
    )?;
    let t = &report.seconds;
    writeln!(
        out,
        "  {}; ms: prepare {:.2}, open {:.2}, draw {:.2}, write {:.2}",
        report.device,
        milliseconds(t.prepare),
        milliseconds(t.open),
        milliseconds(t.draw),
        milliseconds(t.write)
    )
}
