//! The render pipelines for one texture format and sample count.

use super::error_scope::scoped;
use super::overlay::{LINE_ATTRIBUTES, TRIANGLE_ATTRIBUTES};
use super::shaders;
use crate::error::RenderError;
use wgpu::{
    BindGroupLayout, BindGroupLayoutEntry, BindingType, BufferBindingType, CompareFunction, Device,
    RenderPipeline, ShaderStages, TextureFormat, VertexBufferLayout, VertexStepMode,
};

/// Format of the depth buffer.
pub(super) const DEPTH: TextureFormat = TextureFormat::Depth32Float;

/// Render pipelines and their bind group layouts.
#[derive(Debug)]
pub(super) struct Pipelines {
    pub(super) view_layout: BindGroupLayout,
    pub(super) body_layout: BindGroupLayout,
    pub(super) background: RenderPipeline,
    pub(super) surface: RenderPipeline,
    pub(super) overlay_triangles: RenderPipeline,
    pub(super) lines: RenderPipeline,
}

/// The properties in which the pipelines differ.
struct PipelineDescriptor<'a> {
    module: &'a wgpu::ShaderModule,
    layout: &'a wgpu::PipelineLayout,
    /// Entry points of the vertex and the fragment stage.
    stages: [&'static str; 2],
    buffers: &'a [Option<VertexBufferLayout<'a>>],
    /// Depth comparison, and whether depth is written.
    depth: (CompareFunction, bool),
    is_translucent: bool,
}

impl Pipelines {
    pub(super) fn new(
        device: &Device,
        format: TextureFormat,
        samples: u32,
    ) -> Result<Self, RenderError> {
        let view_layout = layout(device, "view", &[uniform(0)])?;
        let [positions, corners, colors, uvs] = [1, 2, 3, 4].map(storage);
        let body = [uniform(0), positions, corners, colors, uvs];
        // Devices without storage buffers in the vertex stage fail here.
        let body_layout = layout(device, "body", &body).map_err(|error| match error {
            RenderError::Validation { message, .. } => RenderError::NoVertexStorage { message },
            other => other,
        })?;
        let create = || {
            let module = |label, source: &'static str| {
                device.create_shader_module(wgpu::ShaderModuleDescriptor {
                    label: Some(label),
                    source: wgpu::ShaderSource::Wgsl(source.into()),
                })
            };
            let layout = |groups: &[Option<&BindGroupLayout>]| {
                device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                    label: None,
                    bind_group_layouts: groups,
                    immediate_size: 0,
                })
            };
            let plain = layout(&[Some(&view_layout)]);
            let with_body = layout(&[Some(&view_layout), Some(&body_layout)]);
            let overlay = module("overlay", shaders::OVERLAY);
            let pipeline = |descriptor: &_| create_pipeline(device, format, samples, descriptor);
            [
                pipeline(&PipelineDescriptor {
                    module: &module("background", shaders::BACKGROUND),
                    layout: &plain,
                    stages: ["background_vertex", "background_fragment"],
                    buffers: &[],
                    depth: (CompareFunction::Always, false),
                    is_translucent: false,
                }),
                pipeline(&PipelineDescriptor {
                    module: &module("surface", shaders::SURFACE),
                    layout: &with_body,
                    stages: ["surface_vertex", "surface_fragment"],
                    buffers: &[],
                    depth: (CompareFunction::Greater, true),
                    is_translucent: false,
                }),
                pipeline(&PipelineDescriptor {
                    module: &overlay,
                    layout: &plain,
                    stages: ["triangle_vertex", "overlay_fragment"],
                    buffers: &[Some(VertexBufferLayout {
                        array_stride: 16,
                        step_mode: VertexStepMode::Vertex,
                        attributes: &TRIANGLE_ATTRIBUTES,
                    })],
                    depth: (CompareFunction::Greater, false),
                    is_translucent: true,
                }),
                pipeline(&PipelineDescriptor {
                    module: &overlay,
                    layout: &plain,
                    stages: ["line_vertex", "overlay_fragment"],
                    buffers: &[Some(VertexBufferLayout {
                        array_stride: 32,
                        step_mode: VertexStepMode::Instance,
                        attributes: &LINE_ATTRIBUTES,
                    })],
                    depth: (CompareFunction::Greater, false),
                    is_translucent: true,
                }),
            ]
        };
        let [background, surface, overlay_triangles, lines] =
            scoped(device, "creating pipelines", create)?;
        Ok(Self {
            view_layout,
            body_layout,
            background,
            surface,
            overlay_triangles,
            lines,
        })
    }
}

fn layout(
    device: &Device,
    label: &'static str,
    entries: &[BindGroupLayoutEntry],
) -> Result<BindGroupLayout, RenderError> {
    scoped(device, "creating a bind group layout", || {
        device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some(label),
            entries,
        })
    })
}

fn uniform(binding: u32) -> BindGroupLayoutEntry {
    let stages = ShaderStages::VERTEX_FRAGMENT;
    entry(binding, stages, BufferBindingType::Uniform)
}

fn storage(binding: u32) -> BindGroupLayoutEntry {
    let kind = BufferBindingType::Storage { read_only: true };
    entry(binding, ShaderStages::VERTEX, kind)
}

fn entry(binding: u32, visibility: ShaderStages, ty: BufferBindingType) -> BindGroupLayoutEntry {
    BindGroupLayoutEntry {
        binding,
        visibility,
        ty: BindingType::Buffer {
            ty,
            has_dynamic_offset: false,
            min_binding_size: None,
        },
        count: None,
    }
}

fn create_pipeline(
    device: &Device,
    format: TextureFormat,
    samples: u32,
    descriptor: &PipelineDescriptor<'_>,
) -> RenderPipeline {
    let [vertex, fragment] = descriptor.stages;
    let (depth_compare, depth_write) = descriptor.depth;
    let blend = wgpu::BlendState::ALPHA_BLENDING;
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(vertex),
        layout: Some(descriptor.layout),
        vertex: wgpu::VertexState {
            module: descriptor.module,
            entry_point: Some(vertex),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: descriptor.buffers,
        },
        // No culling: back faces of open surfaces and of overlays are visible.
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH,
            depth_write_enabled: Some(depth_write),
            depth_compare: Some(depth_compare),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState {
            count: samples,
            ..wgpu::MultisampleState::default()
        },
        fragment: Some(wgpu::FragmentState {
            module: descriptor.module,
            entry_point: Some(fragment),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(wgpu::ColorTargetState {
                format,
                blend: descriptor.is_translucent.then_some(blend),
                write_mask: wgpu::ColorWrites::ALL,
            })],
        }),
        multiview_mask: None,
        cache: None,
    })
}
