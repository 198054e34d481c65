// Twin of colliders.rs.

struct WayOut {
    distance: f32,
    normal: vec3f,
}

// A number of a collider's record, by its place there.
fn collider_number(at: u32, k: u32) -> f32 {
    let pair = constraints[at + k / 2u];
    return bitcast<f32>(select(pair.y, pair.x, (k & 1u) == 0u));
}

fn collider_vector(at: u32, k: u32) -> vec3f {
    return vec3f(collider_number(at, k), collider_number(at, k + 1u), collider_number(at, k + 2u));
}

// Pushes a vertex out of the colliders from an entry of the constraints on.
fn push_out(i: u32, first: u32, count: u32, friction: f32) {
    let x = load_x(i);
    if (!(x.w > 0.0)) {
        return;
    }
    var d = load_d(i);
    for (var k = 0u; k < count; k++) {
        let at = first + COLLIDER_ENTRIES * k;
        let p = (x.xyz - collider_vector(at, 2u)) + d;
        let out = way_out(p, at);
        if (out.distance < 0.0) {
            let n = out.normal;
            let depth = -out.distance;
            let along = dot_product(d, n);
            let slide = d - along * n;
            let length = sqrt(dot_product(slide, slide));
            let limit = velocities[first_vertex + i].w + friction * depth;
            let slips = length > limit;
            velocities[first_vertex + i].w = select(limit - length, 0.0, slips);
            let kept = select(0.0, 1.0 - limit / length, slips);
            d = (along + depth) * n + kept * slide;
        }
    }
    store_d(i, d);
}

fn way_out(p: vec3f, at: u32) -> WayOut {
    let kind = constraints[at].x;
    let along = collider_vector(at, 5u);
    if (kind == PLANE) {
        return WayOut(dot_product(along, p), along);
    }
    let u = collider_vector(at, 8u);
    if (kind == ROUND) {
        var share = dot_product(u, p);
        share = select(share, 0.0, share < 0.0);
        share = select(share, 1.0, share > 1.0);
        let beside = p - share * along;
        let length = sqrt(dot_product(beside, beside));
        let radius = collider_number(at, 1u);
        return WayOut(length - radius, select(vec3f(0.0, 1.0, 0.0), beside / length, length > 0.0));
    }
    let v = collider_vector(at, 11u);
    let w = cross_product(u, v);
    let local = vec3f(dot_product(u, p), dot_product(v, p), dot_product(w, p));
    let beyond = abs(local) - along;
    let first = beyond.y > beyond.x;
    let nearer = select(beyond.x, beyond.y, first);
    let last = beyond.z > nearer;
    let least = select(nearer, beyond.z, last);
    let axis = select(select(u, v, first), w, last);
    let side = select(select(local.x, local.y, first), local.z, last);
    return WayOut(least, select(1.0, -1.0, side < 0.0) * axis);
}
