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

fn greater(a: f32, b: f32) -> f32 {
    return select(a, b, b > a);
}

fn lesser(a: f32, b: f32) -> f32 {
    return select(a, b, b < a);
}

// Returns the direction in which a vertex of weight w can move, and whether the correction of a
// contact along n presses it into a plane.
fn slide_of(body: Body, w: f32, n: vec3f, x: vec4f, d: vec3f) -> Slide {
    if (w == 0.0) {
        return Slide(n, false);
    }
    return slide_on_planes(body, x, d, select(1.0, -1.0, w < 0.0) * n);
}

// Returns the effective inverse mass of a contact. The parts of the vertices multiply their inverse
// masses, and their motion in the bound by MAX_SHARE.
fn effective_inverse_mass(w: vec4f, shares: vec4f, parts: vec4f, sizes: vec4f) -> f32 {
    let along = shares * parts;
    let motion = abs(shares) * sizes;
    let weight = (w.x * along.x + w.y * along.y) + (w.z * along.z + w.w * along.w);
    let largest = greater(greater(motion.x, motion.y), greater(motion.z, motion.w));
    return greater(weight, largest / MAX_SHARE);
}

// Returns a displacement as the planes will leave it.
fn lifted(body: Body, x: vec4f, displacement: vec3f) -> vec3f {
    var d = displacement;
    for (var k = 0u; k < body.planes; k++) {
        d += push_out_of_plane(first_plane(body) + COLLIDER_ENTRIES * k, x, d);
    }
    return d;
}

// Separates the features of the contact at an entry.
fn project_contact(body: Body, at: u32) {
    let v = vec4u(constraints[at], constraints[at + 1u]);
    let w = bitcast<vec4f>(vec4u(constraints[at + 2u], constraints[at + 3u]));
    let plane = bitcast<vec4f>(vec4u(constraints[at + 4u], constraints[at + 5u]));
    let rates = bitcast<vec2f>(constraints[at + 6u]);
    let n = plane.xyz;
    let is_pair = v.y != NO_VERTEX;
    var x: array<vec4f, 4>;
    var d: array<vec3f, 4>;
    var up: array<vec3f, 4>;
    for (var i = 0u; i < select(1u, 4u, is_pair); i++) {
        x[i] = load_x(v[i]);
        d[i] = load_d(v[i]);
        up[i] = lifted(body, x[i], d[i]);
    }
    let center_x = select(vec4f(), x[0], is_pair);
    let center_d = select(vec3f(), up[0], is_pair);
    let r0 = difference(center_x, center_d, x[0], up[0]);
    let r1 = difference(center_x, center_d, x[1], up[1]);
    let r2 = difference(center_x, center_d, x[2], up[2]);
    let r3 = difference(center_x, center_d, x[3], up[3]);
    let between = (w.x * r0 + w.y * r1) + (w.z * r2 + w.w * r3);
    let plane_gap = plane.w + rates.x * (f32(substep_index + 1u) * frame.collider_step);
    let gap = select(plane_gap, plane.w, is_pair);
    let depth = gap - (between.x * n.x + between.y * n.y + between.z * n.z);
    let shares = w * vec4f(x[0].w, x[1].w, x[2].w, x[3].w);
    let free = effective_inverse_mass(w, shares, vec4f(1.0), vec4f(1.0));
    // Vertices on a plane slide along it only.
    var parts = vec4f(1.0);
    var sizes = vec4f(1.0);
    for (var i = 0u; i < 4u; i++) {
        let slide = slide_of(body, w[i], n, x[i], d[i]);
        if (slide.is_pressed) {
            let along = slide.direction;
            let square = dot_product(along, along);
            let size = abs(along.x) + abs(along.y) + abs(along.z);
            parts[i] = select(square, 0.0, square < MIN_SLIDE);
            sizes[i] = select(size, 0.0, square < MIN_SLIDE);
        }
    }
    let weight = effective_inverse_mass(w, shares, parts, sizes);
    let is_active = depth > 0.0 && weight > 0.0;
    constraints[at + 8u].x = select(0u, 1u, is_active);
    if (!is_active) {
        return;
    }
    let drift = vec3f(
        bitcast<vec2f>(constraints[at + 12u]),
        bitcast<f32>(constraints[at + 13u].x),
    );
    let motion = ((w.x * up[0] + w.y * up[1]) + (w.z * up[2] + w.w * up[3])) + drift;
    let along = motion.x * n.x + motion.y * n.y + motion.z * n.z;
    let slide = motion - along * n;
    let press = depth * (free / weight);
    let push = (press * n - hold(at, slide, rates.y * press)) / free;
    let response = (w.x * shares.x + w.y * shares.y) + (w.z * shares.z + w.w * shares.w);
    let held_at = bitcast<vec3u>(between + response * push);
    constraints[at + 10u].y = held_at.x;
    constraints[at + 11u] = held_at.yz;
    let carried = constraints[at + 7u].y >> 16u;
    for (var i = 0u; i < select(1u, 4u, is_pair); i++) {
        let moved = d[i] + shares[i] * push;
        store_d(v[i], moved);
        correct(v[i], -(moved - d[i]));
        if ((carried == CARRIED_FIRST && w[i] > 0.0) || (carried == CARRIED_SECOND && w[i] < 0.0)) {
            mark_carried(v[i]);
        }
    }
}

// Lets the contact at an entry separate without velocity, if it is active.
fn recover_contact(body: Body, at: u32) {
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
    let shares = w * vec4f(x[0].w, x[1].w, x[2].w, x[3].w);
    let free = effective_inverse_mass(w, shares, vec4f(1.0), vec4f(1.0));
    if (!(free > 0.0)) {
        return;
    }
    // The carrying feature stays, as planes do.
    let is_carried = (constraints[at + 7u].y >> 16u) != 0u;
    let down = dot_product(n, frame.gravity_step * frame.h);
    var rising = vec4f(1.0);
    for (var i = 0u; i < 4u; i++) {
        let is_pressed = slide_of(body, w[i], n, x[i], d[i]).is_pressed;
        rising[i] = select(1.0, 0.0, is_pressed || (is_carried && w[i] * down > 0.0));
    }
    var weight = effective_inverse_mass(w, shares, rising, rising);
    if (!(weight > 0.0)) {
        rising = vec4f(1.0);
        weight = free;
    }
    let motion = (w.x * d[0] + w.y * d[1]) + (w.z * d[2] + w.w * d[3]);
    let along = motion.x * n.x + motion.y * n.y + motion.z * n.z;
    let separation = select(0.0, along, along > 0.0);
    let missing = thickness - plane.w;
    let slow = lesser(missing, MAX_MISSING * thickness) * (CONTACT_RECOVERY * frame.h);
    let recovery = lesser(missing, slow + select(0.0, LIFT * abs(down), is_carried));
    for (var i = 0u; i < 4u; i++) {
        let lost = shares[i] * (separation / free);
        let shift = lost + shares[i] * ((recovery / weight) * rising[i]);
        let left = d[i] - lost * n;
        let to = lifted_position(body, vec4f(x[i].xyz + shift * n, x[i].w), left);
        store_x(v[i], vec4f(to, x[i].w));
        store_d(v[i], left);
        correct(v[i], -(left - d[i]));
    }
}

// Returns a position at the start of the substep, moved so that its vertex ends in no plane.
fn lifted_position(body: Body, x: vec4f, displacement: vec3f) -> vec3f {
    var out = x.xyz;
    var d = displacement;
    for (var k = 0u; k < body.planes; k++) {
        let push = push_out_of_plane(first_plane(body) + COLLIDER_ENTRIES * k, x, d);
        d += push;
        out += push;
    }
    return out;
}
