//! Read access to a session: picking, state, statistics and recording.

use super::{FrameReport, PickResult, Session, StatusMessage};
use crate::command::Settings;
use crate::recording::{Entry, Recording, surface_hash};
use incise_mesh::{Aabb, Surface, Vec3};
use incise_scene::{Body, BodyId, FrameStats, Scene, SceneError};

impl Session {
    /// Returns the first intersection of a ray with the body.
    ///
    /// # Errors
    /// As [`Scene::cast_ray`].
    pub fn pick(
        &mut self,
        origin: Vec3,
        direction: Vec3,
    ) -> Result<Option<PickResult>, SceneError> {
        let Some(hit) = self.scene.cast_ray(self.body, origin, direction)? else {
            return Ok(None);
        };
        let corners = self.surface().topology().triangle(hit.triangle);
        let point = origin + direction * hit.distance;
        let nearest = (0..3).max_by(|&i, &j| hit.weights[i].total_cmp(&hit.weights[j]));
        Ok(nearest.map(|i| PickResult {
            vertex: corners[i],
            point,
        }))
    }

    /// Returns the CPU copy of the body, which [`Session::read`] updates.
    #[must_use]
    pub fn surface(&self) -> &Surface {
        // The session owns the body, so that its id is always valid.
        let body = self.scene.body(self.body);
        body.map_or(&self.initial, Body::surface)
    }

    /// Updates the CPU copy of the body.
    ///
    /// # Errors
    /// As [`Scene::read_back`].
    pub fn read(&mut self) -> Result<(), SceneError> {
        self.scene.read_back(self.body)
    }

    /// Returns the current bounding box of the body \[m\]. Reads a GPU body back.
    ///
    /// # Errors
    /// As [`Scene::read_back`].
    pub fn bounds(&mut self) -> Result<Aabb, SceneError> {
        self.read()?;
        Ok(self.surface().bounds())
    }

    /// Returns the scene.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Returns the id of the body in the [scene](Self::scene).
    #[must_use]
    pub fn body(&self) -> BodyId {
        self.body
    }

    /// Returns true if the body sleeps and no blade is held, so that frames change nothing.
    #[must_use]
    pub fn is_asleep(&self) -> bool {
        self.scene.is_asleep(self.body) == Ok(true) && self.stroke.is_none()
    }

    /// Returns the current settings.
    #[must_use]
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Returns the height of the ground \[m\].
    #[must_use]
    pub fn ground(&self) -> f32 {
        self.ground
    }

    /// Returns the diagonal of the initial bounding box \[m\].
    #[must_use]
    pub fn diagonal(&self) -> f32 {
        self.diagonal
    }

    /// Returns the number of frames so far.
    #[must_use]
    pub fn frames(&self) -> u64 {
        self.frame
    }

    /// Returns the report of the last frame.
    #[must_use]
    pub fn last_frame(&self) -> &FrameReport {
        &self.last_frame
    }

    /// Returns the statistics of the last frame with a cut.
    #[must_use]
    pub fn last_cut_stats(&self) -> Option<&FrameStats> {
        self.last_cut_stats.as_ref()
    }

    /// Returns the current message for the user.
    #[must_use]
    pub fn status_message(&self) -> Option<&StatusMessage> {
        self.status_message.as_ref()
    }

    /// Clears the message for the user.
    pub fn clear_status_message(&mut self) {
        self.status_message = None;
    }

    /// Returns a counter that changes with the connectivity of the body.
    #[must_use]
    pub fn topology_version(&self) -> u64 {
        self.topology
    }

    /// Returns a counter that changes when the body may have moved.
    #[must_use]
    pub fn positions_version(&self) -> u64 {
        self.positions
    }

    /// Returns the recording so far.
    #[must_use]
    pub fn recording(&self) -> &Recording {
        &self.recording
    }

    /// Returns a hash of connectivity and positions, bit for bit.
    ///
    /// # Errors
    /// As [`Scene::read_back`].
    pub fn fingerprint(&mut self) -> Result<u64, SceneError> {
        self.read()?;
        Ok(surface_hash(self.surface()))
    }

    /// Returns the recording so far with an end entry for the current state.
    ///
    /// # Errors
    /// As [`Scene::read_back`].
    pub fn finished_recording(&mut self) -> Result<Recording, SceneError> {
        let mut recording = self.recording.clone();
        let state = self.fingerprint()?;
        recording.push(Entry::End {
            frame: self.frame,
            state,
        });
        Ok(recording)
    }
}
