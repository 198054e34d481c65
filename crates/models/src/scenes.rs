//! Named scenes that tests, benches and windows share, and their parts.
//!
//! A scene has bodies, parameters, and a script that moves blades, pins and colliders:
//!
//! ```
//! use incise_models::scenes::find;
//! use incise_scene::BackendRequest;
//!
//! let named = find("bars").expect("a scene of the list");
//! let mut scripted = (named.build)(&BackendRequest::default())?;
//! scripted.step()?;
//! assert_eq!(scripted.scene.bodies().count(), 2);
//! # Ok::<(), incise_scene::SceneError>(())
//! ```

pub mod contacts;
pub mod cuts;
mod directions;
pub mod heaps;
mod knot;
mod solids;
#[cfg(test)]
mod tests;

use crate::{Model, build_model};
pub use directions::{Directions, RelativePlane};
use incise_mesh::{Surface, Vec3, VertexId};
use incise_pbd_gpu::{Collider, InteriorSprings, Material, Stiffness, Volume};
use incise_scene::{BackendRequest, BodyId, ContactParams, Scene, SceneError, SceneParams};
pub use knot::{Rope, knot};
pub use solids::{cuboid, joined, unit_size};

/// Length of a frame \[s\].
pub const FRAME: f32 = 1.0 / 60.0;

/// A scene of [`SCENES`].
#[derive(Debug, Clone, Copy)]
pub struct NamedScene {
    /// A word.
    pub name: &'static str,
    /// One line.
    pub description: &'static str,
    /// Builds the scene on a backend.
    pub build: fn(&BackendRequest) -> Result<ScriptedScene, SceneError>,
}

/// All named scenes.
pub const SCENES: &[NamedScene] = &[
    NamedScene {
        name: "drop",
        description: "a bunny of a meter falls on the ground by half its size",
        build: |backend| {
            let contacts = Some(ContactParams::default());
            let bunny = solids::unit_bunny();
            cuts::dropped(backend, bunny, &Material::soft_body(), contacts, 1.0)
        },
    },
    NamedScene {
        name: "slices",
        description: "a block is cut into ten slices that lie on each other",
        build: |backend| cuts::slices(backend, &cuts::sliced_materials()[0].1),
    },
    NamedScene {
        name: "shatter",
        description: "a bunny is cut by ten random planes in ten frames of its fall",
        build: |backend| cuts::shatter(backend, 1, Some(ContactParams::default())),
    },
    NamedScene {
        name: "slivers",
        description: "a weightless ball is cut by six random planes",
        build: |backend| cuts::slivers(backend, 1),
    },
    NamedScene {
        name: "plate",
        description: "a plate of 1 cm on the ground is split in its plane",
        build: |backend| cuts::split_plate(backend, &sprung()),
    },
    NamedScene {
        name: "slit",
        description: "a ball slit to its center is pulled apart",
        build: |backend| cuts::slit_ball(backend, &cuts::slit_materials()[0].1, 0.1),
    },
    NamedScene {
        name: "heap",
        description: "ten models fall on each other",
        build: |backend| {
            let models = Model::ALL.map(build_model).into_iter();
            let mut models: Vec<Surface> = models.filter_map(unit_size).collect();
            models.retain(|model| model.topology().triangle_count() <= heaps::TRIANGLES);
            heaps::heap(backend, &models, Grouping::Bodies)
        },
    },
    NamedScene {
        name: "bowl",
        description: "a thousand balls of 20 triangles are poured into a bowl of planes",
        build: |backend| heaps::bowl(backend, 1000),
    },
    NamedScene {
        name: "closing",
        description: "two plates close on a weightless bunny to half its size, and open again",
        build: |backend| contacts::closing(backend, solids::unit_bunny(), &sprung(), 0),
    },
    NamedScene {
        name: "bars",
        description: "a bar of 12 triangles falls across a held one",
        build: |backend| contacts::bars(backend, Grouping::Bodies, std::f64::consts::FRAC_PI_4),
    },
    NamedScene {
        name: "drape",
        description: "a sheet falls on a held ball",
        build: |backend| contacts::drape(backend, 1.0),
    },
    NamedScene {
        name: "block",
        description: "a block of 20 cm hits a plate of 2 cm, held at its rim, at 10 m/s",
        build: |backend| contacts::block_on_plate(backend, Grouping::Bodies, 10.0),
    },
    NamedScene {
        name: "tunnel",
        description: "a ball hits a held plate of a tenth of its size by 10 diagonals a second",
        build: |backend| contacts::tunnel(backend, &cuts::sliced_materials()[0].1, 0.37, 1.0),
    },
    NamedScene {
        name: "knot",
        description: "a weightless rope with an open trefoil knot is pulled at both ends",
        build: |backend| Ok(knot(backend)?.0),
    },
];

/// Returns the scene of a name.
#[must_use]
pub fn find(name: &str) -> Option<&'static NamedScene> {
    SCENES.iter().find(|scene| scene.name == name)
}

/// Moves blades, pins and colliders before a frame, counted from 0.
type Script = Box<dyn FnMut(&mut Scene, u32) -> Result<(), SceneError> + Send>;

/// A scene with the motion of its blades, pins and colliders.
pub struct ScriptedScene {
    /// The scene.
    pub scene: Scene,
    script: Script,
    frame: u32,
}

impl std::fmt::Debug for ScriptedScene {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { scene, frame, .. } = self;
        (f.debug_struct("ScriptedScene").field("scene", scene))
            .field("frame", frame)
            .finish_non_exhaustive()
    }
}

impl From<Scene> for ScriptedScene {
    fn from(scene: Scene) -> Self {
        Self::new(scene, |_, _| Ok(()))
    }
}

impl ScriptedScene {
    fn new(
        scene: Scene,
        script: impl FnMut(&mut Scene, u32) -> Result<(), SceneError> + Send + 'static,
    ) -> Self {
        Self {
            scene,
            script: Box::new(script),
            frame: 0,
        }
    }

    /// Moves blades, pins and colliders for the next frame.
    ///
    /// # Errors
    /// [`SceneError`] of the script.
    pub fn drive(&mut self) -> Result<(), SceneError> {
        (self.script)(&mut self.scene, self.frame)?;
        self.frame += 1;
        Ok(())
    }

    /// Drives and steps the scene by a frame.
    ///
    /// # Errors
    /// As [`ScriptedScene::drive`] and [`Scene::step`].
    pub fn step(&mut self) -> Result<(), SceneError> {
        self.drive()?;
        self.scene.step()?;
        Ok(())
    }
}

/// Assignment of surfaces to the bodies of a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Grouping {
    /// Each is a body.
    Bodies,
    /// All are pieces of one body.
    Pieces,
}

impl Grouping {
    /// Both kinds and their names.
    pub const ALL: [(&'static str, Self); 2] = [("bodies", Self::Bodies), ("pieces", Self::Pieces)];
}

/// A horizontal plane through the origin.
const GROUND: Collider = Collider::ground(0.0);

/// Returns the parameters of a scene with contacts.
#[must_use]
pub fn touching() -> SceneParams {
    SceneParams {
        dt: FRAME,
        contacts: Some(ContactParams::default()),
        ..SceneParams::default()
    }
}

/// As [`touching`], without gravity.
fn weightless() -> SceneParams {
    let mut params = touching();
    params.solver.gravity = [0.0; 3];
    params
}

/// Returns a skin around an incompressible volume, with springs through it.
#[must_use]
pub fn sprung() -> Material {
    Material {
        volume: Some(Volume::default()),
        interior_springs: Some(InteriorSprings {
            density: 1.0,
            stiffness: Stiffness::Compliance(1e-6),
        }),
        damping: 1.0,
        ..Material::default()
    }
}

/// A piece of a body.
#[derive(Clone, Copy)]
struct Part {
    body: BodyId,
    piece: u32,
}

/// Creates a scene of connected surfaces; returns it with the part that each surface is.
fn grouped(
    backend: &BackendRequest,
    params: SceneParams,
    surfaces: &[Surface],
    grouping: Grouping,
    material: &Material,
) -> Result<(Scene, Vec<Part>), SceneError> {
    let mut scene = Scene::with_backend(params, backend)?;
    let parts = match grouping {
        Grouping::Bodies => {
            let add = |surface: &Surface| {
                let body = scene.add_body(surface.clone(), material)?;
                Ok(Part { body, piece: 0 })
            };
            surfaces
                .iter()
                .map(add)
                .collect::<Result<_, SceneError>>()?
        }
        Grouping::Pieces => {
            let body = scene.add_body(joined(surfaces), material)?;
            (0..)
                .zip(surfaces)
                .map(|(piece, _)| Part { body, piece })
                .collect()
        }
    };
    Ok((scene, parts))
}

/// Returns the vertices of a piece.
#[must_use]
pub fn vertices_of(surface: &Surface, piece: u32) -> Vec<VertexId> {
    let topology = surface.topology();
    let is_own = |&v: &VertexId| surface.piece(topology.outgoing(v).triangle()) == piece;
    topology.vertices().filter(is_own).collect()
}

/// Pins the vertices of a part that are chosen by their positions, and returns them.
fn pin(
    scene: &mut Scene,
    part: Part,
    is_pinned: impl Fn(Vec3) -> bool,
) -> Result<Vec<VertexId>, SceneError> {
    let (solver, surface) = scene.edit(part.body)?.solver_mut();
    let mut vertices = vertices_of(surface, part.piece);
    vertices.retain(|&v| is_pinned(surface.position(v)));
    for &v in &vertices {
        solver.pin(surface, v)?;
    }
    Ok(vertices)
}

/// Sets the velocity of a part [m/s].
fn throw(scene: &mut Scene, part: Part, velocity: [f32; 3]) -> Result<(), SceneError> {
    let (solver, surface) = scene.edit(part.body)?.solver_mut();
    for v in vertices_of(surface, part.piece) {
        solver.set_velocity(v, velocity)?;
    }
    Ok(())
}
