//! Durations of the last frames and their graph in the panel.

use egui::{Color32, Pos2, Rect, Sense, Stroke, Ui, Vec2};
use std::collections::VecDeque;
use std::time::Duration;

/// Number of frames in the graph.
const FRAMES: usize = 180;

/// Frame duration at 60 frames per second \[ms\].
const TARGET: f32 = 1000.0 / 60.0;

/// Colors of the time for cuts and of the remaining time.
pub(super) const CUTS: Color32 = Color32::from_rgb(222, 92, 66);
pub(super) const REST: Color32 = Color32::from_rgb(96, 132, 180);

/// Durations of the last frames \[ms\].
#[derive(Debug, Clone, Default)]
pub(super) struct FrameTimes {
    /// Duration of each frame, and of its cuts.
    frames: VecDeque<[f32; 2]>,
    /// Duration of a redraw, exponentially smoothed.
    redraw: f32,
}

impl FrameTimes {
    /// Adds the duration of a frame and of its cuts.
    pub(super) fn push(&mut self, frame: Duration, cuts: Duration) {
        if self.frames.len() == FRAMES {
            self.frames.pop_front();
        }
        let all = frame.max(cuts);
        self.frames.push_back([all, cuts].map(milliseconds));
    }

    /// Adds the duration of a redraw.
    pub(super) fn add_redraw(&mut self, time: Duration) {
        let time = milliseconds(time);
        self.redraw = if self.redraw == 0.0 {
            time
        } else {
            0.9 * self.redraw + 0.1 * time
        };
    }

    /// Returns the smoothed duration of a redraw \[ms\].
    pub(super) fn redraw(&self) -> f32 {
        self.redraw
    }

    /// Returns mean and maximum duration of the last frames \[ms\].
    pub(super) fn summary(&self) -> [f32; 2] {
        let (mut sum, mut count, mut most) = (0.0, 0.0, 0.0_f32);
        for [all, _] in &self.frames {
            (sum, count, most) = (sum + all, count + 1.0, most.max(*all));
        }
        [sum / f32::max(count, 1.0), most]
    }

    /// Draws the graph.
    pub(super) fn show(&self, ui: &mut Ui) {
        let size = Vec2::new(ui.available_width(), 64.0);
        let (area, _) = ui.allocate_exact_size(size, Sense::hover());
        let painter = ui.painter_at(area);
        painter.rect_filled(area, 3.0, ui.visuals().extreme_bg_color);
        let [_, most] = self.summary();
        let top = most.max(TARGET * 1.25);
        let y = |time: f32| area.bottom() - area.height() * time / top;
        let count = u16::try_from(FRAMES).map_or(1.0, f32::from);
        let width = area.width() / count;
        let mut x = area.right() - width * u16::try_from(self.frames.len()).map_or(0.0, f32::from);
        for [all, cuts] in &self.frames {
            let bar = |from: f32, to: f32| {
                let [from, to] = [from, to].map(y);
                Rect::from_min_max(Pos2::new(x, to), Pos2::new(x + width.max(1.0), from))
            };
            painter.rect_filled(bar(0.0, *all), 0.0, REST);
            if *cuts > 0.0 {
                painter.rect_filled(bar(0.0, *cuts), 0.0, CUTS);
            }
            x += width;
        }
        let goal = Stroke::new(1.0, ui.visuals().weak_text_color());
        painter.hline(area.x_range(), y(TARGET), goal);
    }
}

fn milliseconds(time: Duration) -> f32 {
    time.as_secs_f32() * 1e3
}
