// What every kernel sees: the arenas that all bodies share, and the numbers of a frame and of a pass.
// The structs have twins in layout.rs; names in capital letters come from there too and are written in
// front of this file by shaders.rs.

struct Frame {
    gravity_step: vec3f,
    h: f32,
    ground: f32,
    has_ground: u32,
    substeps: u32,
    iterations: u32,
    notes_motion: u32,
    own_weight: f32,
    pad_0: u32,
    pad_1: u32,
}

struct Pass {
    first_link: u32,
    links: u32,
    kind: u32,
    color: u32,
    colors: u32,
    with_overflow: u32,
    substep: u32,
    pad: u32,
}

struct Body {
    first_vertex: u32,
    vertices: u32,
    first_pin: u32,
    pins: u32,
    first_tether: u32,
    tethers: u32,
    stretch_factor: f32,
    stretch_alpha: f32,
    stretch_old: f32,
    bending_factor: f32,
    bending_alpha: f32,
    bending_old: f32,
    kept_velocity: f32,
    friction: f32,
    flags: u32,
    first_run: u32,
    stretch_colors: u32,
    bending_colors: u32,
    patch_tables: array<u32, 3>,
    patches: array<u32, 3>,
    first_piece: u32,
    pieces: u32,
    first_chunk: u32,
    chunks: u32,
    first_spoke: u32,
    first_corner: u32,
    corners: u32,
    volume_alpha: f32,
    volume_pressure: f32,
    volume_returned: f32,
    volume_old: f32,
    strut_colors: u32,
    strut_factor: f32,
    strut_alpha: f32,
    strut_old: f32,
    contacts: u32,
    first_collider: u32,
    colliders: u32,
}

struct Run {
    first: u32,
    len: u32,
}

struct Link {
    first_group: u32,
    body: u32,
}

struct Report {
    lowest: array<atomic<u32>, 2>,
    box_min: array<atomic<u32>, 3>,
    box_max: array<atomic<u32>, 3>,
    bad_vertex: atomic<u32>,
    bad_substep: atomic<u32>,
    farthest: atomic<u32>,
    pad_0: u32,
}

// A stiffness as the kernels use it.
struct Projection {
    factor: f32,
    alpha: f32,
    keeps: bool,
    hold: f32,
    old: f32,
    own_weight: f32,
}

// Position [m], inverse mass [1/kg]: 0 does not move, -1 is a slot that no triangle uses.
@group(0) @binding(0) var<storage, read_write> positions: array<vec4f>;
@group(0) @binding(1) var<storage, read_write> velocities: array<vec4f>;
// A stretch constraint or a strut is 2 entries: (a, b), (rest, multiplier). A bending constraint is 3:
// (v0, v1), (v2, v3), (rest, multiplier). A pin is 2: (vertex, x), (y, z). A tether is 2: (vertex, anchor),
// (length, 0). A piece is 4: (first chunk, chunks), (rest, reach), (multiplier, step), (center, 0). A chunk is 4:
// (first spoke, spokes), (piece, 0), its four sums. A spoke is (vertex, half-edge), a corner (origin, twin), a contact 6 as in contacts.rs, a collider 8 as in colliders.rs. Vertices count from the body's first one; numbers are stored as their bits.
@group(0) @binding(3) var<storage, read_write> constraints: array<vec2u>;
@group(0) @binding(4) var<storage, read> bodies: array<Body>;
@group(0) @binding(5) var<storage, read> runs: array<Run>;
@group(0) @binding(6) var<storage, read> links: array<Link>;
@group(0) @binding(7) var<storage, read_write> reports: array<Report>;

@group(1) @binding(0) var<uniform> frame: Frame;
@group(1) @binding(1) var<uniform> current: Pass;

// Where the vertices of the body at hand begin; an entry point sets it before it calls a kernel.
var<private> first_vertex: u32;

// Number of the substep in its frame; an entry point sets it before it looks at contacts.
var<private> substep_at: u32;

// Where b is as seen from a [m]: the twin of block.rs.
fn difference(xa: vec4f, da: vec3f, xb: vec4f, db: vec3f) -> vec3f {
    return (xb.xyz - xa.xyz) + (db - da);
}

fn stretch_projection(body: Body) -> Projection {
    let keeps = (body.flags & KEEPS_STRETCH) != 0u;
    return Projection(body.stretch_factor, body.stretch_alpha, keeps, 0.0, body.stretch_old, frame.own_weight);
}

// See struts.rs.
const STRUT_OWN_WEIGHT: f32 = 10.0;

// Of edges of the surface or through the body.
fn edge_projection(body: Body, kind: u32) -> Projection {
    if (kind == STRETCH) {
        return stretch_projection(body);
    }
    let keeps = (body.flags & KEEPS_STRUTS) != 0u;
    return Projection(body.strut_factor, body.strut_alpha, keeps, 0.0, body.strut_old, STRUT_OWN_WEIGHT);
}

fn bending_projection(body: Body) -> Projection {
    let keeps = (body.flags & KEEPS_BENDING) != 0u;
    let hold = HOLD / body.stretch_alpha;
    let held = select(FIRM, hold, hold < FIRM);
    return Projection(body.bending_factor, body.bending_alpha, keeps, held, body.bending_old, frame.own_weight);
}

fn colors_of(body: Body, kind: u32) -> u32 {
    if (kind == CONTACTS) {
        return select(0u, MAX_COLORS, body.contacts != 0u);
    }
    return select(select(body.strut_colors, body.bending_colors, kind == BENDING), body.stretch_colors, kind == STRETCH);
}

// The run of a color, or of OVERFLOW. A pass may go on to colors that only other bodies have; what the
// body's table holds there is not the body's.
fn run_of(body: Body, kind: u32, color: u32) -> Run {
    if (color >= colors_of(body, kind) && color != OVERFLOW) {
        return Run(0u, 0u);
    }
    return runs[body.first_run + kind * RUN_COLORS + color];
}
