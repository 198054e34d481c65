//! Moves pinned vertices toward their targets.

use super::displacements::Displacements;
use crate::particles::Pin;

/// Moves every pinned vertex so that it reaches its target with the last of `substeps_left`.
#[inline(always)]
pub(crate) fn pins(x: &[[f32; 4]], d: &mut impl Displacements, pins: &[Pin], substeps_left: u32) {
    let share = 1.0 / substeps_left as f32;
    for pin in pins {
        let i = pin.vertex.index();
        let way = |k: usize| (pin.target[k] - x[i][k]) * share;
        d.set(i, [way(0), way(1), way(2), 0.0]);
    }
}
