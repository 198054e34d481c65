// WGSL counterpart of `contacts.rs`.

// Returns the part of a slide that friction removes, and adds `more` to the friction bound.
fn hold(at: u32, slide: vec3f, more: f32) -> vec3f {
    let before = vec3f(
        bitcast<vec2f>(constraints[at + 9u]),
        bitcast<f32>(constraints[at + 10u].x),
    );
    let sum = before + slide;
    let length = sqrt(sum.x * sum.x + sum.y * sum.y + sum.z * sum.z);
    let bound = bitcast<f32>(constraints[at + 8u].y) + more;
    let held = select(1.0, bound / length, length > bound) * sum;
    constraints[at + 8u].y = bitcast<u32>(bound);
    constraints[at + 9u] = bitcast<vec2u>(held.xy);
    constraints[at + 10u].x = bitcast<u32>(held.z);
    return held - before;
}

const MAX_SHARE: f32 = 8.0;

// Returns the effective inverse mass of a contact; no vertex moves by more than MAX_SHARE times the
// correction.
fn mobility(w: vec4f, shares: vec4f) -> f32 {
    let weight = (w.x * shares.x + w.y * shares.y) + (w.z * shares.z + w.w * shares.w);
    let sizes = abs(shares);
    let first = select(sizes.x, sizes.y, sizes.y > sizes.x);
    let second = select(sizes.z, sizes.w, sizes.w > sizes.z);
    let least = select(first, second, second > first) / MAX_SHARE;
    return select(weight, least, least > weight);
}

// Separates the features of the contact at an entry.
fn project_contact(at: u32) {
    let v = vec4u(constraints[at], constraints[at + 1u]);
    let w = bitcast<vec4f>(vec4u(constraints[at + 2u], constraints[at + 3u]));
    let plane = bitcast<vec4f>(vec4u(constraints[at + 4u], constraints[at + 5u]));
    let rates = bitcast<vec2f>(constraints[at + 6u]);
    let n = plane.xyz;
    let is_pair = v.y != NO_VERTEX;
    var x: array<vec4f, 4>;
    var d: array<vec3f, 4>;
    for (var i = 0u; i < select(1u, 4u, is_pair); i++) {
        x[i] = load_x(v[i]);
        d[i] = load_d(v[i]);
    }
    let center_x = select(vec4f(), x[0], is_pair);
    let center_d = select(vec3f(), d[0], is_pair);
    let r0 = difference(center_x, center_d, x[0], d[0]);
    let r1 = difference(center_x, center_d, x[1], d[1]);
    let r2 = difference(center_x, center_d, x[2], d[2]);
    let r3 = difference(center_x, center_d, x[3], d[3]);
    let between = (w.x * r0 + w.y * r1) + (w.z * r2 + w.w * r3);
    let moved = plane.w + rates.x * (f32(substep_index + 1u) * frame.h);
    let gap = select(moved, plane.w, is_pair);
    let depth = gap - (between.x * n.x + between.y * n.y + between.z * n.z);
    let shares = vec4f(w.x * x[0].w, w.y * x[1].w, w.z * x[2].w, w.w * x[3].w);
    let weight = mobility(w, shares);
    let is_active = depth > 0.0 && weight > 0.0;
    constraints[at + 8u].x = select(0u, 1u, is_active);
    if (!is_active) {
        return;
    }
    let motion = (w.x * d[0] + w.y * d[1]) + (w.z * d[2] + w.w * d[3]);
    let along = motion.x * n.x + motion.y * n.y + motion.z * n.z;
    let slide = motion - along * n;
    let push = (depth * n - hold(at, slide, rates.y * depth)) / weight;
    let carried = constraints[at + 7u].y >> 16u;
    for (var i = 0u; i < select(1u, 4u, is_pair); i++) {
        store_d(v[i], d[i] + shares[i] * push);
        if ((carried == CARRIED_FIRST && w[i] > 0.0) || (carried == CARRIED_SECOND && w[i] < 0.0)) {
            mark_carried(v[i]);
        }
    }
}

const CONTACT_RECOVERY: f32 = 5.0;
const MAX_MISSING: f32 = 2.0;

// Lets the contact at an entry separate without velocity, if it is active.
fn recover_contact(at: u32) {
    let v = vec4u(constraints[at], constraints[at + 1u]);
    if (constraints[at + 8u].x == 0u || v.y == NO_VERTEX) {
        return;
    }
    let w = bitcast<vec4f>(vec4u(constraints[at + 2u], constraints[at + 3u]));
    let plane = bitcast<vec4f>(vec4u(constraints[at + 4u], constraints[at + 5u]));
    let thickness = bitcast<f32>(constraints[at + 7u].x);
    let n = plane.xyz;
    var x: array<vec4f, 4>;
    var d: array<vec3f, 4>;
    for (var i = 0u; i < 4u; i++) {
        x[i] = load_x(v[i]);
        d[i] = load_d(v[i]);
    }
    let shares = vec4f(w.x * x[0].w, w.y * x[1].w, w.z * x[2].w, w.w * x[3].w);
    let weight = mobility(w, shares);
    if (!(weight > 0.0)) {
        return;
    }
    let motion = (w.x * d[0] + w.y * d[1]) + (w.z * d[2] + w.w * d[3]);
    let along = motion.x * n.x + motion.y * n.y + motion.z * n.z;
    let separation = select(0.0, along, along > 0.0);
    let missing = thickness - plane.w;
    let limit = MAX_MISSING * thickness;
    let recovery = select(limit, missing, missing < limit) * (CONTACT_RECOVERY * frame.h);
    let lost = separation / weight;
    let gained = (separation + recovery) / weight;
    for (var i = 0u; i < 4u; i++) {
        store_x(v[i], vec4f(x[i].xyz + (shares[i] * gained) * n, x[i].w));
        store_d(v[i], d[i] - (shares[i] * lost) * n);
    }
}
