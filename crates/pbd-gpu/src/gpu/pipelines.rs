//! Compute pipelines, created when a program on the device first needs them.

use super::adapter::{AdapterKind, AdapterSummary};
use super::context::Context;
use super::error::GpuError;
use super::shaders::{self, EntryPoint};
use wgpu::{BindGroupLayout, ComputePipeline, PipelineLayout, ShaderModule};

/// The kernel of a dispatch.
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

/// Workgroup sizes by kind of kernel.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lanes {
    /// For passes with one lane per element.
    pub(super) pass: u32,
    /// For the loop over small colors.
    pub(super) tail: u32,
    /// For the whole-body schedule.
    pub(super) whole_body: u32,
    /// For patches.
    patch: u32,
    /// Maximum number of loop iterations of an invocation.
    ///
    /// Mesa's llvmpipe silently ends every loop after a total of 65,535 iterations.
    pub(super) rounds: u64,
}

impl Lanes {
    /// Returns the sizes for an adapter.
    ///
    /// GPUs hide latency with many lanes; a color of a patch has about 70 constraints. Software
    /// adapters compute about 8 lanes at once and the others serially, with a stack switch at every
    /// barrier.
    fn for_adapter(adapter: &AdapterSummary) -> Self {
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

/// The pipelines that backends on clones of a context share.
#[derive(Debug, Default)]
pub(super) struct SharedPipelines {
    layouts: Option<Layouts>,
    modules: [Option<ShaderModule>; 3],
    made: [Option<ComputePipeline>; Kernel::COUNT],
    /// The pipeline that scatters edits.
    pub(super) scatter: Option<ComputePipeline>,
}

/// The layouts of bind groups: storage buffers, then uniforms; and that of all pipelines.
type Layouts = ([BindGroupLayout; 2], PipelineLayout);

/// The pipelines that a backend uses, by kernel.
#[derive(Debug)]
pub(super) struct Pipelines {
    /// Storage buffers, then uniforms.
    pub(super) layouts: [BindGroupLayout; 2],
    layout: PipelineLayout,
    pub(super) lanes: Lanes,
    /// Capacity of workgroup memory in vertices.
    pub(super) capacity: u32,
    used: [Option<ComputePipeline>; Kernel::COUNT],
    /// Pipelines created since the last query.
    compiled: u32,
}

impl Pipelines {
    pub(super) fn new(context: &Context) -> Result<Self, GpuError> {
        let limits = context.device().limits();
        let mut shared = context.pipelines();
        let (layouts, layout) = match &shared.layouts {
            Some(layouts) => layouts.clone(),
            None => context.scoped("bind groups", || layouts(context.device()))?,
        };
        shared.layouts = Some((layouts.clone(), layout.clone()));
        Ok(Self {
            layouts,
            layout,
            lanes: Lanes::for_adapter(context.adapter()),
            capacity: shaders::capacity(limits.max_compute_workgroup_storage_size),
            used: [const { None }; Kernel::COUNT],
            compiled: 0,
        })
    }

    /// Makes the pipeline of a kernel available, and creates it if no backend has.
    pub(super) fn make(&mut self, context: &Context, kernel: Kernel) -> Result<(), GpuError> {
        let i = kernel.index();
        if self.used[i].is_none() {
            let mut shared = context.pipelines();
            if shared.made[i].is_none() {
                shared.made[i] = Some(self.create(context, &mut shared.modules, kernel)?);
                self.compiled += 1;
            }
            self.used[i].clone_from(&shared.made[i]);
        }
        Ok(())
    }

    /// Creates the pipeline of a kernel, and its module if necessary.
    fn create(
        &self,
        context: &Context,
        modules: &mut [Option<ShaderModule>; 3],
        kernel: Kernel,
    ) -> Result<ComputePipeline, GpuError> {
        let (i, label) = match kernel {
            Kernel::Pass(_) => (0, "passes"),
            Kernel::WholeBody => (1, "whole body"),
            Kernel::Patches | Kernel::ResetPatches => (2, "patches"),
        };
        let module = match &modules[i] {
            Some(module) => module.clone(),
            None => {
                let lanes = self.lanes;
                let source = match i {
                    0 => shaders::passes(lanes.pass, lanes.tail),
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
        modules[i] = Some(module.clone());
        context.scoped(kernel.name(), || {
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
        })
    }

    /// Returns the number of pipelines created since the last call.
    pub(super) fn take_compiled(&mut self) -> u32 {
        std::mem::take(&mut self.compiled)
    }

    /// Returns the names of the pipelines that the backend uses.
    pub(super) fn names(&self) -> impl Iterator<Item = &'static str> {
        let others = [Kernel::WholeBody, Kernel::Patches, Kernel::ResetPatches];
        let all = EntryPoint::ALL.map(Kernel::Pass).into_iter().chain(others);
        all.filter(|kernel| self.get(*kernel).is_some())
            .map(Kernel::name)
    }

    /// Returns the pipeline of a kernel if the backend uses it.
    pub(super) fn get(&self, kernel: Kernel) -> Option<&ComputePipeline> {
        self.used[kernel.index()].as_ref()
    }
}

/// Splits workgroups over two dimensions, which are limited to 65,535 each.
pub(super) fn workgroups(groups: u32) -> [u32; 2] {
    const MOST: u32 = 65_535;
    let rows = groups.div_ceil(MOST).max(1);
    [groups.div_ceil(rows), rows]
}

fn layouts(device: &wgpu::Device) -> Layouts {
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
