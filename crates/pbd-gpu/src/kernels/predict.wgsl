// WGSL counterpart of `predict.rs`. The velocity is not stored, since integrate() computes the next
// one from the displacement alone.

// Returns the velocity of a particle after the gravity of a substep [m/s].
fn predicted_velocity(i: u32) -> vec3f {
    let free = select(0.0, 1.0, load_x(i).w > 0.0);
    return (motions[first_vertex + i].velocity.xyz + frame.gravity_step) * free;
}

fn predict_vertex(i: u32) {
    let at = first_vertex + i;
    let free = select(0.0, 1.0, load_x(i).w > 0.0);
    var d = predicted_velocity(i) * frame.h;
    if (frame.lift > 0.0) {
        let last = motions[at].correction.xyz;
        motions[at].correction = vec4f(-d, 0.0);
        d += (frame.lift * free) * last;
    } else if (substep_index == 0u) {
        motions[at].correction = vec4f();
    }
    store_d(i, d);
}

// Adds a displacement by constraints to that of the substep.
fn correct(i: u32, change: vec3f) {
    if (frame.lift > 0.0) {
        let at = first_vertex + i;
        motions[at].correction = vec4f(motions[at].correction.xyz + change, 0.0);
    }
}

// Predicts a node of a solid: adds the displacement by the last forces of cells on it, and clears
// them. `square` is that of the substep [s²].
fn predict_node(i: u32, square: f32) {
    let at = first_vertex + i;
    let by = square * load_x(i).w;
    store_d(i, predicted_velocity(i) * frame.h + by * motions[at].correction.xyz);
    motions[at].correction = vec4f();
}
