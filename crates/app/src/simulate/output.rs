//! [`SimulateOutput`]: the files that a simulation writes, as options and as keys of a scene file.

use crate::failure::Failure;
use crate::format::Format;
use crate::numbers::small_count;
#[cfg(feature = "gpu")]
use crate::picture::PictureOptions;
use crate::pieces::output_path;
use serde::Deserialize;
use std::num::NonZeroU16;
use std::path::{Path, PathBuf};

/// The files to write.
#[derive(Debug, Clone, Default, clap::Args, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct SimulateOutput {
    /// The folder for the pieces at the end, or a file NAME.glb for all of them.
    #[arg(short = 'o', long = "output", value_name = "DIR|FILE.glb", value_parser = output_path())]
    pub(super) pieces: Option<PathBuf>,
    /// Format of the pieces in a folder. [default: obj]
    #[arg(long, value_enum)]
    pub(super) format: Option<Format>,
    /// Draw the simulation as `DIR/frame_0000.png` and so on.
    #[cfg(feature = "gpu")]
    #[arg(long, value_name = "DIR", value_parser = output_path())]
    pub(super) frames: Option<PathBuf>,
    /// Draw the simulation as an animated PNG.
    #[cfg(feature = "gpu")]
    #[arg(long, value_name = "FILE.png", value_parser = output_path())]
    pub(super) animation: Option<PathBuf>,
    /// Write the motion as one file of glTF: pieces with morph targets, at the times of pictures.
    #[arg(long, value_name = "FILE.glb", value_parser = output_path())]
    pub(super) export: Option<PathBuf>,
    /// Pictures per second of simulated time. [default: 30]
    #[arg(long, value_name = "N", value_parser = small_count, allow_hyphen_values = true)]
    fps: Option<NonZeroU16>,
    /// Appearance of the pictures.
    #[cfg(feature = "gpu")]
    #[command(flatten)]
    pub(super) picture: PictureOptions,
}

/// Default number of pictures per second.
const PICTURES_PER_SECOND: u16 = 30;

impl SimulateOutput {
    /// Adds the files of `other` in place of missing ones.
    pub(super) fn or(self, other: Self) -> Self {
        Self {
            pieces: self.pieces.or(other.pieces),
            format: self.format.or(other.format),
            #[cfg(feature = "gpu")]
            frames: self.frames.or(other.frames),
            #[cfg(feature = "gpu")]
            animation: self.animation.or(other.animation),
            export: self.export.or(other.export),
            fps: self.fps.or(other.fps),
            #[cfg(feature = "gpu")]
            picture: self.picture.or(other.picture),
        }
    }

    /// Returns true if nothing is to be written.
    pub(super) fn is_empty(&self) -> bool {
        self.pieces.is_none() && !self.is_recorded()
    }

    /// Returns true if an output shows the motion.
    pub(super) fn is_recorded(&self) -> bool {
        #[cfg(feature = "gpu")]
        if self.frames.is_some() || self.animation.is_some() {
            return true;
        }
        self.export.is_some()
    }

    /// Returns the number of pictures per second of simulated time.
    pub(super) fn pictures_per_second(&self) -> u16 {
        self.fps.map_or(PICTURES_PER_SECOND, NonZeroU16::get)
    }

    /// Refuses an animation whose name is not that of a PNG, and outputs of the same name.
    pub(super) fn check(&self) -> Result<(), Failure> {
        #[cfg(feature = "gpu")]
        if let Some(path) = &self.animation {
            let extension = path.extension().map(|e| e.to_ascii_lowercase());
            if !extension.is_some_and(|e| e == "png" || e == "apng") {
                let path = path.clone();
                return Err(Failure::ImageFormat { path });
            }
        }
        let files = [
            &self.pieces,
            #[cfg(feature = "gpu")]
            &self.animation,
            &self.export,
        ];
        let mut places = Vec::new();
        for path in files.into_iter().flatten() {
            let place = place(path);
            if places.contains(&place) {
                let path = path.clone();
                return Err(Failure::SameOutput { path });
            }
            places.push(place);
        }
        Ok(())
    }

    /// Returns the paths of all files and folders.
    pub(super) fn paths_mut(&mut self) -> impl Iterator<Item = &mut PathBuf> {
        [
            &mut self.pieces,
            #[cfg(feature = "gpu")]
            &mut self.frames,
            #[cfg(feature = "gpu")]
            &mut self.animation,
            &mut self.export,
        ]
        .into_iter()
        .flatten()
    }
}

/// Returns the path of a file that may not exist yet, equal for all spellings of its folder.
fn place(path: &Path) -> PathBuf {
    let of_parent = || {
        let folder = std::path::absolute(path)
            .ok()?
            .parent()?
            .canonicalize()
            .ok()?;
        Some(folder.join(path.file_name()?))
    };
    path.canonicalize()
        .ok()
        .or_else(of_parent)
        .unwrap_or_else(|| path.to_owned())
}
