//! [`FrameStats`]: counters and times of one frame, filled by `frame.rs` and the GPU side, and the
//! results of a scene's last frame.

use crate::scene::{FailedCut, Scene, SweepResult};
use std::time::Duration;

incise_params::report! {
    /// Counters and times of one frame.
    #[derive(Debug, Clone, Copy, PartialEq, Default)]
    #[non_exhaustive]
    pub struct FrameStats {
        /// Blades that moved.
        sweeps: u32;
        /// Sweeps that intersected no body.
        missed_sweeps: u32;
        /// Blades that did not move, or only along their edge.
        resting_blades: u32;
        /// Body and sweep pairs whose bounding boxes overlapped, so that triangles were tested.
        narrow_phase_queries: u32;
        /// Body and sweep pairs whose bounding boxes were disjoint.
        broad_phase_rejections: u32;
        /// Bodies whose bounding box was computed from all vertices.
        ///
        /// For all others the last box, grown by the displacement since, was sufficient.
        aabbs_computed: u32;
        /// BVHs refitted to moved triangles.
        bvh_refits: u32;
        /// BVHs that needed no refit: no motion, or no query besides cuts.
        bvh_refits_skipped: u32;
        /// Triangles returned by BVH queries of sweeps.
        candidate_triangles: usize;
        /// Triangles that sweeps intersected.
        hit_triangles: usize;
        /// Cuts done.
        cuts: u32;
        /// Cuts that failed, see [`crate::Scene::failed_cuts`].
        failed_cuts: u32;
        /// Body and collider pairs passed to the solver.
        collider_pairs: usize;
        /// Contacts between pieces and with blade faces, see [`crate::SceneParams::contacts`].
        contacts: usize;
        /// Bodies searched for contacts.
        contact_searches: u32;
        /// Bodies that were asleep during the frame, see [`crate::SleepParams`].
        sleeping_bodies: u32;
        /// Bodies that fell asleep at the end of the frame.
        fell_asleep: u32;
        /// Bodies that woke since the previous frame.
        woken: u32;
        /// CPU solver iterations saved, see [`incise_pbd_gpu::SolverParams::residual`].
        iterations_skipped: u32;
        /// Bodies that the GPU steps.
        gpu_bodies: u32;
        /// GPU bodies stepped by one workgroup each, see [`incise_pbd_gpu::Schedule`].
        whole_bodies: u32;
        /// GPU bodies stepped pass by pass, with one workgroup per patch.
        patch_bodies: u32;
        /// GPU dispatches of the frame.
        dispatches: u32;
        /// GPU kernels compiled since the previous frame.
        kernels_compiled: u32;
        /// GPU bodies read back because their bounding box overlapped a sweep's.
        readbacks: u32;
        /// GPU bodies that no sweep came near.
        readbacks_skipped: u32;
        /// Bytes uploaded to the GPU since the previous frame: edits and parameters.
        bytes_uploaded: u64;
        /// Bytes read back since the previous frame: states, bounding boxes, checkpoints.
        bytes_read: u64;
        /// Whether the scene or a body moved from the GPU to the CPU since the previous frame.
        ///
        /// [`crate::Scene::backend_report`] has the reason.
        fell_back: bool;
    }
    seconds {
        /// Time of BVH refits, queries and intersection tests.
        detection;
        /// Time of mesh edits.
        topology;
        /// Time of meshing cross-sections.
        refinement;
        /// Time of updating constraints and BVHs after cuts.
        constraint_update;
        /// Time of uploading edited bodies to the GPU.
        gpu_upload;
        /// Time of finding contacts.
        contact_detection;
        /// Time of the CPU solver and of submitting GPU work.
        solver;
    }
}

impl FrameStats {
    /// Returns the time of everything that a cut needs, from detection to the GPU upload.
    #[must_use]
    pub fn cutting(&self) -> Duration {
        self.detection + self.topology + self.refinement + self.constraint_update + self.gpu_upload
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
