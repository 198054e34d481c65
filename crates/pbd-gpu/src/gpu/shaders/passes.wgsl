// Kernels of one dispatch per pass, over the bodies of the pass's links.

// Maximum displacement in the workgroup; bits of nonnegative floats have the order of the floats.
var<workgroup> max_moved: atomic<u32>;

@compute @workgroup_size(WORKGROUP_SIZE)
fn predict(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let work = find_work(group_number(group, groups));
    first_vertex = bodies[work.body].first_vertex;
    substep_index = current.substep;
    let i = work.first_lane + lane;
    if (i < bodies[work.body].vertices) {
        predict_vertex(i);
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
fn attachments(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let work = find_work(group_number(group, groups));
    first_vertex = bodies[work.body].first_vertex;
    let k = work.first_lane + lane;
    if (k < bodies[work.body].attachments) {
        pull_to_anchor(bodies[work.body].first_attachment + ATTACHMENT_ENTRIES * k);
    }
}

// Resets all colors of the pass; a body has as many lanes as its longest run.
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

// Projects colors that are too small for a dispatch, in order, then the overflow serially, with one
// workgroup per body. If `is_back`, projects the overflow first, then the colors in descending
// order.
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
    substep_index = current.substep;
    let is_back = current.is_back != 0u;
    if (is_back) {
        project_overflow(body, lane);
        storageBarrier();
    }
    for (var i = 0u; i < current.colors; i++) {
        let color = current.color + select(i, current.colors - 1u - i, is_back);
        let run = run_of(body, current.kind, color);
        if (run.len != 0u) {
            sweep(current.kind, body, run, lane, TAIL_SIZE);
            storageBarrier();
        }
    }
    if (!is_back) {
        project_overflow(body, lane);
    }
}

fn project_overflow(body: Body, lane: u32) {
    if (current.with_overflow != 0u && lane == 0u) {
        let run = run_of(body, current.kind, OVERFLOW);
        sweep_serially(current.kind, body, run, current.is_back != 0u);
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
    substep_index = current.substep;
    let i = work.first_lane + lane;
    if (i < body.vertices) {
        push_out(work.body, i, body.first_collider, body.colliders, body.friction);
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
            report_non_finite(work.body, i, current.substep);
        }
    }
    if (frame.measures_motion != 0u) {
        if (lane == 0u) {
            atomicStore(&max_moved, 0u);
        }
        workgroupBarrier();
        atomicMax(&max_moved, bitcast<u32>(max_displacement));
        workgroupBarrier();
        if (lane == 0u) {
            atomicMax(&reports[work.body].max_displacement, atomicLoad(&max_moved));
        }
    }
}

// Resets the box of the body of every link, one lane per link.
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
    first_vertex = bodies[work.body].first_surface_vertex;
    reset_box(lane);
    workgroupBarrier();
    let i = work.first_lane + lane;
    if (i < bodies[work.body].surface_vertices) {
        bound_vertex(i);
    }
    workgroupBarrier();
    report_box(lane, work.body);
}
