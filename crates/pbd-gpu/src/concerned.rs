//! The vertices concerned by an edit, numbered one after another, and what they bring to be shared.

use crate::mass::{lumped_area, third_of_area};
use crate::momentum::Carried;
use crate::solver::Solver;
use incise_mesh::{Surface, TopologyDelta, Vec3, VertexId};

/// No number, no piece.
pub(crate) const NONE: u32 = u32::MAX;

/// The vertices concerned by an edit. Arrays have the shape [concerned vertices] where they do not say
/// otherwise. Kept from edit to edit for their memory.
#[derive(Debug, Default)]
pub(crate) struct Concerned {
    /// New vertices, then others that stay, then those that went.
    pub(crate) vertices: Vec<VertexId>,
    /// The piece of every vertex, that of a neighbor for one that went.
    pub(crate) pieces: Vec<u32>,
    /// So many new vertices come first.
    pub(crate) came: usize,
    /// So many are there.
    pub(crate) stay: usize,
    /// A third of the rest area around every vertex that is there \[m^2\], shape \[`stay`\].
    pub(crate) areas: Vec<f64>,
    /// What every vertex brings that was there, about [`Self::origin`]; shape [those after the new ones].
    pub(crate) carried: Vec<Carried>,
    around: Around,
}

/// The removed triangles around vertices that went.
#[derive(Debug, Default)]
struct Around {
    /// Where those of a vertex begin, shape [vertices that went, and one].
    first: Vec<usize>,
    /// By vertex, ascending for each.
    triangles: Vec<usize>,
    /// Vertices whose piece is known and whose neighbors' may not be.
    reached: Vec<usize>,
    /// The number of every vertex that went in the delta's list of places, shape [vertices that went].
    places: Vec<u32>,
}

impl Concerned {
    /// Finds them. `numbers` has a place for every vertex slot of solver and surface, [`NONE`] before and
    /// after.
    pub(crate) fn find(
        &mut self,
        solver: &Solver,
        surface: &Surface,
        delta: &TopologyDelta,
        numbers: &mut [u32],
    ) {
        self.number_all(surface, delta, numbers);
        self.find_pieces(delta, numbers);
        self.find_carried(solver, surface, delta, numbers);
        for v in &self.vertices {
            numbers[v.index()] = NONE;
        }
    }

    /// The point of reference \[m\].
    pub(crate) fn origin(&self, surface: &Surface) -> Vec3 {
        let first = self.vertices[..self.stay].first();
        first.map_or_else(Vec3::zeros, |&v| surface.position(v))
    }

    fn number_all(&mut self, surface: &Surface, delta: &TopologyDelta, numbers: &mut [u32]) {
        let topology = surface.topology();
        self.vertices.clear();
        self.pieces.clear();
        for added in &delta.vertices_added {
            self.number(added.vertex, added.piece, numbers);
        }
        self.came = self.vertices.len();
        self.areas.clear();
        self.areas.resize(self.came, 0.0);
        for &t in &delta.triangles_added {
            let piece = surface.piece(t);
            let corners = topology.triangle(t);
            let members = corners.map(|v| self.number(v, piece, numbers));
            // All triangles around new vertices are new.
            if members.iter().any(|&n| n < self.came) {
                let area = third_of_area(surface, corners);
                for n in members {
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
                self.number(v, surface.piece(h.triangle()), numbers);
            }
        }
        self.stay = self.vertices.len();
        let others = &self.vertices[self.came..];
        self.areas
            .extend(others.iter().map(|&v| lumped_area(surface, v)));
        for v in corners() {
            self.number(v, NONE, numbers);
        }
    }

    #[inline]
    fn number(&mut self, v: VertexId, piece: u32, numbers: &mut [u32]) -> usize {
        let number = &mut numbers[v.index()];
        if *number == NONE {
            *number = u32::try_from(self.vertices.len()).expect("vertices have 32-bit ids");
            self.vertices.push(v);
            self.pieces.push(piece);
        }
        *number as usize
    }

    /// Vertices that went belong to the piece of the nearest neighbor that stayed.
    fn find_pieces(&mut self, delta: &TopologyDelta, numbers: &[u32]) {
        let gone = self.vertices.len() - self.stay;
        if gone == 0 {
            return;
        }
        let (stay, pieces) = (self.stay, &mut self.pieces);
        let Around {
            first,
            triangles,
            reached,
            ..
        } = &mut self.around;
        let removed = &delta.triangles_removed;
        let triangle = |i: usize| removed[i].1.map(|v| numbers[v.index()] as usize);
        first.clear();
        first.resize(gone + 1, 0);
        reached.clear();
        for i in 0..removed.len() {
            let corners = triangle(i);
            let piece = corners.iter().map(|&n| pieces[n]).find(|&p| p != NONE);
            for n in corners.into_iter().filter(|&n| n >= stay) {
                first[n - stay] += 1;
                if let Some(piece) = piece.filter(|_| pieces[n] == NONE) {
                    pieces[n] = piece;
                    reached.push(n);
                }
            }
        }
        // Where the triangles of each end, then, from the last triangle to the first, where they begin.
        let mut end = 0;
        for first in &mut *first {
            end += *first;
            *first = end;
        }
        triangles.clear();
        triangles.resize(end, 0);
        for i in (0..removed.len()).rev() {
            for n in triangle(i).into_iter().filter(|&n| n >= stay) {
                first[n - stay] -= 1;
                triangles[first[n - stay]] = i;
            }
        }
        let mut next = 0;
        while let Some(&n) = reached.get(next) {
            next += 1;
            for &i in &triangles[first[n - stay]..first[n - stay + 1]] {
                for m in triangle(i) {
                    if pieces[m] == NONE {
                        pieces[m] = pieces[n];
                        reached.push(m);
                    }
                }
            }
        }
    }

    fn find_carried(
        &mut self,
        solver: &Solver,
        surface: &Surface,
        delta: &TopologyDelta,
        numbers: &[u32],
    ) {
        let origin = self.origin(surface);
        let places = &mut self.around.places;
        places.clear();
        places.resize(self.vertices.len() - self.stay, NONE);
        // An edit that is no undo leaves it to the surface where its vertices were.
        let told = delta.vertices_removed.iter().zip(&delta.removed_from);
        for (i, (v, _)) in (0..).zip(told) {
            let n = numbers.get(v.index()).map_or(NONE, |&n| n) as usize;
            let place = n.checked_sub(self.stay).and_then(|n| places.get_mut(n));
            if let Some(place) = place {
                *place = i;
            }
        }
        let bring = |n: usize| {
            let v = self.vertices[n];
            let place = n.checked_sub(self.stay).map_or(NONE, |n| places[n]);
            let at = match delta.removed_from.get(place as usize) {
                Some(&[x, y, z]) => Vec3::new(x.into(), y.into(), z.into()),
                None => surface.position(v),
            };
            let [x, y, z] = solver.velocity(v).map(f64::from);
            let mass = f64::from(solver.mass[v.index()]);
            Carried::of(mass, at - origin, Vec3::new(x, y, z))
        };
        self.carried.clear();
        let others = self.came..self.vertices.len();
        self.carried.extend(others.map(bring));
    }
}
