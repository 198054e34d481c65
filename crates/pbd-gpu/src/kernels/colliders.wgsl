// WGSL counterpart of `colliders.rs`.
//
// The fourth component of the velocity holds the remaining friction bound of the substep. Its sign
// bit tells whether an active contact carries the vertex. integrate() resets both.

const SIGN_BIT: u32 = 0x80000000u;

fn friction_bound(i: u32) -> f32 {
    return abs(motions[first_vertex + i].velocity.w);
}

fn set_friction_bound(i: u32, bound: f32) {
    let sign = bitcast<u32>(motions[first_vertex + i].velocity.w) & SIGN_BIT;
    motions[first_vertex + i].velocity.w = bitcast<f32>(bitcast<u32>(bound) | sign);
}

fn mark_carried(i: u32) {
    let bits = bitcast<u32>(motions[first_vertex + i].velocity.w);
    motions[first_vertex + i].velocity.w = bitcast<f32>(bits | SIGN_BIT);
}

fn is_carried(i: u32) -> bool {
    return (bitcast<u32>(motions[first_vertex + i].velocity.w) & SIGN_BIT) != 0u;
}

struct Separation {
    distance: f32,
    normal: vec3f,
}

// Returns word k of the record of a collider.
fn collider_number(at: u32, k: u32) -> f32 {
    let pair = constraints[at + k / 2u];
    return bitcast<f32>(select(pair.y, pair.x, (k & 1u) == 0u));
}

fn collider_vector(at: u32, k: u32) -> vec3f {
    return vec3f(collider_number(at, k), collider_number(at, k + 1u), collider_number(at, k + 2u));
}

fn collider_velocity(at: u32) -> vec3f {
    return collider_vector(at, 14u);
}

// Returns the origin of a collider at the end of the substep of substep_index.
fn collider_origin(at: u32) -> vec3f {
    let time = f32(substep_index + 1u) * frame.collider_step;
    return collider_vector(at, 2u) + collider_velocity(at) * time;
}

// Pushes a vertex out of the colliders that start at an entry, in the substep of substep_index, and
// reports it for a body.
fn push_out(slot: u32, i: u32, first: u32, count: u32, friction: f32) {
    let x = load_x(i);
    if (!(x.w > 0.0)) {
        return;
    }
    var d = load_d(i);
    for (var k = 0u; k < count; k++) {
        let at = first + COLLIDER_ENTRIES * k;
        let q = x.xyz - collider_origin(at);
        let out = separation(q, d, at);
        let depth = select(0.0, -out.distance, out.distance < 0.0);
        if (depth > 0.0 || (friction_bound(i) > 0.0 && touches(out.distance, q))) {
            if (depth > 0.0) {
                atomicStore(&reports[slot].met_collider, 1u);
            }
            let n = out.normal;
            let dragged = collider_velocity(at) * frame.collider_step;
            let relative = d - dragged;
            let along = dot_product(relative, n);
            let slide = relative - along * n;
            let length = sqrt(dot_product(slide, slide));
            let limit = friction_bound(i) + friction * depth;
            let slips = length > limit;
            set_friction_bound(i, select(limit - length, 0.0, slips));
            let kept = select(0.0, 1.0 - limit / length, slips);
            let pushed = dragged + ((along + depth) * n + kept * slide);
            correct(i, -(pushed - d));
            d = pushed;
        }
    }
    store_d(i, d);
}

// Returns whether a point relative to a collider, at a distance from it, touches it.
fn touches(distance: f32, q: vec3f) -> bool {
    return distance <= TOUCH * ((abs(q.x) + abs(q.y)) + abs(q.z));
}

// Returns the height of a point above a plane.
fn height(q: vec3f, d: vec3f, normal: vec3f) -> f32 {
    return dot_product(normal, q) + dot_product(normal, d);
}

// Returns the entry of the first plane of a body; planes are its last colliders.
fn first_plane(body: Body) -> u32 {
    return body.first_collider + COLLIDER_ENTRIES * (body.colliders - body.planes);
}

// Returns the vector that moves a vertex out of the plane at an entry.
fn push_out_of_plane(at: u32, x: vec4f, d: vec3f) -> vec3f {
    let normal = collider_vector(at, 5u);
    let distance = height(x.xyz - collider_origin(at), d, normal);
    return select(0.0, -distance, distance < 0.0 && x.w > 0.0) * normal;
}

struct Slide {
    direction: vec3f,
    is_pressed: bool,
}

// Returns the part of a direction along which a vertex can move, and whether it would be pressed
// into planes that it touches.
fn slide_on_planes(body: Body, x: vec4f, d: vec3f, direction: vec3f) -> Slide {
    var slide = Slide(direction, false);
    for (var k = 0u; k < body.planes; k++) {
        let at = first_plane(body) + COLLIDER_ENTRIES * k;
        let q = x.xyz - collider_origin(at);
        let normal = collider_vector(at, 5u);
        let along = dot_product(slide.direction, normal);
        if (along < 0.0 && touches(height(q, d, normal), q)) {
            slide = Slide(slide.direction - along * normal, true);
        }
    }
    return slide;
}

fn separation(q: vec3f, d: vec3f, at: u32) -> Separation {
    let kind = constraints[at].x;
    let along = collider_vector(at, 5u);
    if (kind == PLANE) {
        return Separation(height(q, d, along), along);
    }
    let p = q + d;
    let u = collider_vector(at, 8u);
    if (kind == ROUND) {
        var share = dot_product(u, p);
        share = select(share, 0.0, share < 0.0);
        share = select(share, 1.0, share > 1.0);
        let before = q - share * along;
        let beside = before + d;
        let first = sqrt(dot_product(before, before));
        let length = sqrt(dot_product(beside, beside));
        let sum = first + length;
        let more = 2.0 * dot_product(before, d) + dot_product(d, d);
        let grown = select(0.0, more / sum, sum > 0.0);
        let radius = collider_number(at, 1u);
        let normal = select(vec3f(0.0, 1.0, 0.0), beside / length, length > 0.0);
        return Separation((first - radius) + grown, normal);
    }
    let v = collider_vector(at, 11u);
    let w = cross_product(u, v);
    let local = vec3f(dot_product(u, p), dot_product(v, p), dot_product(w, p));
    let before = vec3f(dot_product(u, q), dot_product(v, q), dot_product(w, q));
    let way = vec3f(dot_product(u, d), dot_product(v, d), dot_product(w, d));
    let signs = select(vec3f(1.0), vec3f(-1.0), local < vec3f(0.0));
    let beyond = (signs * before - along) + signs * way;
    let first = beyond.y > beyond.x;
    let nearer = select(beyond.x, beyond.y, first);
    let last = beyond.z > nearer;
    let least = select(nearer, beyond.z, last);
    let axis = select(select(u, v, first), w, last);
    let side = select(select(local.x, local.y, first), local.z, last);
    return Separation(least, select(1.0, -1.0, side < 0.0) * axis);
}
