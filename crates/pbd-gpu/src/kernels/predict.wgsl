// WGSL counterpart of `predict.rs`. The velocity is not stored, since integrate() computes the next
// one from the displacement alone.

fn predict_vertex(i: u32, velocity_factor: f32) {
    let kept = velocity_factor * select(0.0, 1.0, load_x(i).w > 0.0);
    let v = (velocities[first_vertex + i].xyz + frame.gravity_step) * kept;
    store_d(i, v * frame.h);
}
