//! Commands and settings of a session, as serializable data.

use incise_cut::{Caps, CutMethod, CutParams, PaperParams};
use incise_pbd_gpu::{InteriorSprings, Material, SolverParams, Stiffness, Volume};
use incise_refine::RefinementLevel;
use incise_scene::{BladeMode, ContactParams, SceneParams};
use serde::{Deserialize, Serialize};

/// The two ends of a blade's edge \[m\].
pub type Edge = [[f32; 3]; 2];

/// A change of a session.
///
/// Commands and frames determine the state of a session, so commands with their frame numbers form
/// a recording.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Command {
    /// Cuts immediately along the sweep of a blade between two positions of its edge.
    ///
    /// It may end inside the body with [`Settings::progressive`].
    Slice {
        /// Start of the edge.
        from: Edge,
        /// End of the edge.
        to: Edge,
    },
    /// Moves the held blade; the next frame cuts along its sweep. The first one starts a stroke.
    Blade {
        /// New position of the edge.
        edge: Edge,
    },
    /// Ends the stroke without cutting along the motion since the last frame.
    LiftBlade,
    /// Cuts along the motion of the held blade since the last frame and ends the stroke.
    ///
    /// Where the blade is inside the body, the cut ends there.
    FinishBlade,
    /// Grabs a vertex.
    Grab {
        /// Index of the vertex.
        vertex: u32,
    },
    /// Moves the target of the grabbed vertex.
    Drag {
        /// Target position \[m\].
        to: [f32; 3],
    },
    /// Releases the grabbed vertex.
    Release,
    /// Pins a vertex at its position, or unpins it.
    Pin {
        /// Index of the vertex.
        vertex: u32,
    },
    /// Unpins all vertices.
    Unpin,
    /// Changes the settings.
    Set(Settings),
    /// Restores the body of the start of the session.
    Reset,
    /// Undoes the last cut.
    Undo,
    /// Repeats the last undone cut.
    Redo,
}

/// Cut method, see [`CutMethod`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// Splits the intersected triangles along the sweep.
    #[default]
    Exact,
    /// The method of the paper.
    #[serde(alias = "rebuild")]
    Paper,
}

/// The settings that a user changes in the panel.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// Cut method.
    pub method: Method,
    /// Refinement level of the cut section, serialized by name or factor z.
    #[serde(with = "level")]
    pub level: RefinementLevel,
    /// Substeps per frame.
    pub substeps: u32,
    /// Solver iterations per substep.
    pub iterations: u32,
    /// PBD stiffness of stretch constraints, 0 to 1.
    pub stretch: f32,
    /// PBD stiffness of bending constraints, 0 to 1; `None` disables them.
    pub bending: Option<f32>,
    /// Target volume relative to the rest volume; `None` disables volume constraints.
    pub volume: Option<f32>,
    /// Interior springs per vertex, 0 to 1; `None`, also in old recordings, disables them.
    #[serde(default)]
    pub interior_springs: Option<f32>,
    /// Decay rate of velocities [1/s]; 0 in old recordings.
    #[serde(default)]
    pub damping: f32,
    /// Enables gravity.
    pub gravity: bool,
    /// Enables the ground plane.
    pub ground: bool,
    /// Enables contacts between pieces, and within pieces after a cut that ends inside the body.
    pub contacts: bool,
    /// Lets cuts end inside the body (exact method); false in old recordings.
    ///
    /// A held blade then cuts as it moves. Otherwise it cuts when it leaves the body, and a line
    /// that ends inside the body is refused.
    #[serde(default)]
    pub progressive: bool,
    /// Curves along which caps close cuts (exact method); those of bodies in old recordings.
    #[serde(default, with = "caps")]
    pub caps: Caps,
}

impl Default for Settings {
    /// Returns settings for a firm body that keeps its volume and shape, on the ground.
    fn default() -> Self {
        Self {
            method: Method::Exact,
            level: RefinementLevel::Original,
            substeps: SolverParams::default().substeps,
            iterations: SolverParams::default().iterations,
            stretch: 1.0,
            bending: Some(0.2),
            volume: Some(1.0),
            interior_springs: Some(1.0),
            damping: 1.0,
            gravity: true,
            ground: true,
            contacts: true,
            progressive: true,
            caps: Caps::Bodies,
        }
    }
}

impl Settings {
    /// Returns the material of the body.
    pub(crate) fn material(&self) -> Material {
        Material {
            stretch: Stiffness::Pbd(self.stretch),
            bending: self.bending.map(Stiffness::Pbd),
            volume: self.volume(),
            interior_springs: self.interior_springs.map(|density| InteriorSprings {
                density,
                ..InteriorSprings::default()
            }),
            damping: self.damping,
            ..Material::default()
        }
    }

    pub(crate) fn volume(&self) -> Option<Volume> {
        self.volume.map(|pressure| Volume {
            pressure,
            ..Volume::default()
        })
    }

    /// Returns true if a body with settings `other` must be rebuilt for these.
    pub(crate) fn requires_new_body(&self, other: &Self) -> bool {
        self.bending != other.bending || self.interior_springs != other.interior_springs
    }

    /// Returns the mode of the blade: the paper's method cuts full slices only.
    pub(crate) fn blade_mode(&self) -> BladeMode {
        match self.method {
            Method::Exact if self.progressive => BladeMode::Progressive,
            _ => BladeMode::FullSlices,
        }
    }

    /// Returns the cut parameters.
    pub(crate) fn cut(&self) -> CutParams {
        let mut cut = CutParams {
            method: match self.method {
                Method::Exact => CutMethod::default(),
                Method::Paper => CutMethod::Paper(PaperParams::default()),
            },
            caps: self.caps,
            ..CutParams::default()
        };
        cut.refine.level = self.level;
        cut
    }

    /// Returns the scene parameters for a ground at this height \[m\].
    ///
    /// The walls of cuts that end inside the body collide with each other if there are any.
    pub(crate) fn scene(&self, ground: f32, has_walls: bool) -> SceneParams {
        let default = SolverParams::default();
        SceneParams {
            solver: SolverParams {
                substeps: self.substeps,
                iterations: self.iterations,
                gravity: if self.gravity {
                    default.gravity
                } else {
                    [0.0; 3]
                },
                ground: self.ground.then_some(ground),
                ..default
            },
            cut: self.cut(),
            contacts: self.contacts.then(|| ContactParams {
                self_collision: has_walls,
                ..ContactParams::default()
            }),
            ..SceneParams::default()
        }
    }
}

/// Serializes refinement levels by name.
mod level {
    use incise_refine::RefinementLevel;
    use serde::{Deserialize, Deserializer, Serializer};

    pub(super) fn serialize<S: Serializer>(
        level: &RefinementLevel,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        serializer.collect_str(level)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<RefinementLevel, D::Error> {
        let text = String::deserialize(deserializer)?;
        text.parse().map_err(serde::de::Error::custom)
    }
}

/// Serializes the curves that get caps by the names of `--caps`.
mod caps {
    use incise_cut::Caps;
    use serde::{Deserialize, Deserializer, Serializer};

    const NAMES: [(Caps, &str); 3] = [
        (Caps::Bodies, "bodies"),
        (Caps::AllLoops, "all-loops"),
        (Caps::None, "none"),
    ];

    #[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes fields so")]
    pub(super) fn serialize<S: Serializer>(caps: &Caps, serializer: S) -> Result<S::Ok, S::Error> {
        match NAMES.iter().find(|(own, _)| own == caps) {
            Some((_, name)) => serializer.serialize_str(name),
            None => Err(serde::ser::Error::custom("these caps have no name")),
        }
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Caps, D::Error> {
        let text = String::deserialize(deserializer)?;
        let found = NAMES.iter().find(|(_, name)| *name == text);
        let unknown = || serde::de::Error::custom(format!("'{text}' names no caps"));
        found.map(|(caps, _)| *caps).ok_or_else(unknown)
    }
}
