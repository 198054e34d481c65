//! The pipelines, made once for a format and a number of samples.

use super::overlay::{LINE_ATTRIBUTES, SHEET_ATTRIBUTES};
use super::scope::scoped;
use super::shaders;
use crate::error::RenderError;
use wgpu::{
    BindGroupLayout, BindGroupLayoutEntry, BindingType, BufferBindingType, CompareFunction, Device,
    RenderPipeline, ShaderStages, TextureFormat, VertexBufferLayout, VertexStepMode,
};

/// What depths are stored as.
pub(super) const DEPTH: TextureFormat = TextureFormat::Depth32Float;

/// Pipelines and the layouts of what they take.
#[derive(Debug)]
pub(super) struct Pipelines {
    pub(super) view_layout: BindGroupLayout,
    pub(super) body_layout: BindGroupLayout,
    pub(super) background: RenderPipeline,
    pub(super) surface: RenderPipeline,
    pub(super) sheets: RenderPipeline,
    pub(super) lines: RenderPipeline,
}

/// What one pipeline is made of.
struct Recipe<'a> {
    module: &'a wgpu::ShaderModule,
    layout: &'a wgpu::PipelineLayout,
    /// Entry points of the vertex and the fragment stage.
    stages: [&'static str; 2],
    buffers: &'a [Option<VertexBufferLayout<'a>>],
    /// What depths do, and whether they are kept.
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
        let storage = [1, 2, 3].map(storage);
        let [positions, corners, colors] = storage;
        let body = [uniform(0), positions, corners, colors];
        // Some devices read storage buffers in other stages only, and say so here.
        let body_layout = layout(device, "body", &body).map_err(|error| match error {
            RenderError::Validation { message, .. } => RenderError::VertexStorage { message },
            other => other,
        })?;
        let make = || {
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
            let pipeline = |recipe: &Recipe<'_>| pipeline(device, format, samples, recipe);
            [
                pipeline(&Recipe {
                    module: &module("background", shaders::BACKGROUND),
                    layout: &plain,
                    stages: ["background_vertex", "background_fragment"],
                    buffers: &[],
                    depth: (CompareFunction::Always, false),
                    is_translucent: false,
                }),
                pipeline(&Recipe {
                    module: &module("surface", shaders::SURFACE),
                    layout: &with_body,
                    stages: ["surface_vertex", "surface_fragment"],
                    buffers: &[],
                    depth: (CompareFunction::Greater, true),
                    is_translucent: false,
                }),
                pipeline(&Recipe {
                    module: &overlay,
                    layout: &plain,
                    stages: ["sheet_vertex", "overlay_fragment"],
                    buffers: &[Some(VertexBufferLayout {
                        array_stride: 16,
                        step_mode: VertexStepMode::Vertex,
                        attributes: &SHEET_ATTRIBUTES,
                    })],
                    depth: (CompareFunction::Greater, false),
                    is_translucent: true,
                }),
                pipeline(&Recipe {
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
        let [background, surface, sheets, lines] = scoped(device, "making pipelines", make)?;
        Ok(Self {
            view_layout,
            body_layout,
            background,
            surface,
            sheets,
            lines,
        })
    }
}

fn layout(
    device: &Device,
    label: &'static str,
    entries: &[BindGroupLayoutEntry],
) -> Result<BindGroupLayout, RenderError> {
    scoped(device, "a bind group's layout", || {
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

fn pipeline(
    device: &Device,
    format: TextureFormat,
    samples: u32,
    recipe: &Recipe<'_>,
) -> RenderPipeline {
    let [vertex, fragment] = recipe.stages;
    let (depth_compare, depth_write) = recipe.depth;
    let blend = wgpu::BlendState::ALPHA_BLENDING;
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(vertex),
        layout: Some(recipe.layout),
        vertex: wgpu::VertexState {
            module: recipe.module,
            entry_point: Some(vertex),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: recipe.buffers,
        },
        // Both faces are drawn: the inside of an open surface is seen, and so is a sheet's back.
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
            module: recipe.module,
            entry_point: Some(fragment),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(wgpu::ColorTargetState {
                format,
                blend: recipe.is_translucent.then_some(blend),
                write_mask: wgpu::ColorWrites::ALL,
            })],
        }),
        multiview_mask: None,
        cache: None,
    })
}
