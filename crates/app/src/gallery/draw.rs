//! Draws a figure as one image.

use super::figure::{Panel, Row};
use incise_render::{
    Background, BodyView, Camera, Color, DrawList, FigureGrid, Image, Line, Offscreen, Overlay,
    RenderError, Renderer, View, Wireframe,
};

/// Size of the mark of a point [panel sides].
const MARK: f64 = 0.022;

/// Draws figures whose panels have one size.
pub(super) struct FigureRenderer<'a> {
    renderer: &'a Renderer,
    offscreen: Offscreen,
    side: u32,
}

impl<'a> FigureRenderer<'a> {
    /// Creates a renderer for panels of `side` by `side` pixels.
    pub(super) fn new(renderer: &'a Renderer, side: u32) -> Result<Self, RenderError> {
        Ok(Self {
            renderer,
            offscreen: Offscreen::new(renderer, side, side)?,
            side,
        })
    }

    /// Draws all panels of a figure with their labels.
    pub(super) fn figure(&self, rows: &[Row]) -> Result<Image, RenderError> {
        let count = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
        let columns = rows.iter().map(|row| row.panels.len()).max().unwrap_or(0);
        let panel = [self.side; 2];
        let mut sheet = FigureGrid::new(panel, count(columns), count(rows.len()))?;
        for (r, row) in (0..).zip(rows) {
            sheet.title(r, &row.title);
            for (c, panel) in (0..).zip(&row.panels) {
                sheet.put([c, r], &self.panel(panel)?, &panel.label);
            }
        }
        Ok(sheet.into_image())
    }

    fn panel(&self, panel: &Panel) -> Result<Image, RenderError> {
        let views = panel.shown.iter();
        let views = views.map(|shown| {
            let color = |t| shown.color(t);
            let mut view = BodyView::from_surface(self.renderer, &shown.surface, color)?;
            if shown.checkers > 0.0 {
                view.set_checkers(self.renderer, &shown.surface, shown.checkers)?;
            }
            Ok(view)
        });
        let views: Vec<BodyView> = views.collect::<Result<_, RenderError>>()?;
        let marks = panel.points.iter().map(|&p| self.mark(&panel.camera, p));
        let lines: Vec<Line> = panel.lines.iter().copied().chain(marks).collect();
        let overlay = Overlay::new(self.renderer, &panel.sheets, &lines)?;
        let view = View {
            background: Background::Plain(Color::rgb(255, 255, 255)),
            wireframe: Some(Wireframe::default()),
            ..View::from_camera(panel.camera)
        };
        let content = DrawList {
            bodies: &views.iter().collect::<Vec<_>>(),
            overlays: &[&overlay],
        };
        self.offscreen.render(self.renderer, &view, &content)
    }

    /// Returns a square around a point, as a line as wide as it is long.
    fn mark(&self, camera: &Camera, point: [f32; 3]) -> Line {
        let [right, _, _] = camera.axes();
        let half = right * (MARK * camera.distance * (camera.field_of_view / 2.0).tan());
        let at = incise_mesh::geometry::to_f64(point);
        let ends = [at - half, at + half].map(incise_mesh::geometry::to_f32);
        #[expect(clippy::cast_possible_truncation, reason = "a few pixels")]
        let width = (MARK * f64::from(self.side)) as f32;
        Line {
            ends,
            color: super::figure::POINT,
            width,
        }
    }
}
