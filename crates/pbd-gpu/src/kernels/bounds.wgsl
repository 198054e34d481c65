// WGSL counterpart of `bounds.rs`. Coordinates are compared as ordered bits, for atomics.

var<workgroup> box_min: array<atomic<u32>, 3>;
var<workgroup> box_max: array<atomic<u32>, 3>;

fn reset_box(lane: u32) {
    if (lane < 3u) {
        atomicStore(&box_min[lane], ORDERED_INFINITY);
        atomicStore(&box_max[lane], ORDERED_NEGATIVE_INFINITY);
    }
}

// Extends the box of the workgroup by a vertex, unless its slot is unused.
fn bound_vertex(i: u32) {
    let x = load_x(i);
    if (x.w >= 0.0) {
        for (var k = 0u; k < 3u; k++) {
            if (is_number(x[k])) {
                let bits = ordered(x[k]);
                atomicMin(&box_min[k], bits);
                atomicMax(&box_max[k], bits);
            }
        }
    }
}

// Extends the box of the body by that of the workgroup.
fn report_box(lane: u32, body: u32) {
    if (lane < 3u) {
        atomicMin(&reports[body].box_min[lane], atomicLoad(&box_min[lane]));
        atomicMax(&reports[body].box_max[lane], atomicLoad(&box_max[lane]));
    }
}
