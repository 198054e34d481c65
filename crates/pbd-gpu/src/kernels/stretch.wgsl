// WGSL counterpart of `stretch.rs`.

// Projects the constraint at an entry.
fn project_stretch(at: u32, by: Projection) {
    let ends = constraints[at];
    let numbers = bitcast<vec2f>(constraints[at + 1u]);
    let lambda = select(0.0, numbers.y, by.accumulates_lambda);
    let xa = load_x(ends.x);
    let xb = load_x(ends.y);
    let da = load_d(ends.x);
    let db = load_d(ends.y);
    let edge = difference(xa, da, xb, db);
    let length = norm(edge);
    let error = (length - numbers.x) + by.alpha * lambda;
    let diagonal = xa.w + xb.w;
    let sum = by.diagonal_scale * diagonal + by.alpha;
    let weight = select(sum, diagonal, diagonal > sum);
    // An edge of length zero has no direction; two pinned ends do not move.
    let divisor = length * weight;
    let scale = select(0.0, by.factor * error / divisor, divisor > 0.0);

    store_d(ends.x, da + (scale * xa.w) * edge);
    store_d(ends.y, db - (scale * xb.w) * edge);
    if (by.accumulates_lambda) {
        constraints[at + 1u].y = bitcast<u32>(lambda - scale * length);
    }
}
