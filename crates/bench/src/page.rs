//! `incise-bench report`: one page of all results, for a browser and for paper. It needs nothing but itself.

mod chart;
mod csv;
mod error;
mod gallery;
mod html;
mod measure;
mod numbers;
mod rows;
mod speed;
mod table;
#[cfg(test)]
mod tests;
mod verdicts;

use crate::machine;
use crate::output::{self, OutputFile};
use clap::Args;
use error::PageError;
use gallery::Gallery;
use html::Html;
use rows::{AccuracyRow, NAMES, Rows, Source};
use std::collections::BTreeMap;
use std::error::Error;
use std::io::Write;
use std::path::PathBuf;

/// What the page is made of.
#[derive(Args, Clone)]
pub(crate) struct ReportArguments {
    /// Where the page goes, as report.html, and the rows of benches that are run for it.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Take rows that earlier runs wrote by --json; of accuracy also the CSV beside its plots.
    #[arg(long, value_name = "FILE", num_args = 1..)]
    take: Vec<PathBuf>,
    /// Run these, separated by commas. By default all, or none where rows are taken.
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = NAMES)]
    run: Vec<String>,
    /// A folder that `incise gallery` made: its pictures become part of the page.
    #[arg(long, value_name = "DIR")]
    gallery: Option<PathBuf>,
    /// Run a part of every bench: seconds instead of minutes.
    #[arg(long)]
    quick: bool,
    /// Print nothing but warnings and errors: neither rows nor progress.
    #[arg(short, long)]
    pub(crate) quiet: bool,
}

/// What is shown.
#[derive(Debug, Default)]
struct Content {
    sources: Vec<Source>,
    /// Why benches have no rows, or what they said when they ended, by name.
    told: BTreeMap<&'static str, String>,
    gallery: Option<Gallery>,
}

/// Takes, runs and writes.
pub(crate) fn run(arguments: &ReportArguments, out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    let mut content = Content::default();
    // What cannot be read is told before anything is measured.
    for path in &arguments.take {
        content.sources.push(rows::read(path)?);
    }
    content.gallery = arguments
        .gallery
        .as_deref()
        .map(gallery::read)
        .transpose()?;
    output::folder(&arguments.output)?;
    let path = arguments.output.join("report.html");
    let mut file = OutputFile::open(&path)?;
    for name in arguments.to_run() {
        let rows = arguments.output.join(format!("{name}.json"));
        // Those of an earlier run are none of this one.
        drop(OutputFile::open(&rows)?);
        std::fs::write(&rows, "[]")?;
        if let Err(fault) = measure::measure(name, arguments, &rows, out) {
            content.told.insert(name, fault.to_string());
        }
        match rows::read(&rows) {
            Ok(source) => content.sources.push(source),
            Err(fault) => {
                content
                    .told
                    .entry(name)
                    .or_insert_with(|| fault.to_string());
            }
        }
    }
    file.write(content.page()?)?;
    writeln!(out, "{}", path.display())?;
    for name in content.missing() {
        writeln!(out, "  missing: {name}")?;
    }
    Ok(())
}

impl ReportArguments {
    /// Benches to run, in the page's order.
    fn to_run(&self) -> impl Iterator<Item = &'static str> {
        let runs_all = self.run.is_empty() && self.take.is_empty();
        NAMES
            .into_iter()
            .filter(move |&name| runs_all || self.run.iter().any(|n| n == name))
    }
}

/// What a part of the page is headed by.
fn heading(name: &str) -> &'static str {
    match name {
        "table" => "The seven models beside the paper's Table 1",
        "cut" => "What a cut costs",
        "refine" => "Caps: time and quality",
        "step" => "What a frame of the solver costs",
        "accuracy" => "Accuracy: what a frame costs for a given error",
        "stability" => "Stability",
        "skip" => "What costs nothing when it is not needed",
        _ => "The paper's figures",
    }
}

impl Content {
    fn of(&self, name: &str) -> impl Iterator<Item = &Source> {
        self.sources.iter().filter(move |s| s.rows.name() == name)
    }

    /// Parts of the page that there is nothing for.
    fn missing(&self) -> Vec<&'static str> {
        let is_missing = |name: &&str| self.of(name).next().is_none();
        let mut missing: Vec<&str> = NAMES.into_iter().filter(is_missing).collect();
        if self.gallery.is_none() {
            missing.push("gallery");
        }
        missing
    }

    /// The page.
    ///
    /// # Errors
    /// [`PageError::Picture`].
    fn page(&self) -> Result<String, PageError> {
        let mut html = Html::default();
        self.sources(&mut html);
        for name in NAMES {
            html.heading(heading(name));
            if let Some(fault) = self.told.get(name) {
                html.missing(&format!("The run said: {fault}"));
            }
            if self.of(name).next().is_none() {
                html.missing(&format!(
                    "Missing: rows of {name} were neither taken nor measured."
                ));
            }
            self.show(name, &mut html)?;
        }
        html.heading(heading("gallery"));
        match &self.gallery {
            Some(gallery) => gallery.show(&mut html),
            None => html.missing("Missing: no folder of incise gallery was named."),
        }
        Ok(html.page("incise: results"))
    }

    /// Where the rows are from, and which there are not.
    fn sources(&self, html: &mut Html) {
        html.paragraph(
            "incise cuts soft bodies while they move: a reproduction of \"Cutting Simulation in Unity 3D Using Position Based \
             Dynamics with Various Refinement Levels\" (Applied Sciences, 2022), and an exact method beside the paper's.",
        );
        html.paragraph(&format!(
            "Page made by incise-bench {}, commit {}, on {}. Rows say themselves what they were measured on:",
            env!("CARGO_PKG_VERSION"),
            machine::commit(),
            machine::machine()
        ));
        let told = |texts: &[String]| match texts {
            [] => "-".to_owned(),
            texts => texts.join("; "),
        };
        let cells = self.sources.iter().map(|source| {
            let cells = [
                source.rows.name().to_owned(),
                source.file.clone(),
                source.count.to_string(),
                told(&source.machines),
                told(&source.commits),
            ];
            (cells, false)
        });
        let names = ["bench", "file", "rows", "machine or device", "commit"];
        html.table("", names, &[0, 1, 3, 4], &cells.collect::<Vec<_>>());
        let missing = self.missing();
        if !missing.is_empty() {
            html.missing(&format!("Missing: {}.", missing.join(", ")));
        }
    }

    /// All rows of a bench.
    fn show(&self, name: &str, html: &mut Html) -> Result<(), PageError> {
        let is_one = self.of(name).count() < 2;
        let mut errors: Vec<&AccuracyRow> = Vec::new();
        for source in self.of(name) {
            // The plots are told apart by their scenes.
            if let Rows::Accuracy(rows) = &source.rows {
                errors.extend(rows);
                continue;
            }
            if !is_one {
                html.subheading(&source.file);
            }
            match &source.rows {
                Rows::Table(rows) => table::show(html, rows)?,
                Rows::Cut(rows) => speed::cuts(html, rows)?,
                Rows::Refine(rows) => speed::caps(html, rows),
                Rows::Step(rows) => speed::frames(html, rows)?,
                Rows::Stability(rows) => verdicts::stability(html, rows),
                Rows::Skip(rows) => verdicts::skip(html, rows),
                Rows::Accuracy(_) => {}
            }
        }
        if !errors.is_empty() {
            html.paragraph(
                "Time against the error of positions, each point a number of substeps and iterations, lines along the runs \
                 that no other beats.",
            );
            verdicts::accuracy(html, &errors)?;
        }
        Ok(())
    }
}
