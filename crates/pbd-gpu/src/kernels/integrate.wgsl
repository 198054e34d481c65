// WGSL counterpart of `integrate.rs`.

// Maximum displacement of the vertices of this lane along an axis in a substep [m].
var<private> max_displacement: f32;

// Updates velocity and position of a vertex. Returns true if the position is finite.
fn integrate_vertex(i: u32) -> bool {
    let x = load_x(i);
    let d = load_d(i);
    motions[first_vertex + i].velocity = vec4f(d / frame.h, 0.0);
    if (frame.lift > 0.0) {
        let last = motions[first_vertex + i].correction.xyz;
        let free = select(0.0, 1.0, x.w > 0.0);
        motions[first_vertex + i].correction = vec4f((last + d) * free, 0.0);
    }
    let end = x.xyz + d;
    max_displacement = max(max_displacement, max(max(abs(d.x), abs(d.z)), abs(d.y)));
    positions[first_vertex + i] = vec4f(end, x.w);
    return is_finite(end.x) && is_finite(end.y) && is_finite(end.z);
}

// Reports a vertex with a position that is not finite; the first substep and vertex are kept.
fn report_non_finite(body: u32, i: u32, substep: u32) {
    let first = atomicMin(&reports[body].bad_substep, substep);
    if (first >= substep) {
        atomicMin(&reports[body].bad_vertex, i);
    }
}
