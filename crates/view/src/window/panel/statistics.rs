//! The statistics section of the panel: frame times, work done and skipped, the last cut.

use super::super::{OpenWindow, frame_times};
use egui::{Grid, RichText, Ui};
use incise_scene::FrameStats;

pub(super) fn show(ui: &mut Ui, open: &OpenWindow) {
    let (session, stats) = (&open.session, &open.session.last_frame().stats);
    open.times.show(ui);
    let [mean, max] = open.times.summary();
    ui.horizontal(|ui| {
        ui.label("frame time, of which");
        ui.colored_label(frame_times::CUTS, "cuts");
    });
    let surface = session.surface();
    let topology = surface.topology();
    let scene = session.scene();
    let simulated_by = scene.backend_report().adapter;
    let simulated_by = simulated_by.filter(|_| open.is_on_gpu());
    let rows = [
        ("frame time", format!("{mean:.2} ms, max {max:.1} ms")),
        ("redraw time", format!("{:.1} ms", open.times.redraw())),
        ("speed", open.speed.text()),
        ("frame", format!("{}{}", session.frames(), run_state(open))),
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
            "simulated by",
            simulated_by.unwrap_or_else(|| "CPU".to_owned()),
        ),
        ("rendered by", open.adapter.clone()),
    ];
    table(ui, "about", &rows);
    ui.label(RichText::new("Last frame").strong());
    table(ui, "frame", &frame_rows(stats));
    if let Some(cut) = session.last_cut_stats() {
        ui.label(RichText::new("Last cut").strong());
        table(ui, "cut", &cut_rows(cut));
    }
}

fn run_state(open: &OpenWindow) -> &'static str {
    if open.paused {
        ", paused"
    } else if open.session.is_asleep() {
        ", asleep"
    } else {
        ""
    }
}

fn frame_rows(stats: &FrameStats) -> [(&'static str, String); 6] {
    let pair = |ran: u32, skipped: u32| format!("{ran}, {skipped} skipped");
    [
        ("sweeps", pair(stats.sweeps, stats.resting_blades)),
        (
            "searches",
            pair(stats.narrow_phase_queries, stats.broad_phase_rejections),
        ),
        ("refits", pair(stats.bvh_refits, stats.bvh_refits_skipped)),
        ("readbacks", pair(stats.readbacks, stats.readbacks_skipped)),
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

fn cut_rows(stats: &FrameStats) -> [(&'static str, String); 6] {
    let ms = |time: std::time::Duration| format!("{:.2} ms", time.as_secs_f64() * 1e3);
    [
        (
            "triangles hit",
            format!("{} of {}", stats.hit_triangles, stats.candidate_triangles),
        ),
        ("detection", ms(stats.detection)),
        ("topology", ms(stats.topology)),
        ("refinement", ms(stats.refinement)),
        ("constraints", ms(stats.constraint_update)),
        ("total", ms(stats.cutting())),
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
