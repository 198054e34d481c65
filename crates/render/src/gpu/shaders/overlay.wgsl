// Translucent sheets and lines over everything that is behind them.

// How much nearer they are taken than they are: a sheet that lies in a surface, as a blade's sweep lies in the cap that it
// left, is seen before it, whole and from both sides.
const LIFT: f32 = 2e-3;

struct Veil {
    // A sheet in a surface covers the same pixels, though other shaders draw it.
    @builtin(position) @invariant position: vec4<f32>,
    @location(0) color: vec4<f32>,
}

fn lifted(clip: vec4<f32>) -> vec4<f32> {
    return vec4<f32>(clip.xy, clip.z * (1.0 + LIFT), clip.w);
}

@vertex
fn sheet_vertex(@location(0) position: vec3<f32>, @location(1) color: vec4<f32>) -> Veil {
    return Veil(lifted(to_clip(position)), to_light(color));
}

// What there is of a line in front of the eye: depth is 1 where w is as large as z.
fn clipped(end: vec4<f32>, other: vec4<f32>) -> vec4<f32> {
    let near = end.z * (1.0 + LIFT);
    if end.w >= near {
        return end;
    }
    return mix(end, other, clamp((near - end.w) / (other.w - end.w), 0.0, 1.0));
}

// A line is a rectangle of two triangles in the picture's plane.
@vertex
fn line_vertex(
    @builtin(vertex_index) i: u32,
    @location(0) start: vec3<f32>,
    @location(1) end: vec3<f32>,
    @location(2) color: vec4<f32>,
    @location(3) width: f32,
) -> Veil {
    let is_end = i == 1u || i == 2u || i == 4u;
    let is_left = i == 2u || i == 4u || i == 5u;
    let a = clipped(to_clip(start), to_clip(end));
    let b = clipped(to_clip(end), to_clip(start));
    let way = (b.xy / b.w - a.xy / a.w) * view.viewport;
    let along = way / max(length(way), 1e-6);
    let across = vec2<f32>(-along.y, along.x) * select(-1.0, 1.0, is_left);
    var at = a;
    if is_end {
        at = b;
    }
    at = vec4<f32>(at.xy + across * width / view.viewport * at.w, at.zw);
    return Veil(lifted(at), to_light(color));
}

@fragment
fn overlay_fragment(in: Veil) -> @location(0) vec4<f32> {
    return output(in.color.rgb, in.color.a);
}
