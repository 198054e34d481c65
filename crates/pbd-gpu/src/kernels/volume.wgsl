// WGSL counterpart of `volume.rs` and its modules, which explain the formulas and the order of
// sums.
//
// Gradients are stored in the velocities, which are unused between predict() and integrate().

struct Around {
    gradient: vec3f,
    place: f32,
}

// Returns gradient at a spoke and its product with the position, now or at the start of the
// substep.
fn around(body: Body, spoke: vec2u, center: u32, at_start: bool) -> Around {
    let xv = load_x(spoke.x);
    let dv = displacement(spoke.x, at_start);
    let corners = body.first_corner;
    let first = constraints[corners + next_corner(spoke.y)].x;
    var a = difference(xv, dv, load_x(first), displacement(first, at_start));
    var sum = vec3f();
    var h = spoke.y;
    // The bound ends the loop on corrupt data.
    for (var i = 0u; i < body.corners; i++) {
        let across = constraints[corners + previous_corner(h)];
        let b = difference(xv, dv, load_x(across.x), displacement(across.x, at_start));
        sum += cross_product(a, b);
        a = b;
        h = across.y;
        if (h == spoke.y) {
            break;
        }
    }
    let gradient = sum * SIXTH;
    let back = difference(xv, dv, load_x(center), displacement(center, at_start));
    return Around(gradient, -dot_product(gradient, back));
}

fn displacement(i: u32, at_start: bool) -> vec3f {
    if (at_start) {
        return vec3f();
    }
    return load_d(i);
}

// Returns the part of a gradient that a carrying piece and colliders let a vertex follow.
fn free_gradient(body: Body, v: u32, gradient: vec3f) -> vec3f {
    let x = load_x(v);
    let d = load_d(v);
    if (is_carried(v) && dot_product(gradient, frame.gravity_step) > 0.0) {
        return vec3f();
    }
    let slips = !is_carried(v) && friction_bound(v) == 0.0;
    var free = gradient;
    for (var k = 0u; k < body.colliders; k++) {
        let at = body.first_collider + COLLIDER_ENTRIES * k;
        let q = x.xyz - collider_origin(at);
        let out = separation(q, d, at);
        let n = out.normal;
        let along = dot_product(free, n);
        if (along < 0.0 && touches(out.distance, q)) {
            free = select(vec3f(), free - along * n, slips);
        }
    }
    return free;
}

fn next_corner(h: u32) -> u32 {
    return select(h + 1u, h - 2u, h % 3u == 2u);
}

fn previous_corner(h: u32) -> u32 {
    return select(h - 1u, h + 2u, h % 3u == 0u);
}

// Adds leaves. The last component is a maximum, in leaves of motions a sum.
fn add_leaves(a: vec4f, b: vec4f, are_motions: bool) -> vec4f {
    let most = select(a.w, b.w, b.w > a.w);
    return vec4f(a.xyz + b.xyz, select(most, a.w + b.w, are_motions));
}

// Sums the leaves into the first one; all lanes must call it.
fn sum_leaves(lane: u32, lanes: u32, are_motions: bool) {
    workgroupBarrier();
    for (var width = CHUNK / 2u; width > 0u; width /= 2u) {
        for (var i = lane; i < width; i += lanes) {
            store_leaf(i, add_leaves(load_leaf(i), load_leaf(i + width), are_motions));
        }
        workgroupBarrier();
    }
}

// Computes gradients and sums of a chunk.
fn sum_chunk(body: Body, number: u32, lane: u32, lanes: u32) {
    let chunk = body.first_chunk + CHUNK_ENTRIES * number;
    let spokes = constraints[chunk];
    let piece = body.first_piece + PIECE_ENTRIES * constraints[chunk + 1u].x;
    let center = constraints[piece + 3u].x;
    // Compressible pieces have no old errors.
    let recovers = body.volume_alpha == 0.0;
    for (var i = lane; i < CHUNK; i += lanes) {
        var leaf = vec4f();
        if (i < spokes.y) {
            let spoke = constraints[body.first_spoke + spokes.x + i];
            let now = around(body, spoke, center, false);
            let free = free_gradient(body, spoke.x, now.gradient);
            let g = select(now.gradient, free, is_carried(spoke.x));
            let w = load_x(spoke.x).w;
            let square = free.x * free.x + free.y * free.y + free.z * free.z;
            leaf = vec4f(now.place, now.place, w * square, w * sqrt(square));
            if (recovers) {
                leaf.y = around(body, spoke, center, true).place;
            }
            let v = first_vertex + spoke.x;
            motions[v].velocity = vec4f(g, motions[v].velocity.w);
        }
        store_leaf(i, leaf);
    }
    sum_leaves(lane, lanes, false);
    store_sums(chunk + 2u, lane);
    if (frame.contact_rounds > 1u) {
        for (var i = lane; i < CHUNK; i += lanes) {
            var leaf = vec4f();
            if (i < spokes.y) {
                let v = constraints[body.first_spoke + spokes.x + i].x;
                let w = load_x(v).w;
                let mass = select(0.0, 1.0 / w, w > 0.0);
                leaf = vec4f(mass * load_d(v), mass);
            }
            store_leaf(i, leaf);
        }
        sum_leaves(lane, lanes, true);
        store_sums(chunk + 4u, lane);
    }
}

// Stores the first leaf in two entries.
fn store_sums(first: u32, lane: u32) {
    if (lane == 0u) {
        let sums = bitcast<vec4u>(load_leaf(0u));
        constraints[first] = sums.xy;
        constraints[first + 1u] = sums.zw;
    }
    workgroupBarrier();
}

// Sums the two entries from `place` on of the chunks of a piece into the first leaf.
fn sum_chunks(body: Body, chunks: vec2u, place: u32, lane: u32, lanes: u32) {
    let are_motions = place == 4u;
    for (var i = lane; i < CHUNK; i += lanes) {
        var leaf = vec4f();
        for (var k = i; k < chunks.y; k += CHUNK) {
            let sums = body.first_chunk + CHUNK_ENTRIES * (chunks.x + k) + place;
            let chunk = vec4u(constraints[sums], constraints[sums + 1u]);
            leaf = add_leaves(leaf, bitcast<vec4f>(chunk), are_motions);
        }
        store_leaf(i, leaf);
    }
    sum_leaves(lane, lanes, are_motions);
}

// Computes the motion of a piece to the next round, of which the first one of an iteration has
// none, and stores its mean displacement.
fn proceed(piece: u32, is_first: bool, sink: f32) {
    let sums = load_leaf(0u);
    let mean = select(vec3f(), sums.xyz / sums.w, sums.w > 0.0);
    let last = constraints[piece + 5u];
    let moved = mean - bitcast<vec3f>(vec3u(constraints[piece + 4u], last.x));
    let round = select(last.y + 1u, 0u, is_first);
    var factor = select(0.0, (f32(round) - 1.0) / (f32(round) + 2.0), round > 1u);
    let square = moved.x * moved.x + moved.y * moved.y + moved.z * moved.z;
    let length = factor * sqrt(square);
    let most = STEP * sink;
    factor = select(factor, factor * (most / length), length > most);
    let more = bitcast<vec3u>(factor * moved);
    let now = bitcast<vec3u>(mean);
    constraints[piece + 4u] = now.xy;
    constraints[piece + 5u] = vec2u(now.z, round);
    constraints[piece + 6u] = more.xy;
    constraints[piece + 7u] = vec2u(more.z, 0u);
}

// Sums the chunks of a piece and computes its steps against the gradients. The body's slot is that
// of its report.
fn step_piece(body: Body, slot: u32, number: u32, is_first: bool, lane: u32, lanes: u32) {
    let piece = body.first_piece + PIECE_ENTRIES * number;
    let chunks = constraints[piece];
    if (frame.contact_rounds > 1u) {
        sum_chunks(body, chunks, 4u, lane, lanes);
        if (lane == 0u) {
            proceed(piece, is_first, body.volume_sink);
        }
        workgroupBarrier();
    }
    sum_chunks(body, chunks, 2u, lane, lanes);
    if (lane == 0u) {
        let keeps = (body.flags & KEEPS_VOLUME) != 0u;
        let numbers = bitcast<vec2f>(constraints[piece + 1u]);
        let remembered = bitcast<f32>(constraints[piece + 2u].x);
        let lambda = select(0.0, remembered, keeps);
        let sums = load_leaf(0u);
        let steps = steps_of(sums, numbers.x, numbers.y, body, lambda);
        constraints[piece + 2u] = bitcast<vec2u>(vec2f(lambda - steps.x, steps.x));
        constraints[piece + 3u].y = bitcast<u32>(steps.y);
        if (frame.measures_motion != 0u) {
            let change = abs(steps.y) * sums.w;
            atomicMax(&reports[slot].max_displacement, bitcast<u32>(change));
        }
    }
}

// Returns the steps of displacements and of positions.
fn steps_of(sums: vec4f, rest: f32, reach: f32, body: Body, lambda: f32) -> vec2f {
    let size = abs(rest);
    let goal = body.volume_pressure * rest;
    let error = sums.x * THIRD - goal;
    let volume = sums.y * THIRD;
    let before = volume - goal;
    let steady = body.volume_recovery * size;
    let loaded = body.volume_sink * (AREA * (size / reach));
    let returned = select(steady, loaded, loaded > steady);
    let held = select(volume, -volume, rest < 0.0);
    let is_pressed = (body.flags & IS_PRESSED) != 0u;
    let crushed = select(0.0, body.volume_recovery * CRUSHED, is_pressed) * (0.5 * size - held);
    let most = select(returned, crushed, crushed > returned);
    var left = 0.0;
    if (error > most || error < -most) {
        left = select(left, before - most, before > most);
        left = select(left, before + most, before < -most);
    }
    let alpha = body.volume_alpha * size;
    var shift = 0.0;
    if (error > most || error < -most) {
        let old = before - left;
        shift = select(shift, old - loaded, old > loaded);
        shift = select(shift, old + loaded, old < -loaded);
    }
    var parts = vec2f(((error - left) - shift) + alpha * lambda, shift);
    let direction = select(-1.0, 1.0, goal > rest);
    let ahead = -(direction * before);
    if (body.volume_alpha == 0.0 && goal != rest && ahead > 0.0) {
        let change = direction * (error - before);
        let missing = -(direction * (before + (goal - rest)));
        let least = PRESS * steady;
        let force = select(least, loaded, loaded > least) + select(0.0, missing, missing > 0.0);
        let free = returned * (1.0 - EASE * (abs(change) / force));
        let left_over = force - select(0.0, -change, -change > 0.0);
        var growth = select(free, left_over, left_over > free);
        growth = select(growth, returned, returned < growth);
        growth = select(0.0, growth, growth > 0.0);
        parts = vec2f(
            direction * select(change, -force, -force > change),
            -(direction * select(growth, ahead, ahead < growth)),
        );
    }
    let weight = sums.z;
    let sum = frame.diagonal_scale * weight + alpha;
    let under = select(sum, weight, weight > sum);
    let farthest = select(reach, body.volume_sink, body.volume_sink > reach);
    let limit = vec2f(farthest / sums.w, reach / sums.w);
    var wanted = parts / under;
    wanted = select(wanted, limit, wanted > limit);
    wanted = select(wanted, -limit, wanted < -limit);
    return select(vec2f(), wanted, weight > 0.0 && sums.w > 0.0);
}

// Moves the vertices of a chunk.
fn move_chunk(body: Body, number: u32, lane: u32, lanes: u32) {
    let chunk = body.first_chunk + CHUNK_ENTRIES * number;
    let spokes = constraints[chunk];
    let piece = body.first_piece + PIECE_ENTRIES * constraints[chunk + 1u].x;
    let step = bitcast<f32>(constraints[piece + 2u].y);
    let shift = bitcast<f32>(constraints[piece + 3u].y);
    let reach = bitcast<f32>(constraints[piece + 1u].y);
    let reacts = step < 0.0 && reach > body.volume_sink;
    let has_others = frame.contact_rounds > 1u;
    let more = bitcast<vec3f>(vec3u(constraints[piece + 6u], constraints[piece + 7u].x));
    for (var i = lane; i < spokes.y; i += lanes) {
        let v = constraints[body.first_spoke + spokes.x + i].x;
        let g = motions[first_vertex + v].velocity.xyz;
        let x = load_x(v);
        if (has_others && x.w > 0.0) {
            store_d(v, load_d(v) + more);
        }
        var free = g;
        if (!reacts || shift != 0.0) {
            free = free_gradient(body, v, g);
        }
        store_d(v, load_d(v) + -(x.w * step) * select(free, g, reacts));
        if (shift != 0.0) {
            store_x(v, vec4f(x.xyz + -(x.w * shift) * free, x.w));
        }
    }
}
