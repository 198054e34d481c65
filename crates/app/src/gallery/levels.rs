//! Figures 4, 7 to 10 and A1 to A4: the five refinement levels, the second half removed.

use super::figure::{FigureError, Panel, Row, letter};
use super::slice::{METHODS, Plane, Slice, facts, front, name, params, side};
use incise_mesh::geometry::round;
use incise_mesh::{Model, build_model};
use incise_refine::RefinementLevel;
use incise_render::Camera;

/// A way to look at a half.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Look {
    /// All of it, from beside the cap.
    Side,
    /// The cap alone, from straight in front.
    Front,
}

impl Look {
    fn camera(self, slice: &Slice) -> Camera {
        match self {
            Self::Side => side(slice.normal()).frame(slice.half().corners(), 1.0),
            Self::Front => {
                let caps = slice.caps().into_iter().flatten();
                front(slice.normal()).frame(caps.map(round), 1.0)
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

/// The five levels of a cut by both methods, a row for each view.
pub(super) fn levels(model: Model, plane: Plane, looks: &[Look]) -> Result<Vec<Row>, FigureError> {
    let surface = build_model(model);
    let mut rows = Vec::new();
    for method in METHODS {
        let each = RefinementLevel::FIVE.map(|level| params(method, level));
        let slices = each.map(|params| Slice::of(&surface, plane, &params));
        let slices = slices.into_iter().collect::<Result<Vec<_>, _>>()?;
        let halves: Vec<_> = slices.iter().map(Slice::half).collect();
        for look in looks {
            // One for all five: caps differ, their rims do not.
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
                    Panel::of(label, camera, vec![half.clone()], facts)
                });
            rows.push(Row {
                title: format!("{}, {}, {}", model.name(), name(method), look.name()),
                panels: panels.collect(),
            });
        }
    }
    Ok(rows)
}
