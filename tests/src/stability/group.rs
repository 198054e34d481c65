//! [`Group`]: measures of the bodies of a scene and of their pieces.

use super::{Found, larger};
use incise_mesh::geometry::to_f32;
use incise_mesh::{Aabb, Bvh, Surface, TriangleId, Vec3};
use incise_models::scenes::{FRAME, ScriptedScene, vertices_of};
use incise_pbd_gpu::PieceVolume;
use incise_scene::{BodyId, Scene, SceneError};

/// A scene and its parts: the pieces that its bodies have at first.
#[derive(Debug)]
pub(super) struct Group {
    scripted: ScriptedScene,
    bodies: Vec<BodyId>,
    /// A body by its index and a piece of it.
    parts: Vec<(usize, u32)>,
}

impl Group {
    /// Takes a scene that was just built.
    pub(super) fn new(scripted: Result<ScriptedScene, SceneError>) -> Found<Self> {
        let scripted = scripted?;
        let bodies: Vec<BodyId> = scripted.scene.bodies().collect();
        let mut parts = Vec::new();
        for (i, &body) in bodies.iter().enumerate() {
            let surface = scripted.scene.body(body)?.surface();
            parts.extend(pieces(surface).into_iter().map(|piece| (i, piece)));
        }
        Ok(Self {
            scripted,
            bodies,
            parts,
        })
    }

    pub(super) fn scene(&mut self) -> &mut Scene {
        &mut self.scripted.scene
    }

    /// Steps by frames and reads all bodies back.
    pub(super) fn step(&mut self, frames: u32) -> Found<()> {
        for _ in 0..frames {
            self.scripted.step()?;
            for &body in &self.bodies {
                self.scripted.scene.read_back(body)?;
            }
        }
        Ok(())
    }

    /// Steps until all bodies sleep, at most by some frames, and reads them back.
    ///
    /// Returns the number of frames.
    pub(super) fn settle(&mut self, most: u32) -> Found<u32> {
        let mut frames = 0;
        while !self.is_asleep()? && frames < most {
            self.scripted.step()?;
            frames += 1;
        }
        for &body in &self.bodies {
            self.scripted.scene.read_back(body)?;
        }
        Ok(frames)
    }

    pub(super) fn is_asleep(&self) -> Found<bool> {
        for &body in &self.bodies {
            if !self.scripted.scene.is_asleep(body)? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Returns the body of an index.
    pub(super) fn body(&self, index: usize) -> Found<&incise_scene::Body> {
        Ok(self.scripted.scene.body(self.bodies[index])?)
    }

    /// Returns the id of the only body.
    pub(super) fn only(&self) -> BodyId {
        self.bodies[0]
    }

    /// Returns the positions of a part's vertices \[m\].
    pub(super) fn positions(&self, part: usize) -> Found<Vec<Vec3>> {
        let (body, piece) = self.parts[part];
        let surface = self.body(body)?.surface();
        let vertices = vertices_of(surface, piece).into_iter();
        Ok(vertices.map(|v| surface.position(v)).collect())
    }

    /// Returns the positions of the vertices of all parts \[m\].
    pub(super) fn all_positions(&self) -> Found<Vec<Vec<Vec3>>> {
        (0..self.parts.len())
            .map(|part| self.positions(part))
            .collect()
    }

    /// Returns the mean position of a part's vertices \[m\].
    pub(super) fn center(&self, part: usize) -> Found<Vec3> {
        let all = self.positions(part)?;
        Ok(all.iter().sum::<Vec3>() / all.len() as f64)
    }

    /// Returns the largest speed of a vertex relative to a velocity [m/s].
    pub(super) fn speed(&self, velocity: [f64; 3]) -> Found<f64> {
        let mut most = 0.0;
        for index in 0..self.bodies.len() {
            let body = self.body(index)?;
            for v in body.surface().topology().vertices() {
                let own = Vec3::from(body.solver().velocity(v).map(f64::from));
                most = larger(most, (own - Vec3::from(velocity)).norm());
            }
        }
        Ok(most)
    }

    /// Returns the largest relative error of a piece's volume.
    pub(super) fn volume_error(&self) -> Found<f64> {
        let mut most = 0.0;
        for index in 0..self.bodies.len() {
            let body = self.body(index)?;
            let errors = volume_errors(body.surface(), body.solver().volumes().pieces());
            most = errors.into_iter().fold(most, larger);
        }
        Ok(most)
    }

    /// Returns the largest depth of a vertex in another part, which must be closed \[m\].
    pub(super) fn depth(&self) -> Found<f64> {
        let mut trees = Vec::new();
        for index in 0..self.bodies.len() {
            trees.push(Bvh::build(self.body(index)?.surface()));
        }
        let all = self.all_positions()?;
        let around = |points: &Vec<Vec3>| Aabb::around(points.iter().map(|&p| to_f32(p)));
        let boxes: Vec<Aabb> = all.iter().map(around).collect();
        let mut depth = 0.0;
        for (i, points) in all.iter().enumerate() {
            for (j, &(body, piece)) in self.parts.iter().enumerate() {
                if i == j || !boxes[i].overlaps(&boxes[j]) {
                    continue;
                }
                let (surface, tree) = (self.body(body)?.surface(), &trees[body]);
                let reach = boxes[j].diagonal();
                let is_other = |t: TriangleId| surface.piece(t) == piece;
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

/// Returns the duration of frames \[s\].
pub(super) fn seconds(frames: u32) -> f64 {
    f64::from(frames) * f64::from(FRAME)
}

/// Returns the pieces of a surface.
pub(super) fn pieces(surface: &Surface) -> Vec<u32> {
    let numbers = 0..surface.piece_bound();
    numbers
        .filter(|&p| surface.piece_triangles(p) > 0)
        .collect()
}

/// Returns the relative errors of the volumes of pieces.
pub(super) fn volume_errors(surface: &Surface, pieces: &[PieceVolume]) -> Vec<f64> {
    let volumes = surface.piece_volumes();
    let error = |piece: &PieceVolume| {
        (volumes[piece.piece() as usize] / f64::from(piece.rest()) - 1.0).abs()
    };
    pieces.iter().map(error).collect()
}
