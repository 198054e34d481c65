// Twin of stretch.rs.

// Projects the constraint at an entry of the constraints.
fn project_stretch(at: u32, by: Projection) {
    let ends = constraints[at];
    let numbers = bitcast<vec2f>(constraints[at + 1u]);
    var rest = numbers.x;
    let lambda = select(0.0, numbers.y, by.keeps);
    let xa = load_x(ends.x);
    let xb = load_x(ends.y);
    let da = load_d(ends.x);
    let db = load_d(ends.y);

    if (by.old > 0.0) {
        let at_first = difference(xa, vec3f(), xb, vec3f());
        let length = sqrt(at_first.x * at_first.x + at_first.y * at_first.y + at_first.z * at_first.z);
        rest += by.old * (length - rest);
    }
    let edge = difference(xa, da, xb, db);
    let length = sqrt(edge.x * edge.x + edge.y * edge.y + edge.z * edge.z);
    let error = (length - rest) + by.alpha * lambda;
    let own = xa.w + xb.w;
    let sum = by.own_weight * own + by.alpha;
    let weight = select(sum, own, own > sum);
    // A length of zero has no direction; two pinned ends do not move.
    let under = length * weight;
    let scale = select(0.0, by.factor * error / under, under > 0.0);

    store_d(ends.x, da + (scale * xa.w) * edge);
    store_d(ends.y, db - (scale * xb.w) * edge);
    if (by.keeps) {
        constraints[at + 1u].y = bitcast<u32>(lambda - scale * length);
    }
}
