//! [`SceneOptions`]: the options that describe a scene, in place of a scene file.

use super::scene_file::{BladeFile, BodyFile, ColliderFile, PlaneCut, SceneFile};
use crate::failure::Failure;
use crate::input::InputOptions;
use crate::numbers::{Numbers, not_negative, numbers, positive};
use crate::param_options::{OptionSet, ParamOptions};
use clap::Arg;
use clap::builder::PossibleValuesParser;
use incise_params::Value;
use incise_pbd_gpu::Material;
use incise_scene::SceneParams;
use std::path::PathBuf;
use toml::Spanned;

/// Options that describe a scene.
#[derive(clap::Args)]
pub(super) struct SceneOptions {
    #[command(flatten)]
    reading: InputOptions,
    /// Move an input before the start [m]. Repeat once per input, in their order.
    #[arg(
        long,
        value_name = "X,Y,Z",
        value_parser = numbers::<3>,
        allow_hyphen_values = true
    )]
    offset: Vec<Numbers<3>>,
    /// Simulated time [s].
    #[arg(long, value_name = "S", value_parser = positive, allow_hyphen_values = true)]
    seconds: Option<f64>,
    /// Time step of a frame, as a number or a fraction [s]. [default: 1/60]
    #[arg(long, value_name = "S", value_parser = positive, allow_hyphen_values = true)]
    dt: Option<f64>,
    /// Add a horizontal plane at a height [m]; the meshes must begin above it.
    #[arg(long, value_name = "H", value_parser = numbers::<1>, allow_hyphen_values = true)]
    ground: Option<Numbers<1>>,
    /// Material of the bodies. [default: soft-body, or cloth for a mesh with a boundary]
    #[arg(long, value_name = "NAME", value_parser = PossibleValuesParser::new(Material::PRESETS))]
    material: Option<String>,
    /// Let pieces pass through each other instead of resolving their contacts.
    #[arg(long)]
    no_contacts: bool,
    /// Cut all bodies along the plane `nx x + ny y + nz z = d`. Several planes cut in their order.
    #[arg(
        long,
        value_name = "NX,NY,NZ,D",
        value_parser = numbers::<4>,
        allow_hyphen_values = true,
        group = "cutter"
    )]
    plane: Vec<Numbers<4>>,
    /// Move a straight blade through the bodies, one pose per frame. The cut may end inside.
    ///
    /// The file is that of `incise cut --path`, with two points per line. The blade stands at its
    /// last pose. The walls of the cut collide with each other, except with --no-contacts.
    #[arg(long, value_name = "FILE", group = "cutter")]
    path: Option<PathBuf>,
    /// Time of the cut, or of the first pose [s]; 0 by default.
    ///
    /// Give one time for all planes, or one per plane in their order.
    #[arg(
        long,
        value_name = "S",
        value_parser = not_negative,
        allow_hyphen_values = true,
        requires = "cutter"
    )]
    at: Vec<f64>,
    #[command(flatten)]
    params: ParamOptions<SceneOptionSet>,
}

/// The parameters of a scene without an option of their own.
#[derive(Debug)]
struct SceneOptionSet;

impl OptionSet for SceneOptionSet {
    type Params = SceneParams;

    fn defaults() -> SceneParams {
        SceneFile::default_params(false)
    }

    fn option(path: &str, option: Arg) -> Option<Arg> {
        match path {
            "dt" => None,
            "contacts" => Some(option.conflicts_with("no_contacts")),
            "contacts.self_collision" => {
                let help = option
                    .get_help()
                    .map(ToString::to_string)
                    .unwrap_or_default();
                Some(option.help(help + " True by default with --path."))
            }
            path if path.starts_with("cut.") => Some(option.requires("cutter")),
            _ => Some(option),
        }
    }
}

impl SceneOptions {
    /// Returns the first option of the command line that a scene file replaces.
    pub(super) fn first_given(&self) -> Option<String> {
        let own = [
            ("--no-repair", !self.reading.repair()),
            ("--offset", !self.offset.is_empty()),
            ("--seconds", self.seconds.is_some()),
            ("--dt", self.dt.is_some()),
            ("--ground", self.ground.is_some()),
            ("--material", self.material.is_some()),
            ("--no-contacts", self.no_contacts),
            ("--plane", !self.plane.is_empty()),
            ("--path", self.path.is_some()),
            ("--at", !self.at.is_empty()),
        ];
        let own = own.into_iter().find(|(_, is_given)| *is_given);
        let own = own.map(|(name, _)| name.to_owned());
        own.or_else(|| self.params.first_option())
    }

    /// Returns the scene of the inputs and options.
    pub(super) fn scene_file(&self, inputs: &[PathBuf]) -> Result<SceneFile, Failure> {
        let seconds = self.seconds.ok_or(Failure::NoSeconds)?;
        if self.offset.len() > inputs.len() {
            return Err(Failure::Offsets {
                offsets: self.offset.len(),
                bodies: inputs.len(),
            });
        }
        let mut file = SceneFile::new(seconds);
        file.dt = self.dt.unwrap_or(file.dt);
        let ground = self.ground.iter();
        let ground = ground.map(|&Numbers([height])| unplaced(ColliderFile::ground(height)));
        file.colliders = ground.collect();
        file.repair = self.reading.repair();
        file.params = self.params.given().iter().cloned().collect();
        if self.no_contacts {
            file.params
                .insert("contacts".to_owned(), Value::Flag(false));
        }
        let offsets = self.offset.iter().copied();
        let offsets = offsets.chain(std::iter::repeat(Numbers([0.0; 3])));
        let bodies = inputs.iter().zip(offsets).map(|(mesh, offset)| BodyFile {
            mesh: mesh.clone(),
            material: self.material.clone().map(unplaced),
            offset,
        });
        file.bodies = bodies.collect();
        let times = self.times()?;
        let planes = self.plane.iter().zip(&times);
        let planes = planes.map(|(&plane, &at)| unplaced(PlaneCut { plane, at }));
        file.cuts = planes.collect();
        let blade = self.path.iter().map(|path| {
            unplaced(BladeFile {
                path: Some(path.clone()),
                at: times.first().copied(),
                ..BladeFile::default()
            })
        });
        file.blades = blade.collect();
        Ok(file)
    }

    /// Returns the time of each cut: of every plane, or of the path \[s\].
    fn times(&self) -> Result<Vec<f64>, Failure> {
        let planes = self.plane.len().max(1);
        match self.at.as_slice() {
            [] => Ok(vec![0.0; planes]),
            &[time] => Ok(vec![time; planes]),
            times if times.len() == planes => Ok(times.to_vec()),
            times => Err(Failure::CutTimes {
                times: times.len(),
                planes: self.plane.len(),
            }),
        }
    }
}

/// Returns a value without a place in a file.
fn unplaced<T>(value: T) -> Spanned<T> {
    Spanned::new(0..0, value)
}
