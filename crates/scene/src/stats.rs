//! [`FrameStats`]: counters and times of one frame, filled by `frame.rs` and the GPU side, and the
//! results of a scene's last frame.

use crate::scene::{FailedCut, Scene, SweepResult};
use std::time::Duration;

/// Counters and times of one frame.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct FrameStats {
    /// Blades that moved.
    pub sweeps: u32,
    /// Sweeps that intersected no body.
    pub missed_sweeps: u32,
    /// Blades that did not move, or only along their edge.
    pub resting_blades: u32,
    /// Body and sweep pairs whose bounding boxes overlapped, so that triangles were tested.
    pub narrow_phase_queries: u32,
    /// Body and sweep pairs whose bounding boxes were disjoint.
    pub broad_phase_rejections: u32,
    /// Bodies whose bounding box was computed from all vertices.
    ///
    /// For all others the last box, grown by the displacement since, was sufficient.
    pub aabbs_computed: u32,
    /// BVHs refitted to moved triangles.
    pub bvh_refits: u32,
    /// BVHs that needed no refit: no query, or no motion.
    pub bvh_refits_skipped: u32,
    /// Triangles returned by BVH queries of sweeps.
    pub candidate_triangles: usize,
    /// Triangles that sweeps intersected.
    pub hit_triangles: usize,
    /// Cuts done.
    pub cuts: u32,
    /// Cuts that failed, see [`crate::Scene::failed_cuts`].
    pub failed_cuts: u32,
    /// Body and collider pairs passed to the solver.
    pub collider_pairs: usize,
    /// Contacts between pieces and with blade faces, see [`crate::SceneParams::contacts`].
    pub contacts: usize,
    /// Bodies searched for contacts.
    pub contact_searches: u32,
    /// Bodies that were asleep during the frame, see [`crate::SleepParams`].
    pub sleeping_bodies: u32,
    /// Bodies that fell asleep at the end of the frame.
    pub fell_asleep: u32,
    /// Bodies that woke since the previous frame.
    pub woken: u32,
    /// CPU solver iterations saved, see [`incise_pbd_gpu::SolverParams::residual`].
    pub iterations_skipped: u32,
    /// Bodies that took the global step, see [`incise_pbd_gpu::Scheme`].
    pub global_bodies: u32,
    /// Memory of their global steps \[bytes\].
    pub global_bytes: usize,
    /// Longest time of the last factorization of a body, beside the frames or in its first one.
    pub factor_time: Duration,
    /// Greatest age of a factor in use, in frames since its constraints were copied.
    pub factor_age: u32,
    /// Bodies that the GPU steps.
    pub gpu_bodies: u32,
    /// GPU bodies stepped by one workgroup each, see [`incise_pbd_gpu::Schedule`].
    pub whole_bodies: u32,
    /// GPU bodies stepped pass by pass, with one workgroup per patch.
    pub patch_bodies: u32,
    /// GPU dispatches of the frame.
    pub dispatches: u32,
    /// GPU kernels compiled since the previous frame.
    pub kernels_compiled: u32,
    /// GPU bodies read back because their bounding box overlapped a sweep's.
    pub readbacks: u32,
    /// GPU bodies that no sweep came near.
    pub readbacks_skipped: u32,
    /// Bytes uploaded to the GPU since the previous frame: edits and parameters.
    pub bytes_uploaded: u64,
    /// Bytes read back since the previous frame: states, bounding boxes, checkpoints.
    pub bytes_read: u64,
    /// Whether the scene or a body moved from the GPU to the CPU since the previous frame.
    ///
    /// [`crate::Scene::backend_report`] has the reason.
    pub fell_back: bool,
    /// Time of BVH refits, queries and intersection tests.
    pub detection: Duration,
    /// Time of mesh edits.
    pub topology: Duration,
    /// Time of meshing cross-sections.
    pub refinement: Duration,
    /// Time of updating constraints and BVHs after cuts.
    pub constraint_update: Duration,
    /// Time of uploading edited bodies to the GPU.
    pub gpu_upload: Duration,
    /// Time of finding contacts.
    pub contact_detection: Duration,
    /// Time of the CPU solver and of submitting GPU work.
    pub solver: Duration,
}

impl FrameStats {
    /// Returns the time of everything that a cut needs, from detection to the GPU upload.
    #[must_use]
    pub fn cutting(&self) -> Duration {
        self.detection + self.topology + self.refinement + self.constraint_update + self.gpu_upload
    }

    /// Returns the time of the whole frame.
    #[must_use]
    pub fn total(&self) -> Duration {
        self.cutting() + self.contact_detection + self.solver
    }
}

impl Scene {
    /// Returns counters and times of the last frame.
    #[must_use]
    pub fn stats(&self) -> &FrameStats {
        &self.stats
    }

    /// Returns the cuts that failed in the last frame, for example a sweep that ended inside a
    /// body.
    #[must_use]
    pub fn failed_cuts(&self) -> &[FailedCut] {
        &self.failed_cuts
    }

    /// Returns the results of the last frame's sweeps: cuts and misses, in the order of blades.
    #[must_use]
    pub fn cuts(&self) -> &[SweepResult] {
        &self.cuts
    }
}
