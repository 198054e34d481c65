// Twin of predict.rs. The velocity stays in registers: integrate() makes the next one of the
// displacement alone.

// Predicts a vertex. Returns its height as ordered bits, those of infinity if it cannot move or has none.
fn predict_vertex(i: u32, kept_velocity: f32) -> u32 {
    let x = load_x(i);
    let movable = x.w > 0.0;
    let kept = kept_velocity * select(0.0, 1.0, movable);
    let v = (velocities[first_vertex + i].xyz + frame.gravity_step) * kept;
    let d = v * frame.h;
    store_d(i, d);
    let height = x.y + d.y;
    return select(ORDERED_INFINITY, ordered(height), movable && is_number(height));
}
