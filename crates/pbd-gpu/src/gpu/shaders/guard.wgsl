// Kernels of the guard, as in `guard.rs`: one workgroup per body.
//
// A piece has GUARD_ENTRIES entries: first vertex in the list and number of vertices; the motion at
// the start of the frame: origin, center, velocity, momentum and kinetic energy; that at its end:
// origin, center, velocity, angular velocity, the changes of both velocities, and 1 if it is held.

// Factors of the relative and the rigid motion of the body.
var<workgroup> factors: vec2f;

fn is_guarded(body: Body, flag: u32) -> bool {
    return (body.flags & flag) != 0u;
}

fn load_number(at: u32, i: u32) -> f32 {
    let pair = constraints[at + i / 2u];
    return bitcast<f32>(select(pair.y, pair.x, (i & 1u) == 0u));
}

fn store_number(at: u32, i: u32, number: f32) {
    let bits = bitcast<u32>(number);
    if ((i & 1u) == 0u) {
        constraints[at + i / 2u].x = bits;
    } else {
        constraints[at + i / 2u].y = bits;
    }
}

// Returns the vector of a number among those from an entry on.
fn load_vector(at: u32, number: u32) -> vec3f {
    let i = 3u * number;
    return vec3f(load_number(at, i), load_number(at, i + 1u), load_number(at, i + 2u));
}

fn store_vector(at: u32, number: u32, v: vec3f) {
    store_number(at, 3u * number, v.x);
    store_number(at, 3u * number + 1u, v.y);
    store_number(at, 3u * number + 2u, v.z);
}

// Returns the entry of a vertex of the list of a body.
fn first_listed(body: Body) -> u32 {
    return body.first_guard + GUARD_ENTRIES * body.guard_pieces;
}

@compute @workgroup_size(WORKGROUP_SIZE)
fn begin_guard(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let work = find_work(group_number(group, groups));
    let body = bodies[work.body];
    if (work.first_lane != 0u || !is_guarded(body, IS_GUARDED)) {
        return;
    }
    first_vertex = body.first_vertex;
    if (lane == 0u) {
        atomicStore(&reports[work.body].met_collider, 0u);
    }
    for (var piece = 0u; piece < body.guard_pieces; piece++) {
        let at = body.first_guard + GUARD_ENTRIES * piece;
        let motion = measure_piece(constraints[at], body.pins != 0u, lane);
        if (lane == 0u) {
            store_vector(at + 1u, 0u, motion.origin);
            store_vector(at + 1u, 1u, motion.center);
            store_vector(at + 1u, 2u, motion.velocity);
            store_vector(at + 1u, 3u, motion.angular_momentum);
            store_number(at + 1u, 12u, motion.kinetic_energy);
        }
    }
}

// Energies of the body in the frame; only those of the first lane have a meaning.
var<private> energy_before: f32;
var<private> energy_rigid: f32;
var<private> energy_held: f32;
var<private> energy_relative: f32;
var<private> energy_potential: f32;

// Computes the change of a piece at an entry and adds its energies.
fn end_piece(body: Body, at: u32, motion: RigidMotion, met_collider: bool) {
    let is_free = !(is_guarded(body, HAS_CONTACTS) || met_collider);
    let is_held = motion.pin_count > 0.0 || met_collider;
    let turn = angular_velocity_of(motion, motion.angular_momentum);
    var velocity = motion.velocity;
    var momentum = motion.angular_momentum;
    var velocity_change = vec3f();
    var turn_change = vec3f();
    let own = rigid_energy(motion.mass, velocity, turn, momentum);
    if (is_free && motion.pin_count == 0.0 && is_guarded(body, CONSERVES)) {
        velocity = load_vector(at + 1u, 2u) + frame.gravity_step * f32(frame.substeps);
        momentum = load_vector(at + 1u, 3u);
        velocity_change = velocity - motion.velocity;
        turn_change = angular_velocity_of(motion, momentum - motion.angular_momentum);
    }
    let other = motion.kinetic_energy - own;
    let relative = select(0.0, other, other > 0.0);
    let moved = (motion.origin - load_vector(at + 1u, 0u))
        + (motion.center - load_vector(at + 1u, 1u));
    energy_before += load_number(at + 1u, 12u);
    let rigid = rigid_energy(motion.mass, velocity, turn + turn_change, momentum);
    energy_rigid += rigid;
    energy_held += select(0.0, rigid, is_held);
    energy_relative += (body.damping_factor * body.damping_factor) * relative;
    energy_potential -= motion.mass * dot_product(frame.gravity_step, moved) / frame.h;
    store_vector(at + 8u, 0u, motion.origin);
    store_vector(at + 8u, 1u, motion.center);
    store_vector(at + 8u, 2u, motion.velocity);
    store_vector(at + 8u, 3u, turn);
    store_vector(at + 8u, 4u, velocity_change);
    store_vector(at + 8u, 5u, turn_change);
    store_number(at + 8u, 18u, select(0.0, 1.0, is_held));
}

fn scale_to_lose(excess: f32, energy: f32) -> f32 {
    if (!(excess > 0.0 && energy > 0.0)) {
        return 1.0;
    }
    let kept = 1.0 - excess / energy;
    return sqrt(select(0.0, kept, kept > 0.0));
}

// Computes the factors of a body and its slack after the frame, without elastic energy.
fn limit_energy(body: Body, slack: f32) -> f32 {
    let gain = ((energy_rigid + energy_relative) + energy_potential) - energy_before;
    let excess = gain - slack;
    let scale = scale_to_lose(excess, energy_relative);
    let rigid = scale_to_lose(excess - energy_relative, energy_held);
    factors = vec2f(body.damping_factor * scale, rigid);
    let lost = (1.0 - scale * scale) * energy_relative + (1.0 - rigid * rigid) * energy_held;
    let left = slack + (lost - gain);
    return select(0.0, left, left > 0.0);
}

// Changes the velocities of the vertices of a piece.
fn change_piece(at: u32, lane: u32) {
    let origin = load_vector(at + 8u, 0u);
    let center = load_vector(at + 8u, 1u);
    let velocity = load_vector(at + 8u, 2u);
    let turn = load_vector(at + 8u, 3u);
    let velocity_change = load_vector(at + 8u, 4u);
    let turn_change = load_vector(at + 8u, 5u);
    let rigid = select(1.0, factors.y, load_number(at + 8u, 18u) > 0.0);
    let is_unchanged = all(velocity_change == vec3f()) && all(turn_change == vec3f());
    if (factors.x == 1.0 && rigid == 1.0 && is_unchanged) {
        return;
    }
    let list = constraints[at];
    for (var i = lane; i < list.y; i += WORKGROUP_SIZE) {
        let v = listed_vertex(list.x, i);
        let x = load_x(v);
        if (x.w > 0.0) {
            let arm = (x.xyz - origin) - center;
            let own = motions[first_vertex + v].velocity.xyz;
            let rigid_velocity = velocity + cross_product(turn, arm);
            let relative = own - rigid_velocity;
            let restored = velocity_change + cross_product(turn_change, arm);
            let scaled = (factors.x - 1.0) * relative + (rigid - 1.0) * rigid_velocity;
            let end = own + (scaled + restored);
            motions[first_vertex + v].velocity = vec4f(end, 0.0);
        }
    }
}

@compute @workgroup_size(WORKGROUP_SIZE)
fn end_guard(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let work = find_work(group_number(group, groups));
    let body = bodies[work.body];
    if (work.first_lane != 0u || !is_guarded(body, IS_GUARDED)) {
        return;
    }
    first_vertex = body.first_vertex;
    let met_collider = atomicLoad(&reports[work.body].met_collider) != 0u;
    for (var piece = 0u; piece < body.guard_pieces; piece++) {
        let at = body.first_guard + GUARD_ENTRIES * piece;
        let motion = measure_piece(constraints[at], body.pins != 0u, lane);
        if (lane == 0u) {
            end_piece(body, at, motion, met_collider);
        }
    }
    storageBarrier();
    let before = bitcast<f32>(atomicLoad(&reports[work.body].slack));
    let slack = select(before, UNLIMITED, is_guarded(body, IS_UNLIMITED));
    var left = slack;
    if (lane == 0u) {
        left = limit_energy(body, slack);
    }
    workgroupBarrier();
    for (var piece = 0u; piece < body.guard_pieces; piece++) {
        change_piece(body.first_guard + GUARD_ENTRIES * piece, lane);
    }
    if (!is_guarded(body, CONSERVES)) {
        return;
    }
    if (is_guarded(body, IS_DRIVEN)) {
        left = UNLIMITED;
    } else if (is_guarded(body, MEASURES_ELASTIC_ENERGY)) {
        let elastic = elastic_energy(body, lane);
        let relaxed = select(left, elastic + (left - elastic) * body.relaxation, left > elastic);
        left = select(relaxed, elastic, is_guarded(body, IS_UNLIMITED));
    }
    if (lane == 0u) {
        atomicStore(&reports[work.body].slack, bitcast<u32>(left));
    }
}
