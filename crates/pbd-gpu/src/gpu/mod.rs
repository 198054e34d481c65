//! Stepping on any device that wgpu reaches.

mod adapter;
mod arena;
mod backend;
mod blocks;
mod body;
mod calibrate;
mod checkpoint;
mod contacts;
mod context;
mod edit;
mod error;
mod layout;
mod lists;
mod motion;
mod passes;
mod pipelines;
mod program;
mod read;
mod readback;
mod records;
mod runs;
mod shaders;
mod stats;
mod step;
mod stopwatch;
mod uniforms;
mod upload;
mod volumes;

pub use adapter::{AdapterKind, AdapterLimits, AdapterRequest, AdapterSummary, adapters};
pub use backend::{GpuBackend, GpuBody};
pub use context::Context;
pub use error::GpuError;
pub use stats::{GpuMemory, GpuStats, Schedule};

/// An empty list of commands.
fn encoder(context: &Context, label: &str) -> wgpu::CommandEncoder {
    let descriptor = wgpu::CommandEncoderDescriptor { label: Some(label) };
    context.device().create_command_encoder(&descriptor)
}

/// The largest buffer that kernels can see whole \[bytes\].
fn largest_binding(context: &Context) -> u64 {
    let limits = context.device().limits();
    let binding = limits.max_storage_buffer_binding_size;
    binding.min(limits.max_buffer_size)
}
