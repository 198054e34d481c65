// Kernels of solids, whose particles are the nodes of a lattice.

@compute @workgroup_size(WORKGROUP_SIZE)
fn predict_nodes(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let work = find_work(group_number(group, groups));
    let body = bodies[work.body];
    first_vertex = body.first_vertex;
    let i = work.first_lane + lane;
    if (i < body.vertices) {
        predict_node(i, body.cell_square);
    }
}

// Projects the cells of a color, or adds their forces to those of nodes.
@compute @workgroup_size(WORKGROUP_SIZE)
fn cells(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let work = find_work(group_number(group, groups));
    let body = bodies[work.body];
    first_vertex = body.first_vertex;
    let run = run_of(body, CELLS, current.color);
    let k = work.first_lane + lane;
    if (k < run.len && is_swept(body)) {
        sweep_cell(run.first + CELL_ENTRIES * k, body);
    }
}

// Projects the colors that are too small for a dispatch, in order, then the overflow serially, with
// one workgroup per body; or adds the forces of their cells to those of nodes.
@compute @workgroup_size(TAIL_SIZE)
fn cell_tail(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let work = find_work(group_number(group, groups));
    let body = bodies[work.body];
    if (work.first_lane != 0u || !is_swept(body)) {
        return;
    }
    first_vertex = body.first_vertex;
    for (var color = current.color; color < current.color + current.colors; color++) {
        let run = run_of(body, CELLS, color);
        if (run.len != 0u) {
            for (var k = lane; k < run.len; k += TAIL_SIZE) {
                sweep_cell(run.first + CELL_ENTRIES * k, body);
            }
            storageBarrier();
        }
    }
    if (current.with_overflow != 0u && lane == 0u) {
        let run = run_of(body, CELLS, OVERFLOW);
        for (var k = 0u; k < run.len; k++) {
            sweep_cell(run.first + CELL_ENTRIES * k, body);
        }
    }
}

// Returns whether the pass concerns a body: all are projected, but not all forces are added again.
fn is_swept(body: Body) -> bool {
    return current.kind == CELLS || (body.flags & SUMS_FORCES) != 0u;
}

fn sweep_cell(at: u32, body: Body) {
    if (current.kind == CELLS) {
        project_cell(at, body);
    } else {
        add_cell_forces(at, body);
    }
}

// Clears the forces of nodes before those of cells are added again.
@compute @workgroup_size(WORKGROUP_SIZE)
fn clear_forces(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let work = find_work(group_number(group, groups));
    let body = bodies[work.body];
    let i = work.first_lane + lane;
    if (i < body.vertices && (body.flags & SUMS_FORCES) != 0u) {
        motions[body.first_vertex + i].correction = vec4f();
    }
}

// Pulls pinned vertices, one after another.
@compute @workgroup_size(TAIL_SIZE)
fn solid_pins(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let work = find_work(group_number(group, groups));
    let body = bodies[work.body];
    if (work.first_lane == 0u && lane == 0u) {
        first_vertex = body.first_vertex;
        pull_pins(body, frame.substeps - current.substep);
    }
}

// Whether each of the vertices in question is near a collider.
var<workgroup> near_flags: array<u32, TAIL_SIZE>;

// Lists the vertices that colliders may reach within the frame, ascending. Runs before the frame.
@compute @workgroup_size(TAIL_SIZE)
fn find_near(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let work = find_work(group_number(group, groups));
    let body = bodies[work.body];
    if (work.first_lane != 0u) {
        return;
    }
    first_vertex = body.first_vertex;
    if (lane == 0u) {
        atomicStore(&max_moved, 0u);
    }
    workgroupBarrier();
    for (var i = lane; i < body.vertices; i += TAIL_SIZE) {
        let v = predicted_velocity(i);
        atomicMax(&max_moved, bitcast<u32>(dot_product(v, v)));
    }
    workgroupBarrier();
    let speed = sqrt(bitcast<f32>(atomicLoad(&max_moved)));
    let g = abs(frame.gravity_step);
    let gain = ((g.x + g.y) + g.z) * f32(frame.substeps);
    let time = frame.collider_step * f32(frame.substeps);
    let motion = MARGIN * (speed + gain) * time;
    var count = 0u;
    for (var first = 0u; first < body.surface_vertices; first += TAIL_SIZE) {
        let slot = first + lane;
        var is_near = false;
        if (slot < body.surface_vertices) {
            is_near = is_near_collider(body, slot, motion);
        }
        near_flags[lane] = select(0u, 1u, is_near);
        workgroupBarrier();
        if (lane == 0u) {
            for (var i = 0u; i < TAIL_SIZE; i++) {
                if (near_flags[i] != 0u) {
                    constraints[near_entry(body, count)] = vec2u(first + i, 0u);
                    count += 1u;
                }
            }
        }
        workgroupBarrier();
    }
    if (lane == 0u) {
        constraints[body.first_near] = vec2u(count, 0u);
    }
}

// Pushes the listed vertices out of colliders, one after another.
@compute @workgroup_size(TAIL_SIZE)
fn solid_colliders(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let work = find_work(group_number(group, groups));
    let body = bodies[work.body];
    if (work.first_lane == 0u && lane == 0u) {
        first_vertex = body.first_vertex;
        substep_index = current.substep;
        push_all_near(body, work.body);
    }
}

// Places the vertices of the surface, one lane each.
@compute @workgroup_size(WORKGROUP_SIZE)
fn embed(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let work = find_work(group_number(group, groups));
    let body = bodies[work.body];
    first_vertex = body.first_vertex;
    let slot = work.first_lane + lane;
    if (slot < body.surface_vertices) {
        let point = embedding_of(body, slot);
        if (is_embedded(point)) {
            let at = body.first_surface_vertex + slot;
            positions[at] = vec4f(point_position(point), positions[at].w);
        }
    }
}
