// Kernels of passes within patches: one workgroup per patch, with its vertices in workgroup memory.
//
// A patch is a block of entries: (vertices, stretch colors | bending colors << 16), its vertices
// two by two, one run per color, then the constraints with patch-local vertex indices. No color of
// a block is empty. Patches of one layer share no vertex.

var<workgroup> patch_x: array<vec4f, PATCH_VERTICES>;
var<workgroup> patch_d: array<f32, 3u * PATCH_VERTICES>;
// First entry of the block, and its value.
var<workgroup> head: vec3u;

@group(0) @binding(2) var<storage, read_write> displacements: array<vec4f>;

fn load_x(i: u32) -> vec4f {
    return patch_x[i];
}

fn store_x(i: u32, x: vec4f) {
    patch_x[i] = x;
}

fn load_d(i: u32) -> vec3f {
    let at = 3u * i;
    return vec3f(patch_d[at], patch_d[at + 1u], patch_d[at + 2u]);
}

fn store_d(i: u32, d: vec3f) {
    let at = 3u * i;
    patch_d[at] = d.x;
    patch_d[at + 1u] = d.y;
    patch_d[at + 2u] = d.z;
}

struct Block {
    vertices: u32,
    stretch_colors: u32,
    bending_colors: u32,
    // First entries of vertices and runs.
    first_vertex: u32,
    first_run: u32,
}

// Returns the block of the patch, uniform for all lanes.
fn find_block(body: Body, work: Work, lane: u32) -> Block {
    if (lane == 0u) {
        let patch_number = work.first_lane / WORKGROUP_SIZE;
        let at = constraints[body.patch_tables[current.color] + patch_number].x;
        head = vec3u(at, constraints[at]);
    }
    let found = workgroupUniformLoad(&head);
    let vertices = found.y;
    let first = found.x + 1u;
    return Block(vertices, found.z & 0xffffu, found.z >> 16u, first, first + (vertices + 1u) / 2u);
}

// Returns a vertex of the patch, relative to the first one of the body.
fn vertex_of(block: Block, i: u32) -> u32 {
    let pair = constraints[block.first_vertex + i / 2u];
    return select(pair.y, pair.x, (i & 1u) == 0u);
}

fn run_at(entry: u32) -> Run {
    return Run(constraints[entry].x, constraints[entry].y);
}

@compute @workgroup_size(WORKGROUP_SIZE)
fn patches(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let work = find_work(group_number(group, groups));
    let body = bodies[work.body];
    if (work.first_lane / WORKGROUP_SIZE >= body.patches[current.color]) {
        return;
    }
    first_vertex = body.first_vertex;
    let block = find_block(body, work, lane);
    for (var i = lane; i < block.vertices; i += WORKGROUP_SIZE) {
        let v = first_vertex + vertex_of(block, i);
        patch_x[i] = positions[v];
        store_d(i, displacements[v].xyz);
    }
    workgroupBarrier();
    let colors = block.stretch_colors + block.bending_colors;
    for (var i = 0u; i < colors; i++) {
        let color = select(i, colors - 1u - i, current.is_back != 0u);
        let kind = select(BENDING, STRETCH, color < block.stretch_colors);
        sweep(kind, body, run_at(block.first_run + color), lane, WORKGROUP_SIZE);
        workgroupBarrier();
    }
    for (var i = lane; i < block.vertices; i += WORKGROUP_SIZE) {
        displacements[first_vertex + vertex_of(block, i)] = vec4f(load_d(i), 0.0);
    }
}

@compute @workgroup_size(WORKGROUP_SIZE)
fn reset_patches(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let work = find_work(group_number(group, groups));
    let body = bodies[work.body];
    if (work.first_lane / WORKGROUP_SIZE >= body.patches[current.color]) {
        return;
    }
    let block = find_block(body, work, lane);
    for (var color = 0u; color < block.stretch_colors + block.bending_colors; color++) {
        let kind = select(BENDING, STRETCH, color < block.stretch_colors);
        let run = run_at(block.first_run + color);
        for (var k = lane; k < run.len; k += WORKGROUP_SIZE) {
            reset_constraint(kind, run, k);
        }
    }
}
