//! [`SceneParams`]: the parameters of a scene's frames.

use crate::contacts::ContactParams;
use crate::error::SceneError;
use crate::sleep::SleepParams;
use incise_cut::CutParams;
use incise_params::{Params, Range};
use incise_pbd_gpu::SolverParams;

incise_params::params! {
    /// Parameters of a scene's frames.
    ///
    /// By default there are 60 frames a second, a checkpoint a second, sleeping and no contacts.
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub struct SceneParams {
        /// Duration of a frame.
        dt: f32 = 1.0 / 60.0, range: Range::POSITIVE, unit: "s";
        /// Parameters of the solver.
        solver: SolverParams = SolverParams::default();
        /// Parameters of cuts.
        cut: CutParams = CutParams::default();
        /// Whether a sweep skips bodies whose bounding box it does not overlap.
        ///
        /// Off, every sweep is tested against every body's triangles, as in the paper's protocol.
        skip_far_sweeps: bool = true;
        /// Interval of checkpoints of GPU bodies; 0 = none.
        ///
        /// A checkpoint copies a body to the CPU without waiting. The scene continues from it if
        /// the GPU fails.
        checkpoint: u32 = 60, unit: "frames";
        /// Contacts between bodies, their pieces and blade faces; `None` disables them.
        ///
        /// Contact detection runs on the CPU once per frame; positions of GPU bodies near others,
        /// in several pieces, or with self-collision, are read back for it. Bodies that touch are
        /// stepped together on the CPU.
        contacts: Option<ContactParams> = None;
        /// When bodies at rest fall asleep; `None` steps every body in every frame.
        sleep: Option<SleepParams> = Some(SleepParams::default());
    }
}

impl SceneParams {
    /// Checks all parameters, for a caller that sets them long before the next frame.
    ///
    /// # Errors
    /// [`SceneError::Parameter`] and [`SceneError::Frame`].
    pub fn check(&self) -> Result<(), SceneError> {
        self.check_ranges()?;
        self.solver.check(self.dt).map_err(SceneError::Frame)
    }

    /// Checks all parameters except those of cuts, which each cut checks.
    pub(crate) fn check_motion(&self) -> Result<(), SceneError> {
        let motion = Self {
            cut: CutParams::default(),
            ..*self
        };
        motion.check()
    }
}
