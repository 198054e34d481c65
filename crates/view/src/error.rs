//! Why there is no window.

use crate::recording::RecordingError;
use incise_pbd_gpu::GpuError;
use incise_render::RenderError;
use incise_scene::SceneError;

/// Why there is no window, or why it was closed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ViewError {
    /// Nobody would see it.
    #[error(
        "there is no display to open a window on; start it on a desktop, or set DISPLAY or WAYLAND_DISPLAY to one ({message})"
    )]
    NoDisplay {
        /// What the system said.
        message: String,
    },
    /// The display has no window for it.
    #[error("the window cannot be opened: {message}")]
    Window {
        /// What the system said.
        message: String,
    },
    /// Nothing can draw in the window.
    #[error(
        "no device can draw in a window here; install a driver, on Debian the packages mesa-vulkan-drivers and libvulkan1 ({message})"
    )]
    NoSurface {
        /// What the system said.
        message: String,
    },
    /// The only device that was asked for, or that there is, may not even be asked whether it draws in a window.
    #[error(
        "{adapter} cannot draw in a window here; take another adapter, `incise devices` lists them, or leave the choice to the program"
    )]
    NotInWindows {
        /// Its name.
        adapter: String,
    },
    /// There is no device, or it has failed.
    #[error(transparent)]
    Device(#[from] GpuError),
    /// There is no picture.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// The body cannot be simulated.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The recording is not for this body.
    #[error("the recording: {0}")]
    Recording(#[from] RecordingError),
}
