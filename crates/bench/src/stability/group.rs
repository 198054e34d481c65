//! [`Group`]: surfaces that touch in a scene, as bodies of their own or as pieces of one body.

use super::case::larger;
use super::error::StressError;
use super::scenes::FRAME;
use incise_mesh::{Aabb, Bvh, Surface, TriangleId, Vec3, VertexId};
use incise_pbd_gpu::{Material, PieceVolume, SolverParams};
use incise_scene::{BackendRequest, BodyId, ContactParams, Scene, SceneParams};

/// How the parts of a group are bodies of its scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Grouping {
    /// Each part is a body.
    Bodies,
    /// All parts are pieces of one body.
    Pieces,
}

impl Grouping {
    /// Both kinds and their names.
    pub(super) const ALL: [(&'static str, Self); 2] =
        [("bodies", Self::Bodies), ("pieces", Self::Pieces)];
}

/// A part of a group: a piece of a body.
#[derive(Debug, Clone, Copy)]
struct Part {
    body: BodyId,
    piece: u32,
}

/// Surfaces in contact and their scene.
#[derive(Debug)]
pub(super) struct Group {
    pub(super) scene: Scene,
    bodies: Vec<BodyId>,
    parts: Vec<Part>,
}

/// Returns the parameters of a scene with contacts, gravity [m/s^2] and a ground \[m\].
pub(super) fn touching(gravity: f32, ground: Option<f32>) -> SceneParams {
    SceneParams {
        dt: FRAME,
        solver: SolverParams {
            gravity: [0.0, -gravity, 0.0],
            ground,
            ..SolverParams::default()
        },
        contacts: Some(ContactParams::default()),
        ..SceneParams::default()
    }
}

impl Group {
    /// Adds connected surfaces of one material to a new scene.
    ///
    /// # Errors
    /// [`StressError`] when a surface cannot be simulated.
    pub(super) fn new(
        backend: &BackendRequest,
        params: SceneParams,
        (surfaces, grouping): (&[Surface], Grouping),
        material: &Material,
    ) -> Result<Self, StressError> {
        let mut scene = Scene::with_backend(params, backend)?;
        let bodies = match grouping {
            Grouping::Bodies => {
                let add = |surface: &Surface| scene.add_body(surface.clone(), material);
                surfaces.iter().map(add).collect::<Result<Vec<_>, _>>()?
            }
            Grouping::Pieces => vec![scene.add_body(joined(surfaces)?, material)?],
        };
        let part = |i: usize, number: u32| match grouping {
            Grouping::Bodies => Part {
                body: bodies[i],
                piece: 0,
            },
            Grouping::Pieces => Part {
                body: bodies[0],
                piece: number,
            },
        };
        let numbered = (0..surfaces.len()).zip(0..);
        let parts = numbered.map(|(i, number)| part(i, number)).collect();
        Ok(Self {
            scene,
            bodies,
            parts,
        })
    }

    /// Steps a frame and reads all bodies back.
    ///
    /// # Errors
    /// As [`Scene::step`].
    pub(super) fn step(&mut self) -> Result<(), StressError> {
        self.scene.step()?;
        for &body in &self.bodies {
            self.scene.read_back(body)?;
        }
        Ok(())
    }

    /// Steps until all bodies sleep, at most for some seconds; returns the time \[s\].
    ///
    /// # Errors
    /// As [`Scene::step`].
    pub(super) fn settle(&mut self, seconds: f64) -> Result<f64, StressError> {
        let mut time = 0.0;
        while !self.is_asleep()? && time < seconds {
            self.scene.step()?;
            time += f64::from(FRAME);
        }
        for &body in &self.bodies {
            self.scene.read_back(body)?;
        }
        Ok(time)
    }

    fn is_asleep(&self) -> Result<bool, StressError> {
        for &body in &self.bodies {
            if !self.scene.is_asleep(body)? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    fn surface(&self, part: Part) -> Result<&Surface, StressError> {
        Ok(self.scene.body(part.body)?.surface())
    }

    /// Returns the surface that a part belongs to.
    ///
    /// # Errors
    /// None for a part of the group.
    pub(super) fn surface_of(&self, part: usize) -> Result<&Surface, StressError> {
        self.surface(self.parts[part])
    }

    /// Returns the vertices of a part.
    ///
    /// # Errors
    /// None for a part of the group.
    pub(super) fn vertices(&self, part: usize) -> Result<Vec<VertexId>, StressError> {
        let part = self.parts[part];
        let surface = self.surface(part)?;
        let topology = surface.topology();
        let is_own = |&v: &VertexId| surface.piece(topology.outgoing(v).triangle()) == part.piece;
        Ok(topology.vertices().filter(is_own).collect())
    }

    /// Returns the positions of a part's vertices \[m\].
    ///
    /// # Errors
    /// As [`Group::vertices`].
    pub(super) fn positions(&self, part: usize) -> Result<Vec<Vec3>, StressError> {
        let surface = self.surface(self.parts[part])?;
        let vertices = self.vertices(part)?.into_iter();
        Ok(vertices.map(|v| surface.position(v)).collect())
    }

    /// Returns the mean position of a part's vertices \[m\].
    ///
    /// # Errors
    /// As [`Group::vertices`].
    pub(super) fn center(&self, part: usize) -> Result<Vec3, StressError> {
        let all = self.positions(part)?;
        Ok(all.iter().sum::<Vec3>() / all.len() as f64)
    }

    /// Pins the vertices of a part that are chosen by their positions.
    ///
    /// # Errors
    /// As [`Scene::edit`].
    pub(super) fn pin(
        &mut self,
        part: usize,
        is_pinned: impl Fn(Vec3) -> bool,
    ) -> Result<Vec<VertexId>, StressError> {
        let mut vertices = self.vertices(part)?;
        let (solver, surface) = self.scene.edit(self.parts[part].body)?.solver_mut();
        vertices.retain(|&v| is_pinned(surface.position(v)));
        for &v in &vertices {
            solver.pin(surface, v)?;
        }
        Ok(vertices)
    }

    /// Sets the target of a pinned vertex of a part \[m\].
    ///
    /// # Errors
    /// As [`Scene::set_pin_target`].
    pub(super) fn drag(
        &mut self,
        part: usize,
        v: VertexId,
        to: [f32; 3],
    ) -> Result<(), StressError> {
        let body = self.parts[part].body;
        Ok(self.scene.set_pin_target(body, v, to)?)
    }

    /// Sets the velocity of a part [m/s].
    ///
    /// # Errors
    /// As [`Scene::edit`].
    pub(super) fn throw(&mut self, part: usize, velocity: [f32; 3]) -> Result<(), StressError> {
        let vertices = self.vertices(part)?;
        let (solver, _) = self.scene.edit(self.parts[part].body)?.solver_mut();
        for v in vertices {
            solver.set_velocity(v, velocity)?;
        }
        Ok(())
    }

    /// Returns the largest speed of a vertex [m/s].
    ///
    /// # Errors
    /// None for bodies of the group.
    pub(super) fn speed(&self) -> Result<f64, StressError> {
        self.speed_relative_to([0.0; 3])
    }

    /// As [`Group::speed`], relative to a velocity [m/s].
    ///
    /// # Errors
    /// None for bodies of the group.
    pub(super) fn speed_relative_to(&self, velocity: [f64; 3]) -> Result<f64, StressError> {
        let mut most = 0.0;
        for &body in &self.bodies {
            let body = self.scene.body(body)?;
            for v in body.surface().topology().vertices() {
                let own = Vec3::from(body.solver().velocity(v).map(f64::from));
                most = larger(most, (own - Vec3::from(velocity)).norm());
            }
        }
        Ok(most)
    }

    /// Returns the largest relative error of a piece's volume.
    ///
    /// # Errors
    /// None for bodies of the group.
    pub(super) fn volume_error(&self) -> Result<f64, StressError> {
        let mut most = 0.0;
        for &body in &self.bodies {
            let body = self.scene.body(body)?;
            let volumes = body.surface().piece_volumes();
            let error = |piece: &PieceVolume| {
                (volumes[piece.piece() as usize] / f64::from(piece.rest()) - 1.0).abs()
            };
            let errors = body.solver().volumes().pieces().iter().map(error);
            most = errors.fold(most, larger);
        }
        Ok(most)
    }

    /// Returns the largest depth of a vertex in another part, which must be closed \[m\].
    ///
    /// # Errors
    /// As [`Group::vertices`].
    pub(super) fn depth(&self) -> Result<f64, StressError> {
        let mut trees = Vec::new();
        for &body in &self.bodies {
            trees.push(Bvh::build(self.scene.body(body)?.surface()));
        }
        let tree_of = |part: Part| {
            let own = self.bodies.iter().position(|&body| body == part.body);
            &trees[own.unwrap_or(0)]
        };
        let all: Result<Vec<Vec<Vec3>>, StressError> =
            (0..self.parts.len()).map(|i| self.positions(i)).collect();
        let all = all?;
        let boxes: Vec<Aabb> = all.iter().map(|points| around(points)).collect();
        let mut depth = 0.0;
        for (i, points) in all.iter().enumerate() {
            for (j, &other) in self.parts.iter().enumerate() {
                if i == j || !boxes[i].overlaps(&boxes[j]) {
                    continue;
                }
                let (surface, tree) = (self.surface(other)?, tree_of(other));
                let reach = boxes[j].diagonal();
                let is_other = |t: TriangleId| surface.piece(t) == other.piece;
                for &p in points {
                    // Folded surfaces have no normals that tell their inside.
                    if tree.winding_number(surface, p, is_other) == 0 {
                        continue;
                    }
                    if let Some(found) = tree.nearest(surface, p, reach, is_other) {
                        depth = larger(depth, found.distance.abs());
                    }
                }
            }
        }
        Ok(depth)
    }
}

/// Returns the bounding box of points.
fn around(points: &[Vec3]) -> Aabb {
    Aabb::around(points.iter().map(|&p| incise_mesh::geometry::to_f32(p)))
}

/// Joins surfaces as components of one.
///
/// # Errors
/// None for surfaces of few triangles.
pub(super) fn joined(parts: &[Surface]) -> Result<Surface, StressError> {
    let (mut corners, mut faces) = (Vec::new(), Vec::new());
    for part in parts {
        let offset = u32::try_from(corners.len()).unwrap_or(u32::MAX);
        corners.extend_from_slice(part.rest_positions());
        let topology = part.topology();
        let of = |t: TriangleId| topology.triangle(t).map(|v| v.0 + offset);
        faces.extend(topology.triangles().map(of));
    }
    Surface::from_triangles(&corners, &faces)
        .map_err(|error| StressError::Invariant(error.to_string()))
}
