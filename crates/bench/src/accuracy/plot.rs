//! Time against error as a picture, and the rows behind it.

use super::row::{Row, csv};
use crate::front::{Point, front};
use crate::output::{OutputError, OutputFile};
use crate::picture::{FONT, Fault, Picture, PictureFile};
use plotters::backend::DrawingBackend;
use plotters::chart::{ChartBuilder, SeriesLabelPosition};
use plotters::coord::Shift;
use plotters::coord::combinators::IntoLogRange;
use plotters::drawing::DrawingArea;
use plotters::element::{Circle, EmptyElement, PathElement, Text};
use plotters::series::LineSeries;
use plotters::style::{Color, IntoFont, RGBColor, WHITE};
use std::error::Error;
use std::path::Path;

/// A way of stepping.
struct Way {
    name: &'static str,
    color: RGBColor,
    is: fn(&Row) -> bool,
}

const WAYS: [Way; 5] = [
    Way {
        name: "xpbd",
        color: RGBColor(20, 90, 180),
        is: |row| row.scheme == "xpbd",
    },
    Way {
        name: "xpbd, half of own weight",
        color: RGBColor(120, 60, 170),
        is: |row| row.scheme == "xpbd-half",
    },
    Way {
        name: "the same, of second order",
        color: RGBColor(20, 20, 20),
        is: |row| row.scheme == "xpbd-half-bdf2",
    },
    Way {
        name: "pbd",
        color: RGBColor(60, 150, 90),
        is: |row| row.scheme == "pbd" && !row.is_paper(),
    },
    Way {
        name: "the paper's (pbd, one substep)",
        color: RGBColor(200, 60, 30),
        is: Row::is_paper,
    },
];

/// Where a scene's picture on one backend goes, and the rows behind it.
pub(super) struct PlotFiles {
    backend: &'static str,
    picture: PictureFile,
    csv: OutputFile,
}

impl PlotFiles {
    /// Opens `NAME.svg`, `NAME.png` and `NAME.csv` in a folder, before anything is measured.
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

    /// Draws those of a scene's rows that are the backend's, and writes them.
    pub(super) fn draw(&mut self, name: &str, rows: &[Row]) -> Result<(), Box<dyn Error>> {
        let mut rows = rows.to_vec();
        rows.retain(|row| row.backend == self.backend);
        let (rows, name) = (rows.as_slice(), &format!("{name}, {}", self.backend));
        self.csv.write(csv(rows))?;
        Ok(self.picture.draw(&Chart { name, rows })?)
    }
}

/// The rows of a scene over time.
struct Chart<'a> {
    name: &'a str,
    rows: &'a [Row],
}

impl Picture for Chart<'_> {
    const SIZE: (u32, u32) = (1000, 1100);

    fn draw<B: DrawingBackend>(&self, area: &DrawingArea<B, Shift>) -> Result<(), Fault<B>>
    where
        B::ErrorType: 'static,
    {
        let Self { name, rows } = self;
        let (above, below) = area.split_vertically(Self::SIZE.1 / 2);
        panel(&above, rows, &format!("{name}: total error"), |row| {
            row.total_error.map(|e| e.position)
        })?;
        panel(&below, rows, &format!("{name}: solver error"), |row| {
            row.solver_error.map(|e| e.position)
        })
    }
}

/// One error of all rows: a point each, and a line along the front of every way.
fn panel<B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    rows: &[Row],
    name: &str,
    error: impl Fn(&Row) -> Option<f64>,
) -> Result<(), Fault<B>>
where
    B::ErrorType: 'static,
{
    let point = |row: &Row| {
        let point = [row.ms_per_frame, error(row)?];
        point
            .iter()
            .all(|x| x.is_finite() && *x > 0.0)
            .then_some(point)
    };
    let all: Vec<Point> = rows.iter().filter_map(point).collect();
    let range = |k: usize| {
        let [mut low, mut high] = [f64::INFINITY, 0.0_f64];
        for p in &all {
            (low, high) = (low.min(p[k]), high.max(p[k]));
        }
        // Nothing was measured.
        if low > high {
            (0.1, 1.0)
        } else {
            (low / 1.5, high * 1.5)
        }
    };
    let [x, y] = [0, 1].map(range);
    let mut chart = ChartBuilder::on(area)
        .margin(15)
        .x_label_area_size(45)
        .y_label_area_size(70)
        .build_cartesian_2d((x.0..x.1).log_scale(), (y.0..y.1).log_scale())?;
    chart
        .configure_mesh()
        .x_desc("ms a frame")
        .y_desc(format!("{name} [mean edges]"))
        .x_labels(6)
        .x_label_formatter(&|x| format!("{x:.0e}"))
        .y_label_formatter(&|y| format!("{y:.0e}"))
        .draw()?;
    for Way { name, color, is } in WAYS {
        let rows = || rows.iter().filter(|row| is(row));
        let points: Vec<Point> = rows().filter_map(point).collect();
        chart.draw_series(
            points
                .iter()
                .map(|p| Circle::new((p[0], p[1]), 2, color.mix(0.4).filled())),
        )?;
        let best = front(points.into_iter());
        let line = best.iter().map(|p| (p[0], p[1]));
        chart
            .draw_series(LineSeries::new(line, color.stroke_width(2)))?
            .label(name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 20, y)], color.stroke_width(2)));
        let named = best.iter().filter_map(|&p| {
            let row = rows().find(|row| point(row) == Some(p))?;
            Some((p, format!("{}x{}", row.substeps, row.iterations)))
        });
        chart.draw_series(named.map(|(p, label)| {
            EmptyElement::at((p[0], p[1]))
                + Circle::new((0, 0), 3, color.filled())
                + Text::new(label, (5, -4), (FONT, 11).into_font())
        }))?;
    }
    chart
        .configure_series_labels()
        // Below the fronts: they fall from left to right.
        .position(SeriesLabelPosition::LowerLeft)
        .border_style(RGBColor(0, 0, 0))
        .background_style(WHITE.mix(0.8))
        .draw()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::error::Errors;
    use crate::picture;

    #[test]
    fn every_row_is_a_point_and_every_front_a_line() {
        let row = |scheme, substeps, iterations, ms_per_frame: f64, position| Row {
            scheme,
            substeps,
            iterations,
            ms_per_frame,
            total_error: Some(Errors {
                position,
                ..Errors::default()
            }),
            ..Row::default()
        };
        let rows = [
            row("xpbd", 4, 1, 1.0, 1e-2),
            row("xpbd", 2, 2, 1.1, 2e-2),
            row("pbd", 1, 4, 1.0, 1e-1),
            row("pbd", 1, 8, 2.0, f64::NAN),
        ];
        let draw = |rows| {
            picture::svg(&Chart {
                name: "sheet",
                rows,
            })
        };
        let text = draw(&rows).unwrap();
        let points = 3;
        let on_fronts = 2;
        assert_eq!(text.matches("<circle").count(), points + on_fronts);
        for label in ["4x1", "1x4", "sheet: total error", "sheet: solver error"] {
            assert_eq!(text.matches(label).count(), 1, "{label}");
        }
        let text = draw(&[]).unwrap();
        assert!(text.ends_with("</svg>\n"), "no rows, an empty picture");
    }
}
