//! Constraints in blocks: gathered into lanes, computed lane by lane, scattered back.

/// Lanes of a block. The compiler turns loops over them into vector instructions; a block's lanes stay
/// in the first-level cache.
pub(crate) const BLOCK: usize = 32;

/// One number a lane.
pub(crate) type Lanes<const B: usize> = [f32; B];

/// Where `b` is as seen from `a`: `(x_b - x_a) + (d_b - d_a)` \[m\].
#[inline(always)]
pub(crate) fn difference(xa: [f32; 4], da: [f32; 4], xb: [f32; 4], db: [f32; 4]) -> [f32; 4] {
    [
        (xb[0] - xa[0]) + (db[0] - da[0]),
        (xb[1] - xa[1]) + (db[1] - da[1]),
        (xb[2] - xa[2]) + (db[2] - da[2]),
        0.0,
    ]
}
