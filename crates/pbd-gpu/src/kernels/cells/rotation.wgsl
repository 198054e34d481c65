// WGSL counterpart of `rotation.rs`. Matrices are lists of columns.

// Returns the matrix of a unit quaternion w, x, y, z.
fn rotation_matrix(q: vec4f) -> mat3x3f {
    let w = q.x;
    let x = q.y;
    let y = q.z;
    let z = q.w;
    return mat3x3f(
        vec3f(1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)),
        vec3f(2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x)),
        vec3f(2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)),
    );
}

// Returns the quaternion of the rotation nearest to `f`, from the last one.
fn nearest_rotation(f: mat3x3f, last: vec4f) -> vec4f {
    var q = last;
    for (var i = 0u; i < MAX_ROTATION_ITERATIONS; i++) {
        let turn = next_turn(f, rotation_matrix(q));
        let square = (turn.x * turn.x + turn.y * turn.y) + turn.z * turn.z;
        if (square < CONVERGED_TURN) {
            break;
        }
        let by = select(0.5, 0.5 / sqrt(square), square > MAX_CELL_TURN);
        q = turned(q, by * turn);
        if (square < LAST_TURN) {
            break;
        }
    }
    return q;
}

// Returns the next turn from a rotation toward a deformation gradient [rad].
fn next_turn(f: mat3x3f, r: mat3x3f) -> vec3f {
    let y = mat3x3f(
        (f[0] * r[0].x + f[1] * r[1].x) + f[2] * r[2].x,
        (f[0] * r[0].y + f[1] * r[1].y) + f[2] * r[2].y,
        (f[0] * r[0].z + f[1] * r[1].z) + f[2] * r[2].z,
    );
    let axial = vec3f(y[1].z - y[2].y, y[2].x - y[0].z, y[0].y - y[1].x);
    let a = y[1].y + y[2].z;
    let b = y[0].x + y[2].z;
    let c = y[0].x + y[1].y;
    let ab = -0.5 * (y[1].x + y[0].y);
    let bc = -0.5 * (y[2].y + y[1].z);
    let ca = -0.5 * (y[0].z + y[2].x);
    // Cofactors of the symmetric matrix [[a, ab, ca], [ab, b, bc], [ca, bc, c]].
    let first = vec3f(b * c - bc * bc, bc * ca - ab * c, ab * bc - b * ca);
    let second = a * c - ca * ca;
    let mixed = ab * ca - a * bc;
    let third = a * b - ab * ab;
    let determinant = (a * first.x + ab * first.y) + ca * first.z;
    let is_positive = a > MIN_FIRST_MINOR
        && first.x > MIN_SECOND_MINOR
        && third > MIN_SECOND_MINOR
        && determinant > MIN_THIRD_MINOR;
    if (is_positive) {
        let inverse = 1.0 / determinant;
        return inverse * vec3f(
            (first.x * axial.x + first.y * axial.y) + first.z * axial.z,
            (first.y * axial.x + second * axial.y) + mixed * axial.z,
            (first.z * axial.x + mixed * axial.y) + third * axial.z,
        );
    }
    return axial / (abs((y[0].x + y[1].y) + y[2].z) + FLAT_CELL);
}

// Returns a quaternion turned by twice a vector [rad], with length 1.
fn turned(last: vec4f, by: vec3f) -> vec4f {
    let w = last.x;
    let x = last.y;
    let y = last.z;
    let z = last.w;
    let q = vec4f(
        w - ((by.x * x + by.y * y) + by.z * z),
        (x + by.x * w) + (by.y * z - by.z * y),
        (y + by.y * w) + (by.z * x - by.x * z),
        (z + by.z * w) + (by.x * y - by.y * x),
    );
    let square = (q.x * q.x + q.y * q.y) + (q.z * q.z + q.w * q.w);
    return q / sqrt(square);
}
