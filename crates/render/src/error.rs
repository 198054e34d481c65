//! Why there is no picture.

use std::path::PathBuf;

/// What can go wrong between a surface and a picture.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RenderError {
    /// A picture of no pixels, or of more than are taken.
    #[error("{width} x {height} is no size of a picture here; either side has 1 to {limit} pixels")]
    Size {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// The longest side there can be.
        limit: u32,
    },
    /// The bytes are not those of so many pixels.
    #[error("{bytes} bytes are no {width} x {height} pixels of four each")]
    Pixels {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// How many bytes there are.
        bytes: usize,
    },
    /// The font that is part of the program is none, which only a broken build has.
    #[error("the built-in font is broken; build the program again")]
    Font,
    /// A picture cannot be packed as PNG.
    #[error("a picture cannot be packed: {0}")]
    Png(#[from] png::EncodingError),
    /// A picture cannot be written.
    #[error("{}: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The device can do less than what is needed.
    #[error(
        "the device has {name} = {have}, {need} is needed; choose another one, or open it with higher limits"
    )]
    LimitTooSmall {
        /// The limit, as WebGPU calls it.
        name: &'static str,
        /// What is needed.
        need: u64,
        /// What the device has.
        have: u64,
    },
    /// Storage buffers cannot be read where vertices are made.
    #[error(
        "the device reads no storage buffers in vertex shaders; choose another one ({message})"
    )]
    VertexStorage {
        /// What the device said.
        message: String,
    },
    /// The device cannot draw into such a texture, or not with so many samples.
    #[error(
        "the device draws no {format} with {samples} samples a pixel; take what it says to support"
    )]
    Format {
        /// The texture's format, as WebGPU calls it.
        format: String,
        /// Samples of a pixel.
        samples: u32,
    },
    /// The canvas is of another kind than the renderer draws on.
    #[error("the canvas was made for another renderer; make one for this")]
    ForeignCanvas,
    /// More bytes than the device takes as one buffer or binding.
    #[error("{what} would take {bytes} bytes, the device allows {limit}; draw less at once")]
    BufferTooLarge {
        /// What the buffer is for.
        what: &'static str,
        /// Its size \[bytes\].
        bytes: u64,
        /// The largest that the device allows \[bytes\].
        limit: u64,
    },
    /// A body with triangles whose corners have no position.
    #[error(
        "the body's triangles need {need} positions and it has {have}; update its positions after its topology"
    )]
    TooFewPositions {
        /// Vertex slots of the topology.
        need: u64,
        /// Positions there are.
        have: u64,
    },
    /// A part of a buffer that cannot be used as positions.
    #[error(
        "bytes {start}..{end} are no positions of this buffer: it has to be a storage buffer that holds them, 16 bytes each"
    )]
    NoPositions {
        /// Where the part begins.
        start: u64,
        /// Where it ends.
        end: u64,
    },
    /// There is no memory left.
    #[error("{what}: out of memory; draw smaller pictures or fewer bodies")]
    OutOfMemory {
        /// What was being done.
        what: &'static str,
    },
    /// The device is gone, and all that lay on it.
    #[error("the device is lost ({reason}); open a new one and make renderer and bodies again")]
    DeviceLost {
        /// What the driver said.
        reason: String,
    },
    /// A call was refused. That is a defect of this crate, or of who shares its device.
    #[error("{what} was refused: {message}; this is a defect, please report it")]
    Validation {
        /// What was being done.
        what: &'static str,
        /// Why it was refused.
        message: String,
    },
    /// The driver failed at something that is allowed.
    #[error("{what} failed in the driver: {message}; update the driver or choose another device")]
    Driver {
        /// What was being done.
        what: &'static str,
        /// What it said.
        message: String,
    },
    /// The picture was not done in time.
    #[error("the device did not finish within {seconds} s; draw smaller pictures or fewer bodies")]
    Timeout {
        /// How long was waited \[s\].
        seconds: u64,
    },
}
