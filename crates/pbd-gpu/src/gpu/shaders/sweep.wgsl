// Projects the constraints first, first + stride, first + 2 stride and so on of a run.

fn sweep(kind: u32, body: Body, run: Run, first: u32, stride: u32) {
    if (kind == BENDING) {
        let by = bending_projection(body);
        for (var k = first; k < run.len; k += stride) {
            project_bending(run.first + BENDING_ENTRIES * k, by);
        }
    } else if (kind == CONTACTS) {
        for (var k = first; k < run.len; k += stride) {
            project_contact(body, run.first + CONTACT_ENTRIES * k);
        }
    } else if (kind == CONTACT_FEATURES) {
        for (var k = first; k < run.len; k += stride) {
            find_features(run.first + CONTACT_ENTRIES * k);
        }
    } else if (kind == CONTACT_RECOVERIES) {
        for (var k = first; k < run.len; k += stride) {
            recover_contact(body, run.first + CONTACT_ENTRIES * k);
        }
    } else {
        let by = edge_projection(body, kind);
        for (var k = first; k < run.len; k += stride) {
            project_stretch(run.first + STRETCH_ENTRIES * k, by);
        }
    }
}

// Projects the constraints of a run one after another, from last to first if `is_back`.
fn sweep_serially(kind: u32, body: Body, run: Run, is_back: bool) {
    for (var k = 0u; k < run.len; k++) {
        // A sweep whose stride exceeds the run projects one constraint.
        sweep(kind, body, run, select(k, run.len - 1u - k, is_back), run.len);
    }
}

// Sets the multiplier of constraint k of a run to zero, if it exists.
fn reset_constraint(kind: u32, run: Run, k: u32) {
    if (k < run.len) {
        let entries = select(STRETCH_ENTRIES, BENDING_ENTRIES, kind == BENDING);
        constraints[run.first + entries * k + entries - 1u].y = 0u;
    }
}
