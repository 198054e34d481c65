//! [`SceneFile`]: the description of a simulation, read from a TOML file or made of options.

mod colliders;
mod defaults;
mod material;
mod read;

pub(super) use colliders::ColliderFile;
pub(super) use material::MaterialFile;
pub(crate) use read::SceneFileError;

use super::Backend;
use super::output::SimulateOutput;
use crate::failure::Failure;
use crate::numbers::{Numbers, finite_number, positive_number};
use incise_mesh::geometry::round_to_f32;
use incise_params::{Parameter, Params, Value};
use incise_pbd_gpu::Material;
use incise_scene::{ContactParams, SceneParams};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::PathBuf;
use toml::Spanned;

/// A simulation: bodies, materials, colliders, cuts, blades and output.
///
/// All other keys are parameters of the scene. Coordinates are those of the first body's file
/// \[m\]; the y axis points up.
#[derive(Debug, Clone, Deserialize)]
pub(super) struct SceneFile {
    /// Simulated time \[s\].
    #[serde(deserialize_with = "positive_number")]
    pub(super) seconds: f64,
    /// Time step of a frame \[s\].
    #[serde(default = "defaults::dt", deserialize_with = "positive_number")]
    pub(super) dt: f64,
    /// Whether meshes with edges of more than two triangles are separated there.
    #[serde(default = "defaults::yes")]
    pub(super) repair: bool,
    /// Backend that steps the bodies.
    #[serde(default)]
    pub(super) backend: Backend,
    /// A part of the GPU's name.
    #[serde(default)]
    pub(super) adapter: Option<String>,
    /// Materials by name: values that replace those of a preset.
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
    /// Files to write.
    #[serde(default)]
    pub(super) output: SimulateOutput,
    /// Other parameters of the scene, by name.
    #[serde(flatten)]
    pub(super) params: BTreeMap<String, Value>,
    /// The file and its text; none for a scene made of options.
    #[serde(skip)]
    source: Option<Source>,
}

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

    /// Returns the default parameters of a scene.
    ///
    /// Pieces touch each other, and both walls of a cut by a blade, which may end inside.
    pub(super) fn default_params(has_blades: bool) -> SceneParams {
        SceneParams {
            contacts: Some(ContactParams {
                self_collision: has_blades,
                ..ContactParams::default()
            }),
            ..SceneParams::default()
        }
    }

    /// Returns the parameters of the scene.
    pub(super) fn scene_params(&self) -> Result<SceneParams, Failure> {
        let mut params = SceneParams {
            dt: round_to_f32(self.dt),
            ..Self::default_params(!self.blades.is_empty())
        };
        let entries = self.params.iter();
        let entries = entries.map(|(name, value)| (name.clone(), value.clone()));
        let set = params.set_value(&Value::Map(entries.collect()));
        let set = set.and_then(|()| Ok(params.check_ranges()?));
        set.map_err(|source| self.refuse_parameter(source))?;
        Ok(params)
    }

    /// Returns the material of each body, after a check of all materials of the file; `None` for
    /// the default.
    pub(super) fn materials(&self) -> Result<Vec<Option<Material>>, Failure> {
        for (name, own) in &self.materials {
            self.own_material(name, own)?;
        }
        self.bodies.iter().map(|body| self.material(body)).collect()
    }

    /// Returns the material of a body, `None` for the default.
    fn material(&self, body: &BodyFile) -> Result<Option<Material>, Failure> {
        let Some(name) = &body.material else {
            return Ok(None);
        };
        if let Some(own) = self.materials.get(name.get_ref()) {
            return self.own_material(name.get_ref(), own).map(Some);
        }
        let preset = Material::preset(name.get_ref());
        preset.map(Some).ok_or_else(|| {
            self.refuse(SceneFileError::UnknownMaterial {
                line: self.line(name).unwrap_or_default(),
                name: name.get_ref().clone(),
            })
        })
    }

    /// Returns a material of the file.
    fn own_material(&self, name: &str, own: &Spanned<MaterialFile>) -> Result<Material, Failure> {
        own.get_ref().material().map_err(|source| {
            let prefix = ["materials.", name, "."].concat();
            let line = self.line_of_key(&prefix, Material::FIELDS, &source.name());
            let line = line.or_else(|| self.line(own)).unwrap_or_default();
            self.refuse(SceneFileError::Parameter { line, source })
        })
    }
}
