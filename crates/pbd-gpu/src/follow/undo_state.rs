//! Masses, positions and velocities before an edit, which an undo restores bit for bit.
//!
//! The transfer of mass preserves sums, but only to rounding. An undo that transferred mass again
//! would leave other masses than before the edit, and the same cut would then differ.

use crate::follow::affected::Affected;
use crate::particles::Particles;
use incise_mesh::{Surface, TopologyDelta, VertexId};

/// Maximum depth of the undo stack.
const MAX_DEPTH: usize = 64;

/// Bits of mass \[kg\], velocity [m/s] and last correction \[m\] of a vertex.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct VertexState {
    vertex: VertexId,
    mass: u32,
    velocity: [u32; 4],
    correction: [u32; 4],
}

/// The affected vertices of an edit before and after it.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct UndoState {
    before: Vec<VertexState>,
    after: Vec<VertexId>,
    /// Their state directly after the edit.
    state_after: Fingerprint,
}

/// A hash of positions, masses and velocities of vertices, in any order.
///
/// It replaces copies: equal hashes of 64 bits mean equal states, as in the surface's history.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Fingerprint(u64);

/// States of the last edits, newest last, as long as no vertex has moved since.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct UndoStack(Vec<UndoState>);

impl UndoStack {
    /// Returns whether all vertices are slots of the body and all states are finite.
    #[cfg(feature = "serde")]
    pub(crate) fn is_valid(&self, is_slot: impl Fn(VertexId) -> bool) -> bool {
        let is_finite = |bits: u32| f32::from_bits(bits).is_finite();
        let is_state = |state: &VertexState| {
            is_slot(state.vertex)
                && is_finite(state.mass)
                && f32::from_bits(state.mass) >= 0.0
                && (state.velocity.iter().chain(&state.correction)).all(|&bits| is_finite(bits))
        };
        self.0.len() <= MAX_DEPTH && (self.0.iter()).all(|state| state.before.iter().all(is_state))
    }

    /// Returns the allocated size in elements.
    pub(crate) fn capacity(&self) -> usize {
        let state = |state: &UndoState| state.before.capacity() + state.after.capacity();
        self.0.iter().map(state).sum()
    }

    /// Records the affected vertices before an edit.
    pub(crate) fn record_before(
        &mut self,
        particles: &Particles,
        surface: &Surface,
        delta: &TopologyDelta,
        affected: &Affected,
    ) {
        if let Some(last) = self.0.last()
            && last.state_after != Fingerprint::new(particles, surface, delta, &last.after)
        {
            self.0.clear();
        }
        let before = affected.existing_before().iter();
        let before = before.filter_map(|&vertex| {
            Some(VertexState {
                vertex,
                mass: particles.mass.get(vertex.index())?.to_bits(),
                velocity: particles.velocities.get(vertex.index())?.map(f32::to_bits),
                correction: particles.corrections.get(vertex.index())?.map(f32::to_bits),
            })
        });
        let before = before.collect();
        if self.0.len() == MAX_DEPTH {
            self.0.remove(0);
        }
        self.0.push(UndoState {
            before,
            ..UndoState::default()
        });
    }

    /// Records the affected vertices after the edit.
    pub(crate) fn record_after(
        &mut self,
        particles: &Particles,
        surface: &Surface,
        delta: &TopologyDelta,
        affected: &Affected,
    ) {
        if let Some(last) = self.0.last_mut() {
            last.after = affected.existing_after().to_vec();
            last.state_after = Fingerprint::new(particles, surface, delta, &last.after);
        }
    }

    /// Restores the state before the last edit if `delta` undoes it and nothing has changed since.
    ///
    /// Returns true if it did.
    pub(crate) fn restore(
        &mut self,
        particles: &mut Particles,
        surface: &Surface,
        delta: &TopologyDelta,
        affected: &Affected,
    ) -> bool {
        let existing = affected.existing_before();
        let now = Fingerprint::new(particles, surface, delta, existing);
        let Some(last) = self.0.pop() else {
            return false;
        };
        let restored = last.before.iter().map(|state| state.vertex);
        let slots = surface.positions().len().min(particles.len());
        if now != last.state_after
            || restored.clone().any(|v| v.index() >= slots)
            || existing.len() != last.after.len()
            || !are_same(restored, affected.existing_after())
        {
            self.0.clear();
            return false;
        }
        for state in last.before {
            let v = state.vertex;
            particles.mass[v.index()] = f32::from_bits(state.mass);
            particles.velocities[v.index()] = state.velocity.map(f32::from_bits);
            particles.corrections[v.index()] = state.correction.map(f32::from_bits);
        }
        true
    }
}

/// Returns true if two lists have the same vertices in any order.
fn are_same(vertices: impl ExactSizeIterator<Item = VertexId>, others: &[VertexId]) -> bool {
    let sum = |sum: u64, v: VertexId| sum.wrapping_add(mixed(0, v.0, 0));
    vertices.len() == others.len() && vertices.fold(0, sum) == others.iter().copied().fold(0, sum)
}

impl Fingerprint {
    /// Returns the hash of the present state of distinct `vertices`.
    fn new(
        particles: &Particles,
        surface: &Surface,
        delta: &TopologyDelta,
        vertices: &[VertexId],
    ) -> Self {
        let hash = |v: &VertexId| {
            let current = surface.positions().get(v.index());
            let current = current.map(|&[x, y, z, _]| [x, y, z]);
            let [x, y, z] = delta.removed_position(*v).or(current)?.map(f32::to_bits);
            let mass = particles.mass.get(v.index())?.to_bits();
            let velocity = particles.velocities.get(v.index())?;
            let [vx, vy, vz, _] = velocity.map(f32::to_bits);
            let pairs = [(v.0, mass), (x, y), (z, vx), (vy, vz)];
            Some(pairs.into_iter().fold(0, |hash, (a, b)| mixed(hash, a, b)))
        };
        let sum = |sum: u64, hash: u64| sum.wrapping_add(hash);
        Self(vertices.iter().filter_map(hash).fold(0, sum))
    }
}

/// Mixes two numbers into a hash, with the factors of `SplitMix64`.
fn mixed(hash: u64, a: u32, b: u32) -> u64 {
    let word = (u64::from(a) << 32) | u64::from(b);
    let x = (hash ^ word)
        .wrapping_add(0x9e37_79b9_7f4a_7c15)
        .wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 29)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 32)
}
