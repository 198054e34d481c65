//! What a frame did and what it left out.

use std::time::Duration;

/// What a frame did, left out and cost.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FrameStats {
    /// Blades that moved.
    pub sweeps: u32,
    /// Blades at rest, which asked nothing.
    pub sweeps_skipped: u32,
    /// Bodies whose triangles were tested against a sweep.
    pub detections: u32,
    /// Bodies that a sweep's box missed.
    pub detections_skipped: u32,
    /// Bodies of which every vertex was looked at to find the box. Of all others it was known well
    /// enough: where it was before, and how far anything has moved since.
    pub boxes: u32,
    /// Search trees fitted to moved triangles.
    pub refits: u32,
    /// Search trees left as they were: nobody asked, or nothing had moved.
    pub refits_skipped: u32,
    /// Triangles that search trees offered.
    pub candidates: usize,
    /// Triangles that sweeps crossed.
    pub hits: usize,
    /// Cuts done.
    pub cuts: u32,
    /// Cuts refused, see [`crate::Scene::refusals`].
    pub refused: u32,
    /// Colliders that bodies were tested against, each as often as there were bodies near it.
    pub colliders: usize,
    /// Contacts that were found between pieces, see [`crate::SceneParams::contacts`].
    pub contacts: usize,
    /// Bodies whose pieces were compared with each other. Those in one piece, asleep or without contacts were not.
    pub contact_searches: u32,
    /// Bodies that slept through the frame: nothing was done for them. See [`crate::SleepParams`].
    pub asleep: u32,
    /// Bodies that fell asleep at the end of the frame.
    pub fell_asleep: u32,
    /// Bodies that woke since the frame before.
    pub woken: u32,
    /// Iterations that the processor left out, see [`incise_pbd_gpu::SolverParams::residual`].
    pub iterations_skipped: u32,
    /// Passes over the ground that the processor left out, as bodies were above it.
    pub ground_passes_skipped: u32,
    /// Bodies that a device steps.
    pub bodies_on_device: u32,
    /// Bodies on a device of which one workgroup does a whole frame.
    pub whole_bodies: u32,
    /// Bodies on a device that go color by color.
    pub color_bodies: u32,
    /// Bodies on a device that go patch by patch.
    pub patch_bodies: u32,
    /// Dispatches of the frame.
    pub dispatches: u32,
    /// Kernels compiled for the device since the frame before, those of the frame included.
    pub kernels_compiled: u32,
    /// Bodies whose state was brought from the device because a sweep came to them.
    pub readbacks: u32,
    /// Bodies whose state stayed on the device: no sweep came to them.
    pub readbacks_skipped: u32,
    /// Bytes sent to the device since the frame before: edits, parameters.
    pub bytes_uploaded: u64,
    /// Bytes brought from the device since the frame before: states, boxes, checkpoints.
    pub bytes_read: u64,
    /// Whether the scene, or one of its bodies, has left the device for the processor since the frame
    /// before, or never came to one; [`crate::Scene::backend_report`] says why. Told once.
    pub fell_back: bool,
    /// Time of refits, searches and intersections.
    pub detection: Duration,
    /// Time of mesh edits.
    pub topology: Duration,
    /// Time of caps.
    pub refinement: Duration,
    /// Time of constraints following cuts.
    pub constraints: Duration,
    /// Time of telling the device what was edited.
    pub update: Duration,
    /// Time of finding contacts.
    pub contact_detection: Duration,
    /// Time of the solver on the processor, and of handing work to the device.
    pub solver: Duration,
}

impl FrameStats {
    /// Time of everything that a cut needs: detection with the readback that it
    /// takes, topology, refinement, constraint update, the device's update.
    #[must_use]
    pub fn cutting(&self) -> Duration {
        self.detection + self.topology + self.refinement + self.constraints + self.update
    }

    /// Time of the whole frame's work.
    #[must_use]
    pub fn total(&self) -> Duration {
        self.cutting() + self.contact_detection + self.solver
    }
}
