//! What a device's memory can do: the bandwidth that frames are compared with.

use incise_pbd_gpu::{Context, GpuError, wgpu};
use std::time::Instant;
use wgpu::BufferUsages;

/// Bytes of the two buffers, more than caches hold. Less where a device takes less.
const BYTES: u64 = 256 << 20;
/// The same on a software device, which is the CPU and slow.
const BYTES_IN_SOFTWARE: u64 = 64 << 20;
/// Lanes of a workgroup, which every device has.
const LANES: u64 = 256;
/// Workgroups of a row: a device takes 65,535.
const ROW: u64 = 1 << 15;
/// Least time of a measurement \[s\]: much longer than it takes to hand work over and to wait for it.
const LONG: f64 = 0.05;
/// Most copies of a measurement.
const MOST: u32 = 256;
/// Measurements, of which the fastest counts.
const TIMES: u32 = 5;

/// Copies 16 bytes a lane.
const SHADER: &str = "
@group(0) @binding(0) var<storage, read> from_here: array<vec4u>;
@group(0) @binding(1) var<storage, read_write> to_there: array<vec4u>;

@compute @workgroup_size(256)
fn copy(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let i = (group.y * groups.x + group.x) * 256u + lane;
    if i < arrayLength(&to_there) {
        to_there[i] = from_here[i];
    }
}
";

/// Two buffers and what copies one to the other.
struct Copies {
    from: wgpu::Buffer,
    to: wgpu::Buffer,
    pipeline: wgpu::ComputePipeline,
    group: wgpu::BindGroup,
}

/// Who copies.
#[derive(Clone, Copy)]
enum Way {
    Kernel,
    Command,
}

/// Bytes a second that the device reads and writes while it copies a large buffer: by a kernel or by
/// the driver's own command, whichever is faster.
///
/// # Errors
/// [`GpuError`] when the device has no room for the buffers or fails.
pub(super) fn bandwidth(context: &Context, is_software: bool) -> Result<f64, GpuError> {
    let copies = Copies::new(context, is_software)?;
    let mut best: f64 = 0.0;
    for way in [Way::Kernel, Way::Command] {
        copies.time(context, way, 1)?;
        let once = copies.time(context, way, 1)?;
        let count = count_for(once);
        for _ in 0..TIMES {
            let seconds = copies.time(context, way, count)?;
            best = best.max(copies.moved(count) / seconds);
        }
    }
    Ok(best)
}

impl Copies {
    fn new(context: &Context, is_software: bool) -> Result<Self, GpuError> {
        let limits = context.device().limits();
        let largest = limits
            .max_storage_buffer_binding_size
            .min(limits.max_buffer_size);
        let wanted = if is_software {
            BYTES_IN_SOFTWARE
        } else {
            BYTES
        };
        let bytes = wanted.min(largest) / 16 * 16;
        let usage = BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST;
        let from = context.buffer("copied from", bytes, usage)?;
        let to = context.buffer("copied to", bytes, usage)?;
        let (pipeline, group) = context.scoped("the copying kernel", || {
            let device = context.device();
            let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some("copy"),
                source: wgpu::ShaderSource::Wgsl(SHADER.into()),
            });
            let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some("copy"),
                layout: None,
                module: &module,
                entry_point: Some("copy"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                cache: None,
            });
            let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("copy"),
                layout: &pipeline.get_bind_group_layout(0),
                entries: &[bound(0, &from), bound(1, &to)],
            });
            (pipeline, group)
        })?;
        Ok(Self {
            from,
            to,
            pipeline,
            group,
        })
    }

    /// Bytes read and written by so many copies.
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^53 bytes")]
    fn moved(&self, count: u32) -> f64 {
        (2 * self.to.size() * u64::from(count)) as f64
    }

    /// Time of so many copies \[s\].
    fn time(&self, context: &Context, way: Way, count: u32) -> Result<f64, GpuError> {
        let begin = Instant::now();
        let done = context.scoped("copying", || {
            let descriptor = wgpu::CommandEncoderDescriptor {
                label: Some("copy"),
            };
            let mut encoder = context.device().create_command_encoder(&descriptor);
            match way {
                Way::Command => {
                    for _ in 0..count {
                        encoder.copy_buffer_to_buffer(&self.from, 0, &self.to, 0, self.to.size());
                    }
                }
                Way::Kernel => {
                    let descriptor = wgpu::ComputePassDescriptor::default();
                    let mut pass = encoder.begin_compute_pass(&descriptor);
                    pass.set_pipeline(&self.pipeline);
                    pass.set_bind_group(0, &self.group, &[]);
                    let [x, y] = groups(self.to.size());
                    for _ in 0..count {
                        pass.dispatch_workgroups(x, y, 1);
                    }
                }
            }
            context.queue().submit([encoder.finish()])
        })?;
        context.wait(done)?;
        Ok(begin.elapsed().as_secs_f64())
    }
}

/// A whole buffer where the kernel looks for it.
fn bound(binding: u32, buffer: &wgpu::Buffer) -> wgpu::BindGroupEntry<'_> {
    wgpu::BindGroupEntry {
        binding,
        resource: buffer.as_entire_binding(),
    }
}

/// Workgroups for so many bytes.
fn groups(bytes: u64) -> [u32; 2] {
    let groups = bytes.div_ceil(16 * LANES);
    let narrow = |count: u64| u32::try_from(count).unwrap_or(u32::MAX);
    [narrow(groups.min(ROW)), narrow(groups.div_ceil(ROW))]
}

/// Copies that take long enough if one takes `once` \[s\].
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a saturating cast of a positive number"
)]
fn count_for(once: f64) -> u32 {
    ((LONG / once) as u32).clamp(1, MOST)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn workgroups_reach_every_byte() {
        for bytes in [16, 4096, 4112, 128 << 20, BYTES] {
            let [x, y] = groups(bytes).map(u64::from);
            assert!(x * y * LANES * 16 >= bytes, "{bytes}");
            assert!(x <= 65_535 && y <= 65_535, "{bytes}");
        }
    }

    #[test]
    fn a_measurement_is_long_but_not_endless() {
        assert_eq!(count_for(1.0), 1);
        assert_eq!(count_for(LONG / 10.5), 10);
        assert_eq!(count_for(0.0), MOST);
    }
}
