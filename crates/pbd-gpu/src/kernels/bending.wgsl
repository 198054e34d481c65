// WGSL counterpart of `bending.rs`, which explains the formulas.

// A hinge in its present shape.
struct Hinge {
    n2: vec3f,
    n3: vec3f,
    f2: f32,
    f3: f32,
    s: f32,
    t: f32,
    turn: f32,
    weight: f32,
    is_solid: bool,
}

// Measures a hinge from the vectors to its vertices from the first one, its inverse masses and its
// rest angle.
fn hinge_of(e: vec3f, a: vec3f, b: vec3f, w: vec4f, rest: f32) -> Hinge {
    let n2 = cross_product(e, a);
    let n3 = cross_product(b, e);
    let ee = dot_product(e, e);
    let q2 = dot_product(n2, n2);
    let q3 = dot_product(n3, n3);
    let cosine = dot_product(n2, n3);
    let length = sqrt(ee);
    let theta = arctangent2(-(length * dot_product(a, n3)), cosine);
    var turn = theta - rest;
    turn = select(turn, turn - TAU, turn > PI);
    turn = select(turn, turn + TAU, turn <= -PI);

    let big2 = ee + dot_product(a, a);
    let big3 = ee + dot_product(b, b);
    let solid = q2 > FLAT * FLAT * (big2 * big2) && q3 > FLAT * FLAT * (big3 * big3);
    let f2 = length / q2;
    let f3 = length / q3;
    let g22 = f2 * length;
    let g33 = f3 * length;
    let g23 = f2 * f3 * cosine;
    let per_square = 1.0 / ee;
    let s = dot_product(a, e) * per_square;
    let t = dot_product(b, e) * per_square;
    let s0 = 1.0 - s;
    let t0 = 1.0 - t;
    let g00 = s0 * s0 * g22 + t0 * t0 * g33 + 2.0 * (s0 * t0 * g23);
    let g11 = s * s * g22 + t * t * g33 + 2.0 * (s * t * g23);
    let weight = (w.x * g00 + w.y * g11) + (w.z * g22 + w.w * g33);
    return Hinge(n2, n3, f2, f3, s, t, turn, weight, solid);
}

// Projects the constraint at an entry.
fn project_bending(at: u32, by: Projection) {
    let ends = constraints[at];
    let wings = constraints[at + 1u];
    let numbers = bitcast<vec2f>(constraints[at + 2u]);
    let rest = numbers.x;
    let lambda = select(0.0, numbers.y, by.accumulates_lambda);
    let x0 = load_x(ends.x);
    let x1 = load_x(ends.y);
    let x2 = load_x(wings.x);
    let x3 = load_x(wings.y);
    let d0 = load_d(ends.x);
    let d1 = load_d(ends.y);
    let d2 = load_d(wings.x);
    let d3 = load_d(wings.y);

    let e = difference(x0, d0, x1, d1);
    let a = difference(x0, d0, x2, d2);
    let b = difference(x0, d0, x3, d3);
    let hinge = hinge_of(e, a, b, vec4f(x0.w, x1.w, x2.w, x3.w), rest);
    let n2 = hinge.n2;
    let n3 = hinge.n3;
    let f2 = hinge.f2;
    let f3 = hinge.f3;
    let s = hinge.s;
    let t = hinge.t;
    let s0 = 1.0 - s;
    let t0 = 1.0 - t;
    let turn = hinge.turn;
    let weight = hinge.weight;

    let m2 = (d2 - d0) - s * (d1 - d0);
    let m3 = (d3 - d0) - t * (d1 - d0);
    let added = -(f2 * dot_product(n2, m2) + f3 * dot_product(n3, m3));
    let before = turn - added;
    let soft = by.alpha / weight;
    let held = by.edge_stiffness * ((x0.w + x1.w) + (x2.w + x3.w));
    let recovery = RECOVERY * frame.h;
    let limp = held / (LIMP * (recovery * recovery));
    let share = select(1.0, limp, limp < 1.0);
    let follow = FOLLOW * (soft * held);
    let followed = select(FREE, follow, follow < FREE);
    let free = (followed * followed) * (followed * followed);
    let returned = recovery * (share * (1.0 + free) + held);
    var left = 0.0;
    left = select(left, before - returned, before > returned);
    left = select(left, before + returned, before < -returned);
    let wish = by.factor * ((turn - left) + by.alpha * lambda);
    let movable = hinge.is_solid && weight > 0.0;
    let sum = by.diagonal_scale * weight + by.alpha;
    let under = select(sum, weight, weight > sum);
    let most = MAX_TURN / weight;
    var wanted = wish / under;
    wanted = select(wanted, most, wanted > most);
    wanted = select(wanted, -most, wanted < -most);
    let step = select(0.0, wanted, movable);
    let u2 = select(0.0, step * f2, movable) * n2;
    let u3 = select(0.0, step * f3, movable) * n3;
    let ms = select(0.0, s, movable);
    let mt = select(0.0, t, movable);
    let ms0 = select(0.0, s0, movable);
    let mt0 = select(0.0, t0, movable);

    store_d(ends.x, d0 + (-x0.w) * (ms0 * u2 + mt0 * u3));
    store_d(ends.y, d1 + (-x1.w) * (ms * u2 + mt * u3));
    store_d(wings.x, d2 + x2.w * u2);
    store_d(wings.y, d3 + x3.w * u3);
    if (by.accumulates_lambda) {
        constraints[at + 2u].y = bitcast<u32>(lambda - step);
    }
}
