// Projects the constraints first, first + stride, first + 2 stride and so on of a run.

fn sweep(kind: u32, body: Body, run: Run, first: u32, stride: u32) {
    if (kind == BENDING) {
        let by = bending_projection(body);
        for (var k = first; k < run.len; k += stride) {
            project_bending(run.first + BENDING_ENTRIES * k, by);
        }
    } else if (kind == CONTACTS) {
        for (var k = first; k < run.len; k += stride) {
            project_contact(run.first + CONTACT_ENTRIES * k);
        }
    } else if (kind == CONTACT_FEATURES) {
        for (var k = first; k < run.len; k += stride) {
            find_features(run.first + CONTACT_ENTRIES * k);
        }
    } else if (kind == CONTACT_RECOVERIES) {
        for (var k = first; k < run.len; k += stride) {
            recover_contact(run.first + CONTACT_ENTRIES * k);
        }
    } else {
        let by = edge_projection(body, kind);
        for (var k = first; k < run.len; k += stride) {
            project_stretch(run.first + STRETCH_ENTRIES * k, by);
        }
    }
}

var<workgroup> is_back_skipped: u32;

// Returns whether the body leaves out the way back, uniform for all lanes. Its lowest predicted
// height is given as ordered bits.
fn skips_back(body: Body, lowest: u32, lane: u32) -> bool {
    if (lane == 0u) {
        let is_skipped = (body.flags & SKIPS_BACK) != 0u && is_above_ground(lowest);
        is_back_skipped = select(0u, 1u, is_skipped);
    }
    return workgroupUniformLoad(&is_back_skipped) != 0u;
}

// Sets the multiplier of constraint k of a run to zero, if it exists.
fn reset_constraint(kind: u32, run: Run, k: u32) {
    if (k < run.len) {
        let entries = select(STRETCH_ENTRIES, BENDING_ENTRIES, kind == BENDING);
        constraints[run.first + entries * k + entries - 1u].y = 0u;
    }
}
