//! Cuts with a held blade that moves frame by frame.
//!
//! Only cuts right through the body are supported. The sweep therefore starts at the last blade
//! position outside of the body and grows while the blade is inside. The body is cut in the frame
//! in which the blade leaves it, or when the stroke ends outside.

use super::Session;
use crate::command::Edge;
use incise_cut::CutError;
use incise_mesh::geometry::to_f64;
use incise_scene::SceneError;

/// State of a held blade relative to the body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BladeState {
    /// The blade is outside of the body.
    Outside,
    /// The blade moves through the body and cuts when it leaves it.
    Inside,
    /// The stroke started inside the body; nothing is cut before the blade was outside.
    StartedInside,
}

/// The sweep of a held blade.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stroke {
    /// Last position outside of the body, or the current one before that.
    start: Edge,
    /// Current position.
    now: Edge,
    place: BladeState,
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
        let place = if self.edge_intersects_body(edge)? {
            BladeState::StartedInside
        } else {
            BladeState::Outside
        };
        self.stroke = Some(Stroke {
            start: edge,
            now: edge,
            place,
        });
        Ok(())
    }

    /// Cuts along the motion of the held blade since the last frame and ends the stroke.
    pub(super) fn finish_blade(&mut self) -> Result<(), SceneError> {
        let Some(Stroke {
            start, now, place, ..
        }) = self.stroke.take()
        else {
            return Ok(());
        };
        if place == BladeState::StartedInside || self.edge_intersects_body(start)? {
            self.report_error(
                "nothing was cut: the blade was put into the body; start outside and drag it right \
                 through"
                    .to_owned(),
            );
        } else if start != now {
            let inside = "nothing was cut: the blade was let go inside the body; drag it right \
                          through";
            self.cut_along(start, now, inside)?;
        }
        Ok(())
    }

    /// Returns start and current position of the held blade, and its state.
    #[must_use]
    pub fn held_blade(&self) -> Option<([Edge; 2], BladeState)> {
        let stroke = self.stroke?;
        Some(([stroke.start, stroke.now], stroke.place))
    }

    /// Returns true if an edge intersects the surface of the body at its current position.
    fn edge_intersects_body(&mut self, [from, to]: Edge) -> Result<bool, SceneError> {
        let from = to_f64(from);
        let way = to_f64(to) - from;
        let Some(direction) = way.try_normalize(0.0) else {
            return Ok(false);
        };
        let hit = self.scene.cast_ray(self.body, from, direction)?;
        Ok(hit.is_some_and(|hit| hit.distance <= way.norm()))
    }

    /// Sets the scene's blade to the stroke's sweep and returns true if the blade has moved.
    ///
    /// Restarts the stroke if the body has moved to its start.
    pub(super) fn advance_stroke(&mut self) -> Result<bool, SceneError> {
        let Some(mut stroke) = self.stroke else {
            return Ok(false);
        };
        if stroke.place == BladeState::StartedInside || self.edge_intersects_body(stroke.start)? {
            stroke.start = stroke.now;
            stroke.place = if self.edge_intersects_body(stroke.now)? {
                BladeState::StartedInside
            } else {
                BladeState::Outside
            };
        }
        let is_aimed = stroke.start != stroke.now;
        if is_aimed {
            self.scene.teleport_blade(self.blade, stroke.start)?;
            self.scene.move_blade(self.blade, stroke.now)?;
        }
        self.stroke = Some(stroke);
        Ok(is_aimed)
    }

    /// Updates the stroke after the frame's cut and returns the sweep of that cut.
    pub(super) fn end_stroke(&mut self) -> Option<[Edge; 2]> {
        let refusal = self.scene.failed_cuts().first().map(|r| r.error);
        let stroke = self.stroke.as_mut()?;
        let way = [stroke.start, stroke.now];
        stroke.place = match refusal {
            None => BladeState::Outside,
            Some(_) => BladeState::Inside,
        };
        match refusal {
            None => stroke.start = stroke.now,
            Some(CutError::PartialCut { .. }) => {}
            Some(error) => self.report_error(error.to_string()),
        }
        Some(way)
    }
}
