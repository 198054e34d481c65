// Kernel of the whole-body schedule: one workgroup steps a body through all substeps of a frame.
//
// A vertex, and a constraint of one color, is always processed by the same lane. Barriers are
// needed only where lanes share vertices: around pins and attachments, and between colors. Loops
// with barriers have bounds from read-only memory, which are uniform.

fn reset_kind(body: Body, kind: u32, colors: u32, lane: u32) {
    for (var color = 0u; color < colors; color++) {
        let run = run_of(body, kind, color);
        for (var k = lane; k < run.len; k += WORKGROUP_SIZE) {
            reset_constraint(kind, run, k);
        }
    }
    if (lane == 0u) {
        let run = run_of(body, kind, OVERFLOW);
        for (var k = 0u; k < run.len; k++) {
            reset_constraint(kind, run, k);
        }
    }
}

fn project_color(body: Body, kind: u32, color: u32, lane: u32) {
    let run = run_of(body, kind, color);
    if (run.len != 0u) {
        sweep(kind, body, run, lane, WORKGROUP_SIZE);
        workgroupBarrier();
        storageBarrier();
    }
}

// Projects all colors of a kind in one layer; in layer 0 the overflow follows serially.
fn project_kind(body: Body, kind: u32, colors: u32, layer: u32, lane: u32) {
    let end = min(colors, (layer + 1u) * MAX_COLORS);
    for (var color = layer * MAX_COLORS; color < end; color++) {
        project_color(body, kind, color, lane);
    }
    project_overflow(body, kind, layer, false, lane);
}

// Projects the colors of a kind in one layer in reverse order, after the overflow.
fn project_back(body: Body, kind: u32, colors: u32, layer: u32, lane: u32) {
    project_overflow(body, kind, layer, true, lane);
    let first = layer * MAX_COLORS;
    for (var end = min(colors, first + MAX_COLORS); end > first; end--) {
        project_color(body, kind, end - 1u, lane);
    }
}

// Projects the overflow of a kind serially, if the layer is 0; from last to first if `is_back`.
fn project_overflow(body: Body, kind: u32, layer: u32, is_back: bool, lane: u32) {
    let overflow = run_of(body, kind, OVERFLOW);
    if (layer == 0u && overflow.len != 0u) {
        if (lane == 0u) {
            sweep_serially(kind, body, overflow, is_back);
        }
        workgroupBarrier();
        storageBarrier();
    }
}

// Projects the volumes of all pieces. Lanes exchange sums of chunks and pieces through the buffer.
fn project_volumes(body: Body, slot: u32, is_first: bool, lane: u32) {
    for (var chunk = 0u; chunk < body.chunks; chunk++) {
        sum_chunk(body, chunk, lane, WORKGROUP_SIZE);
        workgroupBarrier();
    }
    storageBarrier();
    for (var piece = 0u; piece < body.pieces; piece++) {
        step_piece(body, slot, piece, is_first, lane, WORKGROUP_SIZE);
        workgroupBarrier();
    }
    storageBarrier();
    for (var chunk = 0u; chunk < body.chunks; chunk++) {
        move_chunk(body, chunk, lane, WORKGROUP_SIZE);
    }
    workgroupBarrier();
    storageBarrier();
}

fn predict_body(body: Body, lane: u32) {
    for (var i = lane; i < body.vertices; i += WORKGROUP_SIZE) {
        predict_vertex(i);
    }
}

// Pushes all vertices out of colliders.
fn push_all_out(body: Body, slot: u32, lane: u32) {
    for (var i = lane; i < body.vertices; i += WORKGROUP_SIZE) {
        push_out(slot, i, body.first_collider, body.colliders, body.friction);
    }
    workgroupBarrier();
}

@compute @workgroup_size(WORKGROUP_SIZE)
fn whole_body(
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
    // Layer 0 may have an overflow but no color.
    let colors = max(1u, max(body.stretch_colors, body.bending_colors));
    let layers = (colors + MAX_COLORS - 1u) / MAX_COLORS;
    let end = min(current.substep + current.colors, frame.substeps);
    for (var substep = current.substep; substep < end; substep++) {
        substep_index = substep;
        predict_body(body, lane);
        workgroupBarrier();
        if (body.pins != 0u) {
            for (var k = lane; k < body.pins; k += WORKGROUP_SIZE) {
                move_pin(body.first_pin + PIN_ENTRIES * k, frame.substeps - substep);
            }
            workgroupBarrier();
        }
        if (body.contacts != 0u) {
            project_kind(body, CONTACT_FEATURES, MAX_COLORS, 0u, lane);
        }
        if ((body.flags & KEEPS_STRETCH) != 0u) {
            reset_kind(body, STRETCH, body.stretch_colors, lane);
        }
        if ((body.flags & KEEPS_BENDING) != 0u) {
            reset_kind(body, BENDING, body.bending_colors, lane);
        }
        if ((body.flags & KEEPS_INTERIOR_SPRINGS) != 0u) {
            reset_kind(body, INTERIOR_SPRINGS, body.spring_colors, lane);
        }
        if ((body.flags & KEEPS_VOLUME) != 0u) {
            for (var piece = lane; piece < body.pieces; piece += WORKGROUP_SIZE) {
                constraints[body.first_piece + PIECE_ENTRIES * piece + 2u].x = 0u;
            }
            storageBarrier();
        }
        for (var iteration = 0u; iteration < frame.iterations; iteration++) {
            if (body.attachments != 0u) {
                for (var k = lane; k < body.attachments; k += WORKGROUP_SIZE) {
                    pull_to_anchor(body.first_attachment + ATTACHMENT_ENTRIES * k);
                }
                workgroupBarrier();
            }
            for (var layer = 0u; layer < layers; layer++) {
                project_kind(body, STRETCH, body.stretch_colors, layer, lane);
                project_kind(body, BENDING, body.bending_colors, layer, lane);
            }
            project_kind(body, INTERIOR_SPRINGS, body.spring_colors, 0u, lane);
            project_back(body, INTERIOR_SPRINGS, body.spring_colors, 0u, lane);
            for (var layer = layers; layer > 0u; layer--) {
                project_back(body, BENDING, body.bending_colors, layer - 1u, lane);
                project_back(body, STRETCH, body.stretch_colors, layer - 1u, lane);
            }
            for (var round = 0u; round < frame.contact_rounds; round++) {
                if (body.pieces != 0u) {
                    if (body.contacts != 0u) {
                        project_kind(body, CONTACTS, MAX_COLORS, 0u, lane);
                    }
                    if (body.colliders != 0u) {
                        push_all_out(body, work.body, lane);
                    }
                    project_volumes(body, work.body, round == 0u, lane);
                }
                if (body.contacts != 0u) {
                    project_kind(body, CONTACTS, MAX_COLORS, 0u, lane);
                }
                if (body.colliders != 0u) {
                    push_all_out(body, work.body, lane);
                }
            }
        }
        if (body.contacts != 0u) {
            project_kind(body, CONTACT_RECOVERIES, MAX_COLORS, 0u, lane);
        }
        for (var i = lane; i < body.vertices; i += WORKGROUP_SIZE) {
            if (!integrate_vertex(i)) {
                report_non_finite(work.body, i, substep);
            }
        }
        workgroupBarrier();
        storageBarrier();
    }
    if (frame.measures_motion != 0u) {
        atomicMax(&reports[work.body].max_displacement, bitcast<u32>(max_displacement));
    }
}
