// One dispatch a pass: every entry point works on the bodies of the current pass's links.

// The lowest predicted height in the workgroup, as ordered bits.
var<workgroup> lowest: atomic<u32>;

// The farthest that a vertex of the workgroup moved: bits of numbers that are not negative compare as they do.
var<workgroup> most: atomic<u32>;

@compute @workgroup_size(WORKGROUP_SIZE)
fn predict(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let work = find_work(group_number(group, groups));
    first_vertex = bodies[work.body].first_vertex;
    let i = work.first_lane + lane;
    var height = ORDERED_INFINITY;
    if (i < bodies[work.body].vertices) {
        height = predict_vertex(i, bodies[work.body].kept_velocity);
    }
    if (frame.has_ground != 0u) {
        if (lane == 0u) {
            atomicStore(&lowest, ORDERED_INFINITY);
        }
        workgroupBarrier();
        atomicMin(&lowest, height);
        workgroupBarrier();
        if (lane == 0u) {
            atomicMin(&reports[work.body].lowest[current.substep & 1u], atomicLoad(&lowest));
        }
    }
}

@compute @workgroup_size(WORKGROUP_SIZE)
fn pins(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let work = find_work(group_number(group, groups));
    first_vertex = bodies[work.body].first_vertex;
    let k = work.first_lane + lane;
    if (k < bodies[work.body].pins) {
        move_pin(bodies[work.body].first_pin + PIN_ENTRIES * k, frame.substeps - current.substep);
    }
}

@compute @workgroup_size(WORKGROUP_SIZE)
fn tethers(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let work = find_work(group_number(group, groups));
    first_vertex = bodies[work.body].first_vertex;
    let k = work.first_lane + lane;
    if (k < bodies[work.body].tethers) {
        pull_tether(bodies[work.body].first_tether + TETHER_ENTRIES * k);
    }
}

// For every color of the pass at once; a body has as many lanes as its longest run of them.
@compute @workgroup_size(WORKGROUP_SIZE)
fn reset_multipliers(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let work = find_work(group_number(group, groups));
    let body = bodies[work.body];
    let k = work.first_lane + lane;
    for (var color = current.color; color < current.color + current.colors; color++) {
        reset_constraint(current.kind, run_of(body, current.kind, color), k);
    }
    if (current.with_overflow != 0u) {
        reset_constraint(current.kind, run_of(body, current.kind, OVERFLOW), k);
    }
}

@compute @workgroup_size(WORKGROUP_SIZE)
fn stretch(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let work = find_work(group_number(group, groups));
    let body = bodies[work.body];
    first_vertex = body.first_vertex;
    let run = run_of(body, current.kind, current.color);
    let k = work.first_lane + lane;
    if (k < run.len) {
        project_stretch(run.first + STRETCH_ENTRIES * k, edge_projection(body, current.kind));
    }
}

@compute @workgroup_size(WORKGROUP_SIZE)
fn bending(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let work = find_work(group_number(group, groups));
    let body = bodies[work.body];
    first_vertex = body.first_vertex;
    let run = run_of(body, BENDING, current.color);
    let k = work.first_lane + lane;
    if (k < run.len) {
        project_bending(run.first + BENDING_ENTRIES * k, bending_projection(body));
    }
}

// Colors that are too small to be worth a dispatch, in order, and then the overflow one by one. A body
// has one workgroup.
@compute @workgroup_size(TAIL_SIZE)
fn tail(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let work = find_work(group_number(group, groups));
    if (work.first_lane != 0u) {
        return;
    }
    let body = bodies[work.body];
    first_vertex = body.first_vertex;
    substep_at = current.substep;
    for (var color = current.color; color < current.color + current.colors; color++) {
        let run = run_of(body, current.kind, color);
        if (run.len != 0u) {
            sweep(current.kind, body, run, lane, TAIL_SIZE);
            storageBarrier();
        }
    }
    if (current.with_overflow != 0u && lane == 0u) {
        sweep(current.kind, body, run_of(body, current.kind, OVERFLOW), 0u, 1u);
    }
}

@compute @workgroup_size(WORKGROUP_SIZE)
fn colliders(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let work = find_work(group_number(group, groups));
    let body = bodies[work.body];
    first_vertex = body.first_vertex;
    let i = work.first_lane + lane;
    if (i < body.vertices) {
        push_out(i, body.first_collider, body.colliders, body.friction);
    }
}

@compute @workgroup_size(WORKGROUP_SIZE)
fn ground(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let work = find_work(group_number(group, groups));
    first_vertex = bodies[work.body].first_vertex;
    let i = work.first_lane + lane;
    let height = atomicLoad(&reports[work.body].lowest[current.substep & 1u]);
    if (i < bodies[work.body].vertices && !is_above_ground(height)) {
        lift_vertex(i, bodies[work.body].friction);
    }
}

@compute @workgroup_size(WORKGROUP_SIZE)
fn integrate(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let work = find_work(group_number(group, groups));
    first_vertex = bodies[work.body].first_vertex;
    let i = work.first_lane + lane;
    if (i < bodies[work.body].vertices) {
        if (!integrate_vertex(i)) {
            note_non_finite(work.body, i, current.substep);
        }
        if (i == 0u) {
            // The next substep, be it one of the next frame, reduces into this slot.
            let next = current.substep + 1u;
            let slot = select(next & 1u, 0u, next == frame.substeps);
            atomicStore(&reports[work.body].lowest[slot], ORDERED_INFINITY);
        }
    }
    if (frame.notes_motion != 0u) {
        if (lane == 0u) {
            atomicStore(&most, 0u);
        }
        workgroupBarrier();
        atomicMax(&most, bitcast<u32>(farthest));
        workgroupBarrier();
        if (lane == 0u) {
            atomicMax(&reports[work.body].farthest, atomicLoad(&most));
        }
    }
}

// One lane a link: an empty box for its body.
@compute @workgroup_size(WORKGROUP_SIZE)
fn reset_bounds(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let at = group_number(group, groups) * WORKGROUP_SIZE + lane;
    if (at < current.links) {
        let body = links[current.first_link + at].body;
        for (var k = 0u; k < 3u; k++) {
            atomicStore(&reports[body].box_min[k], ORDERED_INFINITY);
            atomicStore(&reports[body].box_max[k], ORDERED_NEGATIVE_INFINITY);
        }
    }
}

@compute @workgroup_size(WORKGROUP_SIZE)
fn bounds(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let work = find_work(group_number(group, groups));
    first_vertex = bodies[work.body].first_vertex;
    reset_box(lane);
    workgroupBarrier();
    let i = work.first_lane + lane;
    if (i < bodies[work.body].vertices) {
        bound_vertex(i);
    }
    workgroupBarrier();
    report_box(lane, work.body);
}
