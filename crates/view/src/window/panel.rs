//! What stands beside the picture.

mod frames;

use super::{Look, Open, marks, picture};
use crate::command::{Method, Settings};
use crate::keys::{Action, KEYS, MOUSE};
use crate::pointer::Tool;
use crate::session::{BladePlace, Session};
use egui::{Align2, Button, Color32, Grid, RichText, ScrollArea, Slider, Ui};
use incise_refine::RefinementLevel;
use winit::window::Window;

/// How wide the panel is \[points\].
pub(super) const WIDTH: f32 = 292.0;

/// Most substeps and iterations that can be chosen.
pub(super) const MOST: u32 = 64;

const REFUSED: Color32 = Color32::from_rgb(176, 40, 30);

/// What was asked for in the panel.
pub(super) struct Asked {
    pub(super) actions: Vec<Action>,
    pub(super) settings: Settings,
}

impl Asked {
    pub(super) fn of(session: &Session) -> Self {
        Self {
            actions: Vec::new(),
            settings: *session.settings(),
        }
    }
}

/// A panel for a window.
pub(super) fn state(window: &Window) -> egui_winit::State {
    let context = egui::Context::default();
    context.set_theme(egui::Theme::Light);
    let scale = window.scale_factor();
    let id = egui::ViewportId::ROOT;
    egui_winit::State::new(context, id, window, Some(narrow(scale)), None, None)
}

/// Shows all of it.
pub(super) fn show(ui: &mut Ui, open: &Open, asked: &mut Asked) {
    if open.look.panel {
        egui::Panel::right("panel")
            .resizable(false)
            .exact_size(WIDTH)
            .show(ui, |ui| {
                ScrollArea::vertical().show(ui, |ui| contents(ui, open, asked));
            });
    }
    if !open.look.panel {
        status(ui, open);
    }
    marks::show(ui, open);
    if open.look.help {
        help(ui);
    }
}

fn contents(ui: &mut Ui, open: &Open, asked: &mut Asked) {
    let session = &open.session;
    ui.add_space(6.0);
    ui.horizontal_wrapped(|ui| {
        for tool in Tool::ALL {
            let button = ui.selectable_label(open.pointer.tool == tool, tool.name());
            if button.clicked() {
                asked.actions.push(Action::Take(tool));
            }
        }
    });
    ui.horizontal_wrapped(|ui| {
        let mut button = |ui: &mut Ui, text: &str, action: Action, is_on: bool| {
            if ui.add_enabled(is_on, Button::new(text)).clicked() {
                asked.actions.push(action);
            }
        };
        let pause = if open.paused { "Go on" } else { "Pause" };
        button(ui, pause, Action::Pause, true);
        button(ui, "Step", Action::Step, true);
        button(ui, "Reset", Action::Reset, true);
        button(ui, "Undo", Action::Undo, session.undoable() > 0);
        button(ui, "Redo", Action::Redo, session.redoable() > 0);
        button(ui, "Save", Action::Save, true);
        button(ui, "Record", Action::SaveRecording, true);
        button(ui, "Fit", Action::Fit, true);
        button(ui, "Keys ?", Action::Help, true);
    });
    tell(ui, open);
    section(ui, "Cut", |ui| cut(ui, &mut asked.settings));
    section(ui, "Body", |ui| body(ui, &mut asked.settings));
    section(ui, "Look", |ui| look(ui, open, &mut asked.actions));
    section(ui, "Frames", |ui| frames::show(ui, open));
}

fn section(ui: &mut Ui, name: &str, contents: impl FnOnce(&mut Ui)) {
    egui::CollapsingHeader::new(RichText::new(name).strong())
        .default_open(true)
        .show_unindented(ui, contents);
}

/// The same in a corner of the picture, where there is no panel.
fn status(ui: &Ui, open: &Open) {
    egui::Area::new(egui::Id::unique("status"))
        .anchor(Align2::LEFT_BOTTOM, [8.0, -8.0])
        .interactable(false)
        .show(ui.ctx(), |ui| {
            // Else it stays as narrow as it was with nothing to tell.
            ui.set_min_width(WIDTH);
            tell(ui, open);
        });
}

/// What there is to tell.
fn tell(ui: &mut Ui, open: &Open) {
    let mut line = |text: &str, is_refusal: bool| {
        let text = RichText::new(text);
        ui.label(if is_refusal {
            text.color(REFUSED)
        } else {
            text
        });
    };
    if let Some(notice) = open.session.notice() {
        line(&notice.text, notice.is_refusal);
    }
    if let Some((text, is_refusal)) = &open.told {
        line(text, *is_refusal);
    }
    if let Some((_, place)) = open.session.held_blade() {
        match place {
            BladePlace::Begun => line(
                "the blade was put into the body: take it out, then move it right through",
                false,
            ),
            _ if open.paused => line("paused: the blade cuts when it is let go", false),
            BladePlace::Outside => {}
            BladePlace::Inside => line("the blade is inside: it cuts when it comes out", false),
        }
    }
    if open.replay.is_some() {
        line("replaying", false);
    }
}

fn cut(ui: &mut Ui, settings: &mut Settings) {
    ui.horizontal(|ui| {
        ui.label("method");
        ui.selectable_value(&mut settings.method, Method::Exact, "exact");
        ui.selectable_value(&mut settings.method, Method::Rebuild, "paper's");
    });
    ui.label("caps: edges are so many times the rim's");
    ui.horizontal_wrapped(|ui| {
        for level in RefinementLevel::FIVE {
            let name = match level {
                RefinementLevel::Coarser2 => "2",
                RefinementLevel::Coarser1_5 => "1.5",
                RefinementLevel::Original => "1",
                RefinementLevel::Finer1_5 => "1/1.5",
                _ => "1/2",
            };
            ui.selectable_value(&mut settings.level, level, name)
                .on_hover_text(level.to_string());
        }
    });
    let mut z = settings.level.z();
    let slider = Slider::new(&mut z, 0.05..=20.0).logarithmic(true).text("z");
    if ui.add(slider).changed() {
        settings.level = RefinementLevel::Z(z);
    }
}

fn body(ui: &mut Ui, settings: &mut Settings) {
    ui.add(Slider::new(&mut settings.substeps, 1..=MOST).text("substeps"));
    ui.add(Slider::new(&mut settings.iterations, 1..=MOST).text("iterations"));
    ui.add(Slider::new(&mut settings.stretch, 0.0..=1.0).text("stiffness"));
    optional(ui, "bending", &mut settings.bending, 0.2, 1.0)
        .on_hover_text("a change makes the body anew where it is, at rest");
    optional(ui, "volume", &mut settings.volume, 1.0, 3.0)
        .on_hover_text("how many times its rest volume a piece strives for");
    optional(ui, "struts", &mut settings.struts, 1.0, 1.0).on_hover_text(
        "how many struts through the body a vertex has, so that it does not sink in; a change makes the body anew where it is, at rest",
    );
    ui.add(Slider::new(&mut settings.damping, 0.0..=10.0).text("damping [1/s]"));
    ui.horizontal(|ui| {
        ui.checkbox(&mut settings.gravity, "gravity");
        ui.checkbox(&mut settings.ground, "ground");
        ui.checkbox(&mut settings.contacts, "contacts");
    });
}

/// A number that may be left out.
fn optional(
    ui: &mut Ui,
    name: &str,
    value: &mut Option<f32>,
    usual: f32,
    most: f32,
) -> egui::Response {
    let row = ui.horizontal(|ui| {
        let mut is_on = value.is_some();
        ui.checkbox(&mut is_on, "");
        let mut number = value.unwrap_or(usual);
        ui.add_enabled(is_on, Slider::new(&mut number, 0.0..=most).text(name));
        *value = is_on.then_some(number);
    });
    row.response
}

fn look(ui: &mut Ui, open: &Open, actions: &mut Vec<Action>) {
    let Look {
        wireframe,
        pieces,
        caps,
        batches,
        ..
    } = open.look;
    let choices = [
        ("edges", wireframe, Action::Wireframe),
        ("pieces", pieces, Action::PieceColors),
        ("caps", caps, Action::CapColors),
        ("batches", batches, Action::Batches),
    ];
    ui.horizontal(|ui| {
        for (name, is_on, action) in choices {
            let mut now = is_on;
            if ui.checkbox(&mut now, name).changed() {
                actions.push(action);
            }
        }
    });
    if batches {
        legend(ui, &open.session);
    }
}

/// The colors of the batches and how many constraints each has.
fn legend(ui: &mut Ui, session: &Session) {
    let body = session.scene().body(session.body());
    ui.horizontal_wrapped(|ui| {
        for (i, batch) in body.solver().stretch().batches().iter().enumerate() {
            let [r, g, b, _] = picture::color_of_batch(i).0;
            let color = Color32::from_rgb(r, g, b);
            ui.label(RichText::new(batch.len().to_string()).small().color(color));
        }
    });
}

fn help(ui: &Ui) {
    egui::Window::new("Keys")
        .anchor(Align2::CENTER_CENTER, [-WIDTH / 2.0, 0.0])
        .resizable(false)
        .collapsible(false)
        .show(ui.ctx(), |ui| {
            Grid::new("keys")
                .num_columns(4)
                .striped(true)
                .show(ui, |ui| {
                    let half = KEYS.len().div_ceil(2);
                    for (i, left) in KEYS[..half].iter().enumerate() {
                        for key in [Some(left), KEYS.get(half + i)].into_iter().flatten() {
                            ui.monospace(key.name);
                            ui.label(key.about);
                        }
                        ui.end_row();
                    }
                });
            ui.separator();
            Grid::new("mouse").num_columns(2).show(ui, |ui| {
                for (button, about) in MOUSE {
                    ui.monospace(button);
                    ui.label(about);
                    ui.end_row();
                }
            });
        });
}

#[expect(clippy::cast_possible_truncation, reason = "pixels")]
pub(super) fn narrow(x: f64) -> f32 {
    x as f32
}
