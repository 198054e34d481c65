// The background: one triangle that covers the image.
struct BackgroundVertex {
    @builtin(position) position: vec4<f32>,
    // 0 at the upper edge, 1 at the lower edge.
    @location(0) down: f32,
}

@vertex
fn background_vertex(@builtin(vertex_index) i: u32) -> BackgroundVertex {
    let x = select(-1.0, 3.0, i == 1u);
    let y = select(-1.0, 3.0, i == 2u);
    return BackgroundVertex(vec4<f32>(x, y, 0.0, 1.0), 0.5 - 0.5 * y);
}

@fragment
fn background_fragment(in: BackgroundVertex) -> @location(0) vec4<f32> {
    // Interpolated in perceptual space: in linear light the lighter color would dominate.
    let mixed = mix(sqrt(view.top.rgb), sqrt(view.bottom.rgb), clamp(in.down, 0.0, 1.0));
    return output(mixed * mixed, 1.0);
}
