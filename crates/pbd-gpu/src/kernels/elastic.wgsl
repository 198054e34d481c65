// WGSL counterpart of `elastic.rs`: the elastic energy of a body.

// Bits of the largest energy of a constraint, and the sum in fixed point: low and high half.
var<workgroup> largest_energy: atomic<u32>;
var<workgroup> energy_units: atomic<u32>;
var<workgroup> energy_carries: atomic<u32>;

// Adds the energy of a constraint to the largest one, or to the sum in units of 1 / scale.
fn add_energy(energy: f32, scale: f32) {
    if (scale == 0.0) {
        atomicMax(&largest_energy, bitcast<u32>(energy));
    } else {
        let units = u32(ceil(energy * scale));
        let before = atomicAdd(&energy_units, units);
        if (before + units < before) {
            atomicAdd(&energy_carries, 1u);
        }
    }
}

// Returns the energy of an error of a constraint with a weight, times 2 h^2.
fn energy_of(error: f32, weight: f32, by: Projection) -> f32 {
    let alpha = by.alpha * (1.0 - frame.lift);
    let denominator = select(weight, alpha, alpha > weight);
    return select(0.0, by.factor * (error * error / denominator), weight > 0.0);
}

fn edge_energy(a: u32, b: u32, rest: f32, by: Projection) -> f32 {
    let xa = load_x(a);
    let xb = load_x(b);
    let length = norm(xb.xyz - xa.xyz);
    return energy_of(length - rest, xa.w + xb.w, by);
}

fn hinge_energy(v: vec4u, rest: f32, by: Projection) -> f32 {
    let x = array(load_x(v.x), load_x(v.y), load_x(v.z), load_x(v.w));
    let none = vec3f();
    let e = difference(x[0], none, x[1], none);
    let a = difference(x[0], none, x[2], none);
    let b = difference(x[0], none, x[3], none);
    let hinge = hinge_of(e, a, b, vec4f(x[0].w, x[1].w, x[2].w, x[3].w), rest);
    return energy_of(hinge.turn, select(0.0, hinge.weight, hinge.is_solid), by);
}

// Returns the energy of the cell at an entry times 2 h^2.
fn cell_energy(at: u32, body: Body) -> f32 {
    let forces = scaled_forces(load_forces(at), body.cell_square);
    let s = forces.stress;
    let t = forces.shear;
    let trace = (s.x + s.y) + s.z;
    let squares = dot_product(s, s) + 2.0 * dot_product(t, t);
    let mean = THIRD * (trace * trace);
    let shape = squares - mean;
    let of_strain = select(0.0, shape, shape > 0.0) / body.cell_shape + mean / body.cell_volume;
    let bending = four_of(at + 6u);
    let h = forces.hourglass;
    let of_bending = (dot_product(h[0], h[0]) / bending.x + dot_product(h[1], h[1]) / bending.y)
        + (dot_product(h[2], h[2]) / bending.z + dot_product(h[3], h[3]) / bending.w);
    return (of_strain + of_bending / body.cell_hourglass) / four_of(at + 4u).w;
}

// Adds the energies of a run. Vertices are those of a list at an entry, or of the body if it is 0.
fn add_run(kind: u32, body: Body, run: Run, list: u32, lane: u32, scale: f32) {
    if (kind == BENDING) {
        let by = bending_projection(body);
        for (var k = lane; k < run.len; k += WORKGROUP_SIZE) {
            let at = run.first + BENDING_ENTRIES * k;
            let v = vec4u(constraints[at], constraints[at + 1u]);
            let rest = bitcast<f32>(constraints[at + 2u].x);
            let of_body = vec4u(
                body_vertex(list, v.x),
                body_vertex(list, v.y),
                body_vertex(list, v.z),
                body_vertex(list, v.w),
            );
            add_energy(hinge_energy(of_body, rest, by), scale);
        }
    } else if (kind == CELLS) {
        for (var k = lane; k < run.len; k += WORKGROUP_SIZE) {
            add_energy(cell_energy(run.first + CELL_ENTRIES * k, body), scale);
        }
    } else {
        let by = edge_projection(body, kind);
        for (var k = lane; k < run.len; k += WORKGROUP_SIZE) {
            let at = run.first + STRETCH_ENTRIES * k;
            let ends = constraints[at];
            let rest = bitcast<f32>(constraints[at + 1u].x);
            let v = vec2u(body_vertex(list, ends.x), body_vertex(list, ends.y));
            let energy = edge_energy(v.x, v.y, rest, by);
            add_energy(energy, scale);
        }
    }
}

fn body_vertex(list: u32, i: u32) -> u32 {
    if (list == 0u) {
        return i;
    }
    return listed_vertex(list, i);
}

// Adds the energies of all constraints of a body.
fn add_all(body: Body, lane: u32, scale: f32) {
    for (var kind = 0u; kind < CONTACTS; kind++) {
        for (var color = 0u; color < colors_of(body, kind); color++) {
            add_run(kind, body, run_of(body, kind, color), 0u, lane, scale);
        }
        add_run(kind, body, run_of(body, kind, OVERFLOW), 0u, lane, scale);
    }
    for (var layer = 0u; layer < PATCH_LAYERS; layer++) {
        for (var i = 0u; i < body.patches[layer]; i++) {
            let at = constraints[body.patch_tables[layer] + i].x;
            let head = constraints[at];
            let first_run = at + 1u + (head.x + 1u) / 2u;
            let stretch_colors = head.y & 0xffffu;
            for (var color = 0u; color < stretch_colors + (head.y >> 16u); color++) {
                let run = Run(constraints[first_run + color].x, constraints[first_run + color].y);
                let kind = select(BENDING, STRETCH, color < stretch_colors);
                add_run(kind, body, run, at + 1u, lane, scale);
            }
        }
    }
}

// Returns the elastic energy of a body [J].
fn elastic_energy(body: Body, lane: u32) -> f32 {
    if (lane == 0u) {
        atomicStore(&largest_energy, 0u);
        atomicStore(&energy_units, 0u);
        atomicStore(&energy_carries, 0u);
    }
    workgroupBarrier();
    add_all(body, lane, 0.0);
    workgroupBarrier();
    let largest = bitcast<f32>(atomicLoad(&largest_energy));
    if (largest > MIN_ENERGY) {
        add_all(body, lane, UNITS / largest);
    }
    workgroupBarrier();
    let low = f32(atomicLoad(&energy_units));
    let units = f32(atomicLoad(&energy_carries)) * 4294967296.0 + low;
    return units * (largest / UNITS) * (0.5 / (frame.h * frame.h));
}
