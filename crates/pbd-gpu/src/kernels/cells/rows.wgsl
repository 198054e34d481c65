// WGSL counterpart of `rows.rs`. Matrices are lists of columns.

// Forces of the rows of a cell in its frame: stress times volume by xx, yy and zz, then xy, yz and
// zx, and those of the hourglass modes.
struct CellForces {
    stress: vec3f,
    shear: vec3f,
    hourglass: array<vec3f, 4>,
}

// The rows of a cell, relative to a full one.
struct CellRows {
    derivatives: Derivatives,
    fraction: f32,
    bending: vec4f,
    strain_weight: f32,
    mode_weights: array<f32, 8>,
    // Share of the forces that the next prediction repeats.
    kept: f32,
    // Factor of changes of forces, by viscosity.
    viscous: f32,
}

// The symmetric stretch R^T F of a cell, the modes of its positions, and its rotation.
struct CellDeformation {
    stretch: vec3f,
    beside: vec3f,
    modes: array<vec3f, 8>,
    r: mat3x3f,
}

// Returns forces times a factor.
fn scaled_forces(forces: CellForces, by: f32) -> CellForces {
    let h = forces.hourglass;
    return CellForces(
        by * forces.stress,
        by * forces.shear,
        array<vec3f, 4>(by * h[0], by * h[1], by * h[2], by * h[3]),
    );
}

// Returns the symmetric matrix of a stress.
fn stress_matrix(forces: CellForces) -> mat3x3f {
    let a = forces.stress;
    let b = forces.shear;
    return mat3x3f(vec3f(a.x, b.x, b.z), vec3f(b.x, a.y, b.y), vec3f(b.z, b.y, a.z));
}

// Returns a vector in the frame of a cell.
fn in_frame(v: vec3f, r: mat3x3f) -> vec3f {
    return vec3f(dot_product(r[0], v), dot_product(r[1], v), dot_product(r[2], v));
}

// Returns the impulses of a stress on the modes, along the axes of space.
fn stress_impulses(by: Derivatives, stress: mat3x3f, r: mat3x3f) -> array<vec3f, 8> {
    let along = mat3x3f(
        (r[0] * stress[0].x + r[1] * stress[0].y) + r[2] * stress[0].z,
        (r[0] * stress[1].x + r[1] * stress[1].y) + r[2] * stress[1].z,
        (r[0] * stress[2].x + r[1] * stress[2].y) + r[2] * stress[2].z,
    );
    return transposed(by, along);
}

// Returns the impulses of a stress and of the forces of hourglass modes on all modes.
fn cell_impulses(
    by: Derivatives,
    stress: mat3x3f,
    forces: array<vec3f, 4>,
    r: mat3x3f,
) -> array<vec3f, 8> {
    var modes = stress_impulses(by, stress, r);
    var hourglass = HOURGLASS;
    var list = forces;
    for (var h = 0u; h < 4u; h++) {
        let force = list[h];
        let along = (r[0] * force.x + r[1] * force.y) + r[2] * force.z;
        modes[hourglass[h]] = modes[hourglass[h]] + 0.125 * along;
    }
    return modes;
}

// Solves the rows for the elastic forces, of which a share acts already, and returns the impulses
// that are to be applied.
fn solve_rows(
    rows: ptr<function, CellRows>,
    forces: ptr<function, CellForces>,
    deformation: ptr<function, CellDeformation>,
    body: Body,
) -> CellForces {
    let shape = body.cell_shape * (*rows).fraction;
    let volume = body.cell_volume * (*rows).fraction;
    let bending = body.cell_hourglass * (*rows).fraction;
    let rest = 1.0 - (*rows).kept;
    let strain = (*deformation).stretch - vec3f(body.cell_unit);
    let stress = (*forces).stress;
    let shear = (*forces).shear;
    let trace = THIRD * ((strain.x + strain.y) + strain.z);
    let pressure = THIRD * ((stress.x + stress.y) + stress.z);
    let weight = (*rows).strain_weight;
    let viscous = (*rows).viscous * weight;
    let by_volume = 1.0 + rest * (volume * weight);
    let by_shape = 1.0 + rest * (shape * weight);
    let mean = (volume * trace + by_volume * pressure) / (1.0 + volume * viscous);
    let divisor = 1.0 + shape * viscous;
    let off = shape * (strain - vec3f(trace)) + by_shape * (stress - vec3f(pressure));
    let change = -(off / divisor + vec3f(mean));
    let beside = -((shape * (*deformation).beside + by_shape * shear) / divisor);
    var applied: CellForces;
    applied.stress = rest * stress + (*rows).viscous * change;
    applied.shear = rest * shear + (*rows).viscous * beside;
    (*forces).stress = stress + change;
    (*forces).shear = shear + beside;
    var coupled = stress_impulses((*rows).derivatives, stress_matrix(applied), (*deformation).r);
    var hourglass = HOURGLASS;
    for (var h = 0u; h < 4u; h++) {
        let m = hourglass[h];
        let stiffness = bending * (*rows).bending[h];
        var bound = (*rows).mode_weights[0];
        for (var n = 0u; n < 4u; n++) {
            if (n != h) {
                bound = bound + abs((*rows).mode_weights[m ^ hourglass[n]]);
            }
        }
        let weight = 0.125 * (stiffness * bound);
        let by_weight = 1.0 + rest * weight;
        let divisor = 1.0 + (*rows).viscous * weight;
        var moved = (*rows).mode_weights[m ^ 1u] * coupled[1];
        for (var n = 2u; n < 8u; n++) {
            moved = moved + (*rows).mode_weights[m ^ n] * coupled[n];
        }
        let mode = in_frame(0.125 * (*deformation).modes[m] + moved, (*deformation).r);
        let force = (*forces).hourglass[h];
        let change = -((stiffness * mode + by_weight * force) / divisor);
        applied.hourglass[h] = rest * force + (*rows).viscous * change;
        (*forces).hourglass[h] = force + change;
    }
    return applied;
}

// Returns the impulses of forces on the modes, along the axes of space, without torque.
fn free_of_torque(
    rows: ptr<function, CellRows>,
    forces: ptr<function, CellForces>,
    deformation: ptr<function, CellDeformation>,
) -> array<vec3f, 8> {
    let stretch = (*deformation).stretch;
    let beside = (*deformation).beside;
    var torque = commutator(stretch, beside, (*forces).stress, (*forces).shear);
    var hourglass = HOURGLASS;
    for (var h = 0u; h < 4u; h++) {
        let mode = in_frame((*deformation).modes[hourglass[h]], (*deformation).r);
        torque = torque + 0.125 * cross_product(mode, (*forces).hourglass[h]);
    }
    let spin = spin_against(torque, stretch, beside);
    var stress = stress_matrix(*forces);
    stress[1].z += spin.x;
    stress[2].y -= spin.x;
    stress[2].x += spin.y;
    stress[0].z -= spin.y;
    stress[0].y += spin.z;
    stress[1].x -= spin.z;
    return cell_impulses((*rows).derivatives, stress, (*forces).hourglass, (*deformation).r);
}

// Returns the forces at the nodes that the next prediction repeats.
fn repeated_forces(
    rows: ptr<function, CellRows>,
    forces: CellForces,
    r: mat3x3f,
) -> array<vec3f, 8> {
    let kept = scaled_forces(forces, (*rows).kept);
    let by = (*rows).derivatives;
    return to_nodes(cell_impulses(by, stress_matrix(kept), kept.hourglass, r));
}
