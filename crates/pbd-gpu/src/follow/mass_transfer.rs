//! Transfers the mass and momentum of deleted vertices to surviving and new ones.
//!
//! The corners of removed and added triangles of one piece form a pool. Its mass is that of its
//! surviving vertices plus that of adjacent deleted ones; its vertices share it by rest area. Pools
//! of the same piece before the edit have one parent. Within a parent shares are tilted to keep the
//! center of mass, and a rigid motion is added to keep momentum and angular momentum, see
//! [`momentum`](crate::follow::momentum).

use crate::follow::affected::Affected;
use crate::follow::momentum::{Momentum, Recipient, keep_center, keep_momentum};
use crate::follow::undo_state::UndoStack;
use crate::mass::shares_of;
use crate::particles::Particles;
use incise_mesh::{Surface, TopologyDelta, Vec3, VertexId};
use std::ops::Range;

/// No pool.
const NONE: u32 = u32::MAX;

/// Scope within which affected vertices share mass.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Sharing {
    /// Each piece by itself.
    Piece,
    /// Pieces of one parent, because a piece has new vertices only.
    Parent,
    /// All, because such a piece has no parent.
    All,
}

/// A group of affected vertices that share mass, ordered by parent, then by piece.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Pool {
    parent: u32,
    piece: u32,
}

/// Memory of the transfer, reused from edit to edit.
#[derive(Debug, Default)]
pub(crate) struct MassTransfer {
    pub(crate) affected: Affected,
    pools: Pools,
}

impl MassTransfer {
    /// Allocates memory for a body of `slots` vertices and for more `vertices`.
    pub(crate) fn reserve(&mut self, slots: usize, vertices: usize) {
        self.affected.reserve(slots, vertices);
    }

    /// Transfers mass, momentum and angular momentum after an edit.
    ///
    /// Velocities of new vertices must be interpolated; masses must be those before the edit.
    /// O(k log p) for k changed triangles of p pieces. Returns whether the edit was an undo that
    /// could not be restored bit for bit.
    pub(crate) fn run(
        &mut self,
        particles: &mut Particles,
        undo: &mut UndoStack,
        surface: &Surface,
        delta: &TopologyDelta,
    ) -> bool {
        let Self { affected, pools } = self;
        affected.find(particles, surface, delta);
        let is_undo = !delta.removed_positions.is_empty();
        if !is_undo {
            undo.record_before(particles, surface, delta, affected);
        }
        let is_restored = is_undo && undo.restore(particles, surface, delta, affected);
        if !is_restored {
            for sharing in [Sharing::Piece, Sharing::Parent, Sharing::All] {
                pools.divide(affected, delta, sharing);
                if sharing == Sharing::All || pools.sums.iter().all(|sum| sum.mass > 0.0) {
                    pools.distribute(affected, particles, surface);
                    break;
                }
            }
        }
        for v in affected.deleted() {
            particles.mass[v.index()] = 0.0;
            particles.velocities[v.index()] = [0.0; 4];
            particles.corrections[v.index()] = [0.0; 4];
        }
        if !is_undo {
            undo.record_after(particles, surface, delta, affected);
        }
        is_undo && !is_restored
    }
}

/// The pools of an edit.
#[derive(Debug, Default)]
struct Pools {
    /// New pieces with the pieces that they were part of, ascending.
    parents: Vec<(u32, u32)>,
    /// Ascending.
    pools: Vec<Pool>,
    /// Pool of every affected vertex; [`NONE`] for a deleted one without a neighbor.
    pool_of: Vec<u32>,
    /// Sums of the vertices of every pool before the edit, shape \[pools\].
    sums: Vec<Momentum>,
    /// Created and surviving vertices, ordered by pool.
    recipients: Vec<Recipient>,
    /// Recipients of every pool, shape \[pools\].
    ranges: Vec<Range<usize>>,
    /// Share of every recipient in the mass of its pool, shape \[recipients\].
    shares: Vec<f64>,
}

impl Pools {
    /// Finds the pools, the pool of every vertex, and the sums of every pool.
    fn divide(&mut self, affected: &Affected, delta: &TopologyDelta, sharing: Sharing) {
        self.find_pools(affected, delta, sharing);
        self.sums.clear();
        self.sums.resize(self.pools.len(), Momentum::default());
        let mut isolated: Option<Momentum> = None;
        let pools = &self.pool_of[affected.new_count..];
        for (momentum, &pool) in affected.momenta.iter().zip(pools) {
            let sum = self.sums.get_mut(pool as usize);
            let sum = sum.unwrap_or_else(|| isolated.get_or_insert_default());
            sum.add(momentum, 1.0);
        }
        if let Some(isolated) = isolated {
            let fractions = self.fractions_of_isolated(affected);
            for (sum, fraction) in self.sums.iter_mut().zip(fractions) {
                sum.add(&isolated, fraction);
            }
        }
    }

    fn find_pools(&mut self, affected: &Affected, delta: &TopologyDelta, sharing: Sharing) {
        let parents = &mut self.parents;
        parents.clear();
        parents.extend(&delta.pieces_added);
        parents.sort_unstable();
        let pool = |piece: u32| {
            let parent = parents.binary_search_by_key(&piece, |entry| entry.0);
            let parent = parent.map_or(piece, |i| parents[i].1);
            match sharing {
                Sharing::Piece => Pool { parent, piece },
                Sharing::Parent => Pool {
                    parent,
                    piece: parent,
                },
                Sharing::All => Pool {
                    parent: 0,
                    piece: 0,
                },
            }
        };
        let pools = &mut self.pools;
        pools.clear();
        let existing = &affected.pieces[..affected.surviving_count];
        // Vertices of one piece are mostly adjacent, or alternate on the two sides of a cut.
        let mut recent = [NONE; 2];
        for &piece in existing {
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
        let isolated = if sharing == Sharing::All { 0 } else { NONE };
        let mut recent = [(NONE, isolated); 2];
        self.pool_of.extend(affected.pieces.iter().map(|&piece| {
            let known = recent.iter().find(|entry| entry.0 == piece);
            if let Some(&(_, pool)) = known {
                return pool;
            }
            let pool = number(piece);
            recent = [recent[1], (piece, pool)];
            pool
        }));
    }

    /// Returns the fraction of every pool in the sums of deleted vertices without a neighbor.
    ///
    /// Pools share them by the rest area of their new vertices.
    fn fractions_of_isolated(&self, affected: &Affected) -> Vec<f64> {
        let mut areas = vec![0.0; self.pools.len()];
        let recipients = match affected.new_count {
            0 => 0..affected.surviving_count,
            new_count => 0..new_count,
        };
        for n in recipients {
            areas[self.pool_of[n] as usize] += affected.areas[n];
        }
        let sum: f64 = areas.iter().sum();
        let even = 1.0 / areas.len() as f64;
        let fraction = |area: f64| if sum > 0.0 { area / sum } else { even };
        areas.into_iter().map(fraction).collect()
    }

    #[expect(
        clippy::cast_possible_truncation,
        reason = "a computed mass is rounded once to storage"
    )]
    fn distribute(&mut self, affected: &Affected, particles: &mut Particles, surface: &Surface) {
        self.list_recipients(affected, particles, surface);
        let mut first = 0;
        for siblings in self.pools.chunk_by(|a, b| a.parent == b.parent) {
            let pools = first..first + siblings.len();
            first = pools.end;
            let mut before = Momentum::default();
            for sum in &self.sums[pools.clone()] {
                before.add(sum, 1.0);
            }
            let members = self.ranges[pools.start].start..self.ranges[pools.end - 1].end;
            let recipients = &mut self.recipients[members];
            keep_center(recipients, before.first_moment);
            for recipient in &mut *recipients {
                let mass = &mut particles.mass[recipient.vertex.index()];
                *mass = recipient.mass as f32;
                recipient.mass = f64::from(*mass);
            }
            keep_momentum(recipients, &mut particles.velocities, &before);
        }
    }

    /// Lists the created and surviving vertices by pool, with masses by rest area.
    fn list_recipients(&mut self, affected: &Affected, particles: &Particles, surface: &Surface) {
        let pool_of = &self.pool_of[..affected.surviving_count];
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
        let unset = Recipient {
            vertex: VertexId::NULL,
            position: Vec3::zeros(),
            mass: 0.0,
            is_free: false,
        };
        self.recipients.resize(end, unset);
        self.shares.resize(end, 0.0);
        let origin = affected.origin(surface);
        let existing = affected.vertices.iter().zip(&affected.areas);
        for ((&vertex, &area), &pool) in existing.zip(pool_of) {
            let range = &mut ranges[pool as usize];
            self.shares[range.end] = area;
            self.recipients[range.end] = Recipient {
                vertex,
                position: surface.position(vertex) - origin,
                mass: 0.0,
                is_free: particles.find_pin(vertex).is_err(),
            };
            range.end += 1;
        }
        for (range, sum) in ranges.iter().zip(&self.sums) {
            let shares = &mut self.shares[range.clone()];
            shares_of(shares);
            for (recipient, share) in self.recipients[range.clone()].iter_mut().zip(shares) {
                recipient.mass = *share * sum.mass;
            }
        }
    }
}
