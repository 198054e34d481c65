// WGSL counterpart of `arctangent.rs`.

// Returns the angle of the point (x, y) [rad], -pi to pi, and 0 at the origin.
fn arctangent2(y: f32, x: f32) -> f32 {
    let ax = abs(x);
    let ay = abs(y);
    let steep = ay > ax;
    let small = select(ay, ax, steep);
    let large = select(ax, ay, steep);
    let t = select(0.0, small / large, large > 0.0);
    let s = t * t;
    let s2 = s * s;
    let first = COEFFICIENTS[0] + COEFFICIENTS[1] * s;
    let second = COEFFICIENTS[2] + COEFFICIENTS[3] * s;
    let third = COEFFICIENTS[4] + COEFFICIENTS[5] * s;
    let fourth = COEFFICIENTS[6] + COEFFICIENTS[7] * s;
    let low = first + second * s2;
    let high = third + fourth * s2;
    var p = (low + high * (s2 * s2)) * t;
    p = select(p, HALF_PI - p, steep);
    p = select(p, PI - p, x < 0.0);
    return select(p, -p, y < 0.0);
}
