//! Commands and settings of a session, as serializable data.

use incise_mesh::Surface;
use incise_pbd_gpu::{Collider, Material, Solid, Stiffness};
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
#[expect(
    clippy::large_enum_variant,
    reason = "a frame has few commands, and a box would not be `Copy`"
)]
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

incise_params::params! {
    /// The settings that a user changes in the panel. By default a soft body on the ground.
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub struct Settings {
        /// Parameters of the scene; cuts that end inside replace some.
        scene: SceneParams = SceneParams {
            contacts: Some(ContactParams::default()),
            ..SceneParams::default()
        };
        /// Material of the body.
        material: Material = Material::soft_body();
        /// Adds a horizontal plane below the body.
        ground: bool = true;
        /// Lets cuts end inside the body.
        ///
        /// A held blade then cuts as it moves. Otherwise it cuts when it leaves the body, and a
        /// line that ends inside the body is refused.
        progressive: bool = true;
    }
}

impl Settings {
    /// Returns the default settings with the material for a surface: cloth if it has a boundary.
    #[must_use]
    pub fn for_surface(surface: &Surface) -> Self {
        Self {
            material: Material::for_surface(surface),
            ..Self::default()
        }
    }

    /// Returns true if a body with settings `other` must be rebuilt for these.
    pub(crate) fn requires_new_body(&self, other: &Self) -> bool {
        let made_with_body = |material: &Material| Material {
            stretch: Stiffness::Pbd(1.0),
            volume: None,
            solid: material.solid.map(|solid| Solid {
                young_modulus: 1.0,
                poisson_ratio: 0.0,
                relaxation_time: 0.0,
                ..solid
            }),
            damping: 0.0,
            friction: 0.0,
            ..*material
        };
        made_with_body(&self.material) != made_with_body(&other.material)
    }

    /// Returns the mode of the blade.
    pub(crate) fn blade_mode(&self) -> BladeMode {
        match self.progressive {
            true => BladeMode::Progressive,
            false => BladeMode::FullSlices,
        }
    }

    /// Returns the colliders of the scene, for a ground at this height \[m\].
    pub(crate) fn colliders(&self, ground: f32) -> Vec<Collider> {
        let ground = self.ground.then(|| Collider::ground(ground));
        ground.into_iter().collect()
    }

    /// Returns the parameters of the scene.
    ///
    /// The walls of cuts that end inside the body collide with each other if there are any.
    pub(crate) fn scene(&self, has_walls: bool) -> SceneParams {
        let mut params = self.scene;
        if let Some(contacts) = &mut params.contacts {
            contacts.self_collision |= has_walls;
        }
        params
    }
}
