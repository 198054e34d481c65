// WGSL counterpart of `modes.rs`. A vector holds the three axes of a node or of a mode.

// The hourglass modes: xy, yz, zx and xyz.
const HOURGLASS = array(3u, 6u, 5u, 7u);

// Returns all modes of a vector at the nodes.
fn to_modes(nodes: array<vec3f, 8>) -> array<vec3f, 8> {
    var values = nodes;
    for (var axis = 1u; axis < 8u; axis *= 2u) {
        for (var low = 0u; low < 8u; low++) {
            if ((low & axis) == 0u) {
                let a = values[low];
                let b = values[low | axis];
                values[low] = a + b;
                values[low | axis] = b - a;
            }
        }
    }
    return values;
}

// Returns the vector at each node, given the factors of all modes.
fn to_nodes(modes: array<vec3f, 8>) -> array<vec3f, 8> {
    var values = modes;
    for (var axis = 1u; axis < 8u; axis *= 2u) {
        for (var low = 0u; low < 8u; low++) {
            if ((low & axis) == 0u) {
                let a = values[low];
                let b = values[low | axis];
                values[low] = a - b;
                values[low | axis] = a + b;
            }
        }
    }
    return values;
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
