// Displacements of the substep [m] in a buffer.

@group(0) @binding(2) var<storage, read_write> displacements: array<vec4f>;

fn load_x(i: u32) -> vec4f {
    return positions[first_vertex + i];
}

fn store_x(i: u32, x: vec4f) {
    positions[first_vertex + i] = x;
}

fn load_d(i: u32) -> vec3f {
    return displacements[first_vertex + i].xyz;
}

fn store_d(i: u32, d: vec3f) {
    displacements[first_vertex + i] = vec4f(d, 0.0);
}
