//! Number of rounds of contacts and volumes per iteration, which is higher where heavy pieces press
//! thin ones.
//!
//! A piece stops another one by its volume. In a round contacts press pieces together, and volumes
//! push them apart again. The lighter piece takes almost all of both, so that a round passes on a
//! part of the impulse that is proportional to its mass. A thin piece between heavy ones would be
//! flat, or turned inside out, before they have stopped. More substeps would help as much, but
//! constraints are stiffer in shorter substeps, and what they correct at once throws pieces.
//!
//! Rounds accelerate each other, see [`Round`](crate::kernels::volume::Round). Where a piece is
//! heavy, their number grows with the root of that of plain rounds.

use crate::constraints::contacts::LoadRatio;
use crate::step::substeps::fall;

/// Maximum approach of two pieces per substep and round, relative to the thickness of the pressed
/// one and their masses.
const MAX_APPROACH: f64 = 0.1;

/// Maximum number of rounds by the approach.
const MAX_FOR_APPROACH: f64 = 8.0;

/// Maximum free fall per substep and plain round [thickness / mass ratio].
const MAX_FALL: f64 = 0.0003;

/// Number of accelerated rounds, relative to the root of the number of plain ones.
const ACCELERATED: f64 = 3.0;

/// Maximum number of rounds.
const MAX_ROUNDS: f64 = 24.0;

/// Returns the number of rounds of an iteration in substeps of `h` \[s\], with gravity [m/s^2].
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the number of rounds is a whole number between 1 and its maximum"
)]
pub(crate) fn contact_rounds(h: f32, press: LoadRatio, gravity: [f32; 3]) -> u32 {
    let h = f64::from(h);
    let fall = fall(h, gravity) * f64::from(press.load);
    let approach = h * f64::from(press.closing);
    let plain = fall / MAX_FALL;
    let for_fall = plain.min(ACCELERATED * plain.sqrt());
    let for_approach = (approach / MAX_APPROACH).min(MAX_FOR_APPROACH);
    let rounds = f64::max(for_fall, for_approach);
    rounds.ceil().clamp(1.0, MAX_ROUNDS) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thin_and_light_pieces_have_more_rounds() {
        let of = |load, closing| contact_rounds(0.1, LoadRatio { load, closing }, [0.0, -6.0, 8.0]);
        let closing = [0.0, 0.9, 1.1, 2.9, 3.1, 1e30].map(|closing| of(0.0, closing));
        assert_eq!(closing, [1, 1, 2, 3, 4, 8], "a tenth of the thickness");
        let load = [0.002, 0.004, 0.007].map(|load| of(load, 0.0));
        assert_eq!(load, [1, 2, 3], "a fall of 0.1 m by 0.0003");
        let load = [0.0269, 0.0479, 0.191, 1e30].map(|load| of(load, 0.0));
        assert_eq!(load, [9, 12, 24, 24], "three times the root");
        assert_eq!(of(0.004, 3.1), 4);
    }
}
