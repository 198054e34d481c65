// WGSL counterpart of `ground.rs`.

// Lifts a vertex onto the ground and applies friction. The fourth component of the velocity holds
// the remaining friction bound of the substep, which integrate() sets to 0.
fn lift_vertex(i: u32, friction: f32) {
    let x = load_x(i);
    var d = load_d(i);
    let depth = frame.ground - (x.y + d.y);
    if (depth > 0.0 && x.w > 0.0) {
        d.y += depth;
        let sideways = sqrt(d.x * d.x + d.z * d.z);
        let limit = velocities[first_vertex + i].w + friction * depth;
        let slips = sideways > limit;
        let kept = select(0.0, 1.0 - limit / sideways, slips);
        velocities[first_vertex + i].w = select(limit - sideways, 0.0, slips);
        d.x *= kept;
        d.z *= kept;
        store_d(i, d);
    }
}
