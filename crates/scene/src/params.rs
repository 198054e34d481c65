//! [`SceneParams`]: the parameters of a scene's frames.

use crate::contacts::ContactParams;
use crate::error::SceneError;
use crate::sleep::SleepParams;
use incise_cut::CutParams;
use incise_pbd_gpu::SolverParams;

/// Parameters of a scene's frames.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SceneParams {
    /// Duration of a frame \[s\].
    pub dt: f32,
    /// Parameters of the solver.
    pub solver: SolverParams,
    /// Parameters of cuts.
    pub cut: CutParams,
    /// Whether a sweep skips bodies whose bounding box it does not overlap.
    ///
    /// Off, every sweep is tested against every body's triangles, as in the paper's protocol.
    pub skip_far_sweeps: bool,
    /// Interval of checkpoints of GPU bodies \[frames\]; 0 = none.
    ///
    /// A checkpoint copies a body to the CPU without waiting. The scene continues from it if the
    /// GPU fails.
    pub checkpoint: u32,
    /// Contacts between bodies, their pieces and blade faces; `None` disables them.
    ///
    /// Contact detection runs on the CPU once per frame; positions of GPU bodies near others, in
    /// several pieces, or with self-collision, are read back for it. Bodies that touch are stepped
    /// together on the CPU.
    pub contacts: Option<ContactParams>,
    /// When bodies at rest fall asleep; `None` steps every body in every frame.
    pub sleep: Option<SleepParams>,
}

impl SceneParams {
    /// Checks all parameters, for a caller that sets them long before the next frame.
    ///
    /// # Errors
    /// [`SceneError::Frame`], [`SceneError::InvalidSleepParams`],
    /// [`SceneError::InvalidContactThickness`] and [`SceneError::Cut`].
    pub fn check(&self) -> Result<(), SceneError> {
        self.check_motion()?;
        self.cut.check().map_err(SceneError::Cut)
    }

    /// Checks all parameters except those of cuts, which each cut checks.
    pub(crate) fn check_motion(&self) -> Result<(), SceneError> {
        self.solver.check(self.dt).map_err(SceneError::Frame)?;
        self.sleep.map_or(Ok(()), |sleep| sleep.check())?;
        self.contacts.map_or(Ok(()), |contacts| contacts.check())
    }
}

impl Default for SceneParams {
    /// Returns 60 frames a second, a checkpoint a second, sleeping enabled and no contacts.
    fn default() -> Self {
        Self {
            dt: 1.0 / 60.0,
            solver: SolverParams::default(),
            cut: CutParams::default(),
            skip_far_sweeps: true,
            checkpoint: 60,
            contacts: None,
            sleep: Some(SleepParams::default()),
        }
    }
}
