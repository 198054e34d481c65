#![doc = include_str!("../README.md")]

pub use incise_cut as cut;
pub use incise_mesh as mesh;
#[cfg(feature = "paper")]
pub use incise_paper as paper;
pub use incise_params as params;
pub use incise_pbd_gpu as pbd;
pub use incise_refine as refine;
#[cfg(feature = "render")]
pub use incise_render as render;
pub use incise_scene as scene;

/// The types that a first scene needs.
pub mod prelude {
    pub use incise_cut::{CutError, CutOutcome, CutParams, Cutter, Incision, IncisionState, Sweep};
    pub use incise_mesh::{Surface, Vec3, VertexId, icosphere};
    #[cfg(feature = "io")]
    pub use incise_mesh::{read_mesh, write_obj};
    pub use incise_pbd_gpu::{
        Collider, InteriorSprings, Material, SolverParams, Stiffness, Volume,
    };
    pub use incise_scene::{
        BackendChoice, BackendRequest, BladeId, BladeMode, BodyId, ContactParams, FrameStats,
        Scene, SceneError, SceneParams, SleepParams,
    };
}
