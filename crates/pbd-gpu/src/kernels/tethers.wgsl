// Twin of tethers.rs.

const RETURN: f32 = 0.05;

// Pulls the vertex of the tether at an entry of the constraints back to where it reaches.
fn pull_tether(at: u32) {
    let ends = constraints[at];
    let longest = bitcast<f32>(constraints[at + 1u].x);
    let xv = load_x(ends.x);
    let xa = load_x(ends.y);
    let d = load_d(ends.x);
    let way = difference(xv, d, xa, load_d(ends.y));
    let length = norm(way);
    if (length > longest && xv.w > 0.0) {
        let kept = 1.0 - RETURN * frame.h;
        let before = kept * norm(difference(xv, vec3f(), xa, vec3f()));
        let reach = select(longest, before, before > longest);
        let back = (length - reach) / length;
        if (back > 0.0) {
            store_d(ends.x, d + way * back);
        }
    }
}

fn norm(v: vec3f) -> f32 {
    return sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
}
