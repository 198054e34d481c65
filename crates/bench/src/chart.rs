//! Charts of series over logarithmic or linear axes, for the report and for plots.

use crate::picture::{FONT, Fault, Image};
use plotters::backend::DrawingBackend;
use plotters::chart::{ChartBuilder, SeriesLabelPosition};
use plotters::coord::Shift;
use plotters::coord::combinators::IntoLogRange;
use plotters::coord::ranged1d::{AsRangedCoord, ValueFormatter};
use plotters::drawing::DrawingArea;
use plotters::element::{Circle, EmptyElement, PathElement, Text};
use plotters::prelude::Ranged;
use plotters::series::LineSeries;
use plotters::style::{Color, IntoFont, RGBColor, WHITE};
use std::ops::Range;

/// Colors of series, distinct in print too.
const COLORS: [RGBColor; 8] = [
    RGBColor(20, 90, 180),
    RGBColor(200, 60, 30),
    RGBColor(60, 150, 90),
    RGBColor(120, 60, 170),
    RGBColor(20, 20, 20),
    RGBColor(200, 140, 20),
    RGBColor(20, 150, 170),
    RGBColor(190, 80, 140),
];

/// Color of levels.
const LEVEL: RGBColor = RGBColor(110, 110, 110);

/// Top of the y axis relative to the largest value, where the legend is above all lines.
const HEADROOM: f64 = 12.0;

/// Points of one color.
#[derive(Debug, Clone, Default)]
pub(crate) struct Series {
    pub(crate) name: String,
    pub(crate) points: Vec<[f64; 2]>,
    /// The corners of the line.
    pub(crate) line: Vec<[f64; 2]>,
    /// Texts beside points.
    pub(crate) labels: Vec<([f64; 2], String)>,
}

impl Series {
    /// Returns a series with a line through all points, by x.
    pub(crate) fn line(name: String, mut points: Vec<[f64; 2]>) -> Self {
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        Self {
            name,
            line: points.clone(),
            points,
            labels: Vec::new(),
        }
    }
}

/// A horizontal line over the whole chart, with a text at its right end.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Level {
    pub(crate) y: f64,
    pub(crate) label: String,
}

/// A chart with a logarithmic y axis.
#[derive(Debug)]
pub(crate) struct Chart<'a> {
    /// Empty for none.
    pub(crate) title: String,
    pub(crate) x: &'a str,
    pub(crate) y: &'a str,
    pub(crate) log_x: bool,
    pub(crate) legend: SeriesLabelPosition,
    pub(crate) series: Vec<Series>,
    /// Levels that series are compared with.
    pub(crate) levels: Vec<Level>,
}

impl Image for Chart<'_> {
    fn draw<B: DrawingBackend>(&self, area: &DrawingArea<B, Shift>) -> Result<(), Fault<B>>
    where
        B::ErrorType: 'static,
    {
        let x = self.range(0).unwrap_or(0.1..1.0);
        if self.log_x {
            let x = x.start / 1.5..x.end * 1.5;
            self.draw_over(area, x.clone().log_scale(), x, &|x| log_label(*x))
        } else {
            let margin = 0.03 * (x.end - x.start).max(1.0);
            let x = x.start - margin..x.end + margin;
            self.draw_over(area, x.clone(), x, &|x| label(*x))
        }
    }
}

impl Chart<'_> {
    /// Returns the points that the axes can show: logarithms need positive numbers.
    fn drawn<'p>(&self, points: &'p [[f64; 2]]) -> impl Iterator<Item = (f64, f64)> + use<'p> {
        let log_x = self.log_x;
        let is_drawn = move |&&[x, y]: &&[f64; 2]| {
            x.is_finite() && y.is_finite() && y > 0.0 && (x > 0.0 || !log_x)
        };
        points.iter().filter(is_drawn).map(|&[x, y]| (x, y))
    }

    /// Returns the range of all coordinates along an axis.
    fn range(&self, axis: usize) -> Option<Range<f64>> {
        let mut range: Option<Range<f64>> = None;
        let all = self.series.iter().flat_map(|s| [&s.points, &s.line]);
        let values = all.flat_map(|points| self.drawn(points));
        let values = values.map(|(x, y)| [x, y][axis]);
        let levels = self.levels.iter().map(|level| level.y);
        let levels = levels.filter(|y| axis == 1 && y.is_finite() && *y > 0.0);
        for value in values.chain(levels) {
            let known = range.unwrap_or(value..value);
            range = Some(known.start.min(value)..known.end.max(value));
        }
        range
    }

    fn draw_over<B, X>(
        &self,
        area: &DrawingArea<B, Shift>,
        x: X,
        ends: Range<f64>,
        x_label: &dyn Fn(&f64) -> String,
    ) -> Result<(), Fault<B>>
    where
        B: DrawingBackend,
        B::ErrorType: 'static,
        X: AsRangedCoord<Value = f64>,
        X::CoordDescType: Ranged<ValueType = f64> + ValueFormatter<f64>,
    {
        let y = self.range(1).unwrap_or(0.1..1.0);
        let headroom = if self.log_x { 1.5 } else { HEADROOM };
        let y = y.start / 1.5..y.end * headroom;
        let mut builder = ChartBuilder::on(area);
        builder
            .margin(12)
            .x_label_area_size(42)
            .y_label_area_size(66);
        if !self.title.is_empty() {
            builder.caption(&self.title, (FONT, 18));
        }
        let mut chart = builder.build_cartesian_2d(x, y.log_scale())?;
        chart
            .configure_mesh()
            .x_desc(self.x)
            .y_desc(self.y)
            .x_labels(8)
            .y_labels(8)
            .x_label_formatter(x_label)
            .y_label_formatter(&|y| log_label(*y))
            .draw()?;
        for (series, color) in self.series.iter().zip(COLORS.into_iter().cycle()) {
            let points = self.drawn(&series.points);
            chart.draw_series(points.map(|p| Circle::new(p, 2, color.mix(0.5).filled())))?;
            let line = LineSeries::new(self.drawn(&series.line), color.stroke_width(2));
            chart
                .draw_series(line)?
                .label(series.name.as_str())
                .legend(move |(x, y)| {
                    PathElement::new([(x, y), (x + 18, y)], color.stroke_width(2))
                });
            chart.draw_series(series.labels.iter().map(|(p, label)| {
                EmptyElement::at((p[0], p[1]))
                    + Circle::new((0, 0), 3, color.filled())
                    + Text::new(label.clone(), (5, -4), (FONT, 11).into_font())
            }))?;
        }
        for level in self.levels.iter().filter(|level| level.y > 0.0) {
            let line = [(ends.start, level.y), (ends.end, level.y)];
            chart.draw_series(LineSeries::new(line, LEVEL.stroke_width(1)))?;
            let text = Text::new(level.label.clone(), (-110, -13), (FONT, 11).into_font());
            let label = EmptyElement::at((ends.end, level.y)) + text;
            chart.draw_series([label])?;
        }
        chart
            .configure_series_labels()
            .position(self.legend.clone())
            .border_style(RGBColor(150, 150, 150))
            // Lines below the legend stay visible.
            .background_style(WHITE.mix(0.4))
            .draw()
    }
}

/// Charts one below the other.
#[cfg(any(test, feature = "reference"))]
pub(crate) struct Stack<'a>(pub(crate) &'a [Chart<'a>]);

#[cfg(any(test, feature = "reference"))]
impl Image for Stack<'_> {
    fn draw<B: DrawingBackend>(&self, area: &DrawingArea<B, Shift>) -> Result<(), Fault<B>>
    where
        B::ErrorType: 'static,
    {
        let areas = area.split_evenly((self.0.len(), 1));
        self.0.iter().zip(&areas).try_for_each(|(c, a)| c.draw(a))
    }
}

/// Formats a number at a linear axis.
fn label(x: f64) -> String {
    format!("{x:.1}").trim_end_matches(".0").to_owned()
}

/// Formats a number at a logarithmic axis.
fn log_label(x: f64) -> String {
    match x {
        x if !(0.001..100_000.0).contains(&x) => format!("{x:.0e}"),
        x if x < 0.01 => format!("{x:.3}"),
        x if x < 0.1 => format!("{x:.2}"),
        x => format!("{x:.*}", usize::from(x < 1.0)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture;

    #[test]
    fn drawable_points_are_drawn_and_names_are_escaped() {
        let series = |name: &str, points: Vec<[f64; 2]>| Series {
            labels: points
                .iter()
                .take(1)
                .map(|p| (*p, "first".to_owned()))
                .collect(),
            ..Series::line(name.to_owned(), points)
        };
        let chart = |log_x| Chart {
            title: String::new(),
            x: "<x>",
            y: "y",
            log_x,
            legend: SeriesLabelPosition::UpperLeft,
            series: vec![
                series("<b>&", vec![[1.0, 2.0], [10.0, 0.5], [f64::NAN, 1.0]]),
                Series::line("none".to_owned(), vec![[0.0, 3.0], [5.0, -1.0]]),
            ],
            levels: vec![Level {
                y: 1e-6,
                label: "below all <points>".to_owned(),
            }],
        };
        let size = (900, 480);
        let [log, linear] = [true, false].map(|log_x| picture::svg(size, &chart(log_x)).unwrap());
        assert_eq!(
            log.matches("<circle").count(),
            3,
            "two points and a label: {log}"
        );
        assert_eq!(linear.matches("<circle").count(), 4, "0 has no logarithm");
        for svg in [log, linear] {
            assert!(!svg.contains("<b>") && !svg.contains("<x>"), "{svg}");
            assert!(svg.contains("&lt;b&gt;&amp;"), "{svg}");
            assert!(svg.contains("below all &lt;points&gt;"), "{svg}");
            assert!(svg.contains("1e-6"), "the axis reaches the level: {svg}");
        }
        let nothing = Chart {
            series: Vec::new(),
            ..chart(true)
        };
        let stack = Stack(&[nothing, chart(true)]);
        assert!(picture::svg(size, &stack).unwrap().ends_with("</svg>\n"));
    }

    #[test]
    fn axes_have_short_numbers() {
        let texts = [0.0001, 0.005, 0.05, 0.5, 5.0, 5e4, 2e6].map(log_label);
        assert_eq!(texts, ["1e-4", "0.005", "0.05", "0.5", "5", "50000", "2e6"]);
        assert_eq!([0.5, 2.0, 15.0].map(label), ["0.5", "2", "15"]);
    }
}
