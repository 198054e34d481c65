//! Gives the parts of cut pieces piece numbers of their own.
//!
//! Searches start on both sides of every loop, advance in turns and join where they meet. They end
//! as soon as at most one part of each piece is unfinished: its size follows from the others, and
//! if it is the largest it keeps the piece's number. So the largest part is not traversed as a
//! whole. Searches on the side that looks smaller get longer turns.

use crate::sweep::Sweep;
use incise_mesh::{Edit, HalfEdge, Surface, Topology, TriangleId, index_u32};

/// Triangles that a search visits before the next search has its turn.
const TURN: usize = 1024;
/// Factor by which turns are longer on the side that looks smaller.
const SMALLER_SIDE_FACTOR: usize = 8;
/// Triangles that are visited together.
const BATCH: usize = 32;
/// Triangles of a body that are sampled to estimate the smaller side.
const SAMPLES: usize = 64;

/// Scratch memory of the searches.
#[derive(Debug, Clone, Default)]
pub(crate) struct Separator {
    /// By triangle slot: `epoch` + the number of the search that reached it, or less.
    stamps: Vec<u32>,
    epoch: u32,
    /// The next epoch: above all stamps.
    next_epoch: u32,
    /// One per side of a loop, side 0 before side 1.
    searches: Vec<Search>,
    /// The side that looks smaller.
    smaller: usize,
    /// Searches, grouped by part.
    members: Vec<usize>,
    /// The parts that the searches have joined.
    parts: Vec<Part>,
}

/// The triangles that were reached from one side of a loop.
#[derive(Debug, Clone, Default)]
struct Search {
    /// One half-edge of each reached triangle, that across which it was reached.
    reached: Vec<HalfEdge>,
    /// Number of reached triangles whose neighbors were reached, the first ones.
    visited: usize,
    /// The search that it was joined to, itself if none (union-find).
    root: usize,
    /// The piece of its first triangle.
    piece: u32,
}

/// A part of a piece: searches that were joined.
#[derive(Debug, Clone, Copy)]
struct Part {
    /// Range of its searches among the members.
    members: (usize, usize),
    /// The smallest piece number of its searches, and whether there are others.
    piece: u32,
    is_mixed: bool,
    triangles: usize,
    is_finished: bool,
    first_triangle: TriangleId,
}

impl Separator {
    /// Finds the connected parts of the pieces at `seeds`, for [`Self::number_parts`].
    ///
    /// Seeds are triangles in turns below and above the sweep. Seeds with `joined` numbers will be
    /// joined by a cap, so their parts are one.
    pub(crate) fn find_parts(
        &mut self,
        surface: &Surface,
        sweep: &Sweep,
        seeds: &[TriangleId],
        joined: &[(usize, usize)],
    ) {
        self.begin(surface, seeds);
        self.smaller = estimate_smaller_side(surface, sweep, self.searches[0].piece);
        for &(a, b) in joined {
            self.join(a, b);
        }
        let mut parts = std::mem::take(&mut self.parts);
        loop {
            self.join_searches(&mut parts);
            let mut is_done = true;
            for group in parts.chunk_by(|a, b| a.piece == b.piece) {
                let finished = || group.iter().filter(|p| p.is_finished).map(|p| p.triangles);
                let open = group.iter().filter(|p| !p.is_finished).count();
                let rest = surface.piece_triangles(group[0].piece);
                let rest = rest.saturating_sub(finished().sum());
                let is_largest = finished().all(|triangles| triangles < rest);
                for part in group.iter().filter(|p| !p.is_finished) {
                    if open > 1 || part.is_mixed || !is_largest {
                        is_done = false;
                        self.advance(surface, part);
                    }
                }
            }
            if is_done {
                break;
            }
        }
        for part in parts.iter_mut().filter(|p| p.is_finished) {
            let firsts = self
                .reached(part)
                .filter_map(|reached| reached.iter().min());
            part.first_triangle = firsts.min().expect("a search has a triangle").triangle();
        }
        parts.sort_by_key(|part| (part.piece, part.first_triangle));
        self.parts = parts;
    }

    fn begin(&mut self, surface: &Surface, seeds: &[TriangleId]) {
        let slots = surface.topology().triangle_slots();
        for search in &mut self.searches {
            search.reached.clear();
            search.visited = 0;
        }
        self.searches.resize(seeds.len(), Search::default());
        self.stamps.resize(slots.max(self.stamps.len()), 0);
        // Stamps of earlier cuts are below the epoch, so nothing is cleared but once in a long
        // while.
        let count = index_u32(seeds.len());
        if self.next_epoch > u32::MAX - count {
            self.stamps.fill(0);
            self.next_epoch = 0;
        }
        self.epoch = self.next_epoch.max(1);
        self.next_epoch = self.epoch + count;
        for (i, &seed) in seeds.iter().enumerate() {
            let search = &mut self.searches[i];
            search.root = i;
            search.piece = surface.piece(seed);
            let stamp =
                std::mem::replace(&mut self.stamps[seed.index()], self.epoch + index_u32(i));
            if stamp < self.epoch {
                let [h, ..] = seed.half_edges();
                self.searches[i].reached.push(h);
                // A visit of the seed reaches the other two neighbors.
                let near = surface.topology().twin(h);
                if !near.is_null() {
                    self.reach(i, &[near]);
                }
            } else {
                self.join(i, (stamp - self.epoch) as usize);
            }
        }
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.searches[a.max(b)].root = a.min(b);
    }

    fn root(&self, mut i: usize) -> usize {
        while self.searches[i].root != i {
            i = self.searches[i].root;
        }
        i
    }

    /// Collects the parts that the searches have joined so far, by piece, then by root.
    fn join_searches(&mut self, out: &mut Vec<Part>) {
        for i in 0..self.searches.len() {
            self.searches[i].root = self.root(i);
        }
        self.members.clear();
        self.members.extend(0..self.searches.len());
        let searches = &self.searches;
        self.members.sort_by_key(|&i| searches[i].root);
        out.clear();
        let mut from = 0;
        for own in self
            .members
            .chunk_by(|&a, &b| searches[a].root == searches[b].root)
        {
            let own_searches = || own.iter().map(|&i| &searches[i]);
            let pieces = || own_searches().map(|s| s.piece);
            let piece = pieces().min().unwrap_or_default();
            out.push(Part {
                members: (from, from + own.len()),
                piece,
                is_mixed: pieces().any(|p| p != piece),
                triangles: own_searches().map(|s| s.reached.len()).sum(),
                is_finished: own_searches().all(|s| s.visited == s.reached.len()),
                first_triangle: TriangleId::NULL,
            });
            from += own.len();
        }
        // Stable, so that parts of a piece stay in the order of their roots.
        out.sort_by_key(|part| part.piece);
    }

    /// Lets the searches of a part visit more triangles.
    fn advance(&mut self, surface: &Surface, part: &Part) {
        let topology = surface.topology();
        for k in part.members.0..part.members.1 {
            let i = self.members[k];
            let mut turn = if i % 2 == self.smaller {
                SMALLER_SIDE_FACTOR * TURN
            } else {
                TURN
            };
            while turn > 0 && self.searches[i].visited < self.searches[i].reached.len() {
                self.visit(topology, i);
                turn -= BATCH;
            }
        }
    }

    /// Visits the next few triangles of a search.
    ///
    /// All neighbors are read before any is tested, so that memory reads overlap.
    fn visit(&mut self, topology: &Topology, i: usize) {
        let Search {
            reached, visited, ..
        } = &mut self.searches[i];
        let first = *visited;
        *visited = reached.len().min(first + BATCH);
        let mut near = [HalfEdge::NULL; 2 * BATCH];
        let mut count = 0;
        for &h in &reached[first..*visited] {
            for twin in [topology.twin(h.next()), topology.twin(h.prev())] {
                near[count] = twin;
                count += usize::from(!twin.is_null());
            }
        }
        self.reach(i, &near[..count]);
    }

    /// Adds the triangles of half-edges to a search, at most two a visited one.
    ///
    /// No branch depends on whether one is new.
    fn reach(&mut self, i: usize, near: &[HalfEdge]) {
        let own = self.epoch + index_u32(i);
        let mut new = [HalfEdge::NULL; 2 * BATCH];
        let mut fresh = 0;
        for &h in near {
            let stamp = std::mem::replace(&mut self.stamps[h.triangle().index()], own);
            new[fresh] = h;
            fresh += usize::from(stamp < self.epoch);
            if stamp >= self.epoch && stamp != own {
                self.join(i, (stamp - self.epoch) as usize);
            }
        }
        (self.searches[i].reached).extend_from_slice(&new[..fresh]);
    }

    /// Gives every part that was found a piece number of its own.
    ///
    /// The part with the most triangles keeps the old number; of equals, the one with the first
    /// triangle.
    pub(crate) fn number_parts(&self, edit: &mut Edit<'_>) {
        for group in self.parts.chunk_by(|a, b| a.piece == b.piece) {
            // An unfinished part is larger than all others; of finished ones the first of the
            // largest.
            let size = |p: &Part| {
                if p.is_finished {
                    p.triangles
                } else {
                    usize::MAX
                }
            };
            let kept = group.iter().rev().max_by_key(|p| size(p));
            let kept = kept.expect("a group has a part").members;
            for part in group {
                if part.members == kept && !part.is_mixed {
                    continue;
                }
                let number = if part.members == kept {
                    part.piece
                } else {
                    edit.new_piece(part.piece)
                };
                for reached in self.reached(part) {
                    edit.set_pieces(reached.iter().map(|h| h.triangle()), number);
                }
            }
        }
    }

    /// Iterates over the searches of a finished part, with a half-edge of each triangle.
    fn reached(&self, part: &Part) -> impl Iterator<Item = &[HalfEdge]> {
        let own = &self.members[part.members.0..part.members.1];
        own.iter().map(|&i| self.searches[i].reached.as_slice())
    }
}

/// Estimates on which side of the sweep's plane a piece has fewer triangles, from samples.
///
/// Only the time of the searches depends on it.
fn estimate_smaller_side(surface: &Surface, sweep: &Sweep, piece: u32) -> usize {
    let (point, normal) = sweep.plane();
    let slots = surface.topology().triangle_slots();
    let samples = (0..SAMPLES).map(|i| TriangleId::from_index(i * slots / SAMPLES));
    let own = samples.filter(|&t| surface.topology().is_triangle(t) && surface.piece(t) == piece);
    let above: i32 = own
        .map(|t| {
            let [corner, ..] = surface.triangle_positions(t);
            if normal.dot(&(corner - point)) > 0.0 {
                1
            } else {
                -1
            }
        })
        .sum();
    usize::from(above <= 0)
}
