//! Errors of the window.

use crate::recording::RecordingError;
use incise_pbd_gpu::GpuError;
use incise_render::RenderError;
use incise_scene::SceneError;

/// An error that prevents the window from opening, or closes it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ViewError {
    /// No display is available.
    #[error(
        "no display found; start the program on a desktop, or set DISPLAY or WAYLAND_DISPLAY \
         ({message})"
    )]
    NoDisplay {
        /// Message of the window system.
        message: String,
    },
    /// The window system failed to create a window.
    #[error("the window cannot be opened: {message}")]
    Window {
        /// Message of the window system.
        message: String,
    },
    /// No adapter can present to the window.
    #[error(
        "no GPU adapter can draw in a window here; install a driver, on Debian the packages \
         mesa-vulkan-drivers and libvulkan1 ({message})"
    )]
    NoSurface {
        /// Message of the window system.
        message: String,
    },
    /// The only matching adapter cannot present to windows.
    #[error(
        "{adapter} cannot draw in a window here; choose another adapter, `incise devices` lists \
         them, or omit the option"
    )]
    NoPresentation {
        /// Name of the adapter.
        adapter: String,
    },
    /// No GPU is available, or the GPU failed.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// Rendering failed.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// The simulation failed.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The recording does not match the body.
    #[error("recording: {0}")]
    Recording(#[from] RecordingError),
}
