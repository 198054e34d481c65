//! Rejected calls and device loss are typed errors, never panics.

use incise_pbd_gpu::wgpu::{self, BufferUsages};
use incise_pbd_gpu::{Context, GpuError};
use incise_test_support::external_device::{open, same_adapter};
use incise_test_support::gpu::Needs;
use std::time::Duration;

/// Every kind of error of a device, the loss of the device last.
pub(super) fn typed(context: &Context) {
    too_large_a_buffer(context);
    empty_buffer(context);
    broken_shader(context);
    wrong_call(context);
    out_of_scope(context);
    shared(context);
    waits(context);
    too_short(context);
    for_nothing(context);
    lost(context);
}

fn too_large_a_buffer(context: &Context) {
    let limits = context.device().limits();
    let binding = limits.max_storage_buffer_binding_size;
    let storage = binding.min(limits.max_buffer_size);
    for (usage, limit) in [
        (BufferUsages::STORAGE, storage),
        (BufferUsages::MAP_READ, limits.max_buffer_size),
    ] {
        for bytes in [limit + 1, u64::MAX] {
            let usage = usage | BufferUsages::COPY_DST;
            let error = context.buffer("positions", bytes, usage);
            let what = "positions".to_owned();
            let expected = GpuError::BufferTooLarge { what, bytes, limit };
            assert_eq!(error.expect_err("too large"), expected);
        }
    }
    assert_eq!(context.check(), Ok(()), "the device was not even asked");
    let portable =
        Context::open(&Needs::AnyDevice.portable_request()).expect("an adapter is there");
    let bytes = (128 << 20) + 4;
    let error = portable.buffer("positions", bytes, BufferUsages::STORAGE);
    assert!(
        matches!(error, Err(GpuError::BufferTooLarge { limit, .. }) if limit == 128 << 20),
        "{error:?}"
    );
}

fn empty_buffer(context: &Context) {
    for (bytes, size) in [(0, 4), (3, 4), (4, 4), (5, 8)] {
        let buffer = context.buffer("pins", bytes, BufferUsages::STORAGE);
        assert_eq!(
            buffer.expect("a small buffer").size(),
            size,
            "{bytes} bytes"
        );
    }
}

fn shader(context: &Context, text: &str) -> Result<wgpu::ShaderModule, GpuError> {
    let source = wgpu::ShaderSource::Wgsl(text.to_owned().into());
    context.scoped("the test's shader", || {
        let label = None;
        let descriptor = wgpu::ShaderModuleDescriptor { label, source };
        context.device().create_shader_module(descriptor)
    })
}

fn broken_shader(context: &Context) {
    for text in [
        "fn main( {",
        "@compute @workgroup_size(1) fn main() { let a: u32 = 1.5; }",
    ] {
        let error = shader(context, text).expect_err("it does not parse");
        assert!(
            matches!(&error, GpuError::Validation { what, message }
                if what == "the test's shader" && message.contains("wgsl")),
            "{error:?}"
        );
    }
    shader(context, "@compute @workgroup_size(1) fn main() {}").expect("the device is as before");
}

fn wrong_call(context: &Context) {
    let buffer = context.buffer("target", 16, BufferUsages::COPY_DST);
    let buffer = buffer.expect("a small buffer");
    let error = context.scoped("a write past the end", || {
        context.queue().write_buffer(&buffer, 12, &[0; 8]);
    });
    let error = error.expect_err("8 bytes at 12 of 16");
    assert!(
        matches!(&error, GpuError::Validation { what, .. } if what == "a write past the end"),
        "{error:?}"
    );
    assert_eq!(context.check(), Ok(()), "it was returned once");
    let in_time = context.scoped("a write", || {
        context.queue().write_buffer(&buffer, 8, &[0; 8]);
    });
    assert_eq!(in_time, Ok(()));
}

fn out_of_scope(context: &Context) {
    let buffer = context.buffer("target", 16, BufferUsages::COPY_DST);
    let buffer = buffer.expect("a small buffer");
    for at in [12, 16] {
        context.queue().write_buffer(&buffer, at, &[0; 8]);
    }
    let error = context.check().expect_err("two calls were refused");
    assert!(
        matches!(&error, GpuError::Validation { message, .. } if message.contains("at offset 12 ")),
        "the first of them: {error:?}"
    );
    assert_eq!(context.check(), Ok(()), "it was returned once");
}

fn lost(context: &Context) {
    let buffer = context.buffer("target", 16, BufferUsages::COPY_DST);
    let buffer = buffer.expect("a small buffer");
    let submission = context.queue().submit([]);
    context.destroy();
    for _ in 0..2 {
        let results = [
            context.check(),
            context.scoped("a write", || {
                context.queue().write_buffer(&buffer, 0, &[0; 8]);
            }),
            context
                .buffer("other", 16, BufferUsages::COPY_DST)
                .map(drop),
            context.wait(submission.clone()),
            context.poll_once(),
        ];
        for result in results {
            let lost = matches!(&result, Err(GpuError::DeviceLost { .. }));
            assert!(lost, "{result:?}");
        }
    }
    context.destroy();
    drop(buffer);
    let again = Context::open(&Needs::AnyDevice.request()).expect("a new device");
    assert_eq!(again.check(), Ok(()));
}

/// A context that listens reports the loss of a shared device.
fn shared(context: &Context) {
    let adapter = same_adapter(context);
    let (device, queue) = open(&adapter, wgpu::Limits::default());
    let shared = Context::from_device(&adapter, device.clone(), queue).expect("this is enough");
    shared.listen();
    assert_eq!(shared.poll_once(), Ok(()));
    device.destroy();
    let polled = shared.poll_once();
    assert!(
        matches!(polled, Err(GpuError::DeviceLost { .. })),
        "{polled:?}"
    );
}

fn waits(context: &Context) {
    let source = context.buffer(
        "source",
        16,
        BufferUsages::COPY_SRC | BufferUsages::COPY_DST,
    );
    let source = source.expect("a small buffer");
    let target = context.buffer(
        "target",
        16,
        BufferUsages::MAP_READ | BufferUsages::COPY_DST,
    );
    let target = target.expect("a small buffer");
    let submission = context.scoped("a copy", || {
        context.queue().write_buffer(&source, 0, &[7; 16]);
        let mut encoder = context.device().create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(&source, 0, &target, 0, 16);
        let submission = context.queue().submit([encoder.finish()]);
        target.map_async(wgpu::MapMode::Read, .., |mapped| mapped.expect("it maps"));
        submission
    });
    let submission = submission.expect("a copy");
    context.wait(submission).expect("a device that works");
    let bytes = target.get_mapped_range(..).expect("it is mapped");
    assert_eq!(&bytes[..], &[7; 16]);
}

/// Work that takes long, by a loop whose rounds follow from each other, is not done at once.
fn too_short(context: &Context) {
    let text = "@group(0) @binding(0) var<storage, read_write> state: array<u32>;
        @compute @workgroup_size(1) fn main() {
            var x = state[0];
            for (var i = 0u; i < 1u << 31u; i++) { x = x * 1664525u + 1013904223u; }
            state[0] = x;
        }";
    let module = shader(context, text).expect("it is correct");
    let state = context.buffer("state", 4, BufferUsages::STORAGE);
    let state = state.expect("a small buffer");
    let submission = context.scoped("a long dispatch", || {
        let device = context.device();
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: None,
            layout: None,
            module: &module,
            entry_point: None,
            compilation_options: Default::default(),
            cache: None,
        });
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry {
                binding: 0,
                resource: state.as_entire_binding(),
            }],
        });
        let mut encoder = device.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.dispatch_workgroups(1, 1, 1);
        drop(pass);
        context.queue().submit([encoder.finish()])
    });
    let submission = submission.expect("a long dispatch");
    let early = context.wait_for(submission.clone(), Duration::ZERO);
    assert_eq!(early, Err(GpuError::Timeout { seconds: 0.0 }));
    assert_eq!(context.wait(submission), Ok(()), "it has gone on");
}

/// Waiting for a submission of another device is an error.
fn for_nothing(context: &Context) {
    let other = Context::open(&Needs::AnyDevice.request()).expect("it opens twice");
    let mut submission = other.queue().submit([]);
    for _ in 0..100 {
        submission = other.queue().submit([]);
    }
    let error = context
        .wait(submission)
        .expect_err("it was never submitted");
    assert!(matches!(error, GpuError::Validation { .. }), "{error:?}");
}
