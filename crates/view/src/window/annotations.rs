//! Draws annotations over the body: the slice line, the held blade, and pins.

use super::OpenWindow;
use crate::session::BladeState;
use egui::{Color32, Stroke, Ui};
use incise_mesh::geometry::round_to_f32;

const LINE: Color32 = Color32::from_rgb(200, 48, 40);
const PIN: Color32 = Color32::from_rgb(36, 96, 180);

/// Draws the annotations.
pub(super) fn show(ui: &Ui, open: &OpenWindow) {
    let scale = f64::from(ui.ctx().pixels_per_point());
    let painter = ui.ctx().layer_painter(egui::LayerId::background());
    let point = |[x, y]: [f64; 2]| egui::Pos2::from([x / scale, y / scale].map(round_to_f32));
    let camera = open.orbit.window_camera();
    let project = |p: [f32; 3]| {
        let p = incise_mesh::geometry::to_f64(p);
        camera.project(p, open.orbit.size).map(point)
    };
    let held = open.session.held_vertex();
    for (v, p) in open.session.pins() {
        if let Some(at) = project(p) {
            let color = if held == Some(v) { LINE } else { PIN };
            painter.circle(at, 4.5, color, Stroke::new(1.5, Color32::WHITE));
        }
    }
    if let Some(ends) = open.pointer.slice_line() {
        let ends = ends.map(point);
        painter.line_segment(ends, Stroke::new(4.0, Color32::WHITE.gamma_multiply(0.6)));
        painter.line_segment(ends, Stroke::new(2.0, LINE));
    }
    if let Some(([[_, from], [_, to]], place)) = open.session.held_blade()
        && let (Some(from), Some(to)) = (project(from), project(to))
    {
        let color = match place {
            BladeState::Outside => PIN,
            BladeState::Inside | BladeState::StartedInside => LINE,
        };
        painter.line_segment([from, to], Stroke::new(2.0, color));
        painter.circle(to, 5.0, color, Stroke::new(1.5, Color32::WHITE));
    }
}
