// WGSL counterpart of `contacts.rs`.

// Moves the vertex of the contact at an entry to its side of a plane, with friction.
fn separate_from_plane(at: u32, v: u32, n: vec3f, gap: f32, friction: f32) {
    let x = load_x(v);
    let d = load_d(v);
    let place = x.xyz + d;
    let depth = gap - (place.x * n.x + place.y * n.y + place.z * n.z);
    if (!(depth > 0.0 && x.w > 0.0)) {
        return;
    }
    let along = d.x * n.x + d.y * n.y + d.z * n.z;
    let slide = d - along * n;
    let back = friction_fraction(at, slide, friction * depth);
    store_d(v, d + (depth * n - back * slide));
}

// Returns the fraction of a slide that friction removes, and adds `more` to the friction bound.
fn friction_fraction(at: u32, slide: vec3f, more: f32) -> f32 {
    let length = sqrt(slide.x * slide.x + slide.y * slide.y + slide.z * slide.z);
    let keeps = frame.iterations > 1u;
    let held = bitcast<f32>(constraints[at + 5u].y);
    let limit = select(0.0, held, keeps) + more;
    let slips = length > limit;
    if (keeps) {
        constraints[at + 5u].y = bitcast<u32>(select(limit - length, 0.0, slips));
    }
    return select(1.0, limit / length, slips);
}

// Separates vertex and triangle of the contact at an entry.
fn project_contact(at: u32, friction: f32) {
    let first = constraints[at];
    let second = constraints[at + 1u];
    let weights = bitcast<vec2f>(constraints[at + 2u]);
    let mixed = bitcast<vec2f>(constraints[at + 3u]);
    let rest = bitcast<vec2f>(constraints[at + 4u]);
    let last = bitcast<vec2f>(constraints[at + 5u]);
    if (first.y == NO_CORNER) {
        let gap = last.x + mixed.x * (f32(substep_index + 1u) * frame.h);
        separate_from_plane(at, first.x, vec3f(mixed.y, rest.x, rest.y), gap, friction);
        return;
    }
    let wb = weights.x;
    let wc = weights.y;
    let wa = (1.0 - wb) - wc;
    let n = vec3f(mixed.y, rest.x, rest.y);
    let xv = load_x(first.x);
    let xa = load_x(first.y);
    let xb = load_x(second.x);
    let xc = load_x(second.y);
    let dv = load_d(first.x);
    let da = load_d(first.y);
    let db = load_d(second.x);
    let dc = load_d(second.y);

    let ra = difference(xv, dv, xa, da);
    let rb = difference(xv, dv, xb, db);
    let rc = difference(xv, dv, xc, dc);
    let way = wa * ra + wb * rb + wc * rc;
    let gap = last.x + mixed.x * (f32(substep_index + 1u) * frame.h);
    let depth = gap + (way.x * n.x + way.y * n.y + way.z * n.z);
    let sa = wa * xa.w;
    let sb = wb * xb.w;
    let sc = wc * xc.w;
    let weight = (xv.w + wa * sa) + (wb * sb + wc * sc);
    if (!(depth > 0.0 && weight > 0.0)) {
        return;
    }
    let past = dv - (wa * da + wb * db + wc * dc);
    let along = past.x * n.x + past.y * n.y + past.z * n.z;
    let slide = past - along * n;
    let back = friction_fraction(at, slide, friction * depth);
    let push = (depth * n - back * slide) / weight;
    store_d(first.x, dv + xv.w * push);
    store_d(first.y, da + (-sa) * push);
    store_d(second.x, db + (-sb) * push);
    store_d(second.y, dc + (-sc) * push);
}
