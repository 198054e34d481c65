//! What the processor's memory can do: the bandwidth that frames are compared with.

use rayon::prelude::*;
use std::time::Instant;

/// Entries of each of the three arrays: 128 MiB, more than caches hold.
const ENTRIES: usize = 1 << 25;
/// Bytes that go to and from memory.
const BYTES: f64 = (3 * size_of::<f32>() * ENTRIES) as f64;
/// Entries that a thread takes at once.
const CHUNK: usize = 1 << 16;
/// Repetitions, of which the fastest counts.
const TIMES: usize = 5;

/// Bytes a second of `a = b + s c` over long arrays (the triad of the STREAM benchmark) with as many
/// threads as the solver has: two arrays read and one written, 12 bytes an entry.
pub(super) fn of_memory() -> f64 {
    // Threads touch first what they work on later.
    let filled = |value: f32| -> Vec<f32> { (0..ENTRIES).into_par_iter().map(|_| value).collect() };
    let (mut a, b, c) = (filled(0.0), filled(1.0), filled(2.0));
    let mut best = f64::INFINITY;
    for _ in 0..TIMES {
        let begin = Instant::now();
        triad(&mut a, &b, &c, 3.0);
        best = best.min(begin.elapsed().as_secs_f64());
        // Somebody may look: the work cannot be left out.
        std::hint::black_box(&mut a);
    }
    BYTES / best
}

fn triad(a: &mut [f32], b: &[f32], c: &[f32], factor: f32) {
    let parts = b.par_chunks(CHUNK).zip(c.par_chunks(CHUNK));
    a.par_chunks_mut(CHUNK).zip(parts).for_each(|(a, (b, c))| {
        for ((a, b), c) in a.iter_mut().zip(b).zip(c) {
            *a = b + factor * c;
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_triad_reaches_every_entry() {
        let count = 2 * CHUNK + 3;
        let b: Vec<f32> = (0..count).map(|i| (i % 1000) as f32).collect();
        let c: Vec<f32> = (0..count).map(|i| (i % 77) as f32).collect();
        let mut a = vec![-1.0; count];
        triad(&mut a, &b, &c, 3.0);
        assert!(
            a.iter()
                .zip(&b)
                .zip(&c)
                .all(|((a, b), c)| *a == b + 3.0 * c)
        );
    }
}
