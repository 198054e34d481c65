//! Blades and colliders of a [`Scene`].

use super::{Number, Scene, unknown};
use crate::arrays::{edge, vector};
use crate::colliders::collider;
use crate::error::OrRaise;
use crate::params::choice;
use incise::cut::{Incision, IncisionState};
use incise::scene::{BladeId, BladeMode};
use pyo3::prelude::*;

impl Scene {
    fn blade_id(&self, blade: Number) -> PyResult<BladeId> {
        let id = self.scene.blades().nth(blade.0);
        id.ok_or_else(|| unknown("blade", blade.0))
    }
}

/// Returns the value of a state in Python.
const fn name(state: IncisionState) -> &'static str {
    match state {
        IncisionState::Outside => "outside",
        IncisionState::Inside => "inside",
        IncisionState::Blocked => "blocked",
        IncisionState::Finished => "finished",
        IncisionState::Abandoned => "abandoned",
    }
}

#[pymethods]
impl Scene {
    /// Adds a straight blade with its edge from start to end [m], shape (2, 3); returns its number.
    ///
    /// `mode` is "progressive", a blade that may stop inside a body, or "full-slices".
    #[pyo3(signature = (edge, mode=None))]
    fn add_blade(
        &mut self,
        edge: &Bound<'_, PyAny>,
        mode: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<usize> {
        let edge = self::edge(edge, "edge")?;
        let read = |mode| choice(mode, "mode", BladeMode::NAMES, BladeMode::from_name);
        let mode = mode.map(read).transpose()?;
        let blade = self.scene.add_blade(edge);
        if let Some(mode) = mode {
            self.scene.set_blade_mode(blade, mode).or_raise()?;
        }
        Ok(self.scene.blades().count() - 1)
    }

    /// Moves a blade to a pose [m], shape (2, 3); the next step cuts along its sweep.
    fn move_blade(&mut self, blade: Number, edge: &Bound<'_, PyAny>) -> PyResult<()> {
        let edge = self::edge(edge, "edge")?;
        self.scene
            .move_blade(self.blade_id(blade)?, edge)
            .or_raise()
    }

    /// Moves a blade without a cut and ends its incisions.
    fn teleport_blade(&mut self, blade: Number, edge: &Bound<'_, PyAny>) -> PyResult<()> {
        let edge = self::edge(edge, "edge")?;
        self.scene
            .teleport_blade(self.blade_id(blade)?, edge)
            .or_raise()
    }

    /// Returns the incision of a blade in a body: `state` and `refused_steps`.
    ///
    /// A blade that has cut nothing, or whose incisions have ended, is `IncisionState.OUTSIDE`.
    fn incision<'py>(
        &self,
        py: Python<'py>,
        blade: Number,
        body: Number,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (blade, body) = (self.blade_id(blade)?, self.body_id(body)?);
        let incision = self.scene.incision(blade, body).or_raise()?;
        let state = incision.map(Incision::state).unwrap_or_default();
        let refused_steps = incision.map_or(0, Incision::refused_steps);
        let module = py.import("incise._incision")?;
        let state = module.call_method1("IncisionState", (name(state),))?;
        module.call_method1("Incision", (state, refused_steps))
    }

    /// Gives a blade a face, the vector from its edge to its back [m], which pushes bodies.
    ///
    /// None removes it. Faces need `contacts`.
    #[pyo3(signature = (blade, face))]
    fn set_blade_face(&mut self, blade: Number, face: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
        let face = face.map(|face| vector(face, "face")).transpose()?;
        self.scene
            .set_blade_face(self.blade_id(blade)?, face)
            .or_raise()
    }

    /// Restricts a blade to one piece of the bodies; None cuts all pieces.
    #[pyo3(signature = (blade, piece))]
    fn set_blade_piece(&mut self, blade: Number, piece: Option<Number>) -> PyResult<()> {
        let number = |piece: Number| u32::try_from(piece.0).map_err(|_| unknown("piece", piece.0));
        let piece = piece.map(number).transpose()?;
        self.scene
            .set_blade_piece(self.blade_id(blade)?, piece)
            .or_raise()
    }

    /// Replaces the rigid obstacles, a list of dictionaries with one shape each.
    ///
    /// {"plane": {"point", "normal"}}, {"sphere": {"center", "radius"}}, {"capsule": {"ends",
    /// "radius"}} or {"box": {"center", "half", "axes"}}. A list of the same length moves them
    /// within the next frame.
    fn set_colliders(&mut self, colliders: Vec<Bound<'_, PyAny>>) -> PyResult<()> {
        let read = colliders
            .iter()
            .enumerate()
            .map(|(i, value)| collider(value, i));
        self.scene.colliders = read.collect::<PyResult<_>>()?;
        Ok(())
    }
}
