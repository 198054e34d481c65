//! Errors of rendering, image composition and PNG output.

use std::path::PathBuf;

/// An error of rendering or of writing an image.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RenderError {
    /// The image has no pixels, or too many.
    #[error("invalid image size {width} x {height}: each side must have 1 to {limit} pixels")]
    InvalidSize {
        /// Width \[px\].
        width: u32,
        /// Height \[px\].
        height: u32,
        /// Maximum side \[px\].
        limit: u32,
    },
    /// The number of bytes does not match the image size.
    #[error("{bytes} bytes do not match {width} x {height} RGBA pixels")]
    PixelCount {
        /// Width \[px\].
        width: u32,
        /// Height \[px\].
        height: u32,
        /// Number of bytes.
        bytes: usize,
    },
    /// The embedded font cannot be parsed, which happens in a broken build only.
    #[error("the embedded font is invalid; build the program again")]
    InvalidFont,
    /// The image cannot be encoded as PNG.
    #[error("PNG encoding failed: {0}")]
    Png(#[from] png::EncodingError),
    /// An animation has no frames.
    #[error("the animation has no frames; write at least one")]
    NoFrames,
    /// A frame of an animation has another size than the first one.
    #[error(
        "a frame has {width} x {height} pixels, the first one {} x {}; draw all with one size",
        expected[0], expected[1]
    )]
    FrameSize {
        /// Width \[px\].
        width: u32,
        /// Height \[px\].
        height: u32,
        /// Width and height of the first frame \[px\].
        expected: [u32; 2],
    },
    /// The image file cannot be written.
    #[error("{}: {source}", path.display())]
    Write {
        /// Path of the file.
        path: PathBuf,
        /// Cause.
        source: std::io::Error,
    },
    /// A limit of the GPU device is too low.
    #[error(
        "the GPU device has {name} = {have}, but {need} is required; choose another adapter, or \
         open the device with higher limits"
    )]
    LimitTooSmall {
        /// WebGPU name of the limit.
        name: &'static str,
        /// Required value.
        need: u64,
        /// Value of the device.
        have: u64,
    },
    /// The device does not support storage buffers in vertex shaders.
    #[error(
        "the GPU device has no storage buffers in vertex shaders; choose another adapter \
         ({message})"
    )]
    NoVertexStorage {
        /// Message of the device.
        message: String,
    },
    /// The device cannot render to this texture format or sample count.
    #[error(
        "the GPU device cannot render {format} with {samples} samples per pixel; choose a format \
         and a sample count that it supports"
    )]
    UnsupportedFormat {
        /// WebGPU name of the texture format.
        format: String,
        /// Samples per pixel.
        samples: u32,
    },
    /// The attachments have another format or sample count than the renderer.
    #[error("the attachments belong to another renderer; create them with this one")]
    AttachmentMismatch,
    /// A buffer or binding would be larger than the device allows.
    #[error("{what} needs {bytes} bytes, but the device allows {limit}; draw less at once")]
    BufferTooLarge {
        /// Purpose of the buffer.
        what: &'static str,
        /// Required size \[bytes\].
        bytes: u64,
        /// Maximum size of the device \[bytes\].
        limit: u64,
    },
    /// The body has fewer positions than its topology has vertex slots.
    #[error(
        "the body needs {need} positions but has {have}; update the positions after the topology"
    )]
    TooFewPositions {
        /// Vertex slots of the topology.
        need: u64,
        /// Available positions.
        have: u64,
    },
    /// The byte range cannot be bound as positions.
    #[error(
        "bytes {start}..{end} cannot be bound as positions; pass a range of a storage buffer, with \
         16 bytes per position"
    )]
    InvalidPositionRange {
        /// Start of the range \[bytes\].
        start: u64,
        /// End of the range \[bytes\].
        end: u64,
    },
    /// Memory is exhausted.
    #[error("{what}: out of memory; draw smaller images or fewer bodies")]
    OutOfMemory {
        /// Operation that failed.
        what: &'static str,
    },
    /// The device is lost, with all of its resources.
    #[error(
        "the GPU device is lost ({reason}); open a new one and create renderer and bodies again"
    )]
    DeviceLost {
        /// Message of the driver.
        reason: String,
    },
    /// wgpu rejected a call, because of a defect in this crate or in another user of the device.
    #[error("{what}: wgpu rejected a call: {message}; this is a bug, please report it")]
    Validation {
        /// Operation that failed.
        what: &'static str,
        /// Message of wgpu.
        message: String,
    },
    /// The driver failed at a valid call.
    #[error("{what} failed in the driver: {message}; update the driver or choose another adapter")]
    Driver {
        /// Operation that failed.
        what: &'static str,
        /// Message of the driver.
        message: String,
    },
    /// The image was not finished in time.
    #[error("the GPU did not finish within {seconds} s; draw smaller images or fewer bodies")]
    Timeout {
        /// Time limit \[s\].
        seconds: u64,
    },
}
