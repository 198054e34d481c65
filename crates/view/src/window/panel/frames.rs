//! What frames cost, and what they ran and skipped.

use super::super::{Open, graph};
use egui::{Grid, RichText, Ui};
use incise_scene::FrameStats;

pub(super) fn show(ui: &mut Ui, open: &Open) {
    let (session, stats) = (&open.session, &open.session.last().stats);
    open.times.show(ui);
    let [mean, most] = open.times.summary();
    ui.horizontal(|ui| {
        ui.label("time of a frame, and of its");
        ui.colored_label(graph::CUTS, "cuts");
    });
    let surface = session.surface();
    let topology = surface.topology();
    let scene = session.scene();
    let mover = scene.backend_report().device;
    let mover = mover.filter(|_| open.is_on_device());
    let rows = [
        ("a frame", format!("{mean:.2} ms, at most {most:.1} ms")),
        ("a picture", format!("{:.1} ms", open.times.of_picture())),
        ("speed", open.pace.text()),
        ("frame", format!("{}{}", session.frames(), rest(open))),
        ("pieces", surface.piece_count().to_string()),
        (
            "mesh",
            format!(
                "{} vertices, {} triangles",
                topology.vertex_count(),
                topology.triangle_count()
            ),
        ),
        (
            "moved by",
            mover.unwrap_or_else(|| "the processor".to_owned()),
        ),
        ("drawn by", open.device.clone()),
    ];
    table(ui, "about", &rows);
    ui.label(RichText::new("The last frame ran, and skipped").strong());
    table(ui, "ran", &ran(stats));
    if let Some(cut) = session.last_cut() {
        ui.label(RichText::new("The last cut").strong());
        table(ui, "cut", &of_cut(cut));
    }
}

fn rest(open: &Open) -> &'static str {
    if open.paused {
        ", paused"
    } else if open.session.is_asleep() {
        ", asleep"
    } else {
        ""
    }
}

fn ran(stats: &FrameStats) -> [(&'static str, String); 7] {
    let pair = |ran: u32, skipped: u32| format!("{ran}, {skipped} skipped");
    [
        ("sweeps", pair(stats.sweeps, stats.sweeps_skipped)),
        ("searches", pair(stats.detections, stats.detections_skipped)),
        ("refits", pair(stats.refits, stats.refits_skipped)),
        ("readbacks", pair(stats.readbacks, stats.readbacks_skipped)),
        (
            "ground passes",
            format!("{} skipped", stats.ground_passes_skipped),
        ),
        (
            "contacts",
            format!("{} in {} searches", stats.contacts, stats.contact_searches),
        ),
        (
            "solver",
            format!("{:.2} ms", stats.solver.as_secs_f64() * 1e3),
        ),
    ]
}

fn of_cut(stats: &FrameStats) -> [(&'static str, String); 6] {
    let ms = |time: std::time::Duration| format!("{:.2} ms", time.as_secs_f64() * 1e3);
    [
        ("hit", format!("{} of {}", stats.hits, stats.candidates)),
        ("detection", ms(stats.detection)),
        ("topology", ms(stats.topology)),
        ("caps", ms(stats.refinement)),
        ("constraints", ms(stats.constraints)),
        ("all of it", ms(stats.cutting())),
    ]
}

fn table(ui: &mut Ui, id: &str, rows: &[(&'static str, String)]) {
    Grid::new(id)
        .num_columns(2)
        .spacing([10.0, 2.0])
        .show(ui, |ui| {
            for (name, value) in rows {
                ui.label(RichText::new(*name).weak());
                ui.add(egui::Label::new(value).wrap());
                ui.end_row();
            }
        });
}
