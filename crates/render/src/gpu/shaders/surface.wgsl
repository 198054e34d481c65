// Triangles of a body, their corners looked up in storage buffers: a facet's normal comes from where its corners are
// now, whoever moved them there. uniforms.rs has the same struct.
struct Body {
    // The light of a triangle's inner side, and how much of it is its own.
    inside: vec4<f32>,
    // Where vertex 0 is in `positions`.
    first_vertex: u32,
    pad_a: u32,
    pad_b: u32,
    pad_c: u32,
}

@group(1) @binding(0) var<uniform> body: Body;
@group(1) @binding(1) var<storage, read> positions: array<vec4<f32>>;
@group(1) @binding(2) var<storage, read> corners: array<u32>;
@group(1) @binding(3) var<storage, read> colors: array<u32>;

struct Facet {
    @builtin(position) @invariant position: vec4<f32>,
    // Three numbers that are 0 on an edge each and 1 on the corner across.
    @location(0) place: vec3<f32>,
    @location(1) @interpolate(flat) normal: vec3<f32>,
    @location(2) @interpolate(flat) color: u32,
}

fn corner(i: u32) -> vec3<f32> {
    return positions[body.first_vertex + corners[i]].xyz;
}

@vertex
fn surface_vertex(@builtin(vertex_index) i: u32) -> Facet {
    let triangle = i / 3u;
    let side = i % 3u;
    var out: Facet;
    out.color = colors[triangle];
    out.place = vec3<f32>(vec3<u32>(side) == vec3<u32>(0u, 1u, 2u));
    // A triangle without alpha is not there: all corners in one place leave nothing to draw.
    out.position = vec4<f32>(0.0, 0.0, 0.0, 1.0);
    if out.color < 0x1000000u {
        return out;
    }
    let a = corner(3u * triangle);
    let b = corner(3u * triangle + 1u);
    let c = corner(3u * triangle + 2u);
    // Scaled first, so that the product of short edges is not nothing.
    let size = max(length(b - a), length(c - a));
    out.normal = cross((b - a) / size, (c - a) / size);
    // Neighbors must have the very same corner, or background shows between them.
    out.position = to_clip(select(select(c, b, side == 1u), a, side == 0u));
    return out;
}

// How much of a pixel lies on the triangle's edges, by their distances in pixels. Where triangles are a few pixels
// large there is nothing but edges, so they fade there.
fn edges(place: vec3<f32>) -> f32 {
    let dx = dpdx(place);
    let dy = dpdy(place);
    let distance = place / max(sqrt(dx * dx + dy * dy), vec3<f32>(1e-9));
    let nearest = min(min(distance.x, distance.y), distance.z);
    // Either side of an edge draws its half of it.
    let line = clamp(0.5 * view.wire_width + 0.5 - nearest, 0.0, 1.0);
    let size = sqrt(0.5 / max(abs(dx.x * dy.y - dx.y * dy.x), 1e-9));
    return line * smoothstep(1.0, 9.0, size);
}

@fragment
fn surface_fragment(in: Facet, @builtin(front_facing) is_front: bool) -> @location(0) vec4<f32> {
    // Derivatives first, since they need all pixels beside each other.
    let line = edges(in.place) * view.wire.a;
    let own = to_light(unpack4x8unorm(in.color)).rgb;
    let base = select(mix(own, body.inside.rgb, body.inside.a), own, is_front);
    let normal = normalize(in.normal) * select(-1.0, 1.0, is_front);
    let light = view.sky.w * (0.7 + 0.3 * dot(normal, view.sky.xyz))
        + view.key.w * max(dot(normal, view.key.xyz), 0.0)
        + view.fill.w * max(dot(normal, view.fill.xyz), 0.0);
    // No more light than the picture takes, or edges on bright facets would be thinner.
    let lit = min(base * light, vec3<f32>(1.0));
    return output(mix(lit, view.wire.rgb, line), 1.0);
}
