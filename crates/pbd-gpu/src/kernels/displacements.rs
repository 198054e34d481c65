//! The displacements of a substep, as kernels reach them.
//!
//! They are stored as atomic numbers for one reason: the constraints of one color share no vertex, so
//! threads may write them at once, and this is how safe Rust says so. Loads and stores are relaxed, and
//! plain ones where a single thread holds the array.

use std::sync::atomic::{AtomicU32, Ordering};

/// The displacement of one vertex \[m\], last entry unused.
pub(crate) type Cell = [AtomicU32; 4];

/// Displacements by vertex number \[m\].
pub(crate) trait Displacements {
    fn get(&mut self, i: usize) -> [f32; 4];
    fn set(&mut self, i: usize, to: [f32; 4]);
}

/// Displacements held by one thread.
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

/// Displacements that several threads write, no two of them the same vertex.
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
