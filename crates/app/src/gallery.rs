//! `incise gallery`: draws the paper's figures, grids of pictures by `incise render`.

mod figures;

use crate::failure::Failure;
use crate::json::write_report;
use crate::pieces::output_path;
use crate::render::RenderArguments;
use crate::reporter::Reporter;
use clap::Parser;
use clap::builder::PossibleValuesParser;
use figures::{ALL, Figure};
use incise_pbd_gpu::{AdapterRequest, Context};
use incise_render::{FigureGrid, Image, RenderError, Renderer};
use serde::Serialize;
use std::io::Write;
use std::path::PathBuf;

/// Draws the paper's figures from the built-in models, by the paper's and by the exact method.
///
/// Writes DIR/fig1.png and so on, and DIR/index.json with the command of every panel and its
/// numbers of triangles.
#[derive(clap::Args)]
pub(crate) struct GalleryArguments {
    /// The folder for the images.
    #[arg(short, long, value_name = "DIR", value_parser = output_path())]
    output: PathBuf,
    /// Side of each panel [pixels].
    #[arg(
        long,
        value_name = "N",
        default_value_t = 320,
        value_parser = clap::value_parser!(u32).range(64..=2048)
    )]
    size: u32,
    /// Figures to draw, separated by commas.
    #[arg(long, value_name = "NAME,..", value_delimiter = ',', ignore_case = true,
          value_parser = PossibleValuesParser::new(ALL.iter().map(|figure| figure.name)))]
    only: Vec<String>,
    /// GPU to use: a part of its name, as listed by `incise devices`. By default the first one,
    /// software adapters included.
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
}

/// The contents of the figures, as JSON.
#[derive(Serialize)]
struct Index {
    /// Name of the GPU.
    device: String,
    /// Side of a panel [pixels].
    panel: u32,
    figures: Vec<FigureEntry>,
}

#[derive(Serialize)]
struct FigureEntry {
    name: &'static str,
    file: String,
    caption: &'static str,
    width: u32,
    height: u32,
    rows: Vec<Vec<PanelEntry>>,
}

#[derive(Serialize)]
struct PanelEntry {
    /// The panel alone.
    command: String,
    pieces: usize,
    /// Visible triangles, caps included.
    triangles: usize,
    cap_triangles: usize,
}

/// The command line of a panel.
#[derive(Parser)]
struct Panel {
    #[command(flatten)]
    render: RenderArguments,
}

/// Runs the command.
pub(crate) fn run(
    arguments: &GalleryArguments,
    reporter: &mut Reporter<impl Write>,
) -> Result<(), Failure> {
    let folder = &arguments.output;
    std::fs::create_dir_all(folder).map_err(|source| Failure::Folder {
        path: folder.clone(),
        source,
    })?;
    let context = Context::open(&AdapterRequest::any(arguments.adapter.clone()))?;
    let renderer = Renderer::offscreen(context.device(), context.queue())?;
    let mut index = Index {
        device: context.adapter().name.clone(),
        panel: arguments.size,
        figures: Vec::new(),
    };
    let figures: Vec<&Figure> = ALL.iter().filter(|f| arguments.is_drawn(f.name)).collect();
    let progress = reporter.progress(u32::try_from(figures.len()).unwrap_or(u32::MAX), 1);
    for figure in figures {
        progress.begin(figure.name);
        let (picture, rows) = figure.draw(&renderer, arguments.size, reporter)?;
        context.check()?;
        let file = format!("{}.png", figure.name);
        picture.write_png(&folder.join(&file))?;
        index.figures.push(FigureEntry {
            name: figure.name,
            file,
            caption: figure.caption,
            width: picture.width(),
            height: picture.height(),
            rows,
        });
        progress.step();
    }
    progress.end();
    let path = folder.join("index.json");
    let mut text = Vec::new();
    let written = write_report(&index, &mut text).and_then(|()| std::fs::write(&path, text));
    written.map_err(|source| RenderError::Write { path, source })?;
    let printed = reporter.report(&index, |index, out| {
        index.figures.iter().try_for_each(|figure| {
            let (path, width, height) = (folder.join(&figure.file), figure.width, figure.height);
            writeln!(out, "{}: {width} x {height} pixels", path.display())
        })
    });
    Ok(printed?)
}

impl GalleryArguments {
    fn is_drawn(&self, figure: &str) -> bool {
        let mut names = self.only.iter();
        self.only.is_empty() || names.any(|name| name.eq_ignore_ascii_case(figure))
    }
}

impl Figure {
    /// Draws all panels with their words as labels.
    fn draw(
        &self,
        renderer: &Renderer,
        side: u32,
        reporter: &Reporter<impl Write>,
    ) -> Result<(Image, Vec<Vec<PanelEntry>>), Failure> {
        let count = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
        let size = [count(self.columns.len()), count(self.rows.len())];
        let mut grid = FigureGrid::new([side; 2], size[0], size[1])?;
        let mut entries = Vec::new();
        for (r, row) in (0..).zip(self.rows) {
            grid.title(r, &format!("{} {row}", self.words));
            let mut panels = Vec::new();
            for (c, column) in (0..).zip(self.columns) {
                let words = format!("{} {row} {column}", self.words);
                let words = words.split_whitespace().collect::<Vec<_>>().join(" ");
                let command = format!(
                    "incise render {words} --wireframe --background ffffff \
                     --size {side}x{side} -o {}-{r}-{c}.png",
                    self.name
                );
                let panel = Panel::try_parse_from(command.split(' ').skip(1));
                let panel = panel.map_err(|source| Failure::Figure {
                    command: command.clone(),
                    source: Box::new(source),
                })?;
                let bodies = panel.render.read(reporter)?;
                let picture = panel.render.draw(renderer, &bodies)?;
                let (triangles, cap_triangles) = bodies.count();
                let label = format!("{column} {cap_triangles} cap triangles");
                grid.put([c, r], &picture, label.trim());
                panels.push(PanelEntry {
                    command,
                    pieces: bodies.pieces(),
                    triangles,
                    cap_triangles,
                });
            }
            entries.push(panels);
        }
        Ok((grid.into_image(), entries))
    }
}
