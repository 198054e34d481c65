//! Lines and points over two axes.

use super::error::PageError;
use super::html::Html;
use crate::picture::{self, Fault, Picture};
use plotters::backend::DrawingBackend;
use plotters::chart::{ChartBuilder, SeriesLabelPosition};
use plotters::coord::Shift;
use plotters::coord::combinators::IntoLogRange;
use plotters::coord::ranged1d::{AsRangedCoord, ValueFormatter};
use plotters::drawing::DrawingArea;
use plotters::element::{Circle, PathElement};
use plotters::prelude::Ranged;
use plotters::series::LineSeries;
use plotters::style::{Color, RGBColor, WHITE};
use std::fmt::Debug;
use std::ops::Range;

/// Colors of series, told apart on paper too.
const COLORS: [RGBColor; 8] = [
    RGBColor(20, 90, 180),
    RGBColor(200, 60, 30),
    RGBColor(60, 150, 90),
    RGBColor(120, 60, 170),
    RGBColor(200, 140, 20),
    RGBColor(20, 20, 20),
    RGBColor(20, 150, 170),
    RGBColor(190, 80, 140),
];

/// How many times the largest number the upright axis goes up to where names stand above all lines.
const ROOM: f64 = 12.0;

/// Points of one color.
#[derive(Debug, Clone)]
pub(super) struct Series {
    pub(super) name: String,
    pub(super) points: Vec<[f64; 2]>,
    /// Points that a line goes through, in its order.
    pub(super) line: Vec<[f64; 2]>,
}

/// A chart whose upright axis is logarithmic, the other one if it says so.
#[derive(Debug)]
pub(super) struct Chart<'a> {
    pub(super) across: &'a str,
    pub(super) along: &'a str,
    pub(super) log_across: bool,
    /// Where the names of the series stand.
    pub(super) names: SeriesLabelPosition,
    pub(super) series: Vec<Series>,
}

impl Chart<'_> {
    /// The chart as part of a page, as wide as that.
    ///
    /// # Errors
    /// [`PageError::Picture`].
    pub(super) fn svg(&self) -> Result<String, PageError> {
        Ok(Html::svg(&picture::svg(self)?))
    }

    /// The same for half of the page's width, with letters as large as there.
    ///
    /// # Errors
    /// [`PageError::Picture`].
    pub(super) fn half_svg(&self) -> Result<String, PageError> {
        Ok(Html::svg(&picture::svg(&Half(self))?))
    }

    fn draw_on<B: DrawingBackend>(&self, area: &DrawingArea<B, Shift>) -> Result<(), Fault<B>>
    where
        B::ErrorType: 'static,
    {
        let across = self.range(|p| p.0).unwrap_or(0.1..1.0);
        if self.log_across {
            let across = across.start / 1.5..across.end * 1.5;
            self.on(area, across.log_scale(), &|x| short(*x))
        } else {
            let margin = 0.03 * (across.end - across.start).max(1.0);
            let across = across.start - margin..across.end + margin;
            self.on(area, across, &|x| plain(*x))
        }
    }

    /// What can be drawn of points: logarithms are of positive numbers.
    fn seen<'p>(&self, points: &'p [[f64; 2]]) -> impl Iterator<Item = (f64, f64)> + use<'p> {
        let log = self.log_across;
        let is_seen = move |&&[x, y]: &&[f64; 2]| {
            x.is_finite() && y.is_finite() && y > 0.0 && (x > 0.0 || !log)
        };
        points.iter().filter(is_seen).map(|&[x, y]| (x, y))
    }

    /// The least and the largest of all coordinates along an axis.
    fn range(&self, of: impl Fn((f64, f64)) -> f64) -> Option<Range<f64>> {
        let mut range: Option<Range<f64>> = None;
        let all = self.series.iter().flat_map(|s| [&s.points, &s.line]);
        for x in all.flat_map(|points| self.seen(points)).map(of) {
            let known = range.unwrap_or(x..x);
            range = Some(known.start.min(x)..known.end.max(x));
        }
        range
    }

    fn on<B, X>(
        &self,
        area: &DrawingArea<B, Shift>,
        across: X,
        label: &dyn Fn(&f64) -> String,
    ) -> Result<(), Fault<B>>
    where
        B: DrawingBackend,
        B::ErrorType: 'static,
        X: AsRangedCoord<Value = f64>,
        X::CoordDescType: Ranged<ValueType = f64> + ValueFormatter<f64>,
    {
        let along = self.range(|p| p.1).unwrap_or(0.1..1.0);
        // Names stand where lines fall off; lines that do not need room above them.
        let room = if self.log_across { 1.5 } else { ROOM };
        let along = along.start / 1.5..along.end * room;
        let mut chart = ChartBuilder::on(area)
            .margin(12)
            .x_label_area_size(42)
            .y_label_area_size(66)
            .build_cartesian_2d(across, along.log_scale())?;
        chart
            .configure_mesh()
            .x_desc(self.across)
            .y_desc(self.along)
            .x_labels(8)
            .y_labels(8)
            .x_label_formatter(label)
            .y_label_formatter(&|y| short(*y))
            .draw()?;
        for (series, color) in self.series.iter().zip(COLORS.into_iter().cycle()) {
            let points = self.seen(&series.points);
            chart.draw_series(points.map(|p| Circle::new(p, 2, color.mix(0.5).filled())))?;
            let line = LineSeries::new(self.seen(&series.line), color.stroke_width(2));
            chart
                .draw_series(line)?
                .label(series.name.as_str())
                .legend(move |(x, y)| {
                    PathElement::new([(x, y), (x + 18, y)], color.stroke_width(2))
                });
        }
        chart
            .configure_series_labels()
            .position(self.names.clone())
            .border_style(RGBColor(150, 150, 150))
            // Lines that run below it are seen.
            .background_style(WHITE.mix(0.4))
            .draw()
    }
}

/// A chart that stands beside another one.
struct Half<'a>(&'a Chart<'a>);

impl Picture for Chart<'_> {
    const SIZE: (u32, u32) = (900, 480);

    fn draw<B: DrawingBackend>(&self, area: &DrawingArea<B, Shift>) -> Result<(), Fault<B>>
    where
        B::ErrorType: 'static,
    {
        self.draw_on(area)
    }
}

impl Picture for Half<'_> {
    const SIZE: (u32, u32) = (500, 400);

    fn draw<B: DrawingBackend>(&self, area: &DrawingArea<B, Shift>) -> Result<(), Fault<B>>
    where
        B::ErrorType: 'static,
    {
        self.0.draw_on(area)
    }
}

/// A number at an axis that is not logarithmic.
fn plain(x: f64) -> String {
    format!("{x:.1}").trim_end_matches(".0").to_owned()
}

/// A number at an axis.
fn short(x: f64) -> String {
    if (0.001..100_000.0).contains(&x) {
        let digits = if x < 0.01 {
            3
        } else if x < 0.1 {
            2
        } else {
            usize::from(x < 1.0)
        };
        format!("{x:.digits$}")
    } else {
        format!("{x:.0e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_can_be_drawn_is_drawn_and_names_are_no_markup() {
        let series = |name: &str, points: Vec<[f64; 2]>| Series {
            name: name.to_owned(),
            line: points.clone(),
            points,
        };
        let chart = |log_across| Chart {
            across: "<x>",
            along: "y",
            log_across,
            names: SeriesLabelPosition::UpperLeft,
            series: vec![
                series("<b>&", vec![[1.0, 2.0], [10.0, 0.5], [f64::NAN, 1.0]]),
                series("none", vec![[0.0, 3.0], [5.0, -1.0]]),
            ],
        };
        let [log, plain] = [true, false].map(|log| chart(log).svg().unwrap());
        assert_eq!(log.matches("<circle").count(), 2, "{log}");
        assert_eq!(plain.matches("<circle").count(), 3, "0 has no logarithm");
        for svg in [log, plain] {
            assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
            assert!(!svg.contains("<b>") && !svg.contains("<x>"), "{svg}");
            assert!(svg.contains("&lt;b&gt;&amp;"), "{svg}");
            assert!(!svg.contains("http"), "{svg}");
        }
        let nothing = Chart {
            series: Vec::new(),
            ..chart(true)
        };
        assert!(nothing.svg().is_ok());
    }

    #[test]
    fn axes_have_short_numbers() {
        let texts = [0.0001, 0.005, 0.05, 0.5, 5.0, 5e4, 2e6].map(short);
        assert_eq!([0.5, 2.0, 15.0].map(plain), ["0.5", "2", "15"]);
        assert_eq!(texts, ["1e-4", "0.005", "0.05", "0.5", "5", "50000", "2e6"]);
    }
}
