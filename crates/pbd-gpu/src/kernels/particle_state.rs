//! Positions and displacements of particles during a frame, one aligned record each.
//!
//! Constraints read the position and the displacement of every vertex. A record holds both in one
//! cache line, and kernels load it with two vector instructions.

use bytemuck::{Pod, Zeroable};
use std::cell::Cell;

/// Position, inverse mass and displacement of a particle.
#[derive(Debug, Clone, Copy, Default, PartialEq, Pod, Zeroable)]
#[repr(C, align(32))]
pub(crate) struct ParticleState {
    /// Position at the start of the substep \[m\] and inverse mass [1/kg].
    pub(crate) x: [f32; 4],
    /// Displacement since the start of the substep \[m\], last component 0.
    pub(crate) d: [f32; 4],
}

impl ParticleState {
    /// Returns the state at the start of the substep.
    #[inline(always)]
    pub(crate) fn at_start(self) -> Self {
        Self {
            x: self.x,
            d: [0.0; 4],
        }
    }

    /// Returns the vector to another particle \[m\]; its fourth component has no meaning.
    #[inline(always)]
    pub(crate) fn vector_to(self, to: Self) -> [f32; 4] {
        lanes(|k| (to.x[k] - self.x[k]) + (to.d[k] - self.d[k]))
    }
}

/// Returns a vector of four components, which fits a register.
///
/// Compilers vectorize arrays of four more often than those of three.
#[inline(always)]
pub(crate) fn lanes(of: impl Fn(usize) -> f32) -> [f32; 4] {
    [of(0), of(1), of(2), of(3)]
}

/// The states of all particles, shape [vertex slots].
#[derive(Debug, Clone, Copy)]
pub(crate) struct ParticleStates<'a>(pub(crate) &'a [Cell<ParticleState>]);

impl<'a> ParticleStates<'a> {
    /// Borrows states for kernels.
    pub(crate) fn new(states: &'a mut [ParticleState]) -> Self {
        Self(Cell::from_mut(states).as_slice_of_cells())
    }

    /// Returns the state of every particle, in the order of vertices.
    #[inline(always)]
    pub(crate) fn iter(self) -> std::slice::Iter<'a, Cell<ParticleState>> {
        self.0.iter()
    }

    /// Returns the states of `count` particles from `first` on.
    #[inline(always)]
    pub(crate) fn slice(self, first: usize, count: usize) -> Self {
        Self(&self.0[first..first + count])
    }

    #[inline(always)]
    pub(crate) fn get(self, i: usize) -> ParticleState {
        self.0[i].get()
    }

    #[inline(always)]
    pub(crate) fn set(self, i: usize, state: ParticleState) {
        self.0[i].set(state);
    }

    /// Sets the displacement of a particle.
    #[inline(always)]
    pub(crate) fn set_d(self, i: usize, d: [f32; 4]) {
        let state = &self.0[i];
        state.set(ParticleState { d, ..state.get() });
    }

    /// Adds to the displacement of a particle.
    #[inline(always)]
    pub(crate) fn add_d(self, i: usize, change: [f32; 4]) {
        let cell = &self.0[i];
        let mut state = cell.get();
        for (d, change) in state.d.iter_mut().zip(change) {
            *d += change;
        }
        cell.set(state);
    }
}

/// Runs a kernel on separate arrays of positions and displacements.
#[cfg(test)]
pub(crate) fn on_arrays<R>(
    x: &[[f32; 4]],
    d: &mut [[f32; 4]],
    kernel: impl FnOnce(ParticleStates<'_>) -> R,
) -> R {
    let pairs = x.iter().zip(d.iter());
    let mut states: Vec<_> = pairs.map(|(&x, &d)| ParticleState { x, d }).collect();
    let result = kernel(ParticleStates::new(&mut states));
    for (d, state) in d.iter_mut().zip(states) {
        *d = state.d;
    }
    result
}
