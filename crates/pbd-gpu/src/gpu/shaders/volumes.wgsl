// Kernels of volume constraints, one dispatch per pass.

// Leaves of the reduction tree of a chunk or a piece.
var<workgroup> leaves: array<vec4f, CHUNK>;

fn load_leaf(i: u32) -> vec4f {
    return leaves[i];
}

fn store_leaf(i: u32, leaf: vec4f) {
    leaves[i] = leaf;
}

@compute @workgroup_size(WORKGROUP_SIZE)
fn sum_volumes(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let work = find_work(group_number(group, groups));
    let body = bodies[work.body];
    first_vertex = body.first_vertex;
    substep_index = current.substep;
    let chunk = work.first_lane / WORKGROUP_SIZE;
    if (chunk < body.chunks) {
        sum_chunk(body, chunk, lane, WORKGROUP_SIZE);
    }
}

@compute @workgroup_size(WORKGROUP_SIZE)
fn step_volumes(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let work = find_work(group_number(group, groups));
    let body = bodies[work.body];
    let piece = work.first_lane / WORKGROUP_SIZE;
    if (piece < body.pieces) {
        step_piece(body, work.body, piece, current.color == 0u, lane, WORKGROUP_SIZE);
    }
}

@compute @workgroup_size(WORKGROUP_SIZE)
fn move_volumes(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let work = find_work(group_number(group, groups));
    let body = bodies[work.body];
    first_vertex = body.first_vertex;
    substep_index = current.substep;
    let chunk = work.first_lane / WORKGROUP_SIZE;
    if (chunk < body.chunks) {
        move_chunk(body, chunk, lane, WORKGROUP_SIZE);
    }
}

@compute @workgroup_size(WORKGROUP_SIZE)
fn reset_volumes(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let work = find_work(group_number(group, groups));
    let body = bodies[work.body];
    let piece = work.first_lane + lane;
    if (piece < body.pieces) {
        constraints[body.first_piece + PIECE_ENTRIES * piece + 2u].x = 0u;
    }
}
