// Bit patterns of floats. Drivers may assume that no float is infinite or NaN, so kernels detect
// such values by their bits only. `layout.rs` has the same functions.

fn is_finite(value: f32) -> bool {
    return (bitcast<u32>(value) & 0x7f800000u) != 0x7f800000u;
}

fn is_number(value: f32) -> bool {
    return (bitcast<u32>(value) & 0x7fffffffu) <= 0x7f800000u;
}

// Returns bits in the order of the floats; -0 comes before 0.
fn ordered(value: f32) -> u32 {
    let bits = bitcast<u32>(value);
    return bits ^ select(0x80000000u, 0xffffffffu, (bits & 0x80000000u) != 0u);
}
