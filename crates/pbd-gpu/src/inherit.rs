//! Who inherits the mass and momentum of what an edit took away.
//!
//! The corners of removed and added triangles of one piece form a pool. The pool's mass is what its
//! surviving members had, plus that of removed vertices next to it; its members share it by rest area.
//! Pools of what was one piece before the edit form a family. Shares are tilted so that the family's
//! center of mass stays where it is, and its members move as a rigid body on top of how they move, so
//! that its momentum and angular momentum are what they were. See [`crate::momentum`].

use crate::concerned::Concerned;
use crate::mass::shares_of;
use crate::momentum::{Carried, Heir, keep_center, keep_momentum};
use crate::solver::{Solver, inverse};
use incise_mesh::{Surface, TopologyDelta, Vec3, VertexId};
use std::ops::Range;

/// No pool.
const NONE: u32 = u32::MAX;

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

/// What sharing out needs, kept from edit to edit for its memory.
#[derive(Debug, Default)]
pub(crate) struct Heritage {
    pub(crate) concerned: Concerned,
    shares: Shares,
}

/// Shares out mass, momentum and angular momentum after an edit. Constraints and interpolated velocities
/// are those after it, masses those before. O(k) for k changed triangles, but for the pieces among them,
/// which are sorted.
pub(crate) fn settle(
    heritage: &mut Heritage,
    solver: &mut Solver,
    surface: &mut Surface,
    delta: &TopologyDelta,
) {
    let Heritage { concerned, shares } = heritage;
    let mut numbers = std::mem::take(&mut solver.numbers);
    numbers.resize(solver.mass.len(), crate::concerned::NONE);
    concerned.find(solver, surface, delta, &mut numbers);
    solver.numbers = numbers;
    let is_undo = !delta.removed_from.is_empty();
    if !is_undo {
        solver.keep(surface, delta, concerned);
    }
    if !(is_undo && solver.give_back(surface, delta, concerned)) {
        for sharing in [Sharing::Piece, Sharing::Family, Sharing::All] {
            shares.divide(concerned, delta, sharing);
            if sharing == Sharing::All || shares.masses.iter().all(|&mass| mass > 0.0) {
                shares.hand_over(concerned, solver, surface);
                break;
            }
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
    if !is_undo {
        solver.keep_after(surface, delta, concerned);
    }
}

/// Who shares with whom.
#[derive(Debug, Default)]
struct Shares {
    /// The pieces that an edit made, each with the one that it was part of, ascending.
    parents: Vec<(u32, u32)>,
    /// Ascending.
    pools: Vec<Pool>,
    /// The pool of every concerned vertex; [`NONE`] for one that went and left no neighbor.
    pool_of: Vec<u32>,
    /// What the vertices of every pool brought, shape \[pools\].
    estates: Vec<Carried>,
    /// The mass of every pool \[kg\], shape \[pools\].
    masses: Vec<f64>,
    /// The vertices that are there by pool, and where each pool is.
    heirs: Vec<Heir>,
    ranges: Vec<Range<usize>>,
    /// The share of every heir in the mass of its pool, shape \[heirs\].
    portions: Vec<f64>,
}

impl Shares {
    /// Finds pools, who is in which, and what they have.
    fn divide(&mut self, concerned: &Concerned, delta: &TopologyDelta, sharing: Sharing) {
        self.find_pools(concerned, delta, sharing);
        self.estates.clear();
        self.estates.resize(self.pools.len(), Carried::default());
        let mut orphaned: Option<Carried> = None;
        for (carried, &pool) in concerned
            .carried
            .iter()
            .zip(&self.pool_of[concerned.came..])
        {
            let estate = self.estates.get_mut(pool as usize);
            let estate = estate.unwrap_or_else(|| orphaned.get_or_insert_default());
            estate.add(carried, 1.0);
        }
        if let Some(orphaned) = orphaned {
            let shares = self.shares_of_orphaned(concerned);
            for (estate, share) in self.estates.iter_mut().zip(shares) {
                estate.add(&orphaned, share);
            }
        }
        self.masses.clear();
        self.masses.extend(self.estates.iter().map(|e| e.mass));
    }

    fn find_pools(&mut self, concerned: &Concerned, delta: &TopologyDelta, sharing: Sharing) {
        let parents = &mut self.parents;
        parents.clear();
        parents.extend(&delta.pieces_added);
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
        let pools = &mut self.pools;
        pools.clear();
        let there = &concerned.pieces[..concerned.stay];
        // Most of one piece stand together or, on the two lips of a cut, take turns with another.
        let mut recent = [NONE; 2];
        for &piece in there {
            if !recent.contains(&piece) {
                recent = [recent[1], piece];
                pools.push(pool(piece));
            }
        }
        pools.sort_unstable();
        pools.dedup();
        let number = |piece: u32| match pools.binary_search(&pool(piece)) {
            Ok(i) => u32::try_from(i).unwrap_or(NONE),
            Err(_) => NONE,
        };
        self.pool_of.clear();
        let stray = if sharing == Sharing::All { 0 } else { NONE };
        let mut recent = [(NONE, stray); 2];
        self.pool_of.extend(concerned.pieces.iter().map(|&piece| {
            let known = recent.iter().find(|entry| entry.0 == piece);
            if let Some(&(_, pool)) = known {
                return pool;
            }
            let pool = number(piece);
            recent = [recent[1], (piece, pool)];
            pool
        }));
    }

    /// What goes to each pool of that which vertices without a neighbor leave, by the area of new
    /// vertices.
    fn shares_of_orphaned(&self, concerned: &Concerned) -> Vec<f64> {
        let mut shares = vec![0.0; self.pools.len()];
        let heirs = match concerned.came {
            0 => 0..concerned.stay,
            came => 0..came,
        };
        for n in heirs {
            shares[self.pool_of[n] as usize] += concerned.areas[n];
        }
        let sum: f64 = shares.iter().sum();
        let even = 1.0 / shares.len() as f64;
        for share in &mut shares {
            *share = if sum > 0.0 { *share / sum } else { even };
        }
        shares
    }

    #[expect(
        clippy::cast_possible_truncation,
        reason = "a computed mass is rounded once to storage"
    )]
    fn hand_over(&mut self, concerned: &Concerned, solver: &mut Solver, surface: &mut Surface) {
        self.find_heirs(concerned, solver, surface);
        let mut first = 0;
        for family in self.pools.chunk_by(|a, b| a.family == b.family) {
            let pools = first..first + family.len();
            first = pools.end;
            let mut was = Carried::default();
            for estate in &self.estates[pools.clone()] {
                was.add(estate, 1.0);
            }
            let members = self.ranges[pools.start].start..self.ranges[pools.end - 1].end;
            let heirs = &mut self.heirs[members];
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

    /// Sorts the vertices that are there by pool and gives them their shares by area.
    fn find_heirs(&mut self, concerned: &Concerned, solver: &Solver, surface: &Surface) {
        let pool_of = &self.pool_of[..concerned.stay];
        let ranges = &mut self.ranges;
        ranges.clear();
        ranges.resize(self.pools.len(), 0..0);
        for &pool in pool_of {
            ranges[pool as usize].end += 1;
        }
        let mut end = 0;
        for range in &mut *ranges {
            let len = range.end;
            *range = end..end;
            end += len;
        }
        let nobody = Heir {
            vertex: VertexId::NULL,
            at: Vec3::zeros(),
            mass: 0.0,
            is_free: false,
        };
        self.heirs.resize(end, nobody);
        self.portions.resize(end, 0.0);
        let origin = concerned.origin(surface);
        let pins = &solver.pins;
        let there = concerned.vertices.iter().zip(&concerned.areas);
        for ((&vertex, &area), &pool) in there.zip(pool_of) {
            let range = &mut ranges[pool as usize];
            self.portions[range.end] = area;
            self.heirs[range.end] = Heir {
                vertex,
                at: surface.position(vertex) - origin,
                mass: 0.0,
                is_free: pins.binary_search_by_key(&vertex, |p| p.vertex).is_err(),
            };
            range.end += 1;
        }
        for (range, mass) in ranges.iter().zip(&self.masses) {
            let portions = &mut self.portions[range.clone()];
            shares_of(portions);
            for (heir, portion) in self.heirs[range.clone()].iter_mut().zip(portions) {
                heir.mass = *portion * mass;
            }
        }
    }
}
