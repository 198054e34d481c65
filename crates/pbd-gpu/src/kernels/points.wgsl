// WGSL counterpart of `points.rs`: pins and colliders act on the vertices of a solid.
//
// A vertex has EMBEDDING_ENTRIES entries: its eight nodes, the first one NO_COPY for unused slots,
// and their weights. Pushes follow each other in one invocation. Mesa's llvmpipe limits the
// iterations of its loops, so those over nodes are written out.

// A vertex of a solid.
struct Embedding {
    nodes: array<u32, 8>,
    weights: array<f32, 8>,
}

fn embedding_of(body: Body, slot: u32) -> Embedding {
    let at = body.first_embedding + EMBEDDING_ENTRIES * slot;
    let first = four_of(at + 4u);
    let last = four_of(at + 6u);
    return Embedding(
        nodes_of(at),
        array<f32, 8>(first.x, first.y, first.z, first.w, last.x, last.y, last.z, last.w),
    );
}

fn is_embedded(point: Embedding) -> bool {
    return point.nodes[0] != NO_COPY;
}

// Returns the position of a vertex at the start of the substep [m].
fn point_position(point: Embedding) -> vec3f {
    let n = point.nodes;
    let b = point.weights;
    let first = load_x(n[0]).xyz;
    var sum = vec3f() + b[1] * (load_x(n[1]).xyz - first);
    sum = sum + b[2] * (load_x(n[2]).xyz - first);
    sum = sum + b[3] * (load_x(n[3]).xyz - first);
    sum = sum + b[4] * (load_x(n[4]).xyz - first);
    sum = sum + b[5] * (load_x(n[5]).xyz - first);
    sum = sum + b[6] * (load_x(n[6]).xyz - first);
    sum = sum + b[7] * (load_x(n[7]).xyz - first);
    return sum + first;
}

// Returns the displacement of a vertex [m].
fn point_displacement(point: Embedding) -> vec3f {
    let n = point.nodes;
    let b = point.weights;
    let first = load_d(n[0]);
    var sum = vec3f() + b[1] * (load_d(n[1]) - first);
    sum = sum + b[2] * (load_d(n[2]) - first);
    sum = sum + b[3] * (load_d(n[3]) - first);
    sum = sum + b[4] * (load_d(n[4]) - first);
    sum = sum + b[5] * (load_d(n[5]) - first);
    sum = sum + b[6] * (load_d(n[6]) - first);
    sum = sum + b[7] * (load_d(n[7]) - first);
    return sum + first;
}

// Returns the inverse mass by which a push of a vertex moves itself [1/kg].
fn point_response(point: Embedding) -> f32 {
    let n = point.nodes;
    let b = point.weights;
    var sum = b[0] * b[0] * load_x(n[0]).w;
    sum = sum + b[1] * b[1] * load_x(n[1]).w;
    sum = sum + b[2] * b[2] * load_x(n[2]).w;
    sum = sum + b[3] * b[3] * load_x(n[3]).w;
    sum = sum + b[4] * b[4] * load_x(n[4]).w;
    sum = sum + b[5] * b[5] * load_x(n[5]).w;
    sum = sum + b[6] * b[6] * load_x(n[6]).w;
    sum = sum + b[7] * b[7] * load_x(n[7]).w;
    return sum;
}

fn push_node(node: u32, weight: f32, impulse: vec3f) {
    store_d(node, load_d(node) + (weight * load_x(node).w) * impulse);
}

// Moves the nodes of a vertex by an impulse times the substep [kg m].
fn push_point(point: Embedding, impulse: vec3f) {
    let n = point.nodes;
    let b = point.weights;
    push_node(n[0], b[0], impulse);
    push_node(n[1], b[1], impulse);
    push_node(n[2], b[2], impulse);
    push_node(n[3], b[3], impulse);
    push_node(n[4], b[4], impulse);
    push_node(n[5], b[5], impulse);
    push_node(n[6], b[6], impulse);
    push_node(n[7], b[7], impulse);
}

// Pulls pin k onto its line; returns by how much it was off.
fn pull_pin(body: Body, k: u32, rest: f32) -> f32 {
    let head = constraints[body.first_pin + PIN_ENTRIES * k];
    let tail = pair_of(body.first_pin + PIN_ENTRIES * k + 1u);
    let start = four_of(body.first_pin_start + PIN_START_ENTRIES * k).xyz;
    let point = embedding_of(body, head.x);
    if (!is_embedded(point)) {
        return 0.0;
    }
    let w = point_response(point);
    if (!(w > 0.0)) {
        return 0.0;
    }
    let end = vec3f(bitcast<f32>(head.y), tail);
    let wanted = end + rest * (start - end);
    let off = (wanted - point_position(point)) - point_displacement(point);
    push_point(point, off / w);
    return (abs(off.x) + abs(off.y)) + abs(off.z);
}

// Pulls the pins of a body, in one invocation.
fn pull_pins(body: Body, substeps_left: u32) {
    let rest = f32(substeps_left - 1u) / f32(frame.substeps);
    let tolerance = PIN_TOLERANCE * body.cell_size;
    for (var sweep = 0u; sweep < PIN_SWEEPS; sweep++) {
        var largest = 0.0;
        for (var i = 0u; i < 2u * body.pins; i++) {
            let size = pull_pin(body, select(2u * body.pins - 1u - i, i, i < body.pins), rest);
            largest = select(largest, size, size > largest);
        }
        if (largest <= tolerance) {
            break;
        }
    }
}

// Returns whether a collider may reach a vertex that moves by at most `motion` [m].
fn is_near_collider(body: Body, slot: u32, motion: f32) -> bool {
    let point = embedding_of(body, slot);
    if (!is_embedded(point) || !(positions[body.first_surface_vertex + slot].w > 0.0)) {
        return false;
    }
    let x = point_position(point);
    for (var k = 0u; k < body.colliders; k++) {
        let at = body.first_collider + COLLIDER_ENTRIES * k;
        let v = collider_velocity(at);
        let distance = separation(x - collider_vector(at, 2u), vec3f(), at).distance;
        if (distance < motion + ((abs(v.x) + abs(v.y)) + abs(v.z))) {
            return true;
        }
    }
    return false;
}

// The list of vertices near colliders begins with their number. A vertex has NEAR_ENTRIES entries:
// its slot and the sum of its pushes along the normal; that of its pushes by friction.
fn near_entry(body: Body, i: u32) -> u32 {
    return body.first_near + 1u + NEAR_ENTRIES * i;
}

// Pushes vertex i of the list out of the collider at an entry; returns whether it presses on it.
fn push_near(body: Body, i: u32, at: u32, is_first: bool) -> bool {
    let entry = near_entry(body, i);
    let head = constraints[entry];
    let old_normal = select(bitcast<f32>(head.y), 0.0, is_first);
    let old_tangent = select(four_of(entry + 1u).xyz, vec3f(), is_first);
    if (is_first) {
        constraints[entry].y = 0u;
        store_pair(entry + 1u, vec2f());
        store_pair(entry + 2u, vec2f());
    }
    let time = f32(substep_index + 1u) * frame.collider_step;
    let h = frame.collider_step;
    let velocity = collider_velocity(at);
    let point = embedding_of(body, head.x);
    let x = point_position(point);
    let d = point_displacement(point);
    let q = x - (collider_vector(at, 2u) + velocity * time);
    let before = x - (collider_vector(at, 2u) + velocity * (time - h));
    let out = separation(q, d, at);
    let w = point_response(point);
    if (!((old_normal > 0.0 || out.distance < 0.0) && w > 0.0)) {
        return false;
    }
    let n = out.normal;
    let start = separation(before, vec3f(), at).distance;
    let remaining = -start - RECOVERY_SPEED * h;
    let kept = select(0.0, remaining, remaining > 0.0);
    let sum = old_normal - (out.distance + kept) / w;
    let normal = select(0.0, sum, sum > 0.0);
    let relative = d - velocity * h;
    let along = dot_product(relative, n);
    let held = old_tangent - (relative - along * n) / w;
    let limit = body.friction * normal;
    let length = sqrt(dot_product(held, held));
    let share = select(1.0, limit / length, length > limit);
    let tangent = share * held;
    push_point(point, (normal - old_normal) * n + (tangent - old_tangent));
    constraints[entry].y = bitcast<u32>(normal);
    store_pair(entry + 1u, tangent.xy);
    store_pair(entry + 2u, vec2f(tangent.z, 0.0));
    return normal > 0.0;
}

// Pushes the vertices of the list out of all colliders, in one invocation, and reports it.
fn push_all_near(body: Body, slot: u32) {
    let count = constraints[body.first_near].x;
    var has_pushed = false;
    for (var k = 0u; k < body.colliders; k++) {
        let at = body.first_collider + COLLIDER_ENTRIES * k;
        for (var i = 0u; i < 2u * count; i++) {
            let is_first = i < count;
            if (push_near(body, select(2u * count - 1u - i, i, is_first), at, is_first)) {
                has_pushed = true;
            }
        }
    }
    if (has_pushed) {
        atomicStore(&reports[slot].met_collider, 1u);
    }
}
