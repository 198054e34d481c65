//! Errors that end a command, and their exit codes.

use crate::blade_path::BladePathError;
use crate::input::OpenMeshAdvice;
#[cfg(feature = "gpu")]
use crate::numbers::counted;
use crate::simulate::SceneFileError;
use incise_cut::CutError;
use incise_mesh::{Aabb, NotCuttable, ReadError, WriteError};
use incise_models::Model;
use incise_paper::PaperError;
use incise_params::ParamError;
use incise_refine::HoleError;
use incise_scene::SceneError;
use std::path::PathBuf;

/// The exit code of unusable input, or of a machine without a GPU.
const UNUSABLE_INPUT: u8 = 1;
/// The exit code of a wrong command line.
pub(crate) const WRONG_COMMAND_LINE: u8 = 2;
/// The exit code of an output that cannot be written.
const UNWRITABLE_OUTPUT: u8 = 3;
/// The exit code of a cut that misses the mesh, or of a simulation without a cut.
const MISSED: u8 = 4;

/// The reason why a method cannot make a cut.
#[derive(Debug, thiserror::Error)]
pub(crate) enum CutFailure {
    /// Of the exact method.
    #[error(transparent)]
    Cut(CutError),
    /// Of the paper's method.
    #[error(transparent)]
    Paper(PaperError),
}

/// An error that ends a command.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Failure {
    /// The input is not a mesh.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The input names neither a file nor a model.
    #[error(
        "{}: no such file or model; name a mesh (obj, ply, stl, glb or gltf) or one of {}",
        path.display(),
        Model::ALL.map(Model::name).join(", ")
    )]
    NoInput {
        /// The name.
        path: PathBuf,
    },
    /// The input names no file, but its name without the extension is that of a model.
    #[error(
        "{}: no such file; the built-in model is called {model}, without extension",
        path.display()
    )]
    NoFileButModel {
        /// The file.
        path: PathBuf,
        /// The model's name.
        model: &'static str,
    },
    /// The input is a folder.
    #[error("{}: this is a folder; name a mesh (obj, ply, stl, glb or gltf)", path.display())]
    InputIsFolder {
        /// The folder.
        path: PathBuf,
    },
    /// The bounding box of the input is so large that a plane through it leaves 32 bits.
    #[error(
        "{}: its coordinates reach from {:?} to {:?}, too large for a cut by a plane; scale the \
         mesh",
        path.display(), bounds.min, bounds.max
    )]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Bounding box of the mesh \[m\].
        bounds: Aabb,
    },
    /// The input is not a closed, oriented manifold.
    #[error("{}: {source}{advice}", path.display())]
    NotCuttable {
        /// The file.
        path: PathBuf,
        /// All defects.
        source: NotCuttable,
        /// How to close an open mesh.
        advice: OpenMeshAdvice,
    },
    /// The plane or blade of the command line defines no sweep.
    #[error("invalid cut: {0}")]
    Sweep(CutError),
    /// A parameter of the command line has no meaning, or is out of range.
    #[error("invalid option: {0}")]
    Parameter(#[from] ParamError),
    /// Two options of the command line exclude each other.
    #[error("{option} cannot be combined with {with}; omit one of the two")]
    NotWith {
        /// One option.
        option: String,
        /// The other, and the reason.
        with: &'static str,
    },
    /// The sweep of the command line's blade crosses itself: its ends are swapped.
    #[error(
        "invalid cut: the sweep from --blade to --to crosses itself; give the blade's two ends in \
         the same order in both"
    )]
    SweepCrossesItself,
    /// The sweep lies inside the body.
    #[error(
        "{}: the blade's sweep lies inside the body and does not reach its surface; make the sweep \
         larger",
        path.display()
    )]
    SweepInside {
        /// The file.
        path: PathBuf,
    },
    /// The sweep misses the mesh.
    #[error(
        "{}: the cut misses the mesh, whose bounding box is {:?} to {:?}; {output}; move the plane \
         or the blade",
        path.display(), bounds.min, bounds.max
    )]
    Missed {
        /// The file.
        path: PathBuf,
        /// Bounding box of the mesh at the time of the cut \[m\].
        bounds: Aabb,
        /// The content of the output.
        output: &'static str,
    },
    /// The cut cannot be made.
    #[error("{}: {source}", path.display())]
    Cut {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: CutFailure,
    },
    /// The path of the blade cannot be used.
    #[error("{}: {source}", path.display())]
    Path {
        /// The file of the path.
        path: PathBuf,
        /// The reason.
        source: BladePathError,
    },
    /// A step of the blade along its path cannot be cut.
    #[error("{}: line {line}: {source}; nothing was written", path.display())]
    Step {
        /// The file of the path.
        path: PathBuf,
        /// The line of the pose at the end of the step.
        line: usize,
        /// The reason.
        source: CutError,
    },
    /// No cut of a simulation could be made; each has a warning.
    #[error(
        "{}: no cut could be made, see the warnings; the files hold the uncut bodies",
        path.display()
    )]
    NoCut {
        /// The files of the bodies.
        path: PathBuf,
    },
    /// A cut of a simulation cannot be made; the body is unchanged.
    #[error("{}: at {at:.3} s: {source}; the simulation goes on without this cut", path.display())]
    SkippedCut {
        /// The file of the body.
        path: PathBuf,
        /// The time \[s\].
        at: f64,
        /// The reason.
        source: CutError,
    },
    /// A step of a blade of a simulation cannot be cut; the body is unchanged.
    #[error(
        "{}: line {line}, at {at:.3} s: {source}; the simulation goes on without this step",
        path.display()
    )]
    SkippedStep {
        /// The file of the blade's path.
        path: PathBuf,
        /// The time \[s\].
        at: f64,
        /// The line of the pose at the end of the step.
        line: usize,
        /// The reason.
        source: CutError,
    },
    /// The blade moves inside the body and does not cross its surface.
    #[error(
        "{}: line {line}: the blade moves inside the body and does not reach its surface; make it \
         longer, or let it start outside the body; nothing was written",
        path.display()
    )]
    BladeInside {
        /// The file of the path.
        path: PathBuf,
        /// The line of the pose at the end of the step.
        line: usize,
    },
    /// The holes cannot be closed.
    #[error("{}: {source}", path.display())]
    Fill {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: HoleError,
    },
    /// The output's extension is not that of a supported format.
    #[error(
        "{}: only .obj, .ply, .stl and .glb can be written; choose one of them",
        path.display()
    )]
    OutputFormat {
        /// The file.
        path: PathBuf,
    },
    /// The command line describes a scene without its duration.
    #[error("--seconds is missing; give the simulated time, or a scene file (toml)")]
    NoSeconds,
    /// A simulation has more frames than can be counted.
    #[error(
        "{seconds:e} s have more than {} frames of {dt:e} s; simulate less time, or longer frames",
        u32::MAX
    )]
    TooManyFrames {
        /// The simulated time [s].
        seconds: f64,
        /// The time step [s].
        dt: f64,
    },
    /// A simulation writes nothing.
    #[error(
        "there is no output; give -o DIR for the pieces, --frames or --animation for pictures, or \
         --export FILE.glb"
    )]
    NoOutput,
    /// A scene file and other inputs are given.
    #[error(
        "{}: a scene file is the only input; add meshes to it as [[bodies]]",
        path.display()
    )]
    SceneAndMeshes {
        /// The scene file.
        path: PathBuf,
    },
    /// A scene file cannot be used.
    #[error("{}: {source}", path.display())]
    SceneFile {
        /// The scene file.
        path: PathBuf,
        /// The reason.
        source: SceneFileError,
    },
    /// The time of the cut is after the end of the simulation.
    #[error("--at is not before the end of the simulation; increase --seconds")]
    CutAfterEnd,
    /// The times of cuts are neither one for all nor one for each.
    #[error("{times} times --at for {planes} times --plane; give one for all, or one for each")]
    CutTimes {
        /// The number of times.
        times: usize,
        /// The number of planes.
        planes: usize,
    },
    /// There are more offsets than bodies.
    #[error("{offsets} times --offset for {bodies} inputs; give at most one for each")]
    Offsets {
        /// The number of offsets.
        offsets: usize,
        /// The number of inputs.
        bodies: usize,
    },
    /// An offset moves a body so far that single precision rounds its shape away.
    #[error(
        "{}: at this offset coordinates are {spacing:.1e} m apart in single precision, too coarse \
         for the body; move it less",
        path.display()
    )]
    FarOffset {
        /// The file.
        path: PathBuf,
        /// Distance of neighboring coordinates \[m\].
        spacing: f64,
    },
    /// A body is far beyond the place where the scene was.
    #[error(
        "{}: the body has left the scene: it is {distance:.3e} m away after {seconds} s; use \
         shorter substeps or a softer material, or shorten the run",
        path.display()
    )]
    LeftScene {
        /// The file.
        path: PathBuf,
        /// Distance of its farthest corner from the center of the scene at the start \[m\].
        distance: f64,
        /// Length of the run \[s\].
        seconds: f64,
    },
    /// The path of the blade has more poses than the simulation has frames after the first one.
    #[error(
        "the blade's path of {poses} poses, one per frame, ends after the simulation; give \
         --seconds {seconds} or more"
    )]
    PathAfterEnd {
        /// The number of poses.
        poses: usize,
        /// The time at which the path ends [s].
        seconds: f64,
    },
    /// The mesh starts in a plane, which would eject it.
    #[error(
        "{}: it starts {depth} m deep in the ground or another plane, which would eject it; lower \
         the plane, or move the mesh",
        path.display()
    )]
    InPlane {
        /// The file.
        path: PathBuf,
        /// The greatest depth of a vertex \[m\].
        depth: f64,
    },
    /// The body cannot be simulated, or there is no GPU for it.
    #[error("{}: {source}", path.display())]
    Scene {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: SceneError,
    },
    /// The output folder cannot be created.
    #[error("{}: the folder cannot be created: {source}", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// The reason.
        source: std::io::Error,
    },
    /// The output would overwrite the input.
    #[error("{}: this would overwrite the input; choose another folder or name", path.display())]
    TargetIsInput {
        /// The file.
        path: PathBuf,
    },
    /// Two outputs have the same name.
    #[error("{}: two outputs have this name; choose another one for either", path.display())]
    SameOutput {
        /// The file.
        path: PathBuf,
    },
    /// The output file's name is that of a folder.
    #[error("{}: the output file is a folder; choose another name", path.display())]
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
        /// The reason.
        source: std::io::Error,
    },
    /// The command line names a piece that does not exist.
    #[cfg(feature = "gpu")]
    #[error("--without {piece}: the image has {}, numbered from 0", counted(*pieces, "piece"))]
    NoPiece {
        /// Its number.
        piece: usize,
        /// The number of pieces.
        pieces: usize,
    },
    /// The image's extension is not that of PNG.
    #[cfg(feature = "gpu")]
    #[error("{}: only .png can be written; choose another name", path.display())]
    ImageFormat {
        /// The file.
        path: PathBuf,
    },
    /// The command of a figure's panel is wrong.
    #[cfg(feature = "gpu")]
    #[error("{command}: {source}; omit the figure with --only")]
    Figure {
        /// The command of the panel.
        command: String,
        /// The reason.
        source: Box<clap::Error>,
    },
    /// No GPU can draw.
    #[cfg(feature = "gpu")]
    #[error(transparent)]
    Device(#[from] incise_pbd_gpu::GpuError),
    /// The image cannot be drawn or written.
    #[cfg(feature = "gpu")]
    #[error(transparent)]
    Render(#[from] incise_render::RenderError),
    /// The program was built without the feature `gpu`.
    #[cfg(not(feature = "gpu"))]
    #[error("this build has no GPU support; build it with the feature gpu")]
    NoGpuSupport,
    /// The standard output cannot be written to.
    #[error("standard output: {0}")]
    Output(#[from] std::io::Error),
}

impl Failure {
    /// Returns the exit code of the program.
    pub(crate) fn exit_code(&self) -> u8 {
        #[cfg(feature = "gpu")]
        if let Some(code) = self.exit_code_of_image() {
            return code;
        }
        match self {
            Self::Sweep(_)
            | Self::Parameter(_)
            | Self::NotWith { .. }
            | Self::SweepCrossesItself
            | Self::NoSeconds
            | Self::TooManyFrames { .. }
            | Self::NoOutput
            | Self::SceneAndMeshes { .. }
            | Self::CutAfterEnd
            | Self::CutTimes { .. }
            | Self::Offsets { .. }
            | Self::FarOffset { .. }
            | Self::PathAfterEnd { .. }
            | Self::InPlane { .. }
            | Self::SameOutput { .. }
            | Self::OutputFormat { .. } => WRONG_COMMAND_LINE,
            Self::Folder { .. }
            | Self::TargetIsInput { .. }
            | Self::TargetIsFolder { .. }
            | Self::Write(_)
            | Self::Remove { .. }
            | Self::Output(_) => UNWRITABLE_OUTPUT,
            Self::Missed { .. } | Self::NoCut { .. } => MISSED,
            _ => UNUSABLE_INPUT,
        }
    }

    #[cfg(feature = "gpu")]
    fn exit_code_of_image(&self) -> Option<u8> {
        use incise_render::RenderError;
        match self {
            Self::NoPiece { .. }
            | Self::ImageFormat { .. }
            | Self::Render(RenderError::InvalidSize { .. }) => Some(WRONG_COMMAND_LINE),
            Self::Render(RenderError::Write { .. }) => Some(UNWRITABLE_OUTPUT),
            _ => None,
        }
    }
}
