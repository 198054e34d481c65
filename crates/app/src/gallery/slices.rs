//! Figures 5 and 6 and textures: models sliced repeatedly, the pieces moved apart.

use super::figure::{ColoredSurface, FigureError, Panel, Row, letter};
use super::slice::{Method, Plane, color, facts, methods, sweep};
use crate::explode::{centers, move_pieces};
use crate::numbers::counted;
use incise_cut::{CutParams, Cutter};
use incise_mesh::{Surface, Vec3};
use incise_models::{Model, build_model};
use incise_refine::RefinementLevel;
use incise_render::Camera;

/// Displacement of a piece over its distance from the center.
const EXPLOSION: f64 = 0.45;

/// Returns the slices of models, one row per method.
pub(super) fn slices(models: &[(Model, &[Plane])]) -> Result<Vec<Row>, FigureError> {
    let mut rows = Vec::new();
    for method in methods(RefinementLevel::Original) {
        let mut panels = Vec::new();
        for (i, &(model, planes)) in models.iter().enumerate() {
            let surface = sliced(build_model(model), planes, method)?;
            let pieces = surface.piece_count();
            let shown = ColoredSurface::new(surface, |surface, t| Some(color(surface, t)));
            let camera = Camera::default().frame(shown.corners(), 1.0);
            let facts = facts(model, method, planes);
            let label = format!("({}) {}, {pieces} pieces", letter(i), model.name());
            panels.push(Panel::from_surfaces(label, camera, vec![shown], facts));
        }
        rows.push(Row {
            title: method.name().to_owned(),
            panels,
        });
    }
    Ok(rows)
}

/// Squares of a checkerboard per unit of texture coordinates.
const SQUARES: f32 = 16.0;

/// Returns a model with a checkerboard on its texture coordinates, after each list of cuts.
pub(super) fn textured(model: Model, slices: &[&[Plane]]) -> Result<Vec<Row>, FigureError> {
    let method = Method::Exact(CutParams::default());
    let mut panels = Vec::new();
    for (i, &planes) in slices.iter().enumerate() {
        let surface = sliced(build_model(model), planes, method)?;
        let pieces = surface.piece_count();
        let shown = ColoredSurface::new(surface, |surface, t| Some(color(surface, t)));
        let shown = shown.with_checkers(SQUARES);
        let camera = Camera::default().frame(shown.corners(), 1.0);
        let label = format!("({}) {}", letter(i), counted(pieces, "piece"));
        let facts = facts(model, method, planes);
        panels.push(Panel::from_surfaces(label, camera, vec![shown], facts));
    }
    let title = model.name().to_owned();
    Ok(vec![Row { title, panels }])
}

/// Cuts a surface along successive planes and moves the pieces apart.
fn sliced(mut surface: Surface, planes: &[Plane], method: Method) -> Result<Surface, FigureError> {
    let mut cutter = Cutter::new(&surface);
    for &plane in planes {
        let sweep = sweep(&surface, plane)?;
        let _ = method.cut(&mut cutter, &mut surface, &sweep)?;
    }
    let middle = surface.bounds().center();
    let moves: Vec<Vec3> = (centers(&surface).iter())
        .map(|center| (center - middle) * EXPLOSION)
        .collect();
    move_pieces(&mut surface, &moves);
    Ok(surface)
}
