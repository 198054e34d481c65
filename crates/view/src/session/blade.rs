//! Cuts with a held blade that moves frame by frame.
//!
//! A progressive blade cuts in every frame and goes on at the tip of its cut, see
//! [`incise_scene::BladeMode::Progressive`].
//!
//! If the settings say so, only cuts right through the body are made. The sweep then starts at the
//! last blade position outside of the body and grows while the blade is inside. The body is cut in
//! the frame in which the blade leaves it, or when the stroke ends outside.

use super::Session;
use super::cut_history::RecordedCut;
use crate::command::Edge;
use incise_cut::{CutError, Incision};
use incise_mesh::geometry::to_f64;
use incise_scene::{BladeMode, SceneError};

/// State of a held blade relative to the body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BladeState {
    /// The blade is outside of the body.
    Outside,
    /// The blade moves through the body. It cuts as it moves, or when it leaves the body, see
    /// [`Settings::progressive`](crate::Settings::progressive).
    Inside,
    /// The stroke started inside the body, or a step of it failed there; nothing is cut before the
    /// blade was outside.
    StartedInside,
}

/// The motion of a held blade.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stroke {
    /// Start of the next sweep: the position in the last frame, or the last one outside of the body
    /// if the blade is not progressive.
    start: Edge,
    /// Current position.
    now: Edge,
    place: BladeState,
    /// Whether the last cut of the session is a step of this stroke.
    pub(super) has_cut: bool,
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
        let place = self.state_of_edge(edge)?;
        self.stroke = Some(Stroke {
            start: edge,
            now: edge,
            place,
            has_cut: false,
        });
        Ok(())
    }

    /// Cuts along the motion of the held blade since the last frame and ends the stroke.
    pub(super) fn finish_blade(&mut self) -> Result<(), SceneError> {
        let is_progressive = self.settings.blade_mode() == BladeMode::Progressive;
        let last_step = match is_progressive {
            true => self.advance_stroke()?,
            false => None,
        };
        let Some(Stroke {
            start,
            now,
            place,
            has_cut,
        }) = self.stroke.take()
        else {
            return Ok(());
        };
        if let Some(cut) = last_step {
            let inside = "nothing was cut: the blade does not reach the surface of the body";
            return self.cut_now(cut, inside);
        }
        if is_progressive {
            if place == BladeState::StartedInside && !has_cut {
                self.report_error(
                    "nothing was cut: the blade was put into the body; start outside and drag it \
                     into the body"
                        .to_owned(),
                );
            }
            return Ok(());
        }
        if place == BladeState::StartedInside || self.edge_intersects_body(start)? {
            self.report_error(
                "nothing was cut: the blade was put into the body; start outside and drag it right \
                 through"
                    .to_owned(),
            );
        } else if start != now {
            let inside = "nothing was cut: the blade was let go inside the body; drag it right \
                          through";
            let cut = self.full_slice(start, now);
            self.cut_now(cut, inside)?;
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

    /// Returns whether the scene's blade is inside the body, at the tip of its cut.
    pub(super) fn is_blade_inside(&self) -> Result<bool, SceneError> {
        let incision = self.scene.incision(self.blade, self.body)?;
        Ok(incision.is_some_and(Incision::is_inside))
    }

    /// Ends the stroke of a progressive blade, whose tip undo and redo remove.
    pub(super) fn lift_progressive_blade(&mut self) {
        if self.settings.blade_mode() == BladeMode::Progressive {
            self.stroke = None;
        }
    }

    /// Sets the scene's blade to the stroke's sweep and returns the cut, if the blade has moved.
    ///
    /// Restarts the stroke if the body has moved to its start.
    pub(super) fn advance_stroke(&mut self) -> Result<Option<RecordedCut>, SceneError> {
        let Some(mut stroke) = self.stroke else {
            return Ok(None);
        };
        let mode = self.settings.blade_mode();
        let starts_at_tip = mode == BladeMode::Progressive
            && stroke.place == BladeState::Inside
            && self.is_blade_inside()?;
        if !starts_at_tip
            && (stroke.place == BladeState::StartedInside
                || self.edge_intersects_body(stroke.start)?)
        {
            stroke.start = stroke.now;
            stroke.place = self.state_of_edge(stroke.now)?;
        }
        self.stroke = Some(stroke);
        if stroke.start == stroke.now {
            return Ok(None);
        }
        let cut = RecordedCut {
            mode,
            starts_at_tip,
            is_joined: stroke.has_cut,
            ..self.full_slice(stroke.start, stroke.now)
        };
        self.aim(&cut)?;
        Ok(Some(cut))
    }

    /// Returns the state of a blade that has not cut yet.
    fn state_of_edge(&mut self, edge: Edge) -> Result<BladeState, SceneError> {
        Ok(match self.edge_intersects_body(edge)? {
            true => BladeState::StartedInside,
            false => BladeState::Outside,
        })
    }

    /// Updates the stroke after the frame's cut.
    pub(super) fn end_step(&mut self) -> Result<(), SceneError> {
        let refusal = self.scene.failed_cuts().first().map(|r| r.error);
        let Some(mut stroke) = self.stroke else {
            return Ok(());
        };
        if self.settings.blade_mode() == BladeMode::Progressive {
            stroke.start = stroke.now;
            stroke.place = match refusal {
                _ if self.is_blade_inside()? => BladeState::Inside,
                Some(_) => self.state_of_edge(stroke.now)?,
                None => BladeState::Outside,
            };
        } else if refusal.is_some() {
            stroke.place = BladeState::Inside;
        } else {
            stroke.place = BladeState::Outside;
            stroke.start = stroke.now;
        }
        self.stroke = Some(stroke);
        let is_progressive = self.settings.blade_mode() == BladeMode::Progressive;
        match refusal {
            None => {}
            Some(CutError::PartialCut { .. }) if !is_progressive => {}
            Some(error) => self.report_error(error.to_string()),
        }
        Ok(())
    }
}
