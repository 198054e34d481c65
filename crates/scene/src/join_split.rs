//! Bodies from outside the scene, bodies joined into one, and a body split into its pieces.

use crate::body::{Body, BodyId};
use crate::error::SceneError;
use crate::scene::Scene;

impl Scene {
    /// Adds a body of [`Scene::remove_body`], of this scene or another one, with its motion.
    ///
    /// Incisions in it have ended.
    ///
    /// # Errors
    /// [`SceneError`] of the GPU when it has no memory for the body. The scene is unchanged then.
    pub fn insert_body(&mut self, mut body: Body) -> Result<BodyId, SceneError> {
        body.end_all_incisions();
        self.insert(body)
    }

    /// Joins bodies of one material into one, whose pieces they become.
    ///
    /// Positions, velocities, masses and pins stay. Cuts from before cannot be undone, and
    /// incisions have ended. A single body stays as it is. See [`incise_mesh::Surface::append`] for
    /// the numbers of vertices and pieces.
    ///
    /// # Errors
    /// [`SceneError::CannotJoin`] for materials that differ and a body listed twice,
    /// [`SceneError::NothingToJoin`], [`SceneError::Channel`] for different channels of one name,
    /// and as [`Scene::add_body`] and [`Scene::read_back`]. The bodies stay then.
    pub fn join_bodies(&mut self, bodies: &[BodyId]) -> Result<BodyId, SceneError> {
        let (&first, others) = bodies.split_first().ok_or(SceneError::NothingToJoin)?;
        for (i, &body) in bodies.iter().enumerate() {
            self.read_back(body)?;
            self.body_mut(body)?.validate_edit(body)?;
            let cannot_join = |reason| Err(SceneError::CannotJoin { body, reason });
            if bodies[..i].contains(&body) {
                return cannot_join("it is listed twice");
            }
            let material = |id| Ok::<_, SceneError>(*self.body(id)?.solver().material());
            if material(body)? != material(first)? {
                return cannot_join("its material is not that of the first body");
            }
        }
        if others.is_empty() {
            return Ok(first);
        }
        let parts = bodies.iter().map(|&id| self.body(id));
        let parts = parts.collect::<Result<Vec<_>, _>>()?;
        let joined = Body::joined(&parts)?;
        let new = self.replace(bodies, vec![joined])?;
        Ok(new[0])
    }

    /// Splits a body into one body per piece, in the order of the pieces' numbers.
    ///
    /// Positions, velocities, masses and pins stay. Cuts from before cannot be undone, and
    /// incisions have ended. A body of one piece stays as it is.
    ///
    /// # Errors
    /// [`SceneError::Constraint`] for a piece that cannot be simulated alone, and as
    /// [`Scene::add_body`] and [`Scene::read_back`]. The body stays then.
    pub fn split_body(&mut self, body: BodyId) -> Result<Vec<BodyId>, SceneError> {
        self.read_back(body)?;
        let whole = self.body_mut(body)?;
        whole.validate_edit(body)?;
        if whole.surface().piece_count() == 1 {
            return Ok(vec![body]);
        }
        let parts = whole.split()?;
        self.replace(&[body], parts)
    }

    /// Replaces bodies by others, or changes nothing.
    fn replace(&mut self, old: &[BodyId], new: Vec<Body>) -> Result<Vec<BodyId>, SceneError> {
        let mut added = Vec::with_capacity(new.len());
        for body in new {
            match self.insert(body) {
                Ok(id) => added.push(id),
                Err(error) => {
                    for id in added {
                        self.discard_body(id)?;
                    }
                    return Err(error);
                }
            }
        }
        for &id in old {
            self.discard_body(id)?;
        }
        Ok(added)
    }
}
