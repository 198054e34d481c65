// Twin of integrate.rs.

// The farthest that this lane's vertices moved along an axis in a substep [m].
var<private> farthest: f32;

// Gives a vertex its next velocity and position. Returns whether the position is finite.
fn integrate_vertex(i: u32) -> bool {
    let x = load_x(i);
    let d = load_d(i);
    velocities[first_vertex + i] = vec4f(d / frame.h, 0.0);
    let end = x.xyz + d;
    let sunk = frame.has_ground != 0u && x.w > 0.0 && end.y < frame.ground;
    // What is no number must not pass for one that sank.
    let y = select(end.y, frame.ground, sunk && is_number(end.y));
    farthest = max(farthest, max(max(abs(d.x), abs(d.z)), abs(y - x.y)));
    positions[first_vertex + i] = vec4f(end.x, y, end.z, x.w);
    return is_finite(end.x) && is_finite(y) && is_finite(end.z);
}

// Notes a vertex whose position is not finite: the first one of the first such substep is kept.
fn note_non_finite(body: u32, i: u32, substep: u32) {
    let first = atomicMin(&reports[body].bad_substep, substep);
    if (first >= substep) {
        atomicMin(&reports[body].bad_vertex, i);
    }
}
