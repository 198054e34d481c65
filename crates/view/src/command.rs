//! What can be done to a session, as data.

use incise_cut::{CutMethod, CutParams, Sweep};
use incise_pbd_gpu::{Material, SolverParams, Stiffness, Struts, Volume};
use incise_refine::RefinementLevel;
use incise_scene::{ContactParams, SceneParams};
use serde::{Deserialize, Serialize};

/// The two ends of a blade's edge \[m\].
pub type Edge = [[f32; 3]; 2];

/// What changes a session. Everything that decides where bodies are is one of these or a frame, so that a list of them with
/// the numbers of their frames is a recording.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Command {
    /// Cuts at once along the way of a blade's edge from one place to another.
    Slice {
        /// Where the edge begins.
        from: Edge,
        /// Where it ends.
        to: Edge,
    },
    /// Puts the held blade here; the frame cuts along its way. The first one only takes it up.
    Blade {
        /// Where the edge is to be.
        edge: Edge,
    },
    /// Puts the held blade away as if it had not moved since the last frame.
    LiftBlade,
    /// Cuts along what the held blade has passed since the last frame, and puts it away.
    FinishBlade,
    /// Takes hold of a vertex.
    Grab {
        /// Which.
        vertex: u32,
    },
    /// Pulls the held vertex to here.
    Drag {
        /// Where it is to be \[m\].
        to: [f32; 3],
    },
    /// Lets the held vertex go.
    Release,
    /// Pins a vertex where it is, or lets it go if it is pinned.
    Pin {
        /// Which.
        vertex: u32,
    },
    /// Lets all pinned vertices go.
    Unpin,
    /// Chooses how bodies move and are cut.
    Set(Settings),
    /// Puts the body where it was at first, whole.
    Reset,
    /// Takes the last cut back.
    Undo,
    /// Cuts along the last undone cut again.
    Redo,
}

/// How the mesh is opened, see [`CutMethod`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// Hit triangles are split along the sweep.
    #[default]
    Exact,
    /// The paper's.
    Rebuild,
}

/// What a user chooses.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// How the mesh is opened.
    pub method: Method,
    /// How fine caps get, by name or z.
    #[serde(with = "level")]
    pub level: RefinementLevel,
    /// Parts that a frame is divided into.
    pub substeps: u32,
    /// Projections of every constraint a substep.
    pub iterations: u32,
    /// How much of their error edges lose a substep, 0 to 1.
    pub stretch: f32,
    /// The same of angles between triangles; none without bending.
    pub bending: Option<f32>,
    /// How many times its rest volume a piece strives for; none without volume.
    pub volume: Option<f32>,
    /// How many struts through the body a vertex has, 0 to 1; none without struts, as in recordings from before there were any.
    #[serde(default)]
    pub struts: Option<f32>,
    /// The rate at which velocities decay [1/s], so that what could roll comes to rest; 0 in recordings from before there was
    /// any.
    #[serde(default)]
    pub damping: f32,
    /// Whether things fall.
    pub gravity: bool,
    /// Whether there is a ground.
    pub ground: bool,
    /// Whether pieces touch each other.
    pub contacts: bool,
}

impl Default for Settings {
    /// A body that is firm and keeps its volume and its shape, on a ground.
    fn default() -> Self {
        Self {
            method: Method::Exact,
            level: RefinementLevel::Original,
            substeps: SolverParams::default().substeps,
            iterations: SolverParams::default().iterations,
            stretch: 1.0,
            bending: Some(0.2),
            volume: Some(1.0),
            struts: Some(1.0),
            damping: 1.0,
            gravity: true,
            ground: true,
            contacts: true,
        }
    }
}

impl Settings {
    /// What a body is made of.
    pub(crate) fn material(&self) -> Material {
        Material {
            stretch: Stiffness::Pbd(self.stretch),
            bending: self.bending.map(Stiffness::Pbd),
            volume: self.volume(),
            struts: self.struts.map(|density| Struts {
                density,
                ..Struts::default()
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

    /// Whether a body of `other` has to be made anew for these.
    pub(crate) fn needs_new_body(&self, other: &Self) -> bool {
        self.bending != other.bending || self.struts != other.struts
    }

    /// How bodies are cut.
    pub(crate) fn cut(&self) -> CutParams {
        let mut cut = CutParams {
            method: match self.method {
                Method::Exact => CutMethod::Exact,
                Method::Rebuild => CutMethod::Rebuild,
            },
            ..CutParams::default()
        };
        cut.refine.level = self.level;
        cut
    }

    /// How a scene with a ground at this height \[m\] is stepped.
    pub(crate) fn scene(&self, ground: f32) -> SceneParams {
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
            contacts: self.contacts.then(ContactParams::default),
            ..SceneParams::default()
        }
    }
}

/// The blade's two places of a sweep.
pub(crate) fn ways(sweep: &Sweep) -> [Edge; 2] {
    let [start, end, end_after, start_after] = sweep.corners();
    [[start, end], [start_after, end_after]]
}

/// Levels by their names.
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
