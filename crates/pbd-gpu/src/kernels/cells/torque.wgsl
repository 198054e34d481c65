// WGSL counterpart of `torque.rs`. A symmetric matrix has its entries xx, yy and zz, then xy, yz
// and zx.

// Returns the entries yz, zx and xy of A B - B A, which is skew, of two symmetric matrices.
fn commutator(a: vec3f, a_beside: vec3f, b: vec3f, b_beside: vec3f) -> vec3f {
    let along = b_beside.yzx * (a.yzx - a.zxy) + a_beside.yzx * (b.zxy - b.yzx);
    return along + (a_beside * b_beside.zxy - a_beside.zxy * b_beside);
}

// Returns the axial vector of the skew stress that cancels a torque of a stretched cell.
fn spin_against(torque: vec3f, stretch: vec3f, beside: vec3f) -> vec3f {
    let a = stretch.y + stretch.z;
    let b = stretch.z + stretch.x;
    let c = stretch.x + stretch.y;
    let xy = beside.x;
    let yz = beside.y;
    let zx = beside.z;
    // Of the matrix with the diagonal a, b and c, and -xy, -yz and -zx beside it.
    let adjugate = vec3f(b * c - yz * yz, c * a - zx * zx, a * b - xy * xy);
    let others = vec3f(c * xy + yz * zx, a * yz + zx * xy, b * zx + xy * yz);
    let determinant = (a * adjugate.x - xy * others.x) - zx * others.z;
    let scale = 1.0 / select(1.0, determinant, determinant > 1.0);
    let sum = vec3f(
        (adjugate.x * torque.x + others.x * torque.y) + others.z * torque.z,
        (others.x * torque.x + adjugate.y * torque.y) + others.y * torque.z,
        (others.z * torque.x + others.y * torque.y) + adjugate.z * torque.z,
    );
    return -(scale * sum);
}
