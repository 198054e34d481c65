//! Pinned vertices follow their targets.

use crate::plan::Pin;

/// Moves every pinned vertex by its share of the way: it arrives with the last of `substeps_left`.
#[inline(always)]
pub(crate) fn pins(x: &[[f32; 4]], d: &mut [[f32; 4]], pins: &[Pin], substeps_left: u32) {
    let share = 1.0 / substeps_left as f32;
    for pin in pins {
        let i = pin.vertex.index();
        for k in 0..3 {
            d[i][k] = (pin.target[k] - x[i][k]) * share;
        }
    }
}
