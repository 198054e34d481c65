//! Who inherits the mass and momentum of what an edit took away.
//!
//! The corners of removed and added triangles of one piece form a pool. The pool's mass is what its
//! surviving members had, plus that of removed vertices next to it; its members share it by rest area.
//! Pools of what was one piece before the edit form a family. Shares are tilted so that the family's
//! center of mass stays where it is, and its members move as a rigid body on top of how they move, so
//! that its momentum and angular momentum are what they were. See [`crate::momentum`].

use crate::mass::{lumped_area, shares_of};
use crate::momentum::{Carried, Heir, keep_center, keep_momentum};
use crate::solver::{Solver, inverse};
use incise_mesh::geometry::area_vector;
use incise_mesh::{Surface, TopologyDelta, Vec3, VertexId};
use std::ops::Range;

/// No number, no piece.
pub(crate) const NONE: u32 = u32::MAX;

/// Which vertices are concerned and how they share.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Sharing {
    /// Every piece has what it had.
    Piece,
    /// A piece has new vertices only: pieces that were one share.
    Family,
    /// That piece was not part of any: all share.
    All,
}

/// A part of the concerned vertices that shares mass, in the order of family, then of piece.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Pool {
    family: u32,
    piece: u32,
}

/// The vertices concerned by an edit. Arrays have the shape [concerned vertices].
#[derive(Debug, Default)]
struct Concerned {
    vertices: Vec<VertexId>,
    /// The piece of every vertex, that of a neighbor for one that went.
    pieces: Vec<u32>,
    /// So many new vertices come first, then others that stay, then those that went.
    came: usize,
    stay: usize,
}

/// Shares out mass, momentum and angular momentum after an edit. Constraints and interpolated velocities
/// are those after it, masses those before. O(k log k) for k changed triangles.
pub(crate) fn settle(solver: &mut Solver, surface: &mut Surface, delta: &TopologyDelta) {
    let mut numbers = std::mem::take(&mut solver.numbers);
    numbers.resize(solver.mass.len(), NONE);
    let mut concerned = Concerned::new(surface, delta, &mut numbers);
    concerned.find_pieces(delta, &numbers);
    let areas = concerned.areas(surface, delta, &numbers);
    for v in &concerned.vertices {
        numbers[v.index()] = NONE;
    }
    solver.numbers = numbers;
    for &v in &concerned.vertices[..concerned.came] {
        solver.mass[v.index()] = 0.0;
    }
    let carried = concerned.carried(solver, surface, delta);
    for sharing in [Sharing::Piece, Sharing::Family, Sharing::All] {
        let shares = Shares::new(&concerned, delta, sharing);
        let masses = shares.masses(&concerned, &carried, &areas);
        if sharing == Sharing::All || masses.iter().all(|&mass| mass > 0.0) {
            shares.hand_over(&concerned, &carried, &areas, &masses, solver, surface);
            break;
        }
    }
    for v in &concerned.vertices[concerned.stay..] {
        solver.mass[v.index()] = 0.0;
        solver.velocities[v.index()] = [0.0; 4];
        // The slot of an undone vertex may be no more.
        if let Some(position) = surface.positions.get_mut(v.index()) {
            position[3] = 0.0;
        }
    }
}

impl Concerned {
    /// Numbers the concerned vertices.
    fn new(surface: &Surface, delta: &TopologyDelta, numbers: &mut [u32]) -> Self {
        let topology = surface.topology();
        let mut concerned = Self::default();
        for added in &delta.vertices_added {
            concerned.number(added.vertex, added.piece, numbers);
        }
        concerned.came = concerned.vertices.len();
        for &t in &delta.triangles_added {
            let piece = surface.piece(t);
            for v in topology.triangle(t) {
                concerned.number(v, piece, numbers);
            }
        }
        let corners = || delta.triangles_removed.iter().flat_map(|entry| entry.1);
        for v in corners() {
            let h = topology.outgoing(v);
            if !h.is_null() {
                concerned.number(v, surface.piece(h.triangle()), numbers);
            }
        }
        concerned.stay = concerned.vertices.len();
        for v in corners() {
            concerned.number(v, NONE, numbers);
        }
        concerned
    }

    fn number(&mut self, v: VertexId, piece: u32, numbers: &mut [u32]) {
        let number = &mut numbers[v.index()];
        if *number == NONE {
            *number = u32::try_from(self.vertices.len()).expect("vertices have 32-bit ids");
            self.vertices.push(v);
            self.pieces.push(piece);
        }
    }

    /// Vertices that went belong to the piece of the nearest neighbor that stayed.
    fn find_pieces(&mut self, delta: &TopologyDelta, numbers: &[u32]) {
        let gone = self.vertices.len() - self.stay;
        if gone == 0 {
            return;
        }
        let triangle = |i: usize| {
            let corners = delta.triangles_removed[i].1;
            corners.map(|v| numbers[v.index()] as usize)
        };
        // The removed triangles around each of them.
        let mut around = Vec::new();
        let mut reached = Vec::with_capacity(gone);
        for i in 0..delta.triangles_removed.len() {
            let corners = triangle(i);
            let piece = corners.iter().map(|&n| self.pieces[n]).find(|&p| p != NONE);
            for n in corners.into_iter().filter(|&n| n >= self.stay) {
                around.push((n, i));
                if let Some(piece) = piece.filter(|_| self.pieces[n] == NONE) {
                    self.pieces[n] = piece;
                    reached.push(n);
                }
            }
        }
        around.sort_unstable();
        let mut next = 0;
        while let Some(&n) = reached.get(next) {
            next += 1;
            let first = around.partition_point(|entry| entry.0 < n);
            for &(_, i) in around[first..].iter().take_while(|entry| entry.0 == n) {
                for m in triangle(i) {
                    if self.pieces[m] == NONE {
                        self.pieces[m] = self.pieces[n];
                        reached.push(m);
                    }
                }
            }
        }
    }

    /// A third of the rest area around every vertex that is there \[m^2\].
    fn areas(&self, surface: &Surface, delta: &TopologyDelta, numbers: &[u32]) -> Vec<f64> {
        let topology = surface.topology();
        let mut areas = vec![0.0; self.stay];
        // All triangles around new vertices are new.
        for &t in &delta.triangles_added {
            let corners = topology.triangle(t);
            let members = corners.map(|v| numbers[v.index()] as usize);
            if members.iter().any(|&n| n < self.came) {
                let area = area_vector(corners.map(|v| surface.rest_position(v))).norm() / 6.0;
                for n in members.into_iter().filter(|&n| n < self.came) {
                    areas[n] += area;
                }
            }
        }
        let others = &self.vertices[self.came..self.stay];
        for (area, &v) in areas[self.came..].iter_mut().zip(others) {
            *area = lumped_area(surface, v);
        }
        areas
    }

    /// What every vertex brings that was there, about the first one; shape [those after the new ones].
    fn carried(&self, solver: &Solver, surface: &Surface, delta: &TopologyDelta) -> Vec<Carried> {
        let origin = self.origin(surface);
        let bring = |n: usize| {
            let v = self.vertices[n];
            let at = (n >= self.stay)
                .then(|| delta.place_of_removed(v))
                .flatten();
            let at = match at {
                Some([x, y, z]) => Vec3::new(x.into(), y.into(), z.into()),
                None => surface.position(v),
            };
            let [x, y, z] = solver.velocity(v).map(f64::from);
            let mass = f64::from(solver.mass[v.index()]);
            Carried::of(mass, at - origin, Vec3::new(x, y, z))
        };
        (self.came..self.vertices.len()).map(bring).collect()
    }

    /// The point of reference.
    fn origin(&self, surface: &Surface) -> Vec3 {
        let first = self.vertices[..self.stay].first();
        first.map_or_else(Vec3::zeros, |&v| surface.position(v))
    }
}

/// Who shares with whom.
#[derive(Debug)]
struct Shares {
    /// Ascending.
    pools: Vec<Pool>,
    /// The pool of every concerned vertex; [`NONE`] for one that went and left no neighbor.
    pool_of: Vec<u32>,
}

impl Shares {
    fn new(concerned: &Concerned, delta: &TopologyDelta, sharing: Sharing) -> Self {
        let mut parents = delta.pieces_added.clone();
        parents.sort_unstable();
        let pool = |piece: u32| {
            let parent = parents.binary_search_by_key(&piece, |entry| entry.0);
            let family = parent.map_or(piece, |i| parents[i].1);
            match sharing {
                Sharing::Piece => Pool { family, piece },
                Sharing::Family => Pool {
                    family,
                    piece: family,
                },
                Sharing::All => Pool {
                    family: 0,
                    piece: 0,
                },
            }
        };
        let mut pieces = concerned.pieces[..concerned.stay].to_vec();
        // Most stand together.
        pieces.dedup();
        pieces.sort_unstable();
        pieces.dedup();
        let mut pools: Vec<Pool> = pieces.iter().map(|&piece| pool(piece)).collect();
        pools.sort_unstable();
        pools.dedup();
        let number = |piece: u32| match pools.binary_search(&pool(piece)) {
            Ok(i) => u32::try_from(i).unwrap_or(NONE),
            Err(_) => NONE,
        };
        let mut last = (NONE, if sharing == Sharing::All { 0 } else { NONE });
        let numbered = |&piece: &u32| {
            if piece != last.0 {
                last = (piece, number(piece));
            }
            last.1
        };
        let pool_of = concerned.pieces.iter().map(numbered).collect();
        Self { pools, pool_of }
    }

    /// What goes to each pool of that which vertices without a neighbor leave, by the area of new
    /// vertices.
    fn shares_of_orphaned(&self, concerned: &Concerned, areas: &[f64]) -> Vec<f64> {
        let mut shares = vec![0.0; self.pools.len()];
        let heirs = match concerned.came {
            0 => 0..concerned.stay,
            came => 0..came,
        };
        for n in heirs {
            shares[self.pool_of[n] as usize] += areas[n];
        }
        let sum: f64 = shares.iter().sum();
        let even = 1.0 / shares.len() as f64;
        for share in &mut shares {
            *share = if sum > 0.0 { *share / sum } else { even };
        }
        shares
    }

    /// The mass of every pool.
    fn masses(&self, concerned: &Concerned, carried: &[Carried], areas: &[f64]) -> Vec<f64> {
        let mut masses = vec![0.0; self.pools.len()];
        let mut orphaned = 0.0;
        for (carried, &pool) in carried.iter().zip(&self.pool_of[concerned.came..]) {
            match masses.get_mut(pool as usize) {
                Some(mass) => *mass += carried.mass,
                None => orphaned += carried.mass,
            }
        }
        let shares = self.shares_of_orphaned(concerned, areas);
        for (mass, share) in masses.iter_mut().zip(shares) {
            *mass += orphaned * share;
        }
        masses
    }

    #[expect(
        clippy::cast_possible_truncation,
        reason = "a computed mass is rounded once to storage"
    )]
    fn hand_over(
        &self,
        concerned: &Concerned,
        carried: &[Carried],
        areas: &[f64],
        masses: &[f64],
        solver: &mut Solver,
        surface: &mut Surface,
    ) {
        let orphan_shares = self.shares_of_orphaned(concerned, areas);
        let mut estates = vec![Carried::default(); self.pools.len()];
        let mut orphaned = Carried::default();
        for (carried, &pool) in carried.iter().zip(&self.pool_of[concerned.came..]) {
            let estate = estates.get_mut(pool as usize).unwrap_or(&mut orphaned);
            estate.add(carried, 1.0);
        }
        let (mut heirs, ranges) = self.heirs(concerned, areas, masses, solver, surface);
        let mut first = 0;
        for family in self.pools.chunk_by(|a, b| a.family == b.family) {
            let pools = first..first + family.len();
            first = pools.end;
            let mut was = Carried::default();
            for pool in pools.clone() {
                was.add(&estates[pool], 1.0);
                was.add(&orphaned, orphan_shares[pool]);
            }
            let heirs = &mut heirs[ranges[pools.start].start..ranges[pools.end - 1].end];
            keep_center(heirs, was.moment);
            for heir in &mut *heirs {
                let i = heir.vertex.index();
                solver.mass[i] = heir.mass as f32;
                heir.mass = f64::from(solver.mass[i]);
                let inverse = if heir.is_free {
                    inverse(solver.mass[i])
                } else {
                    0.0
                };
                surface.positions[i][3] = inverse;
            }
            keep_momentum(heirs, &mut solver.velocities, &was);
        }
    }

    /// The vertices that are there by pool, with their shares by area, and where each pool is.
    fn heirs(
        &self,
        concerned: &Concerned,
        areas: &[f64],
        masses: &[f64],
        solver: &Solver,
        surface: &Surface,
    ) -> (Vec<Heir>, Vec<Range<usize>>) {
        let mut ranges = vec![0..0; self.pools.len()];
        for &pool in &self.pool_of[..concerned.stay] {
            ranges[pool as usize].end += 1;
        }
        let mut end = 0;
        for range in &mut ranges {
            let len = range.end;
            *range = end..end;
            end += len;
        }
        let mut order = vec![0; end];
        for n in 0..concerned.stay {
            let range = &mut ranges[self.pool_of[n] as usize];
            order[range.end] = n;
            range.end += 1;
        }
        let mut shares: Vec<f64> = order.iter().map(|&n| areas[n]).collect();
        for (range, mass) in ranges.iter().zip(masses) {
            let shares = &mut shares[range.clone()];
            shares_of(shares);
            shares.iter_mut().for_each(|share| *share *= mass);
        }
        let origin = concerned.origin(surface);
        let pins = &solver.pins;
        let heir = |(n, mass): (usize, f64)| {
            let vertex = concerned.vertices[n];
            Heir {
                vertex,
                at: surface.position(vertex) - origin,
                mass,
                is_free: pins.binary_search_by_key(&vertex, |p| p.vertex).is_err(),
            }
        };
        let heirs = order.into_iter().zip(shares).map(heir).collect();
        (heirs, ranges)
    }
}
