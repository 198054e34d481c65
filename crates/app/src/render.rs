//! `incise render`: meshes as a picture, cut on the way if asked to.

mod bodies;
mod values;

use crate::clock::{milliseconds, timed};
use crate::cut_options::CutOptions;
use crate::failure::Failure;
use crate::json::{all_lossy, lossy};
use crate::numbers::positive;
use crate::pieces::check_target;
use crate::teller::Teller;
use bodies::Bodies;
use incise_mesh::Aabb;
use incise_pbd_gpu::{AdapterRequest, Context};
use incise_render::{
    Background, BodyView, Camera, Color, Content, Line, Offscreen, Overlay, Picture, RenderError,
    Renderer, Sheet, View, Wireframe,
};
use serde::Serialize;
use std::io::{self, Write};
use std::path::PathBuf;
pub(crate) use values::{Size, size};
use values::{Viewpoint, backdrop, viewpoint};

/// Draws meshes, cut first if asked to, and writes the picture as PNG.
///
/// The triangles of caps have a color of their own, also in files that `incise cut` wrote.
#[derive(clap::Args)]
#[command(group = clap::ArgGroup::new("cutter").args(["plane", "blade"]))]
pub(crate) struct RenderArguments {
    /// Meshes (obj, ply, stl, glb or gltf), or built-in models: Sphere20, Sphere80, Sphere768, Bunny, Octopus, Banana or
    /// Armadillo. A file goes before a model of the same name.
    #[arg(required = true, value_name = "FILE|MODEL")]
    inputs: Vec<PathBuf>,
    /// Where the picture goes.
    #[arg(short, long, value_name = "PNG")]
    output: PathBuf,
    #[command(flatten)]
    cut: CutOptions,
    #[command(flatten)]
    look: LookOptions,
    /// A part of the name of the GPU to take, see `incise devices`; without one the first that there is, software too.
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// How the picture looks.
#[derive(clap::Args)]
struct LookOptions {
    /// How large the picture is.
    #[arg(long, value_name = "WxH", default_value = "960x720", value_parser = size)]
    size: Size,
    /// From where: degrees around the y axis, 0 from positive z and 90 from positive x, and degrees above the horizon.
    /// Then how far away, in diagonals; without it all there is to see fills the picture.
    #[arg(long, value_name = "AZIMUTH,ELEVATION[,DISTANCE]", value_parser = viewpoint, allow_hyphen_values = true)]
    camera: Option<Viewpoint>,
    /// Draw the edges of triangles.
    #[arg(long)]
    wireframe: bool,
    /// The color of the surface, as #rrggbb.
    #[arg(long, value_name = "COLOR", default_value_t = Color::rgb(154, 174, 198))]
    color: Color,
    /// The color of caps.
    #[arg(long, value_name = "COLOR", default_value_t = Color::rgb(222, 92, 66))]
    cap_color: Color,
    /// Give each piece a color of its own, but for its caps.
    #[arg(long)]
    color_pieces: bool,
    /// What is behind: one color, or those of the upper and the lower edge.
    #[arg(long, value_name = "COLOR[,COLOR]", value_parser = backdrop)]
    background: Option<Background>,
    /// Move pieces apart by so many diagonals: along the cut's normal or, without a cut, from the middle of all.
    #[arg(long, value_name = "X", value_parser = positive, allow_hyphen_values = true)]
    explode: Option<f64>,
    /// Leave pieces out. They are numbered from 0 in the order of the inputs and, of each, in that in which `incise cut`
    /// writes them.
    #[arg(long, value_name = "N,..", value_delimiter = ',')]
    without: Vec<usize>,
    /// Draw what cuts, translucent: the blade's sweep, or the part of the plane that is in the body's box.
    #[arg(long, requires = "cutter")]
    show_sweep: bool,
}

/// The sweep's color.
const SWEEP: Color = Color::rgb(70, 130, 210);

/// The report as JSON.
#[derive(Serialize)]
struct Report {
    #[serde(serialize_with = "all_lossy")]
    inputs: Vec<PathBuf>,
    #[serde(serialize_with = "lossy")]
    output: PathBuf,
    width: u32,
    height: u32,
    /// What drew it.
    device: String,
    /// Samples of a pixel.
    samples: u32,
    /// Triangles that the cut crossed; none without a cut.
    triangles_hit: Option<usize>,
    pieces: usize,
    /// Triangles in the picture, those of caps among them.
    triangles: usize,
    cap_triangles: usize,
    milliseconds: Times,
}

/// Time of each stage \[ms\].
#[derive(Serialize)]
struct Times {
    /// Reading and cutting.
    prepare: f64,
    /// Opening the device.
    open: f64,
    draw: f64,
    write: f64,
}

/// Draws and writes.
pub(crate) fn run(
    arguments: &RenderArguments,
    teller: &mut Teller<impl Write>,
) -> Result<(), Failure> {
    let output = &arguments.output;
    if !output
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("png"))
    {
        let path = output.clone();
        return Err(Failure::PictureFormat { path });
    }
    let options = &arguments.cut;
    let plan = options.is_cut().then(|| options.check()).transpose()?;
    for input in &arguments.inputs {
        check_target(output, input)?;
    }
    let look = &arguments.look;
    let progress = teller.stages(3);
    progress.begin("read and cut");
    let (prepare, bodies) = timed(|| {
        let mut bodies = Bodies::read(&arguments.inputs, plan)?;
        bodies.leave_out(&look.without)?;
        bodies.explode(look.explode.unwrap_or(0.0));
        Ok::<_, Failure>(bodies)
    });
    let bodies = bodies?;
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
        output: output.clone(),
        width: picture.width(),
        height: picture.height(),
        device: context.adapter().name.clone(),
        samples,
        triangles_hit: bodies.hits,
        pieces: bodies.pieces(),
        triangles,
        cap_triangles,
        milliseconds: Times {
            prepare: milliseconds(prepare),
            open: milliseconds(open),
            draw: milliseconds(draw),
            write: milliseconds(write),
        },
    };
    Ok(teller.report(&report, arguments.json, print)?)
}

impl RenderArguments {
    fn draw(&self, renderer: &Renderer, bodies: &Bodies) -> Result<Picture, RenderError> {
        let look = &self.look;
        let Size([width, height]) = look.size;
        let views = bodies.bodies.iter().map(|body| {
            BodyView::of(renderer, &body.surface, |t| {
                let piece = body.piece_of(t)?;
                Some(match (body.is_cap(t), look.color_pieces) {
                    (true, _) => look.cap_color,
                    (false, true) => Color::of_piece(piece),
                    (false, false) => look.color,
                })
            })
        });
        let views: Vec<BodyView> = views.collect::<Result<_, _>>()?;
        let sheets = if look.show_sweep {
            bodies.sheets(self.cut.is_plane())
        } else {
            Vec::new()
        };
        let overlay = overlay(renderer, &sheets)?;
        let aspect = f64::from(width) / f64::from(height);
        let view = View {
            background: look.background.unwrap_or_default(),
            wireframe: look.wireframe.then(Wireframe::default),
            ..View::of(self.camera(bodies, &sheets, aspect))
        };
        let content = Content {
            bodies: &views.iter().collect::<Vec<_>>(),
            overlays: &[&overlay],
        };
        Offscreen::new(renderer, width, height)?.picture(renderer, &view, &content)
    }

    /// The camera asked for. A plane that is shown is in the picture; a blade's sweep may be much larger than the body.
    fn camera(&self, bodies: &Bodies, sheets: &[[[f32; 3]; 4]], aspect: f64) -> Camera {
        let sheets = if self.cut.is_plane() { sheets } else { &[] };
        let points = || bodies.points(sheets);
        let Some(Viewpoint { angles, distance }) = self.look.camera else {
            return Camera::default().frame(points(), aspect);
        };
        let [azimuth, elevation] = angles;
        let camera = Camera::looking(azimuth, elevation);
        match distance {
            None => camera.frame(points(), aspect),
            Some(distance) => {
                let bounds = Aabb::around(points());
                Camera {
                    distance: distance * bounds.diagonal(),
                    ..camera.fit(&bounds, aspect)
                }
            }
        }
    }
}

/// Sheets of four corners and their outlines, translucent.
fn overlay(renderer: &Renderer, sheets: &[[[f32; 3]; 4]]) -> Result<Overlay, RenderError> {
    let triangles = sheets.iter().flat_map(|&[a, b, c, d]| {
        [[a, b, c], [a, c, d]].map(|corners| Sheet {
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
    let (triangles, lines): (Vec<Sheet>, Vec<Line>) = (triangles.collect(), lines.collect());
    Overlay::new(renderer, &triangles, &lines)
}

fn print(report: &Report, out: &mut impl Write) -> io::Result<()> {
    writeln!(
        out,
        "{}: {} x {} pixels of {} samples, {} triangles, {} of them caps, {} pieces",
        report.output.display(),
        report.width,
        report.height,
        report.samples,
        report.triangles,
        report.cap_triangles,
        report.pieces
    )?;
    if report.triangles_hit == Some(0) {
        writeln!(out, "  the cut misses what is drawn")?;
    }
    let t = &report.milliseconds;
    writeln!(
        out,
        "  {}; ms: prepare {:.2}, open {:.2}, draw {:.2}, write {:.2}",
        report.device, t.prepare, t.open, t.draw, t.write
    )
}
