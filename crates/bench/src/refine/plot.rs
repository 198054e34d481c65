//! Run time against quality as a picture.

use super::tradeoff::Row;
use crate::picture::{FONT, Fault, Picture};
use plotters::backend::DrawingBackend;
use plotters::chart::ChartBuilder;
use plotters::coord::Shift;
use plotters::coord::combinators::IntoLogRange;
use plotters::drawing::DrawingArea;
use plotters::element::{Circle, EmptyElement, PathElement, Text};
use plotters::series::LineSeries;
use plotters::style::{Color, IntoFont, RGBAColor, RGBColor, WHITE};

const PAPER: RGBColor = RGBColor(200, 60, 30);
const DEFAULT: RGBColor = RGBColor(20, 90, 180);

/// The rows of all sections: angles above, lengths below, over the time of a thousand triangles.
pub(super) struct Chart<'a>(pub(super) &'a [Row]);

impl Picture for Chart<'_> {
    const SIZE: (u32, u32) = (1000, 1000);

    fn draw<B: DrawingBackend>(&self, area: &DrawingArea<B, Shift>) -> Result<(), Fault<B>>
    where
        B::ErrorType: 'static,
    {
        let (above, below) = area.split_vertically(Self::SIZE.1 / 2);
        let name = "5th percentile of the angles [degrees]";
        panel(&above, self.0, name, |row| row.angle_5)?;
        let name = "error of the mean edge length";
        panel(&below, self.0, name, |row| row.edge_error)
    }
}

/// One quantity of all rows, a line for each method and level.
fn panel<B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    rows: &[Row],
    name: &str,
    value: impl Fn(&Row) -> f64,
) -> Result<(), Fault<B>>
where
    B::ErrorType: 'static,
{
    let time = |row: &Row| row.ms_a_thousand_triangles;
    let seen = rows
        .iter()
        .filter(|row| time(row) > 0.0 && value(row).is_finite());
    let [mut low, mut high, mut top] = [f64::INFINITY, 0.0, 0.0];
    for row in seen.clone() {
        low = time(row).min(low);
        high = time(row).max(high);
        top = value(row).max(top);
    }
    if low > high {
        // Nothing was measured.
        (low, high, top) = (0.1, 1.0, 1.0);
    }
    let mut chart = ChartBuilder::on(area)
        .margin(15)
        .x_label_area_size(45)
        .y_label_area_size(60)
        .build_cartesian_2d((low / 1.3..high * 1.5).log_scale(), 0.0..top * 1.1)?;
    chart
        .configure_mesh()
        .x_desc("ms for a thousand triangles")
        .y_desc(name)
        .draw()?;
    let mut lines: Vec<(&str, f64)> = seen.clone().map(|row| (row.method, row.level)).collect();
    lines.dedup();
    for (k, &(method, level)) in lines.iter().enumerate() {
        let color = shade(method, k / 2, lines.len().div_ceil(2));
        let points: Vec<(f64, f64, f64)> = (seen.clone())
            .filter(|row| row.method == method && row.level == level)
            .map(|row| (time(row), value(row), row.bound))
            .collect();
        let line = points.iter().map(|&(x, y, _)| (x, y));
        chart
            .draw_series(LineSeries::new(line, color.stroke_width(2)))?
            .label(format!("{method}, z {level:.2}"))
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 20, y)], color.stroke_width(2)));
        chart.draw_series(points.iter().map(|&(x, y, bound)| {
            EmptyElement::at((x, y))
                + Circle::new((0, 0), 3, color.filled())
                + Text::new(bound.to_string(), (5, 4), (FONT, 12).into_font())
        }))?;
    }
    chart
        .configure_series_labels()
        .border_style(RGBColor(0, 0, 0))
        .background_style(WHITE.mix(0.8))
        .draw()
}

/// The color of a method, paler for every level after the first.
fn shade(method: &str, level: usize, levels: usize) -> RGBAColor {
    let color = if method == "paper" { PAPER } else { DEFAULT };
    color.mix(1.0 - 0.7 * level as f64 / levels as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture;

    #[test]
    fn every_row_is_a_point_in_both_panels() {
        let row = |method, bound: f64, ms_a_thousand_triangles, level| Row {
            method,
            bound,
            level,
            ms_a_thousand_triangles,
            angle_5: 10.0 + bound,
            edge_error: 0.5 / bound,
            ..Row::default()
        };
        let rows = [
            row("paper", 1.0, 2.0, 1.0),
            row("paper", 2.0, 4.0, 1.0),
            row("default", 20.0, 0.3, 1.0),
            row("paper", 1.0, 2.0, 0.5),
            row("paper", 2.0, f64::NAN, 0.5),
        ];
        let text = picture::svg(&Chart(&rows)).unwrap();
        assert_eq!(text.matches("<circle").count(), 8, "one has no time");
        for name in ["paper, z 1.00", "default, z 1.00", "paper, z 0.50"] {
            assert_eq!(text.matches(name).count(), 2, "{name}");
        }
        let text = picture::svg(&Chart(&[])).unwrap();
        assert!(text.ends_with("</svg>\n"), "no rows, an empty picture");
    }
}
