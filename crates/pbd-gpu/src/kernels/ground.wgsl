// WGSL counterpart of `ground.rs`.
//
// The fourth component of the velocity holds the remaining friction bound of the substep. Its sign
// bit tells whether an active contact carries the vertex. integrate() resets both.

const SIGN_BIT: u32 = 0x80000000u;

fn friction_bound(i: u32) -> f32 {
    return abs(velocities[first_vertex + i].w);
}

fn set_friction_bound(i: u32, bound: f32) {
    let sign = bitcast<u32>(velocities[first_vertex + i].w) & SIGN_BIT;
    velocities[first_vertex + i].w = bitcast<f32>(bitcast<u32>(bound) | sign);
}

fn mark_carried(i: u32) {
    let bits = bitcast<u32>(velocities[first_vertex + i].w);
    velocities[first_vertex + i].w = bitcast<f32>(bits | SIGN_BIT);
}

fn is_carried(i: u32) -> bool {
    return (bitcast<u32>(velocities[first_vertex + i].w) & SIGN_BIT) != 0u;
}

// Lifts a vertex onto the ground and applies friction.
fn lift_vertex(i: u32, friction: f32) {
    let x = load_x(i);
    var d = load_d(i);
    let depth = frame.ground - (x.y + d.y);
    if (depth > 0.0 && x.w > 0.0) {
        d.y += depth;
        let sideways = sqrt(d.x * d.x + d.z * d.z);
        let limit = friction_bound(i) + friction * depth;
        let slips = sideways > limit;
        let kept = select(0.0, 1.0 - limit / sideways, slips);
        set_friction_bound(i, select(limit - sideways, 0.0, slips));
        d.x *= kept;
        d.z *= kept;
        store_d(i, d);
    }
}
