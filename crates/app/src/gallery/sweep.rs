//! Figure 1: a blade's two poses, the two triangles of its sweep, and the triangles it crosses.

use super::figure::{
    BODY, ColoredSurface, EDGE, Facts, FigureError, HIT, POINT, Panel, Row, SWEEP,
};
use super::slice::{against, place};
use incise_cut::Sweep;
use incise_mesh::{Bvh, Surface, TriangleId, Vec3};
use incise_models::{Model, build_model};
use incise_render::{Color, Line, OverlayTriangle};
use std::rc::Rc;

/// The blade's previous and current edge: start (its tip) and end \[m\].
const BEFORE: [[f32; 3]; 2] = [[0.1, -0.75, 0.8], [0.1, 0.75, 0.66]];
const NOW: [[f32; 3]; 2] = [[-0.02, -0.75, -0.7], [-0.02, 0.75, -0.84]];
/// Distance of the blade's back from the end of its edge, and its thickness \[m\].
const HEIGHT: f32 = 0.32;
const THICKNESS: f32 = 0.025;
const STEEL: Color = Color::rgb(196, 200, 206);

pub(super) fn sweep_plane() -> Result<Vec<Row>, FigureError> {
    let (before, now) = (blade(BEFORE)?, blade(NOW)?);
    let sweep = Sweep::new(BEFORE, NOW)?;
    let body = build_model(Model::Sphere80);
    let hits = hits(&body, &sweep);
    let body = ColoredSurface::new(body, |_, t| {
        Some(if hits.contains(&t) { HIT } else { BODY })
    });
    let camera = against(Vec3::new(1.0, 0.45, 0.55));
    let corners = before.corners().chain(now.corners());
    let camera = camera.frame(corners.chain(sweep.points().iter().copied()), 1.0);
    let panel = |label: &str, shown: &[&Rc<ColoredSurface>]| {
        let shown: Vec<Rc<ColoredSurface>> = shown.iter().map(|&shown| Rc::clone(shown)).collect();
        let mut panel = Panel::from_surfaces(label.to_owned(), camera, shown, Facts::default());
        panel.lines.push(line(NOW, POINT, 3.5));
        panel
    };
    let mut area = panel("(b) area between two poses", &[&before, &now]);
    area.sheets = sheets(&sweep, [SWEEP; 2]);
    area.lines.push(line(BEFORE, SWEEP, 2.5));
    let mut triangles = panel("(c) sweep of two triangles", &[]);
    triangles.sheets = sheets(&sweep, [SWEEP, EDGE]);
    let [[a, b], [d, c]] = sweep.ends();
    let sides = [[a, b], [a, c], [a, d], [b, c]];
    (triangles.lines).extend(sides.map(|ends| line(ends, SWEEP, 2.0)));
    let mut hit = panel("", &[&body]);
    hit.label = format!("(d) {} of {} triangles are hit", hits.len(), body.count());
    hit.facts.model = Some(Model::Sphere80.name());
    hit.sheets = sheets(&sweep, [SWEEP; 2]);
    hit.lines.push(line(BEFORE, SWEEP, 2.5));
    Ok(vec![Row {
        title: "sweep plane, the same for both methods".to_owned(),
        panels: vec![panel("(a) the blade", &[&now]), area, triangles, hit],
    }])
}

/// Returns a blade: a wedge with its back above the end of its edge.
fn blade([tip, end]: [[f32; 3]; 2]) -> Result<Rc<ColoredSurface>, FigureError> {
    let at = |p: [f32; 3], side: f32, along: f32| [p[0] + side, p[1], p[2] + along];
    let [left, right] = [-THICKNESS, THICKNESS].map(|side| at(end, side, HEIGHT));
    let corners = [tip, end, left, right];
    let faces = [[0, 1, 3], [0, 3, 2], [0, 2, 1], [1, 2, 3]];
    let surface = Surface::from_triangles(&corners, &faces)?;
    Ok(ColoredSurface::new(surface, |_, _| Some(STEEL)))
}

/// Returns the triangles that the sweep crosses.
fn hits(body: &Surface, sweep: &Sweep) -> Vec<TriangleId> {
    let mut candidates = Vec::new();
    Bvh::build(body).query(body, sweep.triangles(), &mut candidates);
    candidates.retain(|&t| {
        let [a, b, c] = body.topology().triangle(t).map(|v| place(body, v));
        [[a, b], [b, c], [c, a]]
            .iter()
            .any(|&[p, q]| sweep.intersects_segment(p, q))
    });
    candidates
}

fn line(ends: [[f32; 3]; 2], color: Color, width: f32) -> Line {
    Line { ends, color, width }
}

/// Returns the sweep's two triangles, translucent.
fn sheets(sweep: &Sweep, colors: [Color; 2]) -> Vec<OverlayTriangle> {
    let [[a, b], [d, c]] = sweep.ends();
    let triangles = [[a, b, c], [a, c, d]].into_iter().zip(colors);
    triangles
        .map(|(corners, color)| OverlayTriangle {
            corners,
            color: color.with_alpha(90),
        })
        .collect()
}
