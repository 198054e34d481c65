//! The kernels as the device has them, each made when a program first needs it.

use super::adapter::{AdapterKind, AdapterSummary};
use super::context::Context;
use super::error::GpuError;
use super::shaders::{self, EntryPoint};
use wgpu::{BindGroupLayout, ComputePipeline, PipelineLayout, ShaderModule};

/// What a dispatch runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kernel {
    Pass(EntryPoint),
    WholeBody,
    Patches,
    ResetPatches,
}

impl Kernel {
    const COUNT: usize = EntryPoint::ALL.len() + 3;

    const fn index(self) -> usize {
        match self {
            Self::Pass(entry_point) => entry_point as usize,
            Self::WholeBody => EntryPoint::ALL.len(),
            Self::Patches => EntryPoint::ALL.len() + 1,
            Self::ResetPatches => EntryPoint::ALL.len() + 2,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Pass(entry_point) => entry_point.name(),
            Self::WholeBody => shaders::WHOLE_BODY,
            Self::Patches => shaders::PATCHES,
            Self::ResetPatches => shaders::RESET_PATCHES,
        }
    }
}

/// Lanes of workgroups.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lanes {
    /// Where a pass has as many workgroups as it takes.
    pub(super) pass: u32,
    /// Where one workgroup loops over small colors.
    tail: u32,
    /// Where one workgroup steps a body.
    pub(super) whole_body: u32,
    /// Where one workgroup has a patch.
    patch: u32,
    /// How many rounds all loops of an invocation may make together. Mesa's llvmpipe ends every loop after its first round
    /// once 65,535 were made, whosever they were, and does not say so.
    pub(super) rounds: u64,
}

impl Lanes {
    /// A real device hides waiting behind many lanes; a patch's color has some 70 constraints. A
    /// software device computes some 8 lanes at once and the others one after the other, with a change
    /// of stacks at every barrier: 8 instead of 64 make a body's workgroup 1.5 to 5 times as fast on
    /// lavapipe.
    fn of(adapter: &AdapterSummary) -> Self {
        let ends_loops = adapter.name.contains("llvmpipe");
        match adapter.kind {
            AdapterKind::Software => Self {
                pass: 64,
                tail: 8,
                whole_body: 8,
                patch: 8,
                rounds: if ends_loops { 1 << 15 } else { u64::MAX },
            },
            _ => Self {
                pass: 256,
                tail: 256,
                whole_body: 256,
                patch: 64,
                rounds: u64::MAX,
            },
        }
    }
}

/// Pipelines by kernel.
#[derive(Debug)]
pub(super) struct Pipelines {
    /// Storage buffers, then uniforms.
    pub(super) layouts: [BindGroupLayout; 2],
    layout: PipelineLayout,
    pub(super) lanes: Lanes,
    /// Vertices that a workgroup's memory holds.
    pub(super) capacity: u32,
    modules: [Option<ShaderModule>; 3],
    made: [Option<ComputePipeline>; Kernel::COUNT],
    /// How many were made since somebody asked.
    compiled: u32,
}

impl Pipelines {
    pub(super) fn new(context: &Context) -> Result<Self, GpuError> {
        let limits = context.device().limits();
        let device = context.device();
        let (layouts, layout) = context.scoped("bind groups", || layouts(device))?;
        Ok(Self {
            layouts,
            layout,
            lanes: Lanes::of(context.adapter()),
            capacity: shaders::capacity(limits.max_compute_workgroup_storage_size),
            modules: [const { None }; 3],
            made: [const { None }; Kernel::COUNT],
            compiled: 0,
        })
    }

    /// The kernel's pipeline, made now if it has not been.
    pub(super) fn make(&mut self, context: &Context, kernel: Kernel) -> Result<(), GpuError> {
        if self.made[kernel.index()].is_some() {
            return Ok(());
        }
        let (i, label) = match kernel {
            Kernel::Pass(_) => (0, "colors"),
            Kernel::WholeBody => (1, "whole body"),
            Kernel::Patches | Kernel::ResetPatches => (2, "patches"),
        };
        let module = match &self.modules[i] {
            Some(module) => module.clone(),
            None => {
                let lanes = self.lanes;
                let source = match i {
                    0 => shaders::colors(lanes.pass, lanes.tail),
                    1 => shaders::whole_body(lanes.whole_body, self.capacity),
                    _ => shaders::patches(lanes.patch),
                };
                let descriptor = wgpu::ShaderModuleDescriptor {
                    label: Some(label),
                    source: wgpu::ShaderSource::Wgsl(source.into()),
                };
                context.scoped(label, || context.device().create_shader_module(descriptor))?
            }
        };
        self.modules[i] = Some(module.clone());
        let pipeline = context.scoped(kernel.name(), || {
            let descriptor = wgpu::ComputePipelineDescriptor {
                label: Some(kernel.name()),
                layout: Some(&self.layout),
                module: &module,
                entry_point: Some(kernel.name()),
                compilation_options: wgpu::PipelineCompilationOptions {
                    zero_initialize_workgroup_memory: false,
                    ..wgpu::PipelineCompilationOptions::default()
                },
                cache: None,
            };
            context.device().create_compute_pipeline(&descriptor)
        })?;
        self.made[kernel.index()] = Some(pipeline);
        self.compiled += 1;
        Ok(())
    }

    /// How many were made since it was asked last.
    pub(super) fn take_compiled(&mut self) -> u32 {
        std::mem::take(&mut self.compiled)
    }

    /// The names of those that were made.
    pub(super) fn names(&self) -> impl Iterator<Item = &'static str> {
        let others = [Kernel::WholeBody, Kernel::Patches, Kernel::ResetPatches];
        let all = EntryPoint::ALL.map(Kernel::Pass).into_iter().chain(others);
        all.filter(|kernel| self.get(*kernel).is_some())
            .map(Kernel::name)
    }

    /// The kernel's pipeline, if it was made.
    pub(super) fn get(&self, kernel: Kernel) -> Option<&ComputePipeline> {
        self.made[kernel.index()].as_ref()
    }
}

/// Workgroups in two dimensions: a device takes 65,535 in each.
pub(super) fn workgroups(groups: u32) -> [u32; 2] {
    const MOST: u32 = 65_535;
    let rows = groups.div_ceil(MOST).max(1);
    [groups.div_ceil(rows), rows]
}

fn layouts(device: &wgpu::Device) -> ([BindGroupLayout; 2], PipelineLayout) {
    let entry = |binding: usize, ty, has_dynamic_offset| wgpu::BindGroupLayoutEntry {
        binding: u32::try_from(binding).unwrap_or(u32::MAX),
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer {
            ty,
            has_dynamic_offset,
            min_binding_size: None,
        },
        count: None,
    };
    // Positions, velocities, displacements, entries and reports are written.
    let written = [true, true, true, true, false, false, false, true];
    let storage: Vec<_> = (written.iter().enumerate())
        .map(|(i, written)| {
            let read_only = !written;
            entry(i, wgpu::BufferBindingType::Storage { read_only }, false)
        })
        .collect();
    let uniform = wgpu::BufferBindingType::Uniform;
    let uniforms = [entry(0, uniform, false), entry(1, uniform, true)];
    let group = |entries: &[wgpu::BindGroupLayoutEntry]| {
        device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: None,
            entries,
        })
    };
    let layouts = [group(&storage), group(&uniforms)];
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: None,
        bind_group_layouts: &[Some(&layouts[0]), Some(&layouts[1])],
        immediate_size: 0,
    });
    (layouts, layout)
}
