// WGSL counterpart of `integrate.rs`.

// Maximum displacement of the vertices of this lane along an axis in a substep [m].
var<private> max_displacement: f32;

// Updates velocity and position of a vertex. Returns true if the position is finite.
fn integrate_vertex(i: u32) -> bool {
    let x = load_x(i);
    let d = load_d(i);
    velocities[first_vertex + i] = vec4f(d / frame.h, 0.0);
    let end = x.xyz + d;
    let sunk = frame.has_ground != 0u && x.w > 0.0 && end.y < frame.ground;
    // NaN must not be replaced by the height of the ground.
    let y = select(end.y, frame.ground, sunk && is_number(end.y));
    max_displacement = max(max_displacement, max(max(abs(d.x), abs(d.z)), abs(y - x.y)));
    positions[first_vertex + i] = vec4f(end.x, y, end.z, x.w);
    return is_finite(end.x) && is_finite(y) && is_finite(end.z);
}

// Reports a vertex with a position that is not finite; the first substep and vertex are kept.
fn report_non_finite(body: u32, i: u32, substep: u32) {
    let first = atomicMin(&reports[body].bad_substep, substep);
    if (first >= substep) {
        atomicMin(&reports[body].bad_vertex, i);
    }
}
