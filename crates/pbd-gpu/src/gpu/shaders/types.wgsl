// Declarations shared by all kernels: the arenas of all bodies and the parameters of a frame and of
// a pass. `layout.rs` declares their structs, `constants.rs` the constants in capital letters.

// Coefficients of one projection, as in constants.rs.
struct Projection {
    factor: f32,
    alpha: f32,
    accumulates_lambda: bool,
    edge_stiffness: f32,
    diagonal_scale: f32,
}

// Position [m] and inverse mass [1/kg], 0 for pinned vertices, -1 for unused slots.
@group(0) @binding(0) var<storage, read_write> positions: array<vec4f>;
@group(0) @binding(1) var<storage, read_write> motions: array<Motion>;
// Records of several entries each, with floats as bits and vertices relative to the body:
// - stretch constraint, interior spring: (a, b), (rest, multiplier)
// - bending constraint: (v0, v1), (v2, v3), (rest, multiplier)
// - pin: (vertex, x), (y, z)
// - long range attachment: (vertex, anchor), (length, 0)
// - piece: (first chunk, chunks), (rest, reach), (multiplier, step), (center, step of positions),
//   mean displacement and number of the round, motion of the round and 0
// - chunk: (first spoke, spokes), (piece, 0), then four sums, then four sums of the motion
// - spoke: (vertex, half-edge)
// - corner: (origin, twin)
// - contact: CONTACT_ENTRIES entries as in contacts.rs
// - collider: COLLIDER_ENTRIES entries as in colliders.rs
// - cell: CELL_ENTRIES entries as in cells.wgsl
// - vertex of a solid: EMBEDDING_ENTRIES entries as in points.wgsl
@group(0) @binding(3) var<storage, read_write> constraints: array<vec2u>;
@group(0) @binding(4) var<storage, read> bodies: array<Body>;
@group(0) @binding(5) var<storage, read> runs: array<Run>;
@group(0) @binding(6) var<storage, read> links: array<Link>;
@group(0) @binding(7) var<storage, read_write> reports: array<Report>;

@group(1) @binding(0) var<uniform> frame: Frame;
@group(1) @binding(1) var<uniform> current: Pass;

// First vertex of the current body; entry points set it before they call a kernel.
var<private> first_vertex: u32;

// Index of the substep in the frame; entry points set it before contacts and colliders.
var<private> substep_index: u32;

// Returns the vector from a to b [m], as in block.rs.
fn difference(xa: vec4f, da: vec3f, xb: vec4f, db: vec3f) -> vec3f {
    return (xb.xyz - xa.xyz) + (db - da);
}

fn norm(v: vec3f) -> f32 {
    return sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
}

// The built-in functions may round in another order.
fn cross_product(a: vec3f, b: vec3f) -> vec3f {
    return vec3f(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

fn dot_product(a: vec3f, b: vec3f) -> f32 {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

fn stretch_projection(body: Body) -> Projection {
    return Projection(
        body.stretch_factor,
        body.stretch_alpha,
        (body.flags & KEEPS_STRETCH) != 0u,
        0.0,
        frame.diagonal_scale,
    );
}

// Returns the coefficients of edges or of interior springs.
fn edge_projection(body: Body, kind: u32) -> Projection {
    if (kind == STRETCH) {
        return stretch_projection(body);
    }
    return Projection(
        body.spring_factor,
        body.spring_alpha,
        (body.flags & KEEPS_INTERIOR_SPRINGS) != 0u,
        0.0,
        SPRING_DIAGONAL_SCALE,
    );
}

fn bending_projection(body: Body) -> Projection {
    let stiffness = HOLD / body.stretch_alpha;
    return Projection(
        body.bending_factor,
        body.bending_alpha,
        (body.flags & KEEPS_BENDING) != 0u,
        select(FIRM, stiffness, stiffness < FIRM),
        frame.diagonal_scale,
    );
}

fn colors_of(body: Body, kind: u32) -> u32 {
    if (kind >= CONTACTS) {
        return select(0u, MAX_COLORS, body.contacts != 0u);
    }
    if (kind == CELLS) {
        return body.cell_colors;
    }
    let others = select(body.spring_colors, body.bending_colors, kind == BENDING);
    return select(others, body.stretch_colors, kind == STRETCH);
}

// Returns the run of a color, or of OVERFLOW. A pass may include colors that only other bodies
// have; their entries in the table of this body are undefined.
fn run_of(body: Body, kind: u32, color: u32) -> Run {
    if (color >= colors_of(body, kind) && color != OVERFLOW) {
        return Run(0u, 0u);
    }
    // All passes over contacts have one list.
    return runs[body.first_run + min(kind, CONTACTS) * RUN_COLORS + color];
}
