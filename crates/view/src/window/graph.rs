//! How long frames took.

use egui::{Color32, Pos2, Rect, Sense, Stroke, Ui, Vec2};
use std::collections::VecDeque;
use std::time::Duration;

/// How many frames are shown.
const FRAMES: usize = 180;

/// What a frame may take at 60 a second \[ms\].
const GOAL: f32 = 1000.0 / 60.0;

/// The part that cuts took, and the rest.
pub(super) const CUTS: Color32 = Color32::from_rgb(222, 92, 66);
pub(super) const REST: Color32 = Color32::from_rgb(96, 132, 180);

/// Times of the last frames \[ms\].
#[derive(Debug, Clone, Default)]
pub(super) struct Times {
    /// The whole frame and, of it, cuts.
    frames: VecDeque<[f32; 2]>,
    /// A picture, smoothed.
    picture: f32,
}

impl Times {
    pub(super) fn push(&mut self, frame: Duration, cuts: Duration) {
        if self.frames.len() == FRAMES {
            self.frames.pop_front();
        }
        let all = frame.max(cuts);
        self.frames.push_back([all, cuts].map(milliseconds));
    }

    /// A picture with all that it shows took so long.
    pub(super) fn picture(&mut self, time: Duration) {
        let time = milliseconds(time);
        self.picture = if self.picture == 0.0 {
            time
        } else {
            0.9 * self.picture + 0.1 * time
        };
    }

    /// Time of a picture \[ms\].
    pub(super) fn of_picture(&self) -> f32 {
        self.picture
    }

    /// The mean of the last frames, and the longest \[ms\].
    pub(super) fn summary(&self) -> [f32; 2] {
        let (mut sum, mut count, mut most) = (0.0, 0.0, 0.0_f32);
        for [all, _] in &self.frames {
            (sum, count, most) = (sum + all, count + 1.0, most.max(*all));
        }
        [sum / f32::max(count, 1.0), most]
    }

    pub(super) fn show(&self, ui: &mut Ui) {
        let size = Vec2::new(ui.available_width(), 64.0);
        let (area, _) = ui.allocate_exact_size(size, Sense::hover());
        let painter = ui.painter_at(area);
        painter.rect_filled(area, 3.0, ui.visuals().extreme_bg_color);
        let [_, most] = self.summary();
        let top = most.max(GOAL * 1.25);
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
        painter.hline(area.x_range(), y(GOAL), goal);
    }
}

fn milliseconds(time: Duration) -> f32 {
    time.as_secs_f32() * 1e3
}
