//! `incise-bench report`: results of all benches on one self-contained HTML page.

mod bench_runs;
mod error;
mod gallery;
mod html;
mod paper_table;
mod sections;
mod sources;
mod summary;
#[cfg(test)]
mod tests;

use crate::machine;
use crate::output::{self, OutputFile};
use crate::text_table::Column;
use clap::Args;
use error::ReportError;
use gallery::Gallery;
use html::Html;
use sources::{NAMES, Source};
use std::collections::BTreeMap;
use std::error::Error;
use std::io::{self, Write};
use std::path::PathBuf;

/// Anchor of the section of gallery figures.
const GALLERY: &str = "gallery";

/// Writes a page of results, of earlier runs or measured now.
#[derive(Args, Clone)]
pub(crate) struct ReportArguments {
    /// Folder of the page, report.html, and of the rows of benches that are run for it.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Files of rows that earlier runs wrote with --json, or of accuracy the CSV beside its plots.
    /// Files of something else are skipped.
    #[arg(long, value_name = "FILE", num_args = 1..)]
    take: Vec<PathBuf>,
    /// Benches to run, separated by commas. The default is all, or none with --take.
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = NAMES)]
    run: Vec<String>,
    /// A folder that `incise gallery` made; its figures become part of the page.
    #[arg(long, value_name = "DIR")]
    gallery: Option<PathBuf>,
    /// Run a part of every bench: seconds instead of minutes.
    #[arg(long)]
    quick: bool,
    /// Print nothing but warnings and errors: neither rows nor progress.
    #[arg(short, long)]
    pub(crate) quiet: bool,
}

/// The content of a report.
#[derive(Debug, Default)]
struct Content {
    sources: Vec<Source>,
    /// Reasons for skipped files.
    skipped: Vec<String>,
    /// Errors of benches that were run, by name.
    errors: BTreeMap<&'static str, String>,
    gallery: Option<Gallery>,
}

/// Reads and measures rows, and writes the page.
pub(crate) fn run(arguments: &ReportArguments, out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    // Unreadable files are reported before anything is measured.
    let mut content = Content::default();
    content.take(arguments)?;
    let gallery = arguments.gallery.as_deref().map(gallery::read);
    content.gallery = gallery.transpose()?;
    output::folder(&arguments.output)?;
    let path = arguments.output.join("report.html");
    let mut file = OutputFile::open(&path)?;
    for name in arguments.to_run() {
        let rows = arguments.output.join(format!("{name}.json"));
        // Rows of an earlier run are not taken for rows of this one.
        drop(OutputFile::open(&rows)?);
        std::fs::write(&rows, "[]")?;
        let done = bench_runs::run_bench(name, arguments, &rows, out);
        if let Err(error) = done {
            content.errors.insert(name, error.to_string());
        }
        match sources::read(&rows) {
            Ok(source) => content.sources.push(source),
            Err(error) => {
                (content.errors.entry(name)).or_insert_with(|| error.to_string());
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
    /// Returns the benches to run in the report's order.
    fn to_run(&self) -> impl Iterator<Item = &'static str> {
        let runs_all = self.run.is_empty() && self.take.is_empty();
        let is_named = move |name: &&str| runs_all || self.run.iter().any(|n| n == name);
        NAMES.into_iter().filter(is_named)
    }
}

impl Content {
    /// Reads the files of `--take`; names files without rows on the error output and skips them.
    ///
    /// # Errors
    /// [`ReportError::Read`] for a missing file, [`ReportError::NothingTaken`] if none has rows.
    fn take(&mut self, arguments: &ReportArguments) -> Result<(), ReportError> {
        for path in &arguments.take {
            match sources::read(path) {
                Ok(source) => self.sources.push(source),
                Err(error) if error.is_other_file() => {
                    // Without an error output the page names the file.
                    let _ = writeln!(io::stderr(), "incise-bench: skipped {error}");
                    self.skipped.push(error.to_string());
                }
                Err(error) => return Err(error),
            }
        }
        if self.sources.is_empty() && !self.skipped.is_empty() && arguments.run.is_empty() {
            return Err(ReportError::NothingTaken);
        }
        Ok(())
    }

    fn of(&self, bench: &str) -> impl Iterator<Item = &Source> {
        self.sources.iter().filter(move |s| s.bench() == bench)
    }

    /// Returns the sections without content.
    fn missing(&self) -> Vec<&'static str> {
        let mut missing: Vec<&str> = NAMES.into_iter().collect();
        missing.retain(|name| self.of(name).next().is_none());
        if self.gallery.is_none() {
            missing.push(GALLERY);
        }
        missing
    }

    /// Returns the page: summary, contents, figures of the gallery, a section per bench, sources.
    ///
    /// # Errors
    /// [`ReportError::Image`].
    fn page(&self) -> Result<String, ReportError> {
        let origin = format!(
            "Page made by incise-bench {}, commit {}, on {}.",
            env!("CARGO_PKG_VERSION"),
            machine::commit(),
            machine::machine()
        );
        let mut contents = Html::default();
        let mut anchors: Vec<&str> = NAMES.into_iter().collect();
        anchors.retain(|name| self.of(name).next().is_some() || self.errors.contains_key(name));
        if self.gallery.is_some() {
            anchors.insert(0, GALLERY);
        }
        let titles = (anchors.iter()).map(|name| (*name, sections::title(name), String::new()));
        contents.links(titles.chain([("sources", "Sources", String::new())]));
        let mut body = Html::default();
        for name in anchors {
            body.heading(name, sections::title(name));
            if let Some(error) = self.errors.get(name) {
                body.note(&format!("The run ended with an error: {error}"));
            }
            if let (GALLERY, Some(gallery)) = (name, &self.gallery) {
                gallery.show(&mut body);
            }
            for (machine, sources) in sections::by_machine(self.of(name)) {
                body.subheading(machine);
                sections::show(&mut body, &sources)?;
            }
        }
        self.show_sources(&mut body);
        let parts = [
            ("{{origin}}", html::escape(&origin)),
            ("{{summary}}", self.summary().0),
            ("{{contents}}", contents.0),
            ("{{body}}", body.0),
        ];
        // The body comes last: text of files may look like a placeholder.
        let template = include_str!("html_report/template.html").to_owned();
        Ok(parts
            .iter()
            .fold(template, |page, (name, text)| page.replacen(name, text, 1)))
    }

    /// Returns a line per bench and machine with its main result.
    fn summary(&self) -> Html {
        let mut html = Html::default();
        let mut lines = Vec::new();
        for name in NAMES {
            for (machine, sources) in sections::by_machine(self.of(name)) {
                if let Some(text) = summary::summary(&sources) {
                    lines.push((name, sections::title(name), format!(": {text} ({machine})")));
                }
            }
        }
        html.links(lines);
        let missing = self.missing();
        if !missing.is_empty() {
            html.note(&format!("Missing: {}.", missing.join(", ")));
        }
        html
    }

    /// Appends the files that the page is made of, and skipped ones.
    fn show_sources(&self, html: &mut Html) {
        html.heading("sources", "Sources");
        for skipped in &self.skipped {
            html.note(&format!("Skipped: {skipped}"));
        }
        let columns: [Column<Source>; 5] = [
            ("bench", |source| source.bench().to_owned()),
            ("file", |source| source.file.clone()),
            ("rows", |source| source.count.to_string()),
            ("machine or device", |source| source.machine.clone()),
            ("commit", |source| source.commit.clone()),
        ];
        let group = html::Group {
            title: String::new(),
            rows: self.sources.iter().collect(),
            is_folded: false,
        };
        html.table("Files", &columns, vec![group], |_| false);
    }
}
