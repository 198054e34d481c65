//! Contact detection of a frame: which bodies take part, and which sleeping ones it wakes.

use crate::body::Body;
use crate::contacts::{BladeFace, ContactFrame, ContactParams, PieceId};
use crate::error::SceneError;
use crate::frame::inflated;
use crate::params::SceneParams;
use crate::scene::Scene;
use incise_mesh::Vec3;
use incise_pbd_gpu::MovingCollider;
use web_time::Instant;

impl Scene {
    /// Finds the contacts of the frame, wakes touched bodies and groups bodies into islands.
    ///
    /// GPU bodies near others, in several pieces or near a blade face are read back.
    pub(crate) fn find_contacts(&mut self) -> Result<(), SceneError> {
        let begin = Instant::now();
        self.detection.begin_frame(&self.bodies);
        if let Some(params) = self.params.contacts {
            self.separate_overlaps(params)?;
            // A woken body may touch others that sleep.
            self.search_contacts(params)?;
            while self.wake_touched() {
                self.search_contacts(params)?;
            }
        }
        let Self {
            bodies,
            detection,
            islands,
            sleep,
            gpu,
            params,
            ..
        } = self;
        let is_awake = |i: usize| !sleep.is_asleep(i);
        let is_on_gpu = |i: usize| gpu.as_ref().is_some_and(|gpu| gpu.holds(i));
        self.stats.contacts += islands.group(bodies, detection, is_awake, is_on_gpu)?;
        for (i, body) in bodies.iter().enumerate() {
            let touches = islands.is_shared(i) || detection.contacts(i).next().is_some();
            if let Some(body) = body.as_ref().filter(|_| touches && !sleep.is_asleep(i)) {
                sleep.measure(i, body, params);
            }
        }
        if let Some(gpu) = gpu {
            for (i, body) in bodies.iter().enumerate() {
                // The CPU steps it in this frame.
                if let Some(body) = body.as_ref().filter(|_| islands.members(i).is_some()) {
                    gpu.begin_edit(i, body.surface());
                }
            }
        }
        self.stats.contact_detection = begin.elapsed();
        Ok(())
    }

    /// Moves pieces apart that are deep in each other; their bodies are read back.
    fn separate_overlaps(&mut self, params: ContactParams) -> Result<(), SceneError> {
        for n in 0..self.detection.overlaps() {
            self.stop_approach(self.detection.shifts(n))?;
        }
        let frame = contact_frame(
            params,
            &self.params,
            &self.moving_colliders,
            &self.blade_faces,
        );
        for n in 0..self.detection.find_moves(&self.bodies, &frame) {
            let (piece, shift) = self.detection.piece_move(n);
            if let Some(body) = self.begin_move(piece)? {
                body.move_piece(piece.number, shift);
            }
        }
        Ok(())
    }

    /// Removes the approach velocity of an overlapping pair along its separation.
    ///
    /// They share the change as they share the displacement, so that neither moves along gravity.
    fn stop_approach(&mut self, pair: [(PieceId, Vec3); 2]) -> Result<(), SceneError> {
        let apart = pair[1].1 - pair[0].1;
        let mut velocities = [Vec3::zeros(); 2];
        for (velocity, (piece, _)) in velocities.iter_mut().zip(pair) {
            if let Some(body) = self.begin_move(piece)? {
                *velocity = body.piece_velocity(piece.number);
            }
        }
        // Relative to the displacement apart [1/s].
        let rate = (velocities[1] - velocities[0]).dot(&apart) / apart.norm_squared();
        if rate < 0.0 {
            for (piece, shift) in pair {
                if let Some(body) = &mut self.bodies[piece.body as usize] {
                    body.add_piece_velocity(piece.number, shift * -rate)?;
                }
            }
        }
        Ok(())
    }

    /// Reads the body of a piece back and wakes it, before it is moved.
    fn begin_move(&mut self, piece: PieceId) -> Result<Option<&mut Body>, SceneError> {
        let i = piece.body as usize;
        if let (Some(gpu), Some(body)) = (&mut self.gpu, &mut self.bodies[i])
            && let Err(error) = gpu.read_back(i, body)
        {
            self.recover(None, error)?;
        }
        let Some(body) = &mut self.bodies[i] else {
            return Ok(None);
        };
        self.sleep.wake(i);
        self.islands.forget(i);
        if let Some(gpu) = &mut self.gpu {
            gpu.begin_edit(i, body.surface());
        }
        Ok(Some(body))
    }

    /// Searches all bodies that may be in contact, at least one of each pair awake.
    fn search_contacts(&mut self, params: ContactParams) -> Result<(), SceneError> {
        self.stats.contact_searches = 0;
        self.detection.begin_search(self.bodies.len());
        if self.bodies.iter().flatten().nth(1).is_some() {
            loop {
                match self.find_near() {
                    // Bodies that were read back have smaller boxes, by which others are near.
                    Ok(()) if self.read_back_near()? => {}
                    Ok(()) => break,
                    // After a fallback the CPU copies are the bodies.
                    Err(error) => self.recover(None, error)?,
                }
            }
        }
        for i in 0..self.bodies.len() {
            let Some(body) = &mut self.bodies[i] else {
                continue;
            };
            let is_asleep = self.sleep.is_asleep(i);
            let may_collide = self.detection.is_near(i) || !is_asleep && body.may_collide(&params);
            let at_face = !is_asleep && !self.blade_faces.is_empty();
            if !(may_collide || at_face) {
                continue;
            }
            if let Some(gpu) = &mut self.gpu
                && let Err(error) = gpu.read_back(i, body)
            {
                self.recover(None, error)?;
            }
            let Some(body) = &mut self.bodies[i] else {
                continue;
            };
            let refit = u32::from(body.refit());
            self.stats.bvh_refits += refit;
            self.stats.bvh_refits_skipped = self.stats.bvh_refits_skipped.saturating_sub(refit);
            body.measure_pieces();
            self.stats.contact_searches += 1;
            let frame = contact_frame(
                params,
                &self.params,
                &self.moving_colliders,
                &self.blade_faces,
            );
            self.detection.activate(i, body, &frame);
        }
        let frame = contact_frame(
            params,
            &self.params,
            &self.moving_colliders,
            &self.blade_faces,
        );
        self.detection.find(&self.bodies, &frame);
        Ok(())
    }

    /// Reads back the GPU bodies near others; returns whether there are any.
    fn read_back_near(&mut self) -> Result<bool, SceneError> {
        let mut any = false;
        for (i, body) in self.bodies.iter_mut().enumerate() {
            let (Some(gpu), Some(body)) = (&mut self.gpu, body) else {
                continue;
            };
            if self.detection.is_near(i) && !self.sleep.is_asleep(i) {
                match gpu.read_back(i, body) {
                    Ok(is_read) => any |= is_read,
                    Err(error) => {
                        self.recover(None, error)?;
                        return Ok(true);
                    }
                }
            }
        }
        Ok(any)
    }

    /// Finds the bodies whose boxes overlap within the frame.
    fn find_near(&mut self) -> Result<(), SceneError> {
        let Some(params) = self.params.contacts else {
            return Ok(());
        };
        let frame = contact_frame(
            params,
            &self.params,
            &self.moving_colliders,
            &self.blade_faces,
        );
        self.detection.begin_search(self.bodies.len());
        for (i, body) in self.bodies.iter().enumerate() {
            let Some(body) = body else { continue };
            if self.sleep.is_asleep(i) {
                self.detection.add_box(i, self.sleep.bounds(i), true);
                continue;
            }
            match &mut self.gpu {
                Some(gpu) if !gpu.residency(i).is_cpu_current() => {
                    if let Some(bounds) = gpu.bounds(i)? {
                        self.detection.add_box(i, inflated(bounds), false);
                    }
                }
                _ => self.detection.add_body(i, body, &frame),
            }
        }
        self.detection.find_near();
        Ok(())
    }

    /// Wakes the sleeping bodies that an awake one touches; returns whether there are any.
    fn wake_touched(&mut self) -> bool {
        let mut woke = false;
        for i in 0..self.bodies.len() {
            for contact in self.detection.contacts(i) {
                let other = contact.other as usize;
                let pair = [i, other].map(|body| self.sleep.is_asleep(body));
                if pair[0] != pair[1] {
                    self.sleep.wake(if pair[0] { i } else { other });
                    woke = true;
                }
            }
        }
        woke
    }
}

/// Returns the input of a frame's contact detection.
fn contact_frame<'a>(
    params: ContactParams,
    scene: &SceneParams,
    colliders: &'a [MovingCollider],
    blade_faces: &'a [BladeFace],
) -> ContactFrame<'a> {
    let dt = f64::from(scene.dt);
    let gravity = Vec3::from(scene.solver.gravity.map(f64::from));
    ContactFrame {
        params,
        dt,
        gravity,
        speed_gain: gravity.norm() * dt,
        colliders,
        blade_faces,
    }
}
