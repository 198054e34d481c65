//! SIMD blocks of constraints: gather, compute per lane, scatter.

/// Lanes of a block. The compiler vectorizes loops over them, and a block fits in the L1 cache.
pub(crate) const BLOCK: usize = 32;

/// One number per lane.
pub(crate) type Lanes<const B: usize> = [f32; B];

/// Returns the vector from `a` to `b`: `(x_b - x_a) + (d_b - d_a)` \[m\].
#[inline(always)]
pub(crate) fn difference(xa: [f32; 4], da: [f32; 4], xb: [f32; 4], db: [f32; 4]) -> [f32; 4] {
    [
        (xb[0] - xa[0]) + (db[0] - da[0]),
        (xb[1] - xa[1]) + (db[1] - da[1]),
        (xb[2] - xa[2]) + (db[2] - da[2]),
        0.0,
    ]
}
