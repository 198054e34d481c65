// Displacements of the substep [m] in workgroup memory, for at most CAPACITY vertices.

var<workgroup> displacements: array<f32, 3u * CAPACITY>;

fn load_x(i: u32) -> vec4f {
    return positions[first_vertex + i];
}

fn store_x(i: u32, x: vec4f) {
    positions[first_vertex + i] = x;
}

fn load_d(i: u32) -> vec3f {
    let at = 3u * i;
    return vec3f(displacements[at], displacements[at + 1u], displacements[at + 2u]);
}

fn store_d(i: u32, d: vec3f) {
    let at = 3u * i;
    displacements[at] = d.x;
    displacements[at + 1u] = d.y;
    displacements[at + 2u] = d.z;
}

// The leaves of reduction trees are at the end, which bodies with volumes leave free.
fn load_leaf(i: u32) -> vec4f {
    let at = 3u * CAPACITY - 4u * CHUNK + 4u * i;
    return vec4f(
        displacements[at],
        displacements[at + 1u],
        displacements[at + 2u],
        displacements[at + 3u],
    );
}

fn store_leaf(i: u32, leaf: vec4f) {
    let at = 3u * CAPACITY - 4u * CHUNK + 4u * i;
    displacements[at] = leaf.x;
    displacements[at + 1u] = leaf.y;
    displacements[at + 2u] = leaf.z;
    displacements[at + 3u] = leaf.w;
}
