// WGSL counterpart of `arctangent.rs`.

const PI: f32 = 3.14159265358979;
const TAU: f32 = 6.28318530717959;
const HALF_PI: f32 = 1.57079632679490;

const COEFFICIENTS = array<f32, 8>(
    0.99999934,
    -0.3332986,
    0.19946566,
    -0.1390863,
    0.09642197,
    -0.05591233,
    0.02186296,
    -0.0040545675,
);

// Returns the angle of the point (x, y) [rad], -pi to pi, and 0 at the origin.
fn arctangent2(y: f32, x: f32) -> f32 {
    let ax = abs(x);
    let ay = abs(y);
    let steep = ay > ax;
    let small = select(ay, ax, steep);
    let large = select(ax, ay, steep);
    let t = select(0.0, small / large, large > 0.0);
    let s = t * t;
    var p = COEFFICIENTS[7] * s + COEFFICIENTS[6];
    p = p * s + COEFFICIENTS[5];
    p = p * s + COEFFICIENTS[4];
    p = p * s + COEFFICIENTS[3];
    p = p * s + COEFFICIENTS[2];
    p = p * s + COEFFICIENTS[1];
    p = p * s + COEFFICIENTS[0];
    p *= t;
    p = select(p, HALF_PI - p, steep);
    p = select(p, PI - p, x < 0.0);
    return select(p, -p, y < 0.0);
}
