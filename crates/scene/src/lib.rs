//! Bodies, blades and the frame loop.
//!
//! A [`Scene`] holds soft [`Body`]s and [`Blade`]s and steps them frame by frame: sweeps are made
//! from blade poses, bodies near a sweep are cut, constraints follow, the solver moves everything.
//! What a frame does not need it does not do, and [`FrameStats`] counts what was left out.
//!
//! [`Scene::new`] steps on the processor, [`Scene::with_backend`] on a device or on whichever is faster.
//! A body on a device stays there: [`Scene::read`] brings the host's copy of it up to date.
//!
//! How `examples/slice_in_motion.rs` begins:
//!
//! ```
//! use incise_mesh::{Model, build_model};
//! use incise_pbd_gpu::{Material, Volume};
//! use incise_scene::{ContactParams, Scene, SceneError, SceneParams};
//!
//! fn main() -> Result<(), SceneError> {
//!     let mut scene = Scene::new(SceneParams::default());
//!     let body = scene.add_body(build_model(Model::Sphere768), &Material::default())?;
//!     let blade = scene.add_blade([[-2.0, 0.1, -2.0], [-2.0, 0.1, 2.0]]); // left of it
//!     scene.step()?;
//!     scene.move_blade(blade, [[2.0, 0.1, -2.0], [2.0, 0.1, 2.0]]); // and right of it
//!     println!("{:?}", scene.step()?);
//!     // and on
//! # Ok(())
//! }
//! ```

mod backend;
mod blade;
mod body;
mod colliders;
mod contacts;
#[cfg(feature = "gpu")]
mod device;
#[cfg(not(feature = "gpu"))]
#[path = "no_device.rs"]
mod device;
mod error;
mod frame;
mod params;
mod scene;
mod sleep;
mod stats;
mod struts;

pub use backend::{BackendChoice, BackendReport, BackendRequest};
pub use blade::{Blade, BladeId};
pub use body::{Body, BodyId};
pub use contacts::ContactParams;
pub use error::SceneError;
pub use params::SceneParams;
pub use scene::{Refusal, Scene};
pub use sleep::SleepParams;
pub use stats::FrameStats;
