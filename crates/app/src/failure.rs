//! Why the program stops.

use incise_cut::CutError;
use incise_mesh::{Defect, NotFit, ReadError, WriteError};
use incise_refine::HoleError;
use incise_scene::SceneError;
use std::path::PathBuf;

/// Why a command could not be done.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Failure {
    /// The input is not a mesh.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// There is no such file, and no such model.
    #[cfg(feature = "gpu")]
    #[error(
        "{}: there is no such file and no such model; name a mesh (obj, ply, stl, glb or gltf), or one of {}",
        path.display(),
        incise_mesh::Model::ALL.map(incise_mesh::Model::name).join(", ")
    )]
    NoInput {
        /// What was named.
        path: PathBuf,
    },
    /// The input is no body that can be cut.
    #[error("{}: {source}{}", path.display(), what_to_do(source))]
    NotFit {
        /// The file.
        path: PathBuf,
        /// Why.
        source: NotFit,
    },
    /// The plane or the blade is none: the command line is wrong.
    #[error("the cut: {0}")]
    Sweep(CutError),
    /// Two options that do not go together: the command line is wrong.
    #[error("{option} does not go with {with}; leave one of the two out")]
    NotWith {
        /// One option.
        option: &'static str,
        /// The other, and why.
        with: &'static str,
    },
    /// The blade's ends have changed places, so that its sweep crosses itself: the command line is wrong.
    #[error(
        "the cut: the sweep from --blade to --to crosses itself; name the blade's two ends in the same order in both"
    )]
    SweepCrossesItself,
    /// The blade moves inside solid matter.
    #[error(
        "{}: the blade's sweep lies inside the body and does not reach its surface; make the sweep larger",
        path.display()
    )]
    SweepInside {
        /// The file.
        path: PathBuf,
    },
    /// The input cannot be cut there.
    #[error("{}: {source}", path.display())]
    Cut {
        /// The file.
        path: PathBuf,
        /// Why.
        source: CutError,
    },
    /// The input's holes cannot be closed.
    #[error("{}: {source}", path.display())]
    Fill {
        /// The file.
        path: PathBuf,
        /// Why.
        source: HoleError,
    },
    /// The output's name says no format that is written: the command line is wrong.
    #[error("{}: only .obj and .ply are written; choose one of them", path.display())]
    OutputFormat {
        /// The file.
        path: PathBuf,
    },
    /// The body is to be cut when everything is over: the command line is wrong.
    #[error("--at is not before the end; raise --seconds")]
    CutAfterEnd,
    /// The body would begin in the ground, and be shot out of it: the command line is wrong.
    #[error(
        "{}: its lowest point is at {lowest}, below the ground at {ground}, which would shoot it out; give --ground {lowest} \
         or less",
        path.display()
    )]
    BelowGround {
        /// The file.
        path: PathBuf,
        /// Where the mesh begins \[m\].
        lowest: f32,
        /// Where the ground is \[m\].
        ground: f32,
    },
    /// The body cannot be moved, or there is no device to move it.
    #[error("{}: {source}", path.display())]
    Scene {
        /// The file.
        path: PathBuf,
        /// Why.
        source: SceneError,
    },
    /// The output folder cannot be made.
    #[error("{}: {source}", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// What is written would take the input's place.
    #[error("{}: this would overwrite the input; choose another folder or name", path.display())]
    TargetIsInput {
        /// The file.
        path: PathBuf,
    },
    /// Where a file is to go there is a folder.
    #[error("{}: a file is to go here, and it is a folder; choose another output", path.display())]
    TargetIsFolder {
        /// The file.
        path: PathBuf,
    },
    /// A mesh cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// A piece of an earlier run cannot be removed.
    #[error("{}: a piece of an earlier run cannot be removed: {source}", path.display())]
    Remove {
        /// The piece's file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A piece that there is not: the command line is wrong.
    #[cfg(feature = "gpu")]
    #[error("--without {piece}: there are {pieces} pieces, numbered from 0")]
    NoPiece {
        /// Its number.
        piece: usize,
        /// How many there are.
        pieces: usize,
    },
    /// The picture's name says another format: the command line is wrong.
    #[cfg(feature = "gpu")]
    #[error("{}: only .png is written; choose another name", path.display())]
    PictureFormat {
        /// The file.
        path: PathBuf,
    },
    /// A figure of the gallery cannot be made of the built-in models.
    #[cfg(feature = "gpu")]
    #[error("{figure}: {source}; leave it out with --only")]
    Figure {
        /// Its name.
        figure: &'static str,
        /// Why.
        source: crate::gallery::FigureError,
    },
    /// There is no device to draw with.
    #[cfg(feature = "gpu")]
    #[error(transparent)]
    Device(#[from] incise_pbd_gpu::GpuError),
    /// There is no picture.
    #[cfg(feature = "gpu")]
    #[error(transparent)]
    Render(#[from] incise_render::RenderError),
    /// There is no window, or what is in it has failed.
    #[cfg(feature = "view")]
    #[error(transparent)]
    View(#[from] incise_view::ViewError),
    /// The recording is none, or cannot be read.
    #[cfg(feature = "view")]
    #[error("{}: {source}", path.display())]
    Recording {
        /// The file.
        path: PathBuf,
        /// Why.
        source: incise_view::RecordingError,
    },
    /// The program was built without the feature `gpu`.
    #[cfg(not(feature = "gpu"))]
    #[error("this build has no GPU support; build it with the feature gpu")]
    NoGpuSupport,
    /// The standard output cannot be written to.
    #[error("standard output: {0}")]
    Output(#[from] std::io::Error),
}

/// Which command mends a mesh.
fn what_to_do(why: &NotFit) -> &'static str {
    match why.defects.as_slice() {
        [Defect::OpenEdge { gap: None, .. }] => " with `incise fill`",
        _ => "",
    }
}

impl Failure {
    /// What the program ends with: 2 for a wrong command line, 3 for an output that cannot be written, 1
    /// for all that is due to the input or the machine.
    pub(crate) fn exit_code(&self) -> u8 {
        #[cfg(feature = "gpu")]
        if let Some(code) = self.exit_code_of_picture() {
            return code;
        }
        match self {
            Self::Sweep(_)
            | Self::NotWith { .. }
            | Self::SweepCrossesItself
            | Self::CutAfterEnd
            | Self::BelowGround { .. }
            | Self::OutputFormat { .. } => 2,
            Self::Folder { .. }
            | Self::TargetIsInput { .. }
            | Self::TargetIsFolder { .. }
            | Self::Write(_)
            | Self::Remove { .. }
            | Self::Output(_) => 3,
            _ => 1,
        }
    }

    /// The same for what goes wrong with pictures alone.
    #[cfg(feature = "gpu")]
    fn exit_code_of_picture(&self) -> Option<u8> {
        use incise_render::RenderError;
        match self {
            Self::NoPiece { .. }
            | Self::PictureFormat { .. }
            | Self::Render(RenderError::Size { .. }) => Some(2),
            Self::Render(RenderError::Write { .. }) => Some(3),
            _ => None,
        }
    }
}
