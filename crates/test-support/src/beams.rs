//! Closed forms of beams under their own weight.

/// Returns the sag of the end of a cantilever \[m\]: an elastic line of any deflection, and the
/// shear of Timoshenko's beam.
///
/// `weight` is that of a meter \[N/m\], `bending` the stiffness `E I` \[N m²\], `shear` the
/// stiffness `k G A` \[N\].
#[must_use]
pub fn cantilever_sag(length: f64, weight: f64, bending: f64, shear: f64) -> f64 {
    const STEPS: u32 = 4000;
    let step = length / f64::from(STEPS);
    // The curvature at the clamp by bisection: that of the free end is zero.
    let shoot = |clamp: f64| {
        let (mut angle, mut curvature, mut sag) = (0.0_f64, clamp, 0.0);
        for i in 0..STEPS {
            let rest = length - (f64::from(i) + 0.5) * step;
            let middle = angle + 0.5 * step * curvature;
            let change = -(weight / bending) * rest * middle.cos();
            sag += step * middle.sin();
            angle += step * (curvature + 0.5 * step * change);
            curvature += step * change;
        }
        (curvature, sag)
    };
    let (mut low, mut high) = (0.0, weight * length * length / bending);
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if shoot(middle).0 > 0.0 {
            high = middle;
        } else {
            low = middle;
        }
    }
    shoot(0.5 * (low + high)).1 + weight * length * length / (2.0 * shear)
}
