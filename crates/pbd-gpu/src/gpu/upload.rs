//! Uploads to the GPU: whole ranges by copies, single words by a scatter kernel.

use super::context::Context;
use super::error::GpuError;
use super::pipelines::workgroups;
use super::records::push_constraint;
use crate::constraints::batches::Batch;
use wgpu::{Buffer, BufferUsages, ComputePassDescriptor, ComputePipeline};

/// Target array of an edit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Target {
    Positions,
    Motions,
    Constraints,
}

/// Queues edits, uploads them and counts bytes.
#[derive(Debug)]
pub(super) struct Uploads {
    /// Scratch memory for entries.
    pub(super) entries: Vec<[u32; 2]>,
    /// Per target: a count, then index and value of each edit.
    edits: [Vec<u32>; 3],
    buffers: [Option<Buffer>; 3],
    scatter: Option<ComputePipeline>,
    /// Bytes uploaded since the last query.
    bytes: u64,
}

impl Uploads {
    pub(super) fn new() -> Self {
        Self {
            entries: Vec::new(),
            edits: [const { Vec::new() }; 3].map(with_count),
            buffers: [const { None }; 3],
            scatter: None,
            bytes: 0,
        }
    }

    /// Returns the bytes uploaded since the last call.
    pub(super) fn take_bytes(&mut self) -> u64 {
        std::mem::take(&mut self.bytes)
    }

    /// Queues the vector `element`.
    pub(super) fn edit_vector(&mut self, target: Target, element: u32, value: [f32; 4]) {
        for (word, c) in (4 * element..).zip(value) {
            self.edits[target as usize].extend([word, c.to_bits()]);
        }
    }

    /// Queues the inverse mass of a vertex.
    pub(super) fn edit_mass(&mut self, vertex: u32, inverse_mass: f32) {
        let edit = [4 * vertex + 3, inverse_mass.to_bits()];
        self.edits[Target::Positions as usize].extend(edit);
    }

    /// Queues an entry of the constraint arena.
    pub(super) fn edit_entry(&mut self, entry: u32, value: [u32; 2]) {
        for (word, value) in (2 * entry..).zip(value) {
            self.edits[Target::Constraints as usize].extend([word, value]);
        }
    }

    /// Queues a constraint of a batch for the entries from `entry` on.
    pub(super) fn constraint<const N: usize>(&mut self, entry: u32, batch: &Batch<N>, i: usize) {
        let mut entries = std::mem::take(&mut self.entries);
        entries.clear();
        push_constraint(&mut entries, batch, i);
        for (entry, &value) in (entry..).zip(&entries) {
            self.edit_entry(entry, value);
        }
        self.entries = entries;
    }

    /// Uploads the gathered entries to `offset` of a buffer \[bytes\].
    pub(super) fn write(&mut self, context: &Context, buffer: &Buffer, offset: u64) {
        let entries = std::mem::take(&mut self.entries);
        self.send(context, buffer, offset, bytemuck::cast_slice(&entries));
        self.entries = entries;
    }

    /// Uploads bytes.
    pub(super) fn send(&mut self, context: &Context, buffer: &Buffer, offset: u64, data: &[u8]) {
        if !data.is_empty() {
            context.queue().write_buffer(buffer, offset, data);
            self.bytes += data.len() as u64;
        }
    }

    /// Discards queued edits.
    pub(super) fn clear(&mut self) {
        self.edits.iter_mut().for_each(|words| words.truncate(1));
    }

    /// Uploads the queued edits and scatters them to the three targets.
    ///
    /// After an error the edits stay queued.
    pub(super) fn flush(
        &mut self,
        context: &Context,
        targets: [&Buffer; 3],
    ) -> Result<(), GpuError> {
        if self.edits.iter().all(|words| words.len() == 1) {
            return Ok(());
        }
        let pipeline = match self.scatter.take() {
            Some(pipeline) => pipeline,
            None => scatter_pipeline(context)?,
        };
        let pipeline = self.scatter.insert(pipeline).clone();
        let mut encoder = super::encoder(context, "edits");
        let mut pass = encoder.begin_compute_pass(&ComputePassDescriptor::default());
        pass.set_pipeline(&pipeline);
        for (i, target) in targets.into_iter().enumerate() {
            let count = u32::try_from(self.edits[i].len() / 2).unwrap_or(u32::MAX);
            if count == 0 {
                continue;
            }
            self.edits[i][0] = count;
            let words: &[u8] = bytemuck::cast_slice(&self.edits[i]);
            let bytes = words.len() as u64;
            let buffer = match self.buffers[i].take() {
                Some(buffer) if buffer.size() >= bytes => buffer,
                _ => context.buffer(
                    "edits",
                    bytes.next_power_of_two(),
                    BufferUsages::STORAGE | BufferUsages::COPY_DST,
                )?,
            };
            context.queue().write_buffer(&buffer, 0, words);
            self.bytes += bytes;
            let group = bind(context, &pipeline, &buffer, target);
            self.buffers[i] = Some(buffer);
            pass.set_bind_group(0, &group, &[]);
            let [x, y] = workgroups(count.div_ceil(64));
            pass.dispatch_workgroups(x, y, 1);
        }
        drop(pass);
        context.queue().submit([encoder.finish()]);
        context.check()?;
        self.clear();
        Ok(())
    }
}

/// Returns an empty list of edits with its count.
fn with_count(mut words: Vec<u32>) -> Vec<u32> {
    words.push(0);
    words
}

/// Returns the pipeline that scatters edits, and creates it if necessary.
fn scatter_pipeline(context: &Context) -> Result<ComputePipeline, GpuError> {
    let mut shared = context.pipelines();
    if let Some(pipeline) = &shared.scatter {
        return Ok(pipeline.clone());
    }
    let pipeline = context.scoped("scatter.wgsl", || {
        let module = context
            .device()
            .create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some("scatter"),
                source: wgpu::ShaderSource::Wgsl(super::shaders::SCATTER.into()),
            });
        context
            .device()
            .create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some("scatter"),
                layout: None,
                module: &module,
                entry_point: Some("scatter"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                cache: None,
            })
    })?;
    shared.scatter = Some(pipeline.clone());
    Ok(pipeline)
}

fn bind(
    context: &Context,
    pipeline: &ComputePipeline,
    edits: &Buffer,
    words: &Buffer,
) -> wgpu::BindGroup {
    let layout = pipeline.get_bind_group_layout(0);
    context
        .device()
        .create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("scatter"),
            layout: &layout,
            entries: &[
                wgpu::BindGroupEntry {
                    binding: 0,
                    resource: edits.as_entire_binding(),
                },
                wgpu::BindGroupEntry {
                    binding: 1,
                    resource: words.as_entire_binding(),
                },
            ],
        })
}
