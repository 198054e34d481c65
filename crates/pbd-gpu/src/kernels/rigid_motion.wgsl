// WGSL counterpart of `rigid_motion.rs`: the rigid motion of a piece.

struct RigidMotion {
    mass: f32,
    origin: vec3f,
    center: vec3f,
    velocity: vec3f,
    angular_momentum: vec3f,
    pin_count: f32,
    kinetic_energy: f32,
    // xx, yy and zz, then xy, yz and zx.
    moments: vec3f,
    products: vec3f,
}

// Returns a vertex of a list with two in every entry.
fn listed_vertex(first: u32, i: u32) -> u32 {
    let pair = constraints[first + i / 2u];
    return select(pair.y, pair.x, (i & 1u) == 0u);
}

// Returns four of the sums' terms of a vertex.
fn rigid_terms(group: u32, v: u32, origin: vec3f, of_pins: bool) -> vec4f {
    let x = load_x(v);
    let free = select(0.0, 1.0 / x.w, x.w > 0.0);
    let mass = select(free, select(1.0, 0.0, x.w > 0.0), of_pins);
    let r = x.xyz - origin;
    let u = motions[first_vertex + v].velocity.xyz;
    let m = mass * r;
    let p = mass * u;
    if (group == 0u) {
        return vec4f(mass, m);
    }
    if (group == 1u) {
        return vec4f(p, p.x * u.x + p.y * u.y + p.z * u.z);
    }
    if (group == 2u) {
        return vec4f(cross_product(m, u), m.x * r.x);
    }
    if (group == 3u) {
        return vec4f(m.y * r.y, m.z * r.z, m.x * r.y, m.y * r.z);
    }
    return vec4f(m.z * r.x, 0.0, 0.0, 0.0);
}

// Sums the terms of a group over the vertices of a list into the first leaf.
fn sum_rigid(group: u32, list: vec2u, origin: vec3f, of_pins: bool, lane: u32) {
    for (var i = lane; i < CHUNK; i += WORKGROUP_SIZE) {
        var leaf = vec4f();
        for (var k = i; k < list.y; k += CHUNK) {
            leaf += rigid_terms(group, listed_vertex(list.x, k), origin, of_pins);
        }
        store_leaf(i, leaf);
    }
    workgroupBarrier();
    for (var width = CHUNK / 2u; width > 0u; width /= 2u) {
        for (var i = lane; i < width; i += WORKGROUP_SIZE) {
            store_leaf(i, load_leaf(i) + load_leaf(i + width));
        }
        workgroupBarrier();
    }
}

// Measures the vertices of a list. Only the first lane has the result.
fn measure_piece(list: vec2u, has_pins: bool, lane: u32) -> RigidMotion {
    let origin = load_x(listed_vertex(list.x, 0u)).xyz;
    var sums: array<vec4f, 5>;
    for (var group = 0u; group < 5u; group++) {
        sum_rigid(group, list, origin, false, lane);
        sums[group] = load_leaf(0u);
        workgroupBarrier();
    }
    var pins = 0.0;
    if (has_pins) {
        var weight = 0.0;
        for (var group = 0u; group < 5u; group++) {
            sum_rigid(group, list, origin, true, lane);
            let of_pins = load_leaf(0u);
            workgroupBarrier();
            if (group == 0u) {
                pins = of_pins.x;
                weight = select(0.0, PIN_WEIGHT * sums[0].x / pins, pins > 0.0);
            }
            if (pins > 0.0) {
                sums[group] += weight * of_pins;
            }
        }
    }
    var motion = RigidMotion();
    motion.origin = origin;
    motion.pin_count = pins;
    let mass = sums[0].x;
    if (mass == 0.0) {
        return motion;
    }
    let s = sums[0].yzw;
    let c = s / mass;
    let velocity = sums[1].xyz / mass;
    let xx = sums[2].w - c.x * s.x;
    let yy = sums[3].x - c.y * s.y;
    let zz = sums[3].y - c.z * s.z;
    motion.mass = mass;
    motion.center = c;
    motion.velocity = velocity;
    motion.angular_momentum = sums[2].xyz - cross_product(s, velocity);
    motion.kinetic_energy = 0.5 * sums[1].w;
    motion.moments = vec3f(yy + zz, zz + xx, xx + yy);
    motion.products = vec3f(
        c.x * s.y - sums[3].z,
        c.y * s.z - sums[3].w,
        c.z * s.x - sums[4].x,
    );
    return motion;
}

fn at_least(number: f32, least: f32) -> f32 {
    return select(least, number, number > least);
}

// Returns the angular velocity of an angular momentum about the center.
fn angular_velocity_of(motion: RigidMotion, momentum: vec3f) -> vec3f {
    let m = motion.moments;
    let least = MIN_INERTIA * (m.x + m.y + m.z);
    let a = sqrt(at_least(m.x + least, least));
    if (a == 0.0) {
        return vec3f();
    }
    let b = motion.products.x / a;
    let c = motion.products.z / a;
    let d = sqrt(at_least((m.y + least) - b * b, least));
    let e = (motion.products.y - c * b) / d;
    let f = sqrt(at_least(((m.z + least) - c * c) - e * e, least));
    let x = momentum.x / a;
    let y = (momentum.y - b * x) / d;
    let z = (((momentum.z - c * x) - e * y) / f) / f;
    let along = (y - e * z) / d;
    return vec3f(((x - b * along) - c * z) / a, along, z);
}

// Returns the kinetic energy of a rigid motion.
fn rigid_energy(mass: f32, velocity: vec3f, turn: vec3f, momentum: vec3f) -> f32 {
    return 0.5 * (mass * dot_product(velocity, velocity) + dot_product(turn, momentum));
}
