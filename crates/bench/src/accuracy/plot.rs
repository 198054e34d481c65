//! Draws time against error for `--plot`, and writes the rows as CSV.

use crate::chart::{Chart, Stack};
use crate::output::{OutputError, OutputFile};
use crate::picture::PictureFile;
use crate::work_precision::{Row, floors, series};
use plotters::chart::SeriesLabelPosition;
use serde::Serialize;
use std::error::Error;
use std::path::Path;

/// Width and height of a picture \[px\].
const SIZE: (u32, u32) = (1000, 1100);

/// The files of a scene on one backend: pictures and CSV.
pub(super) struct PlotFiles {
    backend: &'static str,
    picture: PictureFile,
    csv: OutputFile,
}

impl PlotFiles {
    /// Opens `NAME.svg`, `NAME.png` and `NAME.csv` in a folder before the run.
    ///
    /// # Errors
    /// As [`OutputFile::open`].
    pub(super) fn open(
        folder: &Path,
        name: &str,
        backend: &'static str,
    ) -> Result<Self, OutputError> {
        let path = folder.join(name);
        Ok(Self {
            backend,
            picture: PictureFile::open(&path)?,
            csv: OutputFile::open(&path.with_extension("csv"))?,
        })
    }

    /// Draws and writes the backend's rows of a scene.
    ///
    /// # Errors
    /// An error of a file, of the CSV writer or of the plot.
    pub(super) fn draw(&mut self, name: &str, rows: &[Row]) -> Result<(), Box<dyn Error>> {
        let backend = self.backend;
        let rows = || rows.iter().filter(|row| row.backend == backend);
        let chart = |error: fn(&Row) -> Option<f64>, y: &'static str| Chart {
            title: format!("{name}, {backend}"),
            x: "ms per frame",
            y,
            log_x: true,
            legend: SeriesLabelPosition::LowerLeft,
            series: series(rows(), error, true),
            levels: Vec::new(),
        };
        let total = Chart {
            levels: floors(rows()),
            ..chart(|row| row.total_position, "total error [mean edges]")
        };
        let solver = chart(|row| row.solver_position, "solver error [mean edges]");
        self.write(rows(), &[total, solver])
    }

    /// Writes rows as CSV, and charts one below the other.
    ///
    /// # Errors
    /// As [`Self::draw`].
    pub(super) fn write<R: Serialize>(
        &mut self,
        rows: impl IntoIterator<Item = R>,
        charts: &[Chart<'_>],
    ) -> Result<(), Box<dyn Error>> {
        let mut csv = csv::Writer::from_writer(Vec::new());
        for row in rows {
            csv.serialize(row)?;
        }
        self.csv.write(csv.into_inner()?)?;
        Ok(self.picture.draw(SIZE, &Stack(charts))?)
    }
}
