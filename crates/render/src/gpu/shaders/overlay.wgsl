// Translucent triangles and lines.

// Relative depth bias toward the camera. An overlay triangle that lies in a surface, such as a
// blade's sweep in the section that it cut, is visible from both sides.
const DEPTH_BIAS: f32 = 2e-3;

struct OverlayVertex {
    // Invariant: a triangle that lies in a surface covers the same pixels as the surface.
    @builtin(position) @invariant position: vec4<f32>,
    @location(0) color: vec4<f32>,
}

fn biased(clip: vec4<f32>) -> vec4<f32> {
    return vec4<f32>(clip.xy, clip.z * (1.0 + DEPTH_BIAS), clip.w);
}

@vertex
fn triangle_vertex(
    @location(0) position: vec3<f32>,
    @location(1) color: vec4<f32>,
) -> OverlayVertex {
    return OverlayVertex(biased(to_clip(position)), to_light(color));
}

// Clips one end of a line against the near plane, where z equals w.
fn clipped(end: vec4<f32>, other: vec4<f32>) -> vec4<f32> {
    let near = end.z * (1.0 + DEPTH_BIAS);
    if end.w >= near {
        return end;
    }
    return mix(end, other, clamp((near - end.w) / (other.w - end.w), 0.0, 1.0));
}

// A line is a rectangle of two triangles in screen space.
@vertex
fn line_vertex(
    @builtin(vertex_index) i: u32,
    @location(0) start: vec3<f32>,
    @location(1) end: vec3<f32>,
    @location(2) color: vec4<f32>,
    @location(3) width: f32,
) -> OverlayVertex {
    let is_end = i == 1u || i == 2u || i == 4u;
    let is_left = i == 2u || i == 4u || i == 5u;
    let a = clipped(to_clip(start), to_clip(end));
    let b = clipped(to_clip(end), to_clip(start));
    let segment = (b.xy / b.w - a.xy / a.w) * view.viewport;
    let along = segment / max(length(segment), 1e-6);
    let across = vec2<f32>(-along.y, along.x) * select(-1.0, 1.0, is_left);
    var at = a;
    if is_end {
        at = b;
    }
    at = vec4<f32>(at.xy + across * width / view.viewport * at.w, at.zw);
    return OverlayVertex(biased(at), to_light(color));
}

@fragment
fn overlay_fragment(in: OverlayVertex) -> @location(0) vec4<f32> {
    return output(in.color.rgb, in.color.a);
}
