// WGSL counterpart of `predict.rs`. The velocity is not stored, since integrate() computes the next
// one from the displacement alone.

fn predict_vertex(i: u32) {
    let at = first_vertex + i;
    let free = select(0.0, 1.0, load_x(i).w > 0.0);
    let v = (motions[at].velocity.xyz + frame.gravity_step) * free;
    var d = v * frame.h;
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
