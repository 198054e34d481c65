// WGSL counterpart of `predict.rs`. The velocity is not stored, since integrate() computes the next
// one from the displacement alone.

// Predicts a vertex. Returns its height as ordered bits, or infinity if it is pinned or NaN.
fn predict_vertex(i: u32, velocity_factor: f32) -> u32 {
    let x = load_x(i);
    let movable = x.w > 0.0;
    let kept = velocity_factor * select(0.0, 1.0, movable);
    let v = (velocities[first_vertex + i].xyz + frame.gravity_step) * kept;
    let d = v * frame.h;
    store_d(i, d);
    let height = x.y + d.y;
    return select(ORDERED_INFINITY, ordered(height), movable && is_number(height));
}
