//! What is seen of a session.

use super::{Frame, Notice, Picked, Session};
use crate::command::Settings;
use crate::recording::{Entry, Recording, number};
use incise_mesh::{Aabb, Surface, Vec3};
use incise_scene::{BodyId, FrameStats, Scene, SceneError};

impl Session {
    /// What a ray meets first.
    ///
    /// # Errors
    /// As [`Scene::cast`].
    pub fn pick(&mut self, origin: Vec3, direction: Vec3) -> Result<Option<Picked>, SceneError> {
        let Some(hit) = self.scene.cast(self.body, origin, direction)? else {
            return Ok(None);
        };
        let corners = self.surface().topology().triangle(hit.triangle);
        let point = origin + direction * hit.distance;
        let nearest = (0..3).max_by(|&i, &j| hit.weights[i].total_cmp(&hit.weights[j]));
        Ok(nearest.map(|i| Picked {
            vertex: corners[i],
            point,
        }))
    }

    /// The body as the host knows it; up to date after [`Session::read`].
    #[must_use]
    pub fn surface(&self) -> &Surface {
        self.scene.body(self.body).surface()
    }

    /// Brings the host's copy of the body up to date.
    ///
    /// # Errors
    /// As [`Scene::read`].
    pub fn read(&mut self) -> Result<(), SceneError> {
        self.scene.read(self.body)
    }

    /// The body's box, where it is now \[m\]. Waits for a device.
    ///
    /// # Errors
    /// As [`Scene::read`].
    pub fn bounds(&mut self) -> Result<Aabb, SceneError> {
        self.read()?;
        Ok(self.surface().bounds())
    }

    /// The scene.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The body in the [scene](Self::scene).
    #[must_use]
    pub fn body(&self) -> BodyId {
        self.body
    }

    /// Whether the body sleeps, so that frames change nothing.
    #[must_use]
    pub fn is_asleep(&self) -> bool {
        self.scene.is_asleep(self.body) && self.stroke.is_none()
    }

    /// What was chosen.
    #[must_use]
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Height of the ground \[m\].
    #[must_use]
    pub fn ground(&self) -> f32 {
        self.ground
    }

    /// The diagonal of the body's box at first \[m\].
    #[must_use]
    pub fn diagonal(&self) -> f32 {
        self.diagonal
    }

    /// Frames so far.
    #[must_use]
    pub fn frames(&self) -> u64 {
        self.frame
    }

    /// What the last frame did.
    #[must_use]
    pub fn last(&self) -> &Frame {
        &self.last
    }

    /// What the last frame in which anything was cut did.
    #[must_use]
    pub fn last_cut(&self) -> Option<&FrameStats> {
        self.last_cut.as_ref()
    }

    /// What is to be told.
    #[must_use]
    pub fn notice(&self) -> Option<&Notice> {
        self.notice.as_ref()
    }

    /// Takes the notice away.
    pub fn dismiss(&mut self) {
        self.notice = None;
    }

    /// A number that is another one when the body has other triangles.
    #[must_use]
    pub fn topology_version(&self) -> u64 {
        self.topology
    }

    /// A number that is another one when the body may be elsewhere.
    #[must_use]
    pub fn positions_version(&self) -> u64 {
        self.positions
    }

    /// Everything that was done so far.
    #[must_use]
    pub fn recording(&self) -> &Recording {
        &self.recording
    }

    /// A number that tells apart where everything is, to the bit.
    ///
    /// # Errors
    /// As [`Scene::read`].
    pub fn fingerprint(&mut self) -> Result<u64, SceneError> {
        self.read()?;
        Ok(number(self.surface()))
    }

    /// The recording with its end: the frame it is in now, and where everything is.
    ///
    /// # Errors
    /// As [`Scene::read`].
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
