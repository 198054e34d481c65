//! Number of iterations of a frame, which is higher in violent impacts.
//!
//! A piece stops another one by its volume: an iteration passes on a part of the impulse. A thin
//! piece that moves by much of its thickness in a substep would be flat, or turned inside out,
//! before the other one has stopped. More substeps would help as much, but constraints are stiffer
//! in shorter substeps, and what they correct at once throws pieces.

/// Maximum approach of two pieces per substep, relative to the thickness of the thinner one.
const MAX_APPROACH: f64 = 0.1;

/// Maximum factor of the number of iterations.
const MAX_FACTOR: f64 = 4.0;

/// Returns the number of iterations of substeps of `h` \[s\], at least the given one.
///
/// `closing` is the largest [closing speed](crate::Contact::closing) of contacts [1/s].
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the factor is a whole number between 1 and its maximum"
)]
pub(crate) fn impact_iterations(iterations: u32, h: f32, closing: f32) -> u32 {
    let approach = f64::from(closing) * f64::from(h);
    let factor = (approach / MAX_APPROACH).ceil().clamp(1.0, MAX_FACTOR);
    iterations.saturating_mul(factor as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn impacts_have_up_to_four_times_as_many_iterations() {
        let of = |closing| impact_iterations(10, 0.05, closing);
        assert_eq!([0.0, 1.9].map(of), [10; 2], "a tenth of the thickness");
        assert_eq!([2.1, 3.9, 4.1, 1e30].map(of), [20, 20, 30, 40]);
        assert_eq!(impact_iterations(u32::MAX, 0.05, f32::MAX), u32::MAX);
    }
}
