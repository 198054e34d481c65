//! Figures 5 and 6: models sliced again and again, the pieces moved apart.

use super::figure::{FigureError, Panel, Row, Shown, letter};
use super::slice::{METHODS, Plane, color, facts, name, params, sweep};
use crate::apart::{centers, move_pieces};
use incise_cut::{CutParams, Cutter};
use incise_mesh::{Model, Surface, Vec3, build_model};
use incise_refine::RefinementLevel;
use incise_render::Camera;

/// How far pieces are moved off the middle, as a part of their distance from it.
const APART: f64 = 0.45;

/// The slices of models by both methods, a row for each.
pub(super) fn slices(models: &[(Model, &[Plane])]) -> Result<Vec<Row>, FigureError> {
    let mut rows = Vec::new();
    for method in METHODS {
        let params = params(method, RefinementLevel::Original);
        let mut panels = Vec::new();
        for (i, &(model, planes)) in models.iter().enumerate() {
            let surface = sliced(build_model(model), planes, &params)?;
            let pieces = surface.piece_count();
            let shown = Shown::new(surface, |surface, t| Some(color(surface, t)));
            let camera = Camera::default().frame(shown.corners(), 1.0);
            let facts = facts(model, &params, planes);
            let label = format!("({}) {}, {pieces} pieces", letter(i), model.name());
            panels.push(Panel::of(label, camera, vec![shown], facts));
        }
        rows.push(Row {
            title: name(method).to_owned(),
            panels,
        });
    }
    Ok(rows)
}

/// The surface, cut along one plane after the other and moved apart.
fn sliced(
    mut surface: Surface,
    planes: &[Plane],
    params: &CutParams,
) -> Result<Surface, FigureError> {
    let mut cutter = Cutter::new(&surface);
    for &plane in planes {
        let sweep = sweep(&surface, plane)?;
        cutter.cut(&mut surface, &sweep, params)?;
    }
    let middle = surface.bounds().center();
    let moves: Vec<Vec3> = (centers(&surface).iter())
        .map(|center| (center - middle) * APART)
        .collect();
    move_pieces(&mut surface, &moves);
    Ok(surface)
}
