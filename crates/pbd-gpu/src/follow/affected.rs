//! Vertices that are affected by an edit, with their pieces, areas and momenta.

use crate::follow::momentum::Momentum;
use crate::mass::{lumped_area, third_of_area};
use crate::particles::Particles;
use incise_mesh::{Surface, TopologyDelta, Vec3, VertexId, index_u32};

/// No index, no piece.
pub(crate) const NONE: u32 = u32::MAX;

/// The affected vertices of an edit. Arrays have shape [affected vertices] unless stated.
#[derive(Debug, Default)]
pub(crate) struct Affected {
    /// Affected vertices: created, then surviving, then deleted.
    pub(crate) vertices: Vec<VertexId>,
    /// Piece of every vertex; that of a neighbor for a deleted vertex.
    pub(crate) pieces: Vec<u32>,
    /// Number of created vertices.
    pub(crate) new_count: usize,
    /// Number of created and surviving vertices.
    pub(crate) surviving_count: usize,
    /// Lumped rest area of every created and surviving vertex \[m^2\].
    pub(crate) areas: Vec<f64>,
    /// Momentum of every surviving and deleted vertex about [`Self::origin`].
    pub(crate) momenta: Vec<Momentum>,
    /// Index of a vertex in `vertices`, shape [vertex slots]; all [`NONE`] between edits.
    index_of: Vec<u32>,
    removed: Removed,
}

/// The removed triangles at deleted vertices.
#[derive(Debug, Default)]
struct Removed {
    /// First entry of every vertex in `triangles`, shape [deleted vertices + 1].
    first: Vec<usize>,
    /// Removed triangles by vertex, ascending for each.
    triangles: Vec<usize>,
    /// Breadth-first queue of vertices with a known piece.
    queue: Vec<usize>,
    /// Index of every deleted vertex in the delta's positions, shape [deleted vertices].
    position_of: Vec<u32>,
}

impl Affected {
    /// Allocates memory for a body of `slots` vertices and for more `vertices`.
    pub(crate) fn reserve(&mut self, slots: usize, vertices: usize) {
        self.index_of.resize(slots, NONE);
        self.index_of.reserve(vertices);
    }

    /// Finds the affected vertices of an edit. Particles still have the slots of deleted vertices.
    pub(crate) fn find(&mut self, particles: &Particles, surface: &Surface, delta: &TopologyDelta) {
        self.index_of.resize(particles.len(), NONE);
        self.list_vertices(surface, delta);
        self.find_pieces(delta);
        self.find_momenta(particles, surface, delta);
        for v in &self.vertices {
            self.index_of[v.index()] = NONE;
        }
    }

    /// Returns the vertices that existed before the edit.
    pub(crate) fn existing_before(&self) -> &[VertexId] {
        &self.vertices[self.new_count..]
    }

    /// Returns the vertices that exist after the edit.
    pub(crate) fn existing_after(&self) -> &[VertexId] {
        &self.vertices[..self.surviving_count]
    }

    /// Returns the deleted vertices.
    pub(crate) fn deleted(&self) -> &[VertexId] {
        &self.vertices[self.surviving_count..]
    }

    /// Returns the point of reference of moments \[m\].
    pub(crate) fn origin(&self, surface: &Surface) -> Vec3 {
        let first = self.existing_after().first();
        first.map_or_else(Vec3::zeros, |&v| surface.position(v))
    }

    fn list_vertices(&mut self, surface: &Surface, delta: &TopologyDelta) {
        let topology = surface.topology();
        self.vertices.clear();
        self.pieces.clear();
        for added in &delta.vertices_added {
            self.add(added.vertex, added.piece);
        }
        self.new_count = self.vertices.len();
        self.areas.clear();
        self.areas.resize(self.new_count, 0.0);
        for &t in &delta.triangles_added {
            let piece = surface.piece(t);
            let corners = topology.triangle(t);
            let indices = corners.map(|v| self.add(v, piece));
            // All triangles at created vertices are new.
            if indices.iter().any(|&n| n < self.new_count) {
                let area = third_of_area(surface, corners);
                for n in indices {
                    if let Some(sum) = self.areas.get_mut(n) {
                        *sum += area;
                    }
                }
            }
        }
        let corners = || delta.triangles_removed.iter().flat_map(|entry| entry.1);
        for v in corners() {
            let h = topology.outgoing(v);
            if !h.is_null() {
                self.add(v, surface.piece(h.triangle()));
            }
        }
        self.surviving_count = self.vertices.len();
        let surviving = &self.vertices[self.new_count..];
        self.areas
            .extend(surviving.iter().map(|&v| lumped_area(surface, v)));
        for v in corners() {
            self.add(v, NONE);
        }
    }

    /// Adds a vertex unless it is listed, and returns its index.
    #[inline]
    fn add(&mut self, v: VertexId, piece: u32) -> usize {
        let index = &mut self.index_of[v.index()];
        if *index == NONE {
            *index = index_u32(self.vertices.len());
            self.vertices.push(v);
            self.pieces.push(piece);
        }
        *index as usize
    }

    /// Assigns deleted vertices to the piece of the nearest surviving neighbor.
    fn find_pieces(&mut self, delta: &TopologyDelta) {
        let deleted = self.vertices.len() - self.surviving_count;
        if deleted == 0 {
            return;
        }
        let (surviving, pieces) = (self.surviving_count, &mut self.pieces);
        let Removed {
            first,
            triangles,
            queue,
            ..
        } = &mut self.removed;
        let index_of = &self.index_of;
        let removed = &delta.triangles_removed;
        let corners = |i: usize| removed[i].1.map(|v| index_of[v.index()] as usize);
        first.clear();
        first.resize(deleted + 1, 0);
        queue.clear();
        for i in 0..removed.len() {
            let corners = corners(i);
            let piece = corners.iter().map(|&n| pieces[n]).find(|&p| p != NONE);
            for n in corners.into_iter().filter(|&n| n >= surviving) {
                first[n - surviving] += 1;
                if let Some(piece) = piece.filter(|_| pieces[n] == NONE) {
                    pieces[n] = piece;
                    queue.push(n);
                }
            }
        }
        // Counting sort: ends of the lists first, which the backward pass turns into starts.
        let mut end = 0;
        for first in &mut *first {
            end += *first;
            *first = end;
        }
        triangles.clear();
        triangles.resize(end, 0);
        for i in (0..removed.len()).rev() {
            for n in corners(i).into_iter().filter(|&n| n >= surviving) {
                first[n - surviving] -= 1;
                triangles[first[n - surviving]] = i;
            }
        }
        let mut next = 0;
        while let Some(&n) = queue.get(next) {
            next += 1;
            for &i in &triangles[first[n - surviving]..first[n - surviving + 1]] {
                for m in corners(i) {
                    if pieces[m] == NONE {
                        pieces[m] = pieces[n];
                        queue.push(m);
                    }
                }
            }
        }
    }

    fn find_momenta(&mut self, particles: &Particles, surface: &Surface, delta: &TopologyDelta) {
        let origin = self.origin(surface);
        let position_of = &mut self.removed.position_of;
        position_of.clear();
        position_of.resize(self.vertices.len() - self.surviving_count, NONE);
        // Only an undo lists positions; otherwise the surface still has them.
        let listed = delta.vertices_removed.iter().zip(&delta.removed_positions);
        for (i, (v, _)) in (0..).zip(listed) {
            let n = self.index_of.get(v.index()).map_or(NONE, |&n| n) as usize;
            let deleted = n.checked_sub(self.surviving_count);
            if let Some(index) = deleted.and_then(|n| position_of.get_mut(n)) {
                *index = i;
            }
        }
        let momentum = |n: usize| {
            let v = self.vertices[n];
            let deleted = n.checked_sub(self.surviving_count);
            let listed = deleted.map_or(NONE, |n| position_of[n]);
            let position = match delta.removed_positions.get(listed as usize) {
                Some(&[x, y, z]) => Vec3::new(x.into(), y.into(), z.into()),
                None => surface.position(v),
            };
            let [x, y, z, _] = particles.velocities[v.index()].map(f64::from);
            let mass = f64::from(particles.mass[v.index()]);
            Momentum::new(mass, position - origin, Vec3::new(x, y, z))
        };
        self.momenta.clear();
        let existing = self.new_count..self.vertices.len();
        self.momenta.extend(existing.map(momentum));
    }
}
