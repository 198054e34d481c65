//! A blade that is held and moved, frame by frame.
//!
//! Only full slices can be cut, so the frame's sweep begins where the blade was last outside of the body: while it is inside
//! the cut is refused and the blade goes on, and it cuts in the frame in which it comes out.

use super::Session;
use crate::command::Edge;
use incise_cut::CutError;

/// The way of a blade that is held.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stroke {
    /// Where it was last outside.
    start: Edge,
    now: Edge,
    is_inside: bool,
    /// Whether this frame cuts along it.
    is_aimed: bool,
}

impl Session {
    pub(super) fn hold_blade(&mut self, edge: Edge) {
        let is_finite = edge.as_flattened().iter().all(|x| x.is_finite());
        match &mut self.stroke {
            _ if !is_finite => {}
            Some(stroke) => stroke.now = edge,
            None => {
                self.stroke = Some(Stroke {
                    start: edge,
                    now: edge,
                    is_inside: false,
                    is_aimed: false,
                });
            }
        }
    }

    /// Where the held blade was last outside of the body and where it is, and whether it is inside.
    #[must_use]
    pub fn held_blade(&self) -> Option<([Edge; 2], bool)> {
        let stroke = self.stroke?;
        Some(([stroke.start, stroke.now], stroke.is_inside))
    }

    /// Has the frame cut along the blade's way.
    pub(super) fn aim_stroke(&mut self) {
        if let Some(stroke) = &mut self.stroke {
            stroke.is_aimed = stroke.start != stroke.now;
            if stroke.is_aimed {
                self.scene.jump_blade(self.blade, stroke.start);
                self.scene.move_blade(self.blade, stroke.now);
            }
        }
    }

    /// The way along which the frame has cut, if it has. What the blade has cut it need not cut again.
    pub(super) fn end_stroke(&mut self) -> Option<[Edge; 2]> {
        let refusal = self.scene.refusals().first().map(|r| r.error);
        let stroke = self.stroke.as_mut().filter(|stroke| stroke.is_aimed)?;
        let way = [stroke.start, stroke.now];
        stroke.is_inside = refusal.is_some();
        match refusal {
            None => stroke.start = stroke.now,
            Some(CutError::PartialCut { .. }) => {}
            Some(error) => self.refuse(error.to_string()),
        }
        Some(way)
    }
}
