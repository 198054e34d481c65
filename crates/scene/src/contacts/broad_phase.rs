//! Broad phase: pairs of pieces whose boxes may overlap within the frame, and their groups.
//!
//! Called by [`super::ContactDetection`] with the bodies that may collide; the narrow phase reads
//! the pairs and displacements.

use super::motion::Motion;
use super::near_bodies::grow;
use super::overlaps::PieceId;
use super::{BladeFace, ContactFrame, SPEED_MARGIN};
use crate::body::Body;
use crate::body::piece_of;
use crate::scene::Bodies;
use incise_mesh::geometry::to_f64;
use incise_mesh::{Aabb, MovingPoint, Surface, Vec3, VertexId, index_u32};
use incise_pbd_gpu::{Collider, MovingCollider};

/// A piece of a body.
#[derive(Debug, Clone, Copy)]
pub(super) struct Piece {
    /// Index of its body in the scene, and its number there.
    pub(super) body: u32,
    number: u32,
    pub(super) bounds: Aabb,
    /// `bounds` grown by the motion of the frame and a thickness.
    grown_bounds: Aabb,
    /// Minimum and maximum velocity of its vertices along each axis [m/s].
    pub(super) velocity_bounds: [Vec3; 2],
    /// Whether a pin, a collider other than a plane or a blade face may stop it.
    is_held: bool,
    /// Index of the first piece of its group.
    group: u32,
    /// Sum of the velocities of its vertices [m/s], and their number.
    velocity_sum: (Vec3, f64),
    /// Mass \[kg\].
    mass: f64,
    /// The common velocity of its group, stored in the first piece [m/s].
    group_velocity: Vec3,
    /// Maximum displacement of its vertices relative to the group, along each axis in either
    /// direction \[m\].
    displacement: [f32; 3],
    /// Maximum displacement of a vertex whose velocity grows \[m\].
    pub(super) max_displacement: f64,
    /// Index of its first pair.
    first_pair: u32,
    /// Range of its vertices in the list of all pieces' vertices.
    vertices: (u32, u32),
}

/// The pieces of all bodies that may collide, in memory reused between frames.
///
/// Pieces that may collide, directly or through others, form a group. The mean velocity of a group
/// is subtracted, so that only motion within it enlarges the searches. A group that may hit an
/// obstacle keeps it: the obstacle may stop it. Planes do not count: slices in a box above one are
/// crushed more if the search sees the impact.
#[derive(Debug, Clone, Default)]
pub(super) struct Pieces {
    list: Vec<Piece>,
    /// Pairs of indices of pieces whose grown boxes overlap, in both orders, ascending.
    pairs: Vec<(u32, u32)>,
    /// By index of a group's first piece: sum of the velocities of its vertices, and their number.
    group_velocity_sums: Vec<(Vec3, f64)>,
    /// The vertices of each piece, ascending.
    vertices: Vec<VertexId>,
}

impl Pieces {
    /// Finds boxes, velocities, pairs, groups and displacements for a frame.
    pub(super) fn update(
        &mut self,
        bodies: &Bodies,
        motions: &mut [Motion],
        frame: &ContactFrame<'_>,
    ) {
        #[expect(
            clippy::cast_possible_truncation,
            reason = "parameters of scenes have 32 bits"
        )]
        let dt = frame.dt as f32;
        self.list.clear();
        for (i, (body, motion)) in bodies.iter().zip(&mut *motions).enumerate() {
            if let (true, Some(body)) = (motion.is_active, body) {
                self.measure(index_u32(i), body, motion);
                for pin in body.solver().pins() {
                    if let Some(number) = piece_of(body.surface(), pin.vertex) {
                        let index = motion.pieces[number as usize];
                        self.list[index as usize].is_held = true;
                    }
                }
            }
        }
        for piece in &mut self.list {
            piece.grown_bounds = piece.bounds;
            let speed = max_difference(piece.velocity_bounds, Vec3::zeros());
            let displacement = (SPEED_MARGIN * speed + frame.speed_gain) * frame.dt;
            let thickness = motions[piece.body as usize].thickness;
            grow(&mut piece.grown_bounds, thickness + displacement);
            let at_collider = |c: &MovingCollider| {
                let is_plane = matches!(c.start, Collider::Plane { .. });
                !is_plane && c.bounds(dt).overlaps(&piece.grown_bounds)
            };
            let at_face = |face: &BladeFace| face.bounds().overlaps(&piece.grown_bounds);
            piece.is_held |=
                frame.colliders.iter().any(at_collider) || frame.blade_faces.iter().any(at_face);
        }
        self.find_pairs(motions);
        self.find_groups();
        self.begin_vertices();
        for (body, motion) in bodies.iter().zip(motions) {
            if let (true, Some(body)) = (motion.is_active, body) {
                self.find_displacements(body.surface(), motion, frame.dt);
            }
        }
        for piece in &mut self.list {
            piece.max_displacement = SPEED_MARGIN * to_f64(piece.displacement).norm();
        }
    }

    /// Returns the mean velocity of a piece relative to its group [m/s]; zero for one that does not
    /// take part.
    pub(super) fn own_velocity(&self, index: u32) -> Vec3 {
        let Some(piece) = self.list.get(index as usize) else {
            return Vec3::zeros();
        };
        self.mean_velocity(index) - self.list[piece.group as usize].group_velocity
    }

    /// Returns the mean velocity of the vertices of a piece [m/s].
    pub(super) fn mean_velocity(&self, index: u32) -> Vec3 {
        let (sum, count) = self.list[index as usize].velocity_sum;
        sum / count
    }

    /// Returns the mass of a piece \[kg\]; 0 for one that does not take part.
    pub(super) fn mass(&self, index: u32) -> f64 {
        self.list
            .get(index as usize)
            .map_or(0.0, |piece| piece.mass)
    }

    /// Returns the vertices of a piece, ascending.
    pub(super) fn vertices(&self, index: u32) -> &[VertexId] {
        let (first, end) = self.list[index as usize].vertices;
        &self.vertices[first as usize..end as usize]
    }

    /// Returns a piece by its index.
    pub(super) fn get(&self, index: u32) -> &Piece {
        &self.list[index as usize]
    }

    /// Returns all pieces, ascending by index.
    pub(super) fn iter(&self) -> std::slice::Iter<'_, Piece> {
        self.list.iter()
    }

    /// Returns the pieces with which a piece, by index, may collide.
    pub(super) fn neighbors(&self, index: u32) -> impl Iterator<Item = &Piece> {
        let all = self.neighbor_indices(index);
        all.map(|other| &self.list[other as usize])
    }

    /// Returns the indices of the pieces with which a piece may collide, ascending.
    pub(super) fn neighbor_indices(&self, index: u32) -> impl Iterator<Item = u32> {
        let first = self.list[index as usize].first_pair as usize;
        let pairs = self.pairs[first..].iter();
        let of_piece = pairs.take_while(move |pair| pair.0 == index);
        of_piece.map(|pair| pair.1)
    }

    /// Adds the pieces of a body with their boxes and velocity bounds.
    fn measure(&mut self, index: u32, body: &Body, motion: &mut Motion) {
        let (surface, masses) = (body.surface(), body.solver().masses());
        let topology = surface.topology();
        for v in topology.vertices() {
            let number = surface.piece(topology.outgoing(v).triangle());
            let piece = &mut motion.pieces[number as usize];
            if *piece == u32::MAX {
                *piece = index_u32(self.list.len());
                self.list.push(Piece {
                    body: index,
                    number,
                    bounds: Aabb::default(),
                    grown_bounds: Aabb::default(),
                    velocity_bounds: [Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY)],
                    is_held: false,
                    group: 0,
                    velocity_sum: (Vec3::zeros(), 0.0),
                    mass: 0.0,
                    group_velocity: Vec3::zeros(),
                    displacement: [0.0; 3],
                    max_displacement: 0.0,
                    first_pair: 0,
                    vertices: (0, 0),
                });
            }
            let piece = &mut self.list[*piece as usize];
            let [x, y, z, _] = surface.positions()[v.index()];
            for (k, c) in [x, y, z].into_iter().enumerate() {
                piece.bounds.min[k] = piece.bounds.min[k].min(c);
                piece.bounds.max[k] = piece.bounds.max[k].max(c);
            }
            let velocity = motion.velocity(v);
            let [min, max] = piece.velocity_bounds;
            piece.velocity_bounds = [min.inf(&velocity), max.sup(&velocity)];
            piece.velocity_sum.0 += velocity;
            piece.velocity_sum.1 += 1.0;
            piece.mass += f64::from(masses[v.index()]);
        }
    }

    /// Finds the pairs of overlapping grown boxes by a sweep along the x axis.
    fn find_pairs(&mut self, motions: &mut [Motion]) {
        self.pairs.clear();
        let x = |piece: &Piece| piece.grown_bounds.min[0];
        self.list.sort_unstable_by(|a, b| {
            let by_position = x(a).total_cmp(&x(b));
            by_position.then((a.body, a.number).cmp(&(b.body, b.number)))
        });
        for (i, a) in (0..).zip(&self.list) {
            motions[a.body as usize].pieces[a.number as usize] = i;
            let later = self.list.iter().enumerate().skip(i as usize + 1);
            for (j, b) in later.take_while(|(_, b)| x(b) <= a.grown_bounds.max[0]) {
                if a.grown_bounds.overlaps(&b.grown_bounds) {
                    self.pairs.extend([(i, index_u32(j)), (index_u32(j), i)]);
                }
            }
        }
        self.pairs.sort_unstable();
        for (first, &(a, _)) in (0..index_u32(self.pairs.len())).zip(&self.pairs).rev() {
            self.list[a as usize].first_pair = first;
        }
    }

    /// Finds the groups by union-find, and their common velocities.
    fn find_groups(&mut self) {
        let list = &mut self.list;
        for (i, piece) in (0..).zip(list.iter_mut()) {
            piece.group = i;
        }
        for &(a, b) in &self.pairs {
            let (a, b) = (find_root(list, a), find_root(list, b));
            list[a.max(b) as usize].group = a.min(b);
        }
        let sums = &mut self.group_velocity_sums;
        sums.clear();
        sums.resize(list.len(), (Vec3::zeros(), 0.0));
        for i in 0..index_u32(list.len()) {
            let root = find_root(list, i);
            let piece = list[i as usize];
            list[i as usize].group = root;
            list[root as usize].is_held |= piece.is_held;
            let (sum, count) = &mut sums[root as usize];
            *sum += piece.velocity_sum.0;
            *count += piece.velocity_sum.1;
        }
        for (root, &(sum, count)) in list.iter_mut().zip(sums.iter()) {
            root.group_velocity = if root.is_held {
                Vec3::zeros()
            } else {
                sum / f64::max(count, 1.0)
            };
        }
    }

    /// Makes room for the vertices of each piece.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a sum of ones"
    )]
    fn begin_vertices(&mut self) {
        let mut count = 0;
        for piece in &mut self.list {
            piece.vertices = (count, count);
            count += piece.velocity_sum.1 as u32;
        }
        self.vertices.clear();
        self.vertices.resize(count as usize, VertexId::NULL);
    }

    /// Finds displacements relative to groups, and lists the vertices of each piece.
    fn find_displacements(&mut self, surface: &Surface, motion: &mut Motion, dt: f64) {
        let topology = surface.topology();
        for v in topology.vertices() {
            let number = surface.piece(topology.outgoing(v).triangle());
            let index = motion.pieces[number as usize] as usize;
            let common = self.list[self.list[index].group as usize].group_velocity;
            let displacement = motion.set_displacement(v, common, dt);
            let piece = &mut self.list[index];
            for (max, c) in piece.displacement.iter_mut().zip(displacement) {
                *max = max.max(c.abs());
            }
            self.vertices[piece.vertices.1 as usize] = v;
            piece.vertices.1 += 1;
        }
    }
}

impl Piece {
    /// Returns whether a moving point may reach the piece's box.
    pub(super) fn is_near(&self, point: &MovingPoint) -> bool {
        point.reaches(&self.bounds, self.displacement)
    }

    /// Returns whether a point is at most `reach` \[m\] outside of the piece's box.
    pub(super) fn contains(&self, at: Vec3, reach: f64) -> bool {
        let [min, max] = [self.bounds.min, self.bounds.max].map(to_f64);
        let outside = (min - at).sup(&(at - max));
        outside.max() <= reach
    }

    /// Returns the body of the piece and its number there.
    pub(super) fn id(&self) -> PieceId {
        PieceId {
            body: self.body,
            number: self.number,
        }
    }
}

/// Returns the maximum difference between a velocity within bounds and another one [m/s].
fn max_difference([min, max]: [Vec3; 2], from: Vec3) -> f64 {
    (min - from).abs().sup(&(max - from).abs()).norm()
}

/// Returns the index of the first piece of a group, halving paths on the way.
fn find_root(list: &mut [Piece], mut i: u32) -> u32 {
    while list[i as usize].group != i {
        let next = list[list[i as usize].group as usize].group;
        list[i as usize].group = next;
        i = next;
    }
    i
}
