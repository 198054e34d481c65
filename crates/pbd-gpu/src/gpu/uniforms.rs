//! Uniform buffers with the parameters of dispatches, and the bind groups of all kernels.

use super::body::{Arenas, DISPLACEMENTS, MOTIONS, POSITIONS, RECORDS, REPORTS, RUN_TABLES};
use super::context::Context;
use super::error::GpuError;
use super::layout::{FrameUniform, PassUniform};
use super::pipelines::Pipelines;
use super::program::Program;
use super::upload::Uploads;
use bytemuck::Zeroable;
use wgpu::{BindGroup, BindGroupEntry, BindingResource, Buffer, BufferBinding, BufferUsages};

/// Bytes between the parameters of passes; the alignment that every adapter supports.
pub(super) const PASS_STRIDE: u32 = 256;

/// Parameter buffers and bind groups.
#[derive(Debug)]
pub(super) struct Uniforms {
    frame: Buffer,
    /// Last uploaded parameters.
    uploaded: FrameUniform,
    passes: Buffer,
    links: Buffer,
    groups: Option<[BindGroup; 2]>,
    /// Buffers of the bind groups.
    bound: Vec<Buffer>,
    /// Scratch memory.
    bytes: Vec<u8>,
}

impl Uniforms {
    pub(super) fn new(context: &Context) -> Result<Self, GpuError> {
        let uniform = BufferUsages::UNIFORM | BufferUsages::COPY_DST;
        let storage = BufferUsages::STORAGE | BufferUsages::COPY_DST;
        Ok(Self {
            frame: context.buffer("frame", size_of::<FrameUniform>() as u64, uniform)?,
            uploaded: FrameUniform::zeroed(),
            passes: context.buffer("passes", 64 * u64::from(PASS_STRIDE), uniform)?,
            links: context.buffer("links", 1024, storage)?,
            groups: None,
            bound: Vec::new(),
            bytes: Vec::new(),
        })
    }

    /// Uploads the parameters of a frame if they have changed.
    pub(super) fn send_frame(
        &mut self,
        context: &Context,
        uploads: &mut Uploads,
        frame: FrameUniform,
    ) {
        if bytemuck::bytes_of(&frame) != bytemuck::bytes_of(&self.uploaded) {
            uploads.send(context, &self.frame, 0, bytemuck::bytes_of(&frame));
            self.uploaded = frame;
        }
    }

    /// Uploads the parameters of a program's dispatches.
    pub(super) fn send_program(
        &mut self,
        context: &Context,
        uploads: &mut Uploads,
        program: &Program,
    ) -> Result<(), GpuError> {
        let links: &[u8] = bytemuck::cast_slice(&program.links);
        // Allocates first, so that an error costs no further work.
        for (buffer, bytes) in [
            (
                &mut self.passes,
                program.passes.len() as u64 * u64::from(PASS_STRIDE),
            ),
            (&mut self.links, links.len() as u64),
        ] {
            if buffer.size() < bytes {
                *buffer = context.buffer("program", bytes.next_power_of_two(), buffer.usage())?;
            }
        }
        self.bytes.clear();
        for pass in &program.passes {
            let end = self.bytes.len() + PASS_STRIDE as usize;
            self.bytes.extend(bytemuck::bytes_of(pass));
            self.bytes.resize(end, 0);
        }
        uploads.send(context, &self.passes, 0, &self.bytes);
        uploads.send(context, &self.links, 0, links);
        Ok(())
    }

    /// Returns the bind groups, recreated if a buffer was replaced.
    pub(super) fn groups(
        &mut self,
        context: &Context,
        pipelines: &Pipelines,
        arenas: &Arenas,
    ) -> Result<&[BindGroup; 2], GpuError> {
        let storage = [
            arenas.vertices.buffer(POSITIONS),
            arenas.vertices.buffer(MOTIONS),
            arenas.vertices.buffer(DISPLACEMENTS),
            arenas.entries.buffer(0),
            arenas.bodies.buffer(RECORDS),
            arenas.bodies.buffer(RUN_TABLES),
            &self.links,
            arenas.bodies.buffer(REPORTS),
        ];
        let now = || storage.into_iter().chain([&self.frame, &self.passes]);
        let groups = match self.groups.take() {
            Some(groups) if now().eq(&self.bound) => groups,
            _ => {
                self.bound.clear();
                self.bound.extend(now().cloned());
                context.scoped("bind groups", || {
                    let uniforms = [
                        BindingResource::Buffer(self.frame.as_entire_buffer_binding()),
                        BindingResource::Buffer(BufferBinding {
                            buffer: &self.passes,
                            offset: 0,
                            size: wgpu::BufferSize::new(size_of::<PassUniform>() as u64),
                        }),
                    ];
                    let storage = storage.map(Buffer::as_entire_binding);
                    [
                        bind(context, &pipelines.layouts[0], storage),
                        bind(context, &pipelines.layouts[1], uniforms),
                    ]
                })?
            }
        };
        Ok(self.groups.insert(groups))
    }
}

fn bind<const N: usize>(
    context: &Context,
    layout: &wgpu::BindGroupLayout,
    resources: [BindingResource<'_>; N],
) -> BindGroup {
    let entries: Vec<_> = (0..)
        .zip(resources)
        .map(|(binding, resource)| BindGroupEntry { binding, resource })
        .collect();
    context
        .device()
        .create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout,
            entries: &entries,
        })
}
