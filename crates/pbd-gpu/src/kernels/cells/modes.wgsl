// WGSL counterpart of `modes.rs`. A vector holds the three axes of a node or of a mode.

// The hourglass modes: xy, yz, zx and xyz.
const HOURGLASS = array(3u, 6u, 5u, 7u);

// Returns all modes of a vector at the nodes. One step for each axis: x, y and z.
fn to_modes(x: array<vec3f, 8>) -> array<vec3f, 8> {
    let a = array<vec3f, 8>(
        x[0] + x[1],
        x[1] - x[0],
        x[2] + x[3],
        x[3] - x[2],
        x[4] + x[5],
        x[5] - x[4],
        x[6] + x[7],
        x[7] - x[6],
    );
    let b = array<vec3f, 8>(
        a[0] + a[2],
        a[1] + a[3],
        a[2] - a[0],
        a[3] - a[1],
        a[4] + a[6],
        a[5] + a[7],
        a[6] - a[4],
        a[7] - a[5],
    );
    return array<vec3f, 8>(
        b[0] + b[4],
        b[1] + b[5],
        b[2] + b[6],
        b[3] + b[7],
        b[4] - b[0],
        b[5] - b[1],
        b[6] - b[2],
        b[7] - b[3],
    );
}

// Returns the vector at each node, given the factors of all modes.
fn to_nodes(x: array<vec3f, 8>) -> array<vec3f, 8> {
    let a = array<vec3f, 8>(
        x[0] - x[1],
        x[0] + x[1],
        x[2] - x[3],
        x[2] + x[3],
        x[4] - x[5],
        x[4] + x[5],
        x[6] - x[7],
        x[6] + x[7],
    );
    let b = array<vec3f, 8>(
        a[0] - a[2],
        a[1] - a[3],
        a[0] + a[2],
        a[1] + a[3],
        a[4] - a[6],
        a[5] - a[7],
        a[4] + a[6],
        a[5] + a[7],
    );
    return array<vec3f, 8>(
        b[0] - b[4],
        b[1] - b[5],
        b[2] - b[6],
        b[3] - b[7],
        b[0] + b[4],
        b[1] + b[5],
        b[2] + b[6],
        b[3] + b[7],
    );
}

// Derivatives of the modes at the centroid of the part in a cell.
struct Derivatives {
    // The centroid from the cell's center [half cells], and the products xy, yz and zx.
    center: vec3f,
    products: vec3f,
    // One by four cell sizes [1/m].
    scale: f32,
}

// Returns the gradient of vectors with given modes; its columns are the derivatives by axis.
fn gradient(by: Derivatives, m: array<vec3f, 8>) -> mat3x3f {
    let c = by.center;
    let p = by.products;
    return mat3x3f(
        by.scale * ((m[1] + c.y * m[3]) + (c.z * m[5] + p.y * m[7])),
        by.scale * ((m[2] + c.x * m[3]) + (c.z * m[6] + p.z * m[7])),
        by.scale * ((m[4] + c.x * m[5]) + (c.y * m[6] + p.x * m[7])),
    );
}

// Returns the factors of modes whose sum with the modes is the sum of `along` times the gradient:
// the transpose of gradient().
fn transposed(by: Derivatives, along: mat3x3f) -> array<vec3f, 8> {
    let center = by.center;
    let p = by.products;
    let a = by.scale * along[0];
    let b = by.scale * along[1];
    let c = by.scale * along[2];
    return array<vec3f, 8>(
        vec3f(),
        a,
        b,
        center.y * a + center.x * b,
        c,
        center.z * a + center.x * c,
        center.z * b + center.y * c,
        (p.y * a + p.z * b) + p.x * c,
    );
}
