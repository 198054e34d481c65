// WGSL counterpart of `cells.rs`, which explains the formulas.
//
// A cell has CELL_ENTRIES entries: its eight nodes; centroid and fraction; bending; mode weights;
// strain weight and 0; then, from CELL_STATE on, its rotation, stress and forces of hourglass
// modes.

// Returns the two numbers of an entry.
fn pair_of(at: u32) -> vec2f {
    return bitcast<vec2f>(constraints[at]);
}

// Returns the four numbers of two entries.
fn four_of(at: u32) -> vec4f {
    return vec4f(pair_of(at), pair_of(at + 1u));
}

fn store_pair(at: u32, pair: vec2f) {
    constraints[at] = bitcast<vec2u>(pair);
}

// Returns the eight nodes that start at an entry.
fn nodes_of(at: u32) -> array<u32, 8> {
    let a = constraints[at];
    let b = constraints[at + 1u];
    let c = constraints[at + 2u];
    let d = constraints[at + 3u];
    return array<u32, 8>(a.x, a.y, b.x, b.y, c.x, c.y, d.x, d.y);
}

fn load_rows(at: u32, body: Body) -> CellRows {
    let shape = four_of(at + 4u);
    let first = four_of(at + 8u);
    let last = four_of(at + 10u);
    let strain_weight = pair_of(at + 12u).x;
    let center = shape.xyz;
    let ratio = (body.cell_volume * shape.w) * strain_weight;
    let kept = select(1.0, RESOLVED / ratio, ratio > RESOLVED);
    let products = vec3f(center.x * center.y, center.y * center.z, center.z * center.x);
    return CellRows(
        Derivatives(center, products, body.cell_scale),
        shape.w,
        four_of(at + 6u),
        strain_weight,
        array<f32, 8>(first.x, first.y, first.z, first.w, last.x, last.y, last.z, last.w),
        kept,
        1.0 + body.cell_viscosity * kept,
    );
}

fn load_forces(at: u32) -> CellForces {
    let state = at + CELL_STATE + 2u;
    let a = four_of(state);
    let b = four_of(state + 2u);
    let c = four_of(state + 4u);
    let d = four_of(state + 6u);
    let e = pair_of(state + 8u);
    return CellForces(
        a.xyz,
        vec3f(a.w, b.xy),
        array<vec3f, 4>(vec3f(b.zw, c.x), c.yzw, d.xyz, vec3f(d.w, e)),
    );
}

fn store_forces(at: u32, forces: CellForces) {
    let to = at + CELL_STATE + 2u;
    let h = forces.hourglass;
    store_pair(to, forces.stress.xy);
    store_pair(to + 1u, vec2f(forces.stress.z, forces.shear.x));
    store_pair(to + 2u, forces.shear.yz);
    store_pair(to + 3u, h[0].xy);
    store_pair(to + 4u, vec2f(h[0].z, h[1].x));
    store_pair(to + 5u, h[1].yz);
    store_pair(to + 6u, h[2].xy);
    store_pair(to + 7u, vec2f(h[2].z, h[3].x));
    store_pair(to + 8u, h[3].yz);
}

// Adds forces to those of a node [N], which the next prediction repeats.
fn add_node_force(node: u32, force: vec3f) {
    let at = first_vertex + node;
    motions[at].correction = vec4f(motions[at].correction.xyz + force, 0.0);
}

// Projects the cell at an entry, and adds its forces to those of nodes.
fn project_cell(at: u32, body: Body) {
    var nodes = nodes_of(at);
    let x0 = load_x(nodes[0]);
    let d0 = load_d(nodes[0]);
    var x: array<vec3f, 8>;
    var w: array<f32, 8>;
    w[0] = x0.w;
    for (var i = 1u; i < 8u; i++) {
        let xi = load_x(nodes[i]);
        x[i] = difference(x0, d0, xi, load_d(nodes[i]));
        w[i] = xi.w;
    }
    var rows = load_rows(at, body);
    var deformation: CellDeformation;
    deformation.modes = to_modes(x);
    let f = gradient(rows.derivatives, deformation.modes);
    let q = nearest_rotation(f, four_of(at + CELL_STATE));
    let r = rotation_matrix(q);
    deformation.r = r;
    deformation.stretch = vec3f(
        dot_product(r[0], f[0]),
        dot_product(r[1], f[1]),
        dot_product(r[2], f[2]),
    );
    deformation.beside = 0.5 * vec3f(
        dot_product(r[0], f[1]) + dot_product(r[1], f[0]),
        dot_product(r[1], f[2]) + dot_product(r[2], f[1]),
        dot_product(r[2], f[0]) + dot_product(r[0], f[2]),
    );
    var forces = scaled_forces(load_forces(at), body.cell_square);
    var applied = solve_rows(&rows, &forces, &deformation, body);
    var impulses = to_nodes(free_of_torque(&rows, &applied, &deformation));
    forces = scaled_forces(forces, 1.0 / body.cell_square);
    var repeated = repeated_forces(&rows, forces, r);
    for (var i = 0u; i < 8u; i++) {
        store_d(nodes[i], load_d(nodes[i]) + w[i] * impulses[i]);
        add_node_force(nodes[i], repeated[i]);
    }
    store_pair(at + CELL_STATE, q.xy);
    store_pair(at + CELL_STATE + 1u, q.zw);
    store_forces(at, forces);
}

// Adds the forces of the cell at an entry, which the next prediction repeats, to those of nodes.
fn add_cell_forces(at: u32, body: Body) {
    var nodes = nodes_of(at);
    var rows = load_rows(at, body);
    let r = rotation_matrix(four_of(at + CELL_STATE));
    var repeated = repeated_forces(&rows, load_forces(at), r);
    for (var i = 0u; i < 8u; i++) {
        add_node_force(nodes[i], repeated[i]);
    }
}
