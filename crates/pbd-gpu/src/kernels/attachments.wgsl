// WGSL counterpart of `attachments.rs`.

// Moves the vertex of the attachment at an entry back within its length.
fn pull_to_anchor(at: u32) {
    let ends = constraints[at];
    let max_length = bitcast<f32>(constraints[at + 1u].x);
    let xv = load_x(ends.x);
    let xa = load_x(ends.y);
    let d = load_d(ends.x);
    let offset = difference(xv, d, xa, load_d(ends.y));
    let length = norm(offset);
    if (length > max_length && xv.w > 0.0) {
        let kept = 1.0 - RETURN * frame.h;
        let before = kept * norm(difference(xv, vec3f(), xa, vec3f()));
        let reach = select(max_length, before, before > max_length);
        let back = (length - reach) / length;
        if (back > 0.0) {
            let pull = offset * back;
            store_d(ends.x, d + pull);
            correct(ends.x, -pull);
        }
    }
}
