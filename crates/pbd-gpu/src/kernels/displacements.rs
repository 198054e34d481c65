//! Displacements of a substep, for one thread or for several.
//!
//! They are stored as atomics because the constraints of a color share no vertex: threads write
//! them concurrently without conflicts, which safe Rust expresses with relaxed loads and stores.
//! With a single thread the accesses are plain.

use std::sync::atomic::{AtomicU32, Ordering};

/// Displacement of one vertex \[m\], last component unused.
pub(crate) type Cell = [AtomicU32; 4];

/// Displacements by vertex number \[m\].
pub(crate) trait Displacements {
    fn get(&mut self, i: usize) -> [f32; 4];
    fn set(&mut self, i: usize, to: [f32; 4]);
}

/// Displacements of a single thread.
#[derive(Debug)]
pub(crate) struct Exclusive<'a>(pub(crate) &'a mut [Cell]);

impl Displacements for Exclusive<'_> {
    #[inline(always)]
    fn get(&mut self, i: usize) -> [f32; 4] {
        self.0[i].each_mut().map(|c| f32::from_bits(*c.get_mut()))
    }

    #[inline(always)]
    fn set(&mut self, i: usize, to: [f32; 4]) {
        for (c, to) in self.0[i].iter_mut().zip(to) {
            *c.get_mut() = to.to_bits();
        }
    }
}

/// Displacements that several threads write, each vertex by one thread only.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shared<'a>(pub(crate) &'a [Cell]);

impl Displacements for Shared<'_> {
    #[inline(always)]
    fn get(&mut self, i: usize) -> [f32; 4] {
        self.0[i]
            .each_ref()
            .map(|c| f32::from_bits(c.load(Ordering::Relaxed)))
    }

    #[inline(always)]
    fn set(&mut self, i: usize, to: [f32; 4]) {
        for (c, to) in self.0[i].iter().zip(to) {
            c.store(to.to_bits(), Ordering::Relaxed);
        }
    }
}

/// Plain arrays, for tests of single kernels.
#[cfg(test)]
impl<T: AsMut<[[f32; 4]]>> Displacements for T {
    fn get(&mut self, i: usize) -> [f32; 4] {
        self.as_mut()[i]
    }

    fn set(&mut self, i: usize, to: [f32; 4]) {
        self.as_mut()[i] = to;
    }
}
