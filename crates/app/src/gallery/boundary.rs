//! Figure 2: the boundary that a cut leaves, made anew, step by step.
//!
//! Only a whole cut is public. Its parts show the steps: the triangles that it removed, those that it added without the
//! cap, and the same of a cut without the step that comes after.

use super::figure::{BODY, EDGE, FigureError, NEW, Panel, Row, Shown, letter};
use super::slice::{METHODS, Plane, Slice, facts, name, params, place, side};
use incise_cut::{CutMethod, CutParams};
use incise_mesh::{Model, Origin, Surface, TriangleId, Vec3, VertexId, build_model};
use incise_refine::RefinementLevel;
use incise_render::{Camera, Line};
use std::collections::HashSet;
use std::rc::Rc;

const MODEL: Model = Model::Sphere80;
/// Where Sphere80 is cut: off its middle and its edges.
pub(super) const PLANE: Plane = [1.0, 0.12, 0.2, 0.06];

/// What a step is called, and how to cut so that it is the last.
type Step = (&'static str, CutParams);

pub(super) fn boundary() -> Result<Vec<Row>, FigureError> {
    let surface = build_model(MODEL);
    let [x, y, z, _] = PLANE;
    let whole = Shown::new(surface.clone(), |_, _| Some(BODY));
    let camera = side(Vec3::new(x, y, z)).frame(whole.corners(), 1.0);
    let rows = METHODS.map(|method| row(&surface, camera, method));
    rows.into_iter().collect()
}

/// The third and the fourth step of a method.
fn steps(method: CutMethod) -> [Step; 2] {
    let last = params(method, RefinementLevel::Original);
    match method {
        CutMethod::Rebuild => {
            // No angle is below 0, so that no ear is closed.
            let ear_angle = 0.0;
            let first = CutParams { ear_angle, ..last };
            let names = ["edges joined to points", "acute angles closed"];
            [(names[0], first), (names[1], last)]
        }
        _ => {
            let first = CutParams { snap: 0.0, ..last };
            let names = ["split along the sweep", "short rim edges snapped"];
            [(names[0], first), (names[1], last)]
        }
    }
}

fn row(surface: &Surface, camera: Camera, method: CutMethod) -> Result<Row, FigureError> {
    let steps = steps(method);
    let slices = steps.map(|(_, params)| Slice::of(surface, PLANE, &params));
    let slices = slices.into_iter().collect::<Result<Vec<_>, _>>()?;
    let facts = facts(MODEL, &steps[1].1, &[PLANE]);
    let panel = |i: usize, text: &str, shown: Rc<Shown>| {
        let label = format!("({}) {text}", letter(i));
        Panel::of(label, camera, vec![shown], facts.clone())
    };
    let gone: HashSet<TriangleId> = hits(&slices[0]).collect();
    let whole = Shown::new(surface.clone(), |_, _| Some(BODY));
    let open = Shown::new(surface.clone(), |_, t| (!gone.contains(&t)).then_some(BODY));
    let mut opened = panel(1, "hit triangles removed", open);
    opened.points = points(&slices[0]);
    opened.lines = old_boundary(surface, &gone);
    let mut panels = vec![panel(0, "before the cut", whole), opened];
    for (i, ((text, _), slice)) in steps.iter().zip(&slices).enumerate() {
        let added: HashSet<TriangleId> = slice
            .outcome
            .delta
            .triangles_added
            .iter()
            .copied()
            .collect();
        let caps: HashSet<TriangleId> = slice.outcome.cap.iter().copied().collect();
        let shown = Shown::new(slice.surface.clone(), |_, t| {
            match (caps.contains(&t), added.contains(&t)) {
                (true, _) => None,
                (false, true) => slice.is_behind(t).then_some(NEW),
                (false, false) => Some(BODY),
            }
        });
        let mut panel = panel(i + 2, text, shown);
        let edges = slice.rim_edges().into_iter();
        panel.lines = edges.map(|ends| edge(&slice.surface, ends)).collect();
        panel.points = points(slice);
        panels.push(panel);
    }
    Ok(Row {
        title: format!("{}, {}", MODEL.name(), name(method)),
        panels,
    })
}

/// Triangles of the surface before the cut that the blade hit.
fn hits(slice: &Slice) -> impl Iterator<Item = TriangleId> {
    let removed = &slice.outcome.delta.triangles_removed;
    removed.iter().map(|&(t, _)| t)
}

/// Where edges cross the plane, as far as they are vertices of the half behind it.
fn points(slice: &Slice) -> Vec<[f32; 3]> {
    let rim: HashSet<VertexId> = slice.rim_edges().iter().map(|&[a, _]| a).collect();
    let added = slice.outcome.delta.vertices_added.iter();
    let crossings = added.filter(|added| matches!(added.origin, Origin::OnEdge { .. }));
    let on_rim = crossings.filter(|added| rim.contains(&added.vertex));
    on_rim
        .map(|added| place(&slice.surface, added.vertex))
        .collect()
}

/// Edges between triangles that stay and those that are gone.
fn old_boundary(surface: &Surface, gone: &HashSet<TriangleId>) -> Vec<Line> {
    let topology = surface.topology();
    let sides = gone.iter().flat_map(|t| t.half_edges());
    let boundary = sides.filter(|&h| !gone.contains(&topology.twin(h).triangle()));
    let mut ends: Vec<[VertexId; 2]> = boundary
        .map(|h| [topology.origin(h), topology.target(h)])
        .collect();
    ends.sort_unstable();
    ends.into_iter().map(|ends| edge(surface, ends)).collect()
}

/// An edge of a boundary.
fn edge(surface: &Surface, ends: [VertexId; 2]) -> Line {
    Line {
        ends: ends.map(|v| place(surface, v)),
        color: EDGE,
        width: 3.0,
    }
}
