//! The panel beside the view: tools, settings, display options, messages and help.

mod parameters;
mod statistics;

use super::{DisplayOptions, OpenWindow, annotations, scene_view};
use crate::command::Settings;
use crate::keys::{Action, KEYS, MOUSE};
use crate::pointer::Tool;
use crate::session::{BladeState, Session};
use egui::{Align2, Button, Color32, Grid, RichText, ScrollArea, Ui};
use incise_mesh::geometry::round_to_f32;
use incise_scene::BladeMode;
use winit::window::Window;

/// Width of the panel \[points\].
pub(super) const WIDTH: f32 = 292.0;

const ERROR: Color32 = Color32::from_rgb(176, 40, 30);

/// Actions and settings that the user requested in the panel.
pub(super) struct PanelRequests {
    pub(super) actions: Vec<Action>,
    pub(super) settings: Settings,
}

impl PanelRequests {
    /// Starts without requests.
    pub(super) fn new(session: &Session) -> Self {
        Self {
            actions: Vec::new(),
            settings: *session.settings(),
        }
    }
}

/// Creates the egui state of a window.
pub(super) fn state(window: &Window) -> egui_winit::State {
    let context = egui::Context::default();
    context.set_theme(egui::Theme::Light);
    let scale = window.scale_factor();
    let id = egui::ViewportId::ROOT;
    egui_winit::State::new(context, id, window, Some(round_to_f32(scale)), None, None)
}

/// Shows the panel, annotations and help.
pub(super) fn show(ui: &mut Ui, open: &OpenWindow, requests: &mut PanelRequests) {
    if open.display.panel {
        egui::Panel::right("panel")
            .resizable(false)
            .exact_size(WIDTH)
            .show(ui, |ui| {
                ScrollArea::vertical().show(ui, |ui| contents(ui, open, requests));
            });
    }
    if !open.display.panel {
        status(ui, open);
    }
    annotations::show(ui, open);
    if open.display.help {
        help(ui);
    }
}

fn contents(ui: &mut Ui, open: &OpenWindow, requests: &mut PanelRequests) {
    let session = &open.session;
    ui.add_space(6.0);
    ui.horizontal_wrapped(|ui| {
        for tool in Tool::ALL {
            let button = ui.selectable_label(open.pointer.tool == tool, tool.name());
            if button.clicked() {
                requests.actions.push(Action::SelectTool(tool));
            }
        }
    });
    ui.horizontal_wrapped(|ui| {
        let mut button = |ui: &mut Ui, text: &str, action: Action, is_on: bool| {
            if ui.add_enabled(is_on, Button::new(text)).clicked() {
                requests.actions.push(action);
            }
        };
        let pause = if open.paused { "Resume" } else { "Pause" };
        button(ui, pause, Action::Pause, true);
        button(ui, "Step", Action::Step, true);
        button(ui, "Reset", Action::Reset, true);
        button(ui, "Undo", Action::Undo, session.undo_count() > 0);
        button(ui, "Redo", Action::Redo, session.redo_count() > 0);
        button(ui, "Save", Action::Save, true);
        button(ui, "Record", Action::SaveRecording, true);
        button(ui, "Fit", Action::Fit, true);
        button(ui, "Keys ?", Action::Help, true);
    });
    messages(ui, open);
    section(ui, "Cut", |ui| cut(ui, &mut requests.settings));
    section(ui, "Body", |ui| body(ui, &mut requests.settings));
    section(ui, "Motion", |ui| motion(ui, &mut requests.settings));
    section(ui, "Display", |ui| display(ui, open, &mut requests.actions));
    section(ui, "Statistics", |ui| statistics::show(ui, open));
}

fn section(ui: &mut Ui, name: &str, contents: impl FnOnce(&mut Ui)) {
    egui::CollapsingHeader::new(RichText::new(name).strong())
        .default_open(true)
        .show_unindented(ui, contents);
}

/// Shows the messages in a corner while the panel is hidden.
fn status(ui: &Ui, open: &OpenWindow) {
    egui::Area::new(egui::Id::unique("status"))
        .anchor(Align2::LEFT_BOTTOM, [8.0, -8.0])
        .interactable(false)
        .show(ui.ctx(), |ui| {
            // Without a minimum, the area keeps its width without messages.
            ui.set_min_width(WIDTH);
            messages(ui, open);
        });
}

/// Shows messages of session and window, the state of the blade, and replay.
fn messages(ui: &mut Ui, open: &OpenWindow) {
    let mut line = |text: &str, is_error: bool| {
        let text = RichText::new(text);
        ui.label(if is_error { text.color(ERROR) } else { text });
    };
    if let Some(status_message) = open.session.status_message() {
        line(&status_message.text, status_message.is_error);
    }
    if let Some((text, is_error)) = &open.message {
        line(text, *is_error);
    }
    if let Some((_, place)) = open.session.held_blade() {
        match place {
            BladeState::StartedInside => line(
                "nothing is cut before the blade was outside the body: move it out",
                false,
            ),
            _ if open.paused => line("paused: the blade cuts when you release it", false),
            BladeState::Outside => {}
            BladeState::Inside
                if open.session.settings().blade_mode() == BladeMode::Progressive => {}
            BladeState::Inside => line(
                "the blade is inside: it cuts when it leaves the body",
                false,
            ),
        }
    }
    if open.replay.is_some() {
        line("replaying", false);
    }
}

fn cut(ui: &mut Ui, settings: &mut Settings) {
    ui.checkbox(&mut settings.progressive, "cuts may end inside the body");
    // The marks of caps are those of the window.
    parameters::show(
        ui,
        &mut settings.scene,
        "cut",
        &["cut.cap_material", "cut.only_piece"],
    );
}

fn body(ui: &mut Ui, settings: &mut Settings) {
    ui.label("Density, bending and springs rebuild the body at rest in its current shape.");
    parameters::show(ui, &mut settings.material, "", &[]);
}

fn motion(ui: &mut Ui, settings: &mut Settings) {
    ui.checkbox(&mut settings.ground, "ground");
    // The window plays frames at their rate.
    let own = ["dt", "cut"];
    parameters::show(ui, &mut settings.scene, "", &own);
}

fn display(ui: &mut Ui, open: &OpenWindow, actions: &mut Vec<Action>) {
    let DisplayOptions {
        wireframe,
        pieces,
        caps,
        batches,
        ..
    } = open.display;
    let choices = [
        ("wireframe", wireframe, Action::Wireframe),
        ("pieces", pieces, Action::PieceColors),
        ("caps", caps, Action::CapColors),
        ("batches", batches, Action::BatchColors),
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

/// Shows the number of constraints of each batch in its color.
fn legend(ui: &mut Ui, session: &Session) {
    let Ok(body) = session.scene().body(session.body()) else {
        return;
    };
    ui.horizontal_wrapped(|ui| {
        for (i, batch) in body.solver().stretch().batches().iter().enumerate() {
            let [r, g, b, _] = scene_view::batch_color(i).0;
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
                            ui.label(key.description);
                        }
                        ui.end_row();
                    }
                });
            ui.separator();
            Grid::new("mouse").num_columns(2).show(ui, |ui| {
                for (button, description) in MOUSE {
                    ui.monospace(button);
                    ui.label(description);
                    ui.end_row();
                }
            });
        });
}
