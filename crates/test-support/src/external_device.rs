//! wgpu adapters and devices that the test opens itself, without a `Context`.

use incise_pbd_gpu::{Context, wgpu};

/// Returns the wgpu adapter of a context, enumerated anew.
///
/// # Panics
/// If the adapter is gone.
#[must_use]
pub fn same_adapter(context: &Context) -> wgpu::Adapter {
    let descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    let instance = wgpu::Instance::new(descriptor);
    let mut found =
        pollster::block_on(instance.enumerate_adapters(wgpu::Backends::all())).into_iter();
    let same = found.find(|adapter| adapter.get_info().name == context.adapter().name);
    same.expect("it is open already")
}

/// Opens a device with these limits.
///
/// # Panics
/// If the adapter does not have the limits.
#[must_use]
pub fn open(adapter: &wgpu::Adapter, limits: wgpu::Limits) -> (wgpu::Device, wgpu::Queue) {
    let descriptor = wgpu::DeviceDescriptor {
        required_limits: limits,
        ..wgpu::DeviceDescriptor::default()
    };
    pollster::block_on(adapter.request_device(&descriptor)).expect("the adapter has these limits")
}
