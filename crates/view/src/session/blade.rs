//! A blade that is held and moved, frame by frame.
//!
//! Only full slices can be cut, so the frame's sweep begins where the blade was last outside of the body: while it is inside
//! the cut is refused and the blade goes on, and it cuts in the frame in which it comes out, or when it is let go there.

use super::Session;
use crate::command::Edge;
use incise_cut::CutError;
use incise_mesh::geometry::widen;
use incise_scene::SceneError;

/// Where a held blade is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BladePlace {
    /// Beside the body.
    Outside,
    /// On its way through the body: it cuts when it comes out.
    Inside,
    /// In the body without having come in from outside, so that it cuts nothing before it has been taken out.
    Begun,
}

/// The way of a blade that is held.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stroke {
    /// Where it was last outside; where it is, before it was.
    start: Edge,
    now: Edge,
    place: BladePlace,
}

impl Session {
    pub(super) fn hold_blade(&mut self, edge: Edge) -> Result<(), SceneError> {
        if !edge.as_flattened().iter().all(|x| x.is_finite()) {
            return Ok(());
        }
        if let Some(stroke) = &mut self.stroke {
            stroke.now = edge;
            return Ok(());
        }
        let place = if self.meets_body(edge)? {
            BladePlace::Begun
        } else {
            BladePlace::Outside
        };
        self.stroke = Some(Stroke {
            start: edge,
            now: edge,
            place,
        });
        Ok(())
    }

    /// Cuts along what the held blade has passed since the last frame, and puts it away.
    pub(super) fn finish_blade(&mut self) -> Result<(), SceneError> {
        let Some(Stroke {
            start, now, place, ..
        }) = self.stroke.take()
        else {
            return Ok(());
        };
        if place == BladePlace::Begun || self.meets_body(start)? {
            self.refuse(
                "the blade was put into the body, so it has cut nothing: begin beside it and move right through"
                    .to_owned(),
            );
        } else if start != now {
            let inside = "the blade was let go inside the body, so it has cut nothing: move it right through";
            self.cut_along(start, now, inside)?;
        }
        Ok(())
    }

    /// Where the held blade was last outside of the body and where it is, and what that means.
    #[must_use]
    pub fn held_blade(&self) -> Option<([Edge; 2], BladePlace)> {
        let stroke = self.stroke?;
        Some(([stroke.start, stroke.now], stroke.place))
    }

    /// Whether an edge goes through the body's surface, where the body is now.
    fn meets_body(&mut self, [from, to]: Edge) -> Result<bool, SceneError> {
        let from = widen(from);
        let way = widen(to) - from;
        let Some(direction) = way.try_normalize(0.0) else {
            return Ok(false);
        };
        let hit = self.scene.cast(self.body, from, direction)?;
        Ok(hit.is_some_and(|hit| hit.distance <= way.norm()))
    }

    /// Has the frame cut along the blade's way, and says whether it does. A body may have come to where the blade was outside
    /// of it.
    pub(super) fn aim_stroke(&mut self) -> Result<bool, SceneError> {
        let Some(mut stroke) = self.stroke else {
            return Ok(false);
        };
        if stroke.place == BladePlace::Begun || self.meets_body(stroke.start)? {
            stroke.start = stroke.now;
            stroke.place = if self.meets_body(stroke.now)? {
                BladePlace::Begun
            } else {
                BladePlace::Outside
            };
        }
        let is_aimed = stroke.start != stroke.now;
        if is_aimed {
            self.scene.jump_blade(self.blade, stroke.start);
            self.scene.move_blade(self.blade, stroke.now);
        }
        self.stroke = Some(stroke);
        Ok(is_aimed)
    }

    /// The way along which the frame has cut. What the blade has cut it need not cut again.
    pub(super) fn end_stroke(&mut self) -> Option<[Edge; 2]> {
        let refusal = self.scene.refusals().first().map(|r| r.error);
        let stroke = self.stroke.as_mut()?;
        let way = [stroke.start, stroke.now];
        stroke.place = match refusal {
            None => BladePlace::Outside,
            Some(_) => BladePlace::Inside,
        };
        match refusal {
            None => stroke.start = stroke.now,
            Some(CutError::PartialCut { .. }) => {}
            Some(error) => self.refuse(error.to_string()),
        }
        Some(way)
    }
}
