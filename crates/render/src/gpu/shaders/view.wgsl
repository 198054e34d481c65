// View uniforms shared by all shaders; `uniforms.rs` has the same struct.
struct View {
    // Matrix from points relative to `origin` to clip space. The origin is close to the target, so
    // that precision does not depend on the distance from the world's origin.
    clip: mat4x4<f32>,
    origin: vec4<f32>,
    // Direction toward each light and its strength.
    key: vec4<f32>,
    fill: vec4<f32>,
    sky: vec4<f32>,
    // Linear colors.
    top: vec4<f32>,
    bottom: vec4<f32>,
    wire: vec4<f32>,
    viewport: vec2<f32>,
    wire_width: f32,
    // 1 if the output must be encoded as sRGB.
    encode: u32,
}

@group(0) @binding(0) var<uniform> view: View;

fn to_clip(p: vec3<f32>) -> vec4<f32> {
    return view.clip * vec4<f32>(p - view.origin.xyz, 1.0);
}

// Converts an sRGB color to linear light.
fn to_light(color: vec4<f32>) -> vec4<f32> {
    let low = color.rgb / 12.92;
    let high = pow((color.rgb + 0.055) / 1.055, vec3<f32>(2.4));
    return vec4<f32>(select(high, low, color.rgb <= vec3<f32>(0.04045)), color.a);
}

// Converts linear light to the values of the output texture.
fn output(light: vec3<f32>, alpha: f32) -> vec4<f32> {
    let c = clamp(light, vec3<f32>(0.0), vec3<f32>(1.0));
    if view.encode == 0u {
        return vec4<f32>(c, alpha);
    }
    let high = 1.055 * pow(c, vec3<f32>(1.0 / 2.4)) - 0.055;
    return vec4<f32>(select(high, 12.92 * c, c <= vec3<f32>(0.0031308)), alpha);
}
