// Numbers as bits. Drivers may assume that no number is infinite or none, so neither is ever made,
// compared or looked for by arithmetic. The twins are in layout.rs.

// What ordered() gives for infinity and for negative infinity.
const ORDERED_INFINITY: u32 = 0xff800000u;
const ORDERED_NEGATIVE_INFINITY: u32 = 0x007fffffu;

fn is_finite(value: f32) -> bool {
    return (bitcast<u32>(value) & 0x7f800000u) != 0x7f800000u;
}

fn is_number(value: f32) -> bool {
    return (bitcast<u32>(value) & 0x7fffffffu) <= 0x7f800000u;
}

// Bits that compare as the numbers do; -0 comes before 0.
fn ordered(value: f32) -> u32 {
    let bits = bitcast<u32>(value);
    return bits ^ select(0x80000000u, 0xffffffffu, (bits & 0x80000000u) != 0u);
}

// Whether the lowest height, given as ordered bits, is above the ground. Zeros of both signs are equal.
fn is_above_ground(lowest: u32) -> bool {
    let bits = bitcast<u32>(frame.ground);
    let ground = select(ordered(frame.ground), 0x80000000u, bits == 0x80000000u);
    return lowest > ground;
}
