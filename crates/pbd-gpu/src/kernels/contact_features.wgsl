// WGSL counterpart of `contact_features.rs`.

// Weights and normal of a contact, and the signed distance of its features.
struct Features {
    weights: vec4f,
    normal: vec3f,
    distance: f32,
}

// Returns the barycentric coordinates of the point of a triangle nearest to a point.
fn nearest_weights(ab: vec3f, ac: vec3f, ap: vec3f) -> vec3f {
    let d1 = dot_product(ab, ap);
    let d2 = dot_product(ac, ap);
    if (d1 <= 0.0 && d2 <= 0.0) {
        return vec3f(1.0, 0.0, 0.0);
    }
    let bp = ap - ab;
    let d3 = dot_product(ab, bp);
    let d4 = dot_product(ac, bp);
    if (d3 >= 0.0 && d4 <= d3) {
        return vec3f(0.0, 1.0, 0.0);
    }
    let vc = d1 * d4 - d3 * d2;
    if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) {
        let t = d1 / (d1 - d3);
        return vec3f(1.0 - t, t, 0.0);
    }
    let cp = ap - ac;
    let d5 = dot_product(ab, cp);
    let d6 = dot_product(ac, cp);
    if (d6 >= 0.0 && d5 <= d6) {
        return vec3f(0.0, 0.0, 1.0);
    }
    let vb = d5 * d2 - d1 * d6;
    if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) {
        let t = d2 / (d2 - d6);
        return vec3f(1.0 - t, 0.0, t);
    }
    let va = d3 * d6 - d5 * d4;
    let e = d4 - d3;
    let f = d5 - d6;
    if (va <= 0.0 && e >= 0.0 && f >= 0.0) {
        let t = e / (e + f);
        return vec3f(0.0, 1.0 - t, t);
    }
    let sum = (va + vb) + vc;
    if (sum > 0.0) {
        return vec3f(va / sum, vb / sum, vc / sum);
    }
    return vec3f(1.0, 0.0, 0.0);
}

fn vertex_face(kind: u32, v: vec4u, old_weights: vec4f, old: vec3f, thickness: f32) -> Features {
    let xa = load_x(v.y).xyz;
    let ab = load_x(v.z).xyz - xa;
    let ac = load_x(v.w).xyz - xa;
    let av = load_x(v.x).xyz - xa;
    let area = cross_product(ab, ac);
    let area_square = dot_product(area, area);
    if (!(area_square > 0.0)) {
        return Features(old_weights, old, INACTIVE);
    }
    let w = nearest_weights(ab, ac, av);
    let weights = vec4f(1.0, -w.x, -w.y, -w.z);
    let offset = av - (w.y * ab + w.z * ac);
    let square = dot_product(offset, offset);
    let normal = area / sqrt(area_square);
    let height = dot_product(normal, av);
    let is_inside = w.x > 0.0 && w.y > 0.0 && w.z > 0.0;
    if (kind == CONTACT_VERTEX_POINT && !is_inside) {
        if (!(height > 0.0 && square > 0.0)) {
            return Features(weights, old, INACTIVE);
        }
        let length = sqrt(square);
        return Features(weights, offset / length, length);
    }
    let beside = square - height * height;
    let is_near = height > 0.0 || beside <= thickness * thickness;
    return Features(weights, normal, select(INACTIVE, height, is_near));
}

fn edge_edge(v: vec4u, old_weights: vec4f, old: vec3f) -> Features {
    let xa = load_x(v.x).xyz;
    let xc = load_x(v.z).xyz;
    let ab = load_x(v.y).xyz - xa;
    let cd = load_x(v.w).xyz - xc;
    let ca = xa - xc;
    let aa = dot_product(ab, ab);
    let ee = dot_product(cd, cd);
    let bb = dot_product(ab, cd);
    let first = dot_product(ab, ca);
    let second = dot_product(cd, ca);
    let across = cross_product(ab, cd);
    let square = dot_product(across, across);
    if (!(square > MIN_SQUARED_SINE * (aa * ee))) {
        return Features(old_weights, old, INACTIVE);
    }
    let s = (bb * second - first * ee) / square;
    let t = (aa * second - bb * first) / square;
    if (!(s > 0.0 && s < 1.0 && t > 0.0 && t < 1.0)) {
        return Features(old_weights, old, INACTIVE);
    }
    let length = sqrt(square);
    let side = select(length, -length, dot_product(across, old) < 0.0);
    let normal = across / side;
    return Features(vec4f(1.0 - s, s, t - 1.0, -t), normal, dot_product(normal, ca));
}

// Returns the vector from the second feature to the first one at the start of the substep.
fn between_features(v: vec4u, w: vec4f) -> vec3f {
    let x = load_x(v.x);
    let none = vec3f();
    let r0 = w.x * difference(x, none, x, none);
    let r1 = w.y * difference(x, none, load_x(v.y), none);
    let r2 = w.z * difference(x, none, load_x(v.z), none);
    let r3 = w.w * difference(x, none, load_x(v.w), none);
    return (r0 + r1) + (r2 + r3);
}

// Finds the features of the contact at an entry and begins its sum of friction.
fn find_features(at: u32) {
    let was_held = bitcast<f32>(constraints[at + 8u].y) > 0.0;
    constraints[at + 8u].y = 0u;
    constraints[at + 9u] = vec2u();
    constraints[at + 10u].x = 0u;
    let kind = constraints[at + 7u].y & 0xffffu;
    if (kind == CONTACT_PLANE) {
        return;
    }
    let v = vec4u(constraints[at], constraints[at + 1u]);
    let weights = bitcast<vec4f>(vec4u(constraints[at + 2u], constraints[at + 3u]));
    let held_at = bitcast<vec3f>(vec3u(constraints[at + 10u].y, constraints[at + 11u]));
    let drift = bitcast<vec3u>(between_features(v, weights) - held_at);
    constraints[at + 12u] = select(vec2u(), drift.xy, was_held);
    constraints[at + 13u].x = select(0u, drift.z, was_held);
    let normal = bitcast<vec4f>(vec4u(constraints[at + 4u], constraints[at + 5u])).xyz;
    let thickness = bitcast<f32>(constraints[at + 7u].x);
    var found: Features;
    if (kind == CONTACT_EDGE_EDGE) {
        found = edge_edge(v, weights, normal);
    } else {
        found = vertex_face(kind, v, weights, normal, thickness);
    }
    let gap = select(thickness, found.distance, found.distance < thickness);
    let w = bitcast<vec4u>(found.weights);
    let plane = bitcast<vec4u>(vec4f(found.normal, gap));
    constraints[at + 2u] = w.xy;
    constraints[at + 3u] = w.zw;
    constraints[at + 4u] = plane.xy;
    constraints[at + 5u] = plane.zw;
}
