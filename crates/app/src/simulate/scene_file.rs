//! [`SceneFile`]: the description of a simulation, read from a TOML file or made of options.

mod colliders;
mod defaults;
mod material;
mod read;

pub(super) use colliders::ColliderFile;
pub(super) use material::{InteriorSpringsFile, MaterialFile, Preset, VolumeFile};
pub(crate) use read::SceneFileError;

use super::Backend;
use super::output::SimulateOutput;
use crate::caps::CapsOption;
use crate::failure::Failure;
use crate::numbers::{Numbers, finite_number, positive_number};
use incise_pbd_gpu::Material;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::num::NonZeroU32;
use std::path::PathBuf;
use toml::Spanned;

/// A simulation: bodies, materials, ground, colliders, cuts, blades, contacts and output.
///
/// Coordinates are those of the first body's file \[m\]; the y axis points up.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SceneFile {
    /// Simulated time \[s\].
    #[serde(deserialize_with = "positive_number")]
    pub(super) seconds: f64,
    /// Time step of a frame \[s\].
    #[serde(default = "defaults::dt", deserialize_with = "positive_number")]
    pub(super) dt: f64,
    /// Solver iterations per substep.
    #[serde(default = "defaults::iterations")]
    pub(super) iterations: NonZeroU32,
    /// Substeps per frame.
    #[serde(default = "defaults::substeps")]
    pub(super) substeps: NonZeroU32,
    /// Gravitational acceleration [m/s^2].
    #[serde(default = "defaults::gravity")]
    pub(super) gravity: Numbers<3>,
    /// Height of the ground plane \[m\].
    #[serde(default)]
    pub(super) ground: Option<Height>,
    /// Curves along which caps close cuts.
    #[serde(default)]
    pub(super) caps: CapsOption,
    /// Whether meshes with edges of more than two triangles are separated there.
    #[serde(default = "defaults::yes")]
    pub(super) repair: bool,
    /// Backend that steps the bodies.
    #[serde(default)]
    pub(super) backend: Backend,
    /// A part of the GPU's name.
    #[serde(default)]
    pub(super) adapter: Option<String>,
    /// Materials by name.
    #[serde(default)]
    pub(super) materials: BTreeMap<String, Spanned<MaterialFile>>,
    /// Bodies, in the order of the written pieces.
    #[serde(default)]
    pub(super) bodies: Vec<BodyFile>,
    /// Rigid obstacles.
    #[serde(default)]
    pub(super) colliders: Vec<Spanned<ColliderFile>>,
    /// Cuts along planes; in one frame the first one cuts first.
    #[serde(default)]
    pub(super) cuts: Vec<Spanned<PlaneCut>>,
    /// Straight blades that move.
    #[serde(default)]
    pub(super) blades: Vec<Spanned<BladeFile>>,
    /// Contacts between bodies and pieces.
    #[serde(default)]
    pub(super) contacts: ContactsFile,
    /// Files to write.
    #[serde(default)]
    pub(super) output: SimulateOutput,
    /// The file and its text; none for a scene made of options.
    #[serde(skip)]
    source: Option<Source>,
}

/// A height \[m\].
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(transparent)]
pub(super) struct Height(#[serde(deserialize_with = "finite_number")] pub(super) f64);

/// The file of a scene.
#[derive(Debug, Clone)]
struct Source {
    path: PathBuf,
    text: String,
}

/// A body at rest at the start.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct BodyFile {
    /// A file or the name of a built-in model.
    pub(super) mesh: PathBuf,
    /// The name of a material or of a preset.
    #[serde(default)]
    pub(super) material: Option<Spanned<String>>,
    /// Motion before the start \[m\].
    #[serde(default = "defaults::zero")]
    pub(super) offset: Numbers<3>,
}

/// A cut of all bodies along a plane.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PlaneCut {
    /// Normal and offset: `nx x + ny y + nz z = d`.
    pub(super) plane: Numbers<4>,
    /// Time of the cut \[s\].
    #[serde(default, deserialize_with = "finite_number")]
    pub(super) at: f64,
}

/// A straight blade that moves by timed poses, or along the path of a file.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct BladeFile {
    /// Poses in the order of their times.
    pub(super) poses: Option<Vec<Spanned<TimedPose>>>,
    /// A file of poses, one per frame.
    pub(super) path: Option<PathBuf>,
    /// Time of the first pose of the path \[s\].
    pub(super) at: Option<f64>,
    /// Vector from the edge to the back of a face that bodies collide with \[m\].
    pub(super) face: Option<Numbers<3>>,
}

/// A pose of a blade; the blade moves straight from pose to pose.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TimedPose {
    /// Time \[s\].
    #[serde(deserialize_with = "finite_number")]
    pub(super) at: f64,
    /// Start and end of the edge \[m\].
    pub(super) edge: [Numbers<3>; 2],
}

/// Contacts between bodies and pieces.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct ContactsFile {
    /// Whether there are contacts.
    pub(super) enabled: bool,
    /// Minimum distance between surfaces [edge lengths].
    pub(super) thickness: f32,
    /// Whether the triangles of one piece collide; by default with blades only, for the walls of
    /// cuts that end inside.
    pub(super) self_collision: Option<bool>,
}

impl SceneFile {
    /// Checks that the frames can be counted.
    pub(super) fn check_frames(&self) -> Result<(), Failure> {
        let Self { seconds, dt, .. } = *self;
        if seconds / dt < f64::from(u32::MAX) {
            Ok(())
        } else {
            Err(Failure::TooManyFrames { seconds, dt })
        }
    }

    /// Returns the number of frames, at least one.
    pub(super) fn frames(&self) -> u32 {
        self.frame_at(self.seconds).max(1)
    }

    /// Returns the frame that begins nearest to a time \[s\].
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a saturating cast"
    )]
    pub(super) fn frame_at(&self, time: f64) -> u32 {
        (time / self.dt).round() as u32
    }

    /// Returns the material of a body.
    pub(super) fn material(&self, body: &BodyFile) -> Result<Material, Failure> {
        let Some(name) = &body.material else {
            return Ok(Preset::default().material());
        };
        if let Some(own) = self.materials.get(name.get_ref()) {
            let material = own.get_ref().material();
            // The scene checks the material of options.
            return match (self.line(own), material.check()) {
                (Some(line), Err(source)) => {
                    Err(self.refuse(SceneFileError::Material { line, source }))
                }
                _ => Ok(material),
            };
        }
        let preset = Preset::from_name(name.get_ref());
        preset.map(Preset::material).ok_or_else(|| {
            self.refuse(SceneFileError::UnknownMaterial {
                line: self.line(name).unwrap_or_default(),
                name: name.get_ref().clone(),
            })
        })
    }
}
