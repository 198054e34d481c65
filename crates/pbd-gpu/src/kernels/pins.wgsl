// WGSL counterpart of `pins.rs`.

// Moves the vertex of the pin at an entry toward its target.
fn move_pin(at: u32, substeps_left: u32) {
    let head = constraints[at];
    let pin_target = vec3f(bitcast<f32>(head.y), bitcast<vec2f>(constraints[at + 1u]));
    let share = 1.0 / f32(substeps_left);
    store_d(head.x, (pin_target - load_x(head.x).xyz) * share);
}
