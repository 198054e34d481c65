//! Figures 4, 7 to 10 and A1 to A4: the five refinement levels, second half removed.

use super::figure::{FigureError, Panel, Row, letter};
use super::slice::{Plane, Slice, facts, front, methods, side};
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
    for m in 0..2 {
        let each = RefinementLevel::FIVE.map(|level| methods(level)[m]);
        let slices = each.map(|method| Slice::new(&surface, plane, method));
        let slices = slices.into_iter().collect::<Result<Vec<_>, _>>()?;
        let halves: Vec<_> = slices.iter().map(Slice::half).collect();
        for look in looks {
            // One camera for all five levels: their rims are equal.
            let camera = look.camera(&slices[0]);
            let panels = each
                .iter()
                .zip(&halves)
                .enumerate()
                .map(|(i, (&method, half))| {
                    let mut facts = facts(model, method, &[plane]);
                    facts.second_half_removed = true;
                    let (letter, level, caps) = (letter(i), method.level(), half.caps());
                    let label = format!("({letter}) {level}, {caps} cap triangles");
                    Panel::from_surfaces(label, camera, vec![half.clone()], facts)
                });
            rows.push(Row {
                title: format!("{}, {}, {}", model.name(), each[0].name(), look.name()),
                panels: panels.collect(),
            });
        }
    }
    Ok(rows)
}
