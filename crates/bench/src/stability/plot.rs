//! Draws the stability map for `--plot`.

use super::map::{COMPLIANCES, Cell, RATES, RATIOS};
use crate::picture::{FONT, Fault, Image};
use plotters::backend::DrawingBackend;
use plotters::chart::ChartBuilder;
use plotters::coord::Shift;
use plotters::drawing::DrawingArea;
use plotters::element::{Rectangle, Text};
use plotters::style::{BLACK, Color, IntoFont, RGBColor};

/// Colors of cells within the bound, at no energy and at all of it.
const CALM: RGBColor = RGBColor(225, 240, 250);
const KEPT: RGBColor = RGBColor(20, 90, 180);
/// Color of cells above the bound.
const BROKEN: RGBColor = RGBColor(200, 60, 30);

/// Width and height of the picture \[px\].
pub(super) const SIZE: (u32, u32) = (1400, 560);

/// The cells and their bound, one panel per load.
pub(super) struct Map<'a> {
    pub(super) cells: &'a [Cell],
    pub(super) bound: f64,
}

impl Image for Map<'_> {
    fn draw<B: DrawingBackend>(&self, area: &DrawingArea<B, Shift>) -> Result<(), Fault<B>>
    where
        B::ErrorType: 'static,
    {
        let title =
            "largest energy of a swinging ribbon, relative to the start; red: above the bound";
        let below = area.titled(title, (FONT, 22))?;
        let panels = below.split_evenly((1, RATIOS.len()));
        for (area, ratio) in panels.iter().zip(RATIOS) {
            let of_ratio = self.cells.iter().filter(|cell| cell.ratio == ratio);
            panel(area, of_ratio, ratio, self.bound)?;
        }
        Ok(())
    }
}

/// The cells of one load.
fn panel<'a, B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    cells: impl Iterator<Item = &'a Cell> + Clone,
    ratio: f32,
    bound: f64,
) -> Result<(), Fault<B>>
where
    B::ErrorType: 'static,
{
    let x = f64::from(*COMPLIANCES.start()) - 0.5..f64::from(*COMPLIANCES.end()) + 0.5;
    let y = f64::from(*RATES.start()) / 2.0 - 0.25..f64::from(*RATES.end()) / 2.0 + 0.25;
    let mut chart = ChartBuilder::on(area)
        .caption(format!("load of {ratio:e} vertices"), (FONT, 18))
        .margin(12)
        .x_label_area_size(42)
        .y_label_area_size(52)
        .build_cartesian_2d(x, y)?;
    chart
        .configure_mesh()
        .disable_mesh()
        .x_desc("log10 of the compliance [m/N]")
        .y_desc("log10 of the steps a second")
        .draw()?;
    let corner = |cell: &Cell, side: f64| {
        let x = f64::from(cell.compliance) + 0.48 * side;
        (x, f64::from(cell.rate) / 2.0 + 0.24 * side)
    };
    chart.draw_series(cells.clone().map(|cell| {
        let corners = [corner(cell, -1.0), corner(cell, 1.0)];
        Rectangle::new(corners, shade(cell.energy, bound).filled())
    }))?;
    chart.draw_series(cells.map(|cell| {
        let style = (FONT, 9).into_font().color(&BLACK);
        let (x, y) = corner(cell, -0.8);
        Text::new(short(cell.energy), (x, y + 0.2), style)
    }))?;
    Ok(())
}

/// Formats two digits.
fn short(energy: f64) -> String {
    if energy < 10.0 {
        format!("{energy:.2}")
    } else {
        format!("{energy:.0e}")
    }
}

/// Returns the color of an energy: darker with more of it, another one above the bound.
fn shade(energy: f64, bound: f64) -> RGBColor {
    if energy > bound || energy.is_nan() {
        return BROKEN;
    }
    let part = energy.clamp(0.0, 1.0);
    let mix = |low: u8, high: u8| {
        let value = f64::from(low) + (f64::from(high) - f64::from(low)) * part * 0.7;
        value.round().clamp(0.0, 255.0)
    };
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped to a byte"
    )]
    let channel = |low: u8, high: u8| mix(low, high) as u8;
    RGBColor(
        channel(CALM.0, KEPT.0),
        channel(CALM.1, KEPT.1),
        channel(CALM.2, KEPT.2),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture;

    #[test]
    fn every_cell_is_drawn_and_broken_ones_are_red() {
        let cell = |ratio, compliance, energy| Cell {
            ratio,
            rate: 4,
            compliance,
            energy,
        };
        let cells = [
            cell(RATIOS[0], -3, 0.5),
            cell(RATIOS[1], -3, 1.0),
            cell(RATIOS[2], -4, 3e5),
            cell(RATIOS[2], -3, f64::INFINITY),
        ];
        let cells = &cells;
        let text = picture::svg(SIZE, &Map { cells, bound: 1.01 }).unwrap();
        assert_eq!(text.matches("#C83C1E").count(), 2, "two are broken");
        assert!(text.contains("0.50") && text.contains("3e5"), "numbers");
        assert!(text.contains("load of 1e6 vertices"), "a panel a load");
    }
}
