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

// The shares of the vertices in the correction of a contact.
struct Mobility {
    shares: vec4f,
    // Vertical components of the normal, 0 for vertices that the ground holds.
    climbs: vec4f,
    weight: f32,
    // The same without the ground, for friction.
    free_weight: f32,
}

fn greater(a: f32, b: f32) -> f32 {
    return select(a, b, b > a);
}

fn lesser(a: f32, b: f32) -> f32 {
    return select(a, b, b < a);
}

// Returns an effective inverse mass, bounded from below by sizes.
fn bounded(w: vec4f, along: vec4f, sizes: vec4f) -> f32 {
    let weight = (w.x * along.x + w.y * along.y) + (w.z * along.z + w.w * along.w);
    let largest = greater(greater(sizes.x, sizes.y), greater(sizes.z, sizes.w));
    return greater(weight, largest / MAX_SHARE);
}

fn is_low(heights: vec4f) -> vec4<bool> {
    return heights <= vec4f(frame.ground) & vec4<bool>(frame.has_ground != 0u);
}

// Returns the shares of vertices, of which low ones do not move down.
fn mobility_of(w: vec4f, n: vec3f, inverse_masses: vec4f, low: vec4<bool>) -> Mobility {
    let shares = w * inverse_masses;
    let sizes = abs(shares);
    let is_held = (w * n.y < vec4f()) & low;
    // Held vertices move along the horizontal part of the normal.
    let level = vec2f(greater(1.0 - n.y * n.y, 0.0), abs(n.x) + abs(n.z));
    let along = select(shares, shares * level.x, is_held);
    let bounds = select(sizes, sizes * level.y, is_held);
    let climbs = select(vec4f(n.y), vec4f(), is_held);
    return Mobility(shares, climbs, bounded(w, along, bounds), bounded(w, shares, sizes));
}

// Returns a displacement as the ground will leave it.
fn lifted(x: vec4f, d: vec3f) -> vec3f {
    let depth = frame.ground - (x.y + d.y);
    let is_low = frame.has_ground != 0u && depth > 0.0 && x.w > 0.0;
    return vec3f(d.x, select(d.y, d.y + depth, is_low), d.z);
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
    var up: array<vec3f, 4>;
    for (var i = 0u; i < select(1u, 4u, is_pair); i++) {
        x[i] = load_x(v[i]);
        d[i] = load_d(v[i]);
        up[i] = lifted(x[i], d[i]);
    }
    let center_x = select(vec4f(), x[0], is_pair);
    let center_d = select(vec3f(), up[0], is_pair);
    let r0 = difference(center_x, center_d, x[0], up[0]);
    let r1 = difference(center_x, center_d, x[1], up[1]);
    let r2 = difference(center_x, center_d, x[2], up[2]);
    let r3 = difference(center_x, center_d, x[3], up[3]);
    let between = (w.x * r0 + w.y * r1) + (w.z * r2 + w.w * r3);
    let moved = plane.w + rates.x * (f32(substep_index + 1u) * frame.h);
    let gap = select(moved, plane.w, is_pair);
    let depth = gap - (between.x * n.x + between.y * n.y + between.z * n.z);
    let inverse_masses = vec4f(x[0].w, x[1].w, x[2].w, x[3].w);
    let heights = vec4f(x[0].y, x[1].y, x[2].y, x[3].y) + vec4f(d[0].y, d[1].y, d[2].y, d[3].y);
    let mobility = mobility_of(w, n, inverse_masses, is_low(heights));
    let is_active = depth > 0.0 && mobility.weight > 0.0;
    constraints[at + 8u].x = select(0u, 1u, is_active);
    if (!is_active) {
        return;
    }
    let motion = (w.x * up[0] + w.y * up[1]) + (w.z * up[2] + w.w * up[3]);
    let along = motion.x * n.x + motion.y * n.y + motion.z * n.z;
    let slide = motion - along * n;
    let push = depth / mobility.weight;
    let drag = hold(at, slide, rates.y * depth) / mobility.free_weight;
    let carried = constraints[at + 7u].y >> 16u;
    for (var i = 0u; i < select(1u, 4u, is_pair); i++) {
        let along = vec3f(n.x, mobility.climbs[i], n.z);
        store_d(v[i], d[i] + mobility.shares[i] * (push * along - drag));
        if ((carried == CARRIED_FIRST && w[i] > 0.0) || (carried == CARRIED_SECOND && w[i] < 0.0)) {
            mark_carried(v[i]);
        }
    }
}

const CONTACT_RECOVERY: f32 = 5.0;
const MAX_MISSING: f32 = 2.0;
const LIFT: f32 = 4.0;

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
    let inverse_masses = vec4f(x[0].w, x[1].w, x[2].w, x[3].w);
    let heights = vec4f(x[0].y, x[1].y, x[2].y, x[3].y) + vec4f(d[0].y, d[1].y, d[2].y, d[3].y);
    let free = mobility_of(w, n, inverse_masses, is_low(heights));
    if (!(free.weight > 0.0)) {
        return;
    }
    let is_carried = (constraints[at + 7u].y >> 16u) != 0u;
    let is_base = is_low(heights) | vec4<bool>(is_carried);
    var raised = mobility_of(w, n, inverse_masses, is_base);
    if (!(raised.weight > 0.0)) {
        raised = free;
    }
    let motion = (w.x * d[0] + w.y * d[1]) + (w.z * d[2] + w.w * d[3]);
    let along = motion.x * n.x + motion.y * n.y + motion.z * n.z;
    let separation = select(0.0, along, along > 0.0);
    let missing = thickness - plane.w;
    let slow = lesser(missing, MAX_MISSING * thickness) * (CONTACT_RECOVERY * frame.h);
    let fall = frame.gravity_step * frame.h;
    let along_normal = abs(fall.x * n.x + fall.y * n.y + fall.z * n.z);
    let recovery = lesser(missing, slow + select(0.0, LIFT * along_normal, is_carried));
    for (var i = 0u; i < 4u; i++) {
        let lost = free.shares[i] * (separation / free.weight);
        let gained = free.shares[i] * (recovery / raised.weight);
        let back = vec3f(lost * n.x, lost * free.climbs[i], lost * n.z);
        let shift = vec3f(gained * n.x, gained * raised.climbs[i], gained * n.z);
        store_x(v[i], vec4f(x[i].xyz + (back + shift), x[i].w));
        store_d(v[i], d[i] - back);
    }
}
