//! Figure 2: reconstruction of the boundary of a cut, step by step.
//!
//! Only whole cuts are public. The steps are drawn from their deltas: removed triangles, added
//! triangles without the cap, and the same of a cut without the next step.

use super::figure::{BODY, ColoredSurface, EDGE, FigureError, NEW, Panel, Row, letter};
use super::slice::{Method, Plane, Slice, facts, methods, place, side};
use incise_cut::CutParams;
use incise_mesh::{Surface, TriangleId, Vec3, VertexId, VertexOrigin};
use incise_models::{Model, build_model};
use incise_paper::PaperParams;
use incise_refine::RefinementLevel;
use incise_render::{Camera, Line};
use std::collections::HashSet;
use std::rc::Rc;

const MODEL: Model = Model::Sphere80;
/// The plane that cuts Sphere80, away from its center and its edges.
pub(super) const PLANE: Plane = [1.0, 0.12, 0.2, 0.06];

/// The name of a step, and the method of a cut that ends with it.
type Step = (&'static str, Method);

pub(super) fn boundary() -> Result<Vec<Row>, FigureError> {
    let surface = build_model(MODEL);
    let [x, y, z, _] = PLANE;
    let whole = ColoredSurface::new(surface.clone(), |_, _| Some(BODY));
    let camera = side(Vec3::new(x, y, z)).frame(whole.corners(), 1.0);
    let rows = methods(RefinementLevel::Original).map(|method| row(&surface, camera, method));
    rows.into_iter().collect()
}

/// Returns the third and the fourth step of a method.
fn steps(last: Method) -> [Step; 2] {
    let (first, names) = match last {
        Method::Paper(paper) => {
            // No angle is below 0, so that no ear is closed.
            let ear_angle = 0.0;
            let first = Method::Paper(PaperParams { ear_angle, ..paper });
            (first, ["edges joined to points", "acute angles closed"])
        }
        Method::Exact(exact) => {
            let first = Method::Exact(CutParams { snap: 0.0, ..exact });
            (first, ["split along the sweep", "short rim edges snapped"])
        }
    };
    [(names[0], first), (names[1], last)]
}

fn row(surface: &Surface, camera: Camera, method: Method) -> Result<Row, FigureError> {
    let steps = steps(method);
    let slices = steps.map(|(_, method)| Slice::new(surface, PLANE, method));
    let slices = slices.into_iter().collect::<Result<Vec<_>, _>>()?;
    let facts = facts(MODEL, method, &[PLANE]);
    let panel = |i: usize, text: &str, shown: Rc<ColoredSurface>| {
        let label = format!("({}) {text}", letter(i));
        Panel::from_surfaces(label, camera, vec![shown], facts.clone())
    };
    let gone: HashSet<TriangleId> = hits(&slices[0]).collect();
    let whole = ColoredSurface::new(surface.clone(), |_, _| Some(BODY));
    let open = ColoredSurface::new(surface.clone(), |_, t| (!gone.contains(&t)).then_some(BODY));
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
        let shown = ColoredSurface::new(slice.surface.clone(), |_, t| {
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
        title: format!("{}, {}", MODEL.name(), method.name()),
        panels,
    })
}

/// Returns the triangles of the uncut surface that the sweep crosses.
fn hits(slice: &Slice) -> impl Iterator<Item = TriangleId> {
    let removed = &slice.outcome.delta.triangles_removed;
    removed.iter().map(|&(t, _)| t)
}

/// Returns the intersection points that are vertices of the half behind the plane.
fn points(slice: &Slice) -> Vec<[f32; 3]> {
    let rim: HashSet<VertexId> = slice.rim_edges().iter().map(|&[a, _]| a).collect();
    let added = slice.outcome.delta.vertices_added.iter();
    let crossings = added.filter(|added| matches!(added.origin, VertexOrigin::OnEdge { .. }));
    let on_rim = crossings.filter(|added| rim.contains(&added.vertex));
    on_rim
        .map(|added| place(&slice.surface, added.vertex))
        .collect()
}

/// Returns the edges between remaining and removed triangles.
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

/// Returns the line of a boundary edge.
fn edge(surface: &Surface, ends: [VertexId; 2]) -> Line {
    Line {
        ends: ends.map(|v| place(surface, v)),
        color: EDGE,
        width: 3.0,
    }
}
