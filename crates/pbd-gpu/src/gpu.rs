//! The GPU backend: steps bodies with wgpu compute shaders.

mod adapter;
mod arena;
mod backend;
mod body;
mod calibration;
mod collect;
mod contacts;
mod context;
mod edit;
mod error;
mod guard;
mod layout;
mod lists;
mod motion;
mod passes;
mod patch_blocks;
mod pipelines;
mod program;
mod read;
mod readback;
mod records;
mod runs;
mod shaders;
mod solid;
mod stats;
mod step;
mod submit;
mod timestamps;
mod uniforms;
mod upload;
mod volumes;

pub use adapter::{AdapterKind, AdapterLimits, AdapterRequest, AdapterSummary, adapters};
pub use backend::{GpuBackend, GpuBody};
pub use context::Context;
pub use error::GpuError;
pub use stats::{GpuMemory, GpuStats, Schedule};

/// Creates a command encoder.
fn encoder(context: &Context, label: &str) -> wgpu::CommandEncoder {
    let descriptor = wgpu::CommandEncoderDescriptor { label: Some(label) };
    context.device().create_command_encoder(&descriptor)
}

/// Returns the maximum size of a buffer that kernels can bind whole \[bytes\].
fn largest_binding(context: &Context) -> u64 {
    let limits = context.device().limits();
    let binding = limits.max_storage_buffer_binding_size;
    binding.min(limits.max_buffer_size)
}
