//! `incise gallery`: draws the paper's figures from the built-in models, by both methods, and a
//! figure of incisions.

mod boundary;
mod catalog;
mod draw;
mod figure;
mod incisions;
mod levels;
mod refinement;
mod slice;
mod slices;
mod sweep;

pub(crate) use figure::FigureError;

use crate::failure::Failure;
use crate::json::write_report;
use crate::pieces::output_path;
use crate::reporter::Reporter;
use catalog::{ALL, Entry};
use clap::builder::PossibleValuesParser;
use draw::FigureRenderer;
use figure::{Facts, Row};
use incise_pbd_gpu::{AdapterRequest, Context};
use incise_render::{Image, RenderError, Renderer};
use serde::Serialize;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Draws the paper's figures, cut by the paper's and by the exact method, and incisions.
///
/// Writes DIR/fig1.png and so on from the built-in models, and DIR/index.json with the parameters
/// and triangle counts of every panel.
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
          value_parser = PossibleValuesParser::new(ALL.iter().map(|entry| entry.name)))]
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
    figures: Vec<Figure>,
}

#[derive(Serialize)]
struct Figure {
    name: &'static str,
    file: String,
    caption: &'static str,
    width: u32,
    height: u32,
    rows: Vec<FigureRow>,
}

#[derive(Serialize)]
struct FigureRow {
    title: String,
    panels: Vec<FigurePanel>,
}

#[derive(Serialize)]
struct FigurePanel {
    label: String,
    #[serde(flatten)]
    facts: Facts,
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
    let figures_renderer = FigureRenderer::new(&renderer, arguments.size)?;
    let mut index = Index {
        device: context.adapter().name.clone(),
        panel: arguments.size,
        figures: Vec::new(),
    };
    let figures = arguments.entries().count();
    let progress = reporter.progress(u32::try_from(figures).unwrap_or(u32::MAX), 1);
    for entry in arguments.entries() {
        progress.begin(entry.name);
        let rows = (entry.make)().map_err(|error| error.in_figure(entry.name))?;
        let picture = figures_renderer.figure(&rows)?;
        context.check()?;
        let file = format!("{}.png", entry.name);
        picture.write_png(&folder.join(&file))?;
        let figure = Figure::of(entry, file, rows, &picture);
        index.figures.push(figure);
        progress.step();
    }
    progress.end();
    write_index(&folder.join("index.json"), &index)?;
    let written = reporter.report(&index, |index, out| {
        index.figures.iter().try_for_each(|figure| {
            let Figure {
                file,
                width,
                height,
                ..
            } = figure;
            let path = folder.join(file);
            writeln!(out, "{}: {width} x {height} pixels", path.display())
        })
    });
    Ok(written?)
}

impl GalleryArguments {
    /// Returns the selected figures, in the order of the catalog.
    fn entries(&self) -> impl Iterator<Item = &'static Entry> {
        let is_named = |entry: &&Entry| {
            let mut names = self.only.iter();
            self.only.is_empty() || names.any(|name| name.eq_ignore_ascii_case(entry.name))
        };
        ALL.iter().filter(is_named)
    }
}

impl Figure {
    fn of(entry: &Entry, file: String, rows: Vec<Row>, picture: &Image) -> Self {
        let rows = rows.into_iter().map(|row| FigureRow {
            title: row.title,
            panels: (row.panels.into_iter())
                .map(|panel| FigurePanel {
                    label: panel.label,
                    facts: panel.facts,
                })
                .collect(),
        });
        Self {
            name: entry.name,
            file,
            caption: entry.caption,
            width: picture.width(),
            height: picture.height(),
            rows: rows.collect(),
        }
    }
}

fn write_index(path: &Path, index: &Index) -> Result<(), Failure> {
    let mut text = Vec::new();
    let written = write_report(index, &mut text).and_then(|()| std::fs::write(path, text));
    let written = written.map_err(|source| RenderError::Write {
        path: path.to_owned(),
        source,
    });
    Ok(written?)
}
