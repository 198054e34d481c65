//! What vertices had before an edit shared it out, so that an undo at once gives it back to the bit.
//!
//! Sharing out keeps sums, and those to rounding. Were an undo to share out, too, where nothing has moved since the edit, the masses
//! after it would not be those before, and the same cut done again would not be the same.

use crate::concerned::Concerned;
use crate::solver::{Solver, inverse};
use incise_mesh::{Surface, TopologyDelta, VertexId};

/// So many edits can be taken back to the bit, one after another. Memory is what they cost.
const MOST: usize = 64;

/// What a vertex has, as bits: where it is \[m\], its mass \[kg\] and how fast it is [m/s].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Holding {
    vertex: VertexId,
    place: [u32; 3],
    mass: u32,
    velocity: [u32; 4],
}

/// What the vertices concerned by an edit had before it and after it, each ascending by vertex.
#[derive(Debug, Clone, Default)]
pub(crate) struct Keepsake {
    before: Vec<Holding>,
    after: Vec<Holding>,
}

impl Keepsake {
    pub(crate) fn capacity(&self) -> usize {
        self.before.capacity() + self.after.capacity()
    }
}

impl Solver {
    /// Notes what those have that an edit concerns and that were there before it.
    pub(crate) fn keep(&mut self, surface: &Surface, delta: &TopologyDelta, concerned: &Concerned) {
        let last = self.keepsakes.last();
        // Where anything has moved since the last edit, there is no way back to the bit from here on.
        let is_now = |h: &Holding| self.holding(surface, delta, h.vertex) == Some(*h);
        if last.is_some_and(|last| !last.after.iter().all(is_now)) {
            self.keepsakes.clear();
        }
        let before = self.holdings(surface, delta, &concerned.vertices[concerned.came..]);
        let after = Vec::new();
        if self.keepsakes.len() == MOST {
            self.keepsakes.remove(0);
        }
        self.keepsakes.push(Keepsake { before, after });
    }

    /// Notes what those have after it that are there.
    pub(crate) fn keep_after(
        &mut self,
        surface: &Surface,
        delta: &TopologyDelta,
        concerned: &Concerned,
    ) {
        let after = self.holdings(surface, delta, &concerned.vertices[..concerned.stay]);
        if let Some(last) = self.keepsakes.last_mut() {
            last.after = after;
        }
    }

    /// Gives everybody back what they had before the last edit, if this undoes it and nothing has happened since. Says
    /// whether it did.
    pub(crate) fn give_back(
        &mut self,
        surface: &mut Surface,
        delta: &TopologyDelta,
        concerned: &Concerned,
    ) -> bool {
        let now = self.holdings(surface, delta, &concerned.vertices[concerned.came..]);
        let mut there = concerned.vertices[..concerned.stay].to_vec();
        there.sort_unstable();
        let Some(Keepsake { before, after }) = self.keepsakes.pop() else {
            return false;
        };
        let is_same = before.iter().map(|h| h.vertex).eq(there);
        if now != after || !is_same {
            self.keepsakes.clear();
            return false;
        }
        for Holding {
            vertex,
            mass,
            velocity,
            ..
        } in before
        {
            let mass = f32::from_bits(mass);
            let is_pinned = self.pins.binary_search_by_key(&vertex, |pin| pin.vertex);
            self.mass[vertex.index()] = mass;
            self.velocities[vertex.index()] = velocity.map(f32::from_bits);
            surface.positions[vertex.index()][3] = match is_pinned {
                Ok(_) => 0.0,
                Err(_) => inverse(mass),
            };
        }
        true
    }

    fn holdings(&self, surface: &Surface, delta: &TopologyDelta, of: &[VertexId]) -> Vec<Holding> {
        let holdings = of.iter().filter_map(|&v| self.holding(surface, delta, v));
        let mut holdings: Vec<Holding> = holdings.collect();
        holdings.sort_unstable_by_key(|h| h.vertex);
        holdings
    }

    fn holding(&self, surface: &Surface, delta: &TopologyDelta, v: VertexId) -> Option<Holding> {
        let known = surface
            .positions
            .get(v.index())
            .map(|&[x, y, z, _]| [x, y, z]);
        let place = delta.place_of_removed(v).or(known)?;
        Some(Holding {
            vertex: v,
            place: place.map(f32::to_bits),
            mass: self.mass.get(v.index())?.to_bits(),
            velocity: self.velocities.get(v.index())?.map(f32::to_bits),
        })
    }
}
