// Triangles of a body with vertex pulling and flat shading: the normal of a triangle follows from
// its current positions. `uniforms.rs` has the same struct.
struct Body {
    // Linear color of back faces and its weight.
    back_face: vec4<f32>,
    // Index of vertex 0 in `positions`.
    first_vertex: u32,
    // Squares per unit of texture coordinates; 0 for plain colors.
    checkers: f32,
    pad_a: u32,
    pad_b: u32,
}

// Brightness of the dark squares.
const DARK_SQUARE: f32 = 0.55;

@group(1) @binding(0) var<uniform> body: Body;
@group(1) @binding(1) var<storage, read> positions: array<vec4<f32>>;
@group(1) @binding(2) var<storage, read> corners: array<u32>;
@group(1) @binding(3) var<storage, read> colors: array<u32>;
@group(1) @binding(4) var<storage, read> uvs: array<vec2<f32>>;

struct SurfaceVertex {
    @builtin(position) @invariant position: vec4<f32>,
    @location(0) barycentric: vec3<f32>,
    @location(1) @interpolate(flat) normal: vec3<f32>,
    @location(2) @interpolate(flat) color: u32,
    // Texture coordinates in squares.
    @location(3) square: vec2<f32>,
}

fn corner(i: u32) -> vec3<f32> {
    return positions[body.first_vertex + corners[i]].xyz;
}

@vertex
fn surface_vertex(@builtin(vertex_index) i: u32) -> SurfaceVertex {
    let triangle = i / 3u;
    let side = i % 3u;
    var out: SurfaceVertex;
    out.color = colors[triangle];
    out.barycentric = vec3<f32>(vec3<u32>(side) == vec3<u32>(0u, 1u, 2u));
    // A triangle with alpha 0 is hidden: it degenerates to a point.
    out.position = vec4<f32>(0.0, 0.0, 0.0, 1.0);
    if out.color < 0x1000000u {
        return out;
    }
    if body.checkers > 0.0 {
        out.square = body.checkers * uvs[i];
    }
    let a = corner(3u * triangle);
    let b = corner(3u * triangle + 1u);
    let c = corner(3u * triangle + 2u);
    // Scaled first, so that the cross product of short edges does not underflow.
    let size = max(length(b - a), length(c - a));
    out.normal = cross((b - a) / size, (c - a) / size);
    // Adjacent triangles compute identical corners, so no background shows between them.
    out.position = to_clip(select(select(c, b, side == 1u), a, side == 0u));
    return out;
}

// Coverage of a pixel by the triangle's edges. Edges of triangles of a few pixels fade out.
fn edge_coverage(barycentric: vec3<f32>) -> f32 {
    let dx = dpdx(barycentric);
    let dy = dpdy(barycentric);
    let distance = barycentric / max(sqrt(dx * dx + dy * dy), vec3<f32>(1e-9));
    let nearest = min(min(distance.x, distance.y), distance.z);
    // The two triangles of an edge draw one half each.
    let line = clamp(0.5 * view.wire_width + 0.5 - nearest, 0.0, 1.0);
    let size = sqrt(0.5 / max(abs(dx.x * dy.y - dx.y * dy.x), 1e-9));
    return line * smoothstep(1.0, 9.0, size);
}

// The part of a pixel that light squares cover: a checkerboard under a box filter.
fn light_squares(square: vec2<f32>, width: vec2<f32>) -> f32 {
    let w = max(width, vec2<f32>(1e-6));
    let start = abs(fract((square - 0.5 * w) / 2.0) - 0.5);
    let end = abs(fract((square + 0.5 * w) / 2.0) - 0.5);
    let along = 2.0 * (start - end) / w;
    return 0.5 - 0.5 * along.x * along.y;
}

@fragment
fn surface_fragment(
    in: SurfaceVertex,
    @builtin(front_facing) is_front: bool,
) -> @location(0) vec4<f32> {
    // Derivatives come first: they require uniform control flow.
    let line = edge_coverage(in.barycentric) * view.wire.a;
    let squares = light_squares(in.square, fwidth(in.square));
    let shade = select(1.0, mix(DARK_SQUARE, 1.0, squares), body.checkers > 0.0);
    let color = shade * to_light(unpack4x8unorm(in.color)).rgb;
    let base = select(mix(color, body.back_face.rgb, body.back_face.a), color, is_front);
    let normal = normalize(in.normal) * select(-1.0, 1.0, is_front);
    let light = view.sky.w * (0.7 + 0.3 * dot(normal, view.sky.xyz))
        + view.key.w * max(dot(normal, view.key.xyz), 0.0)
        + view.fill.w * max(dot(normal, view.fill.xyz), 0.0);
    // Clamped, since edges on overexposed triangles would look thinner.
    let lit = min(base * light, vec3<f32>(1.0));
    return output(mix(lit, view.wire.rgb, line), 1.0);
}
