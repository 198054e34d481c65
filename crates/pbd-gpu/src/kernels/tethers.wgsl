// Twin of tethers.rs.

// Pulls the vertex of the tether at an entry of the constraints back to where it reaches.
fn pull_tether(at: u32) {
    let ends = constraints[at];
    let reach = bitcast<f32>(constraints[at + 1u].x);
    let d = load_d(ends.x);
    let x = load_x(ends.x);
    let way = difference(x, d, load_x(ends.y), load_d(ends.y));
    let length = sqrt(way.x * way.x + way.y * way.y + way.z * way.z);
    if (length > reach && x.w > 0.0) {
        let back = (length - reach) / length;
        store_d(ends.x, d + way * back);
    }
}
