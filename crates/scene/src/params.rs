//! What a scene's user chooses.

use crate::contacts::ContactParams;
use crate::sleep::SleepParams;
use incise_cut::CutParams;
use incise_pbd_gpu::SolverParams;

/// How a scene is stepped.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SceneParams {
    /// Time of a frame \[s\].
    pub dt: f32,
    /// How bodies move.
    pub solver: SolverParams,
    /// How bodies are cut.
    pub cut: CutParams,
    /// Whether a body is left alone by a sweep whose box misses the body's. Off, every moving
    /// blade's sweep is tested against every body's triangles, as the paper's protocol does.
    pub skip_far_sweeps: bool,
    /// Every how many frames bodies on a device are copied to the host, while the device goes on: what
    /// the scene goes on with should the device fail. 0 = never.
    pub checkpoint: u32,
    /// How the pieces of a body touch each other. `None` lets them pass through each other and costs nothing.
    ///
    /// Contacts are found by the host: a body on a device that is in more than one piece, or touches itself, is brought
    /// home in every frame.
    pub contacts: Option<ContactParams>,
    /// When bodies at rest are left alone until something comes to them. `None` steps every body in every frame, as who
    /// measures a solver wants it.
    pub sleep: Option<SleepParams>,
}

impl Default for SceneParams {
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
