//! Figures 4, 7 to 10 and A1 to A4: the five refinement levels, second half removed.

use super::figure::{FigureError, Panel, Row, letter};
use super::slice::{Plane, Slice, facts, front, methods, name, params, side};
use incise_mesh::geometry::to_f32;
use incise_models::{Model, build_model};
use incise_refine::RefinementLevel;
use incise_render::Camera;

/// A view of a half.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Look {
    /// The whole half, from beside the cap.
    Side,
    /// The cap alone, from the front.
    Front,
}

impl Look {
    fn camera(self, slice: &Slice) -> Camera {
        match self {
            Self::Side => side(slice.normal()).frame(slice.half().corners(), 1.0),
            Self::Front => {
                let caps = slice.caps().into_iter().flatten();
                front(slice.normal()).frame(caps.map(to_f32), 1.0)
            }
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Side => "side view",
            Self::Front => "front view",
        }
    }
}

/// Returns the five levels of a cut by both methods, one row per view.
pub(super) fn levels(model: Model, plane: Plane, looks: &[Look]) -> Result<Vec<Row>, FigureError> {
    let surface = build_model(model);
    let mut rows = Vec::new();
    for method in methods() {
        let each = RefinementLevel::FIVE.map(|level| params(method, level));
        let slices = each.map(|params| Slice::new(&surface, plane, &params));
        let slices = slices.into_iter().collect::<Result<Vec<_>, _>>()?;
        let halves: Vec<_> = slices.iter().map(Slice::half).collect();
        for look in looks {
            // One camera for all five levels: their rims are equal.
            let camera = look.camera(&slices[0]);
            let panels = each
                .iter()
                .zip(&halves)
                .enumerate()
                .map(|(i, (params, half))| {
                    let mut facts = facts(model, params, &[plane]);
                    facts.second_half_removed = true;
                    let (letter, level, caps) = (letter(i), params.refine.level, half.caps());
                    let label = format!("({letter}) {level}, {caps} cap triangles");
                    Panel::from_surfaces(label, camera, vec![half.clone()], facts)
                });
            rows.push(Row {
                title: format!("{}, {}, {}", model.name(), name(method), look.name()),
                panels: panels.collect(),
            });
        }
    }
    Ok(rows)
}
