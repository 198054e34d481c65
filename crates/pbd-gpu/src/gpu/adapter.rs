//! Which devices a machine has, and which of them to take.

use super::error::GpuError;
use wgpu::{Backend, Backends, DeviceType, Features, InstanceFlags, Limits};

/// Which adapter to open, and how.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct AdapterRequest {
    /// A part of the adapter's name in any case. A named adapter is taken even if it is software.
    pub name: Option<String>,
    /// Whether an adapter that computes on the CPU will do when there is no other. It proves what a
    /// device would do; it is slower than [`CpuBackend`](crate::CpuBackend).
    pub allow_software: bool,
    /// How large one storage binding must at least be \[bytes\].
    pub storage_binding: u64,
    /// Opens the device with the limits that every WebGPU device has, whatever the adapter could do
    /// beyond.
    pub portable_limits: bool,
}

impl AdapterRequest {
    /// The adapter of this name, else the best there is, one that computes on the CPU if there is no other.
    #[must_use]
    pub fn any(name: Option<String>) -> Self {
        Self {
            name,
            allow_software: true,
            ..Self::default()
        }
    }
}

/// What an adapter is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum AdapterKind {
    /// A GPU with memory of its own.
    Discrete,
    /// A GPU that shares the CPU's memory.
    Integrated,
    /// A GPU seen through a virtual machine.
    Virtual,
    /// The driver does not say.
    Other,
    /// A program on the CPU.
    Software,
}

impl std::fmt::Display for AdapterKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Discrete => "discrete",
            Self::Integrated => "integrated",
            Self::Virtual => "virtual",
            Self::Other => "other",
            Self::Software => "software",
        })
    }
}

/// The limits of an adapter that bodies and kernels run into.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct AdapterLimits {
    /// The largest storage binding \[bytes\].
    pub storage_binding: u64,
    /// The largest buffer \[bytes\].
    pub buffer: u64,
    /// Storage buffers that one shader may use.
    pub storage_buffers: u32,
    /// Bind groups that one pipeline may use.
    pub bind_groups: u32,
    /// Lanes of one workgroup.
    pub workgroup_lanes: u32,
    /// Memory of one workgroup \[bytes\].
    pub workgroup_memory: u32,
}

/// An adapter as plain data.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct AdapterSummary {
    /// Its name, as the driver gives it.
    pub name: String,
    /// The driver and its version.
    pub driver: String,
    /// The programming interface behind it: `vulkan`, `metal` or `dx12`.
    pub backend: &'static str,
    /// What it is.
    pub kind: AdapterKind,
    /// What it allows.
    pub limits: AdapterLimits,
    /// Whether it can tell how long its work took.
    pub timestamps: bool,
    /// Why this crate cannot use it; `None` if it can.
    pub refusal: Option<GpuError>,
}

impl AdapterSummary {
    pub(crate) fn new(adapter: &wgpu::Adapter) -> Self {
        let info = adapter.get_info();
        let limits = adapter.limits();
        let driver = [info.driver.as_str(), info.driver_info.as_str()]
            .join(" ")
            .trim()
            .to_owned();
        Self {
            driver,
            backend: info.backend.to_str(),
            kind: kind(info.device_type, &info.name),
            limits: AdapterLimits {
                storage_binding: limits.max_storage_buffer_binding_size,
                buffer: limits.max_buffer_size,
                storage_buffers: limits.max_storage_buffers_per_shader_stage,
                bind_groups: limits.max_bind_groups,
                workgroup_lanes: limits.max_compute_invocations_per_workgroup,
                workgroup_memory: limits.max_compute_workgroup_storage_size,
            },
            timestamps: adapter.features().contains(Features::TIMESTAMP_QUERY),
            refusal: check_limits(&info.name, &limits, 0).err(),
            name: info.name,
        }
    }
}

/// All adapters of this machine: discrete ones first, software last, then by name and driver. The
/// order is the same every time.
pub fn adapters() -> Vec<AdapterSummary> {
    found().into_iter().map(|(summary, _)| summary).collect()
}

/// Adapters that are behind an interface this crate is built for, in order.
fn found() -> Vec<(AdapterSummary, wgpu::Adapter)> {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    // Validation by the driver's own layers only where the environment asks for it: a debug build
    // must not behave unlike a release build.
    descriptor.flags = InstanceFlags::VALIDATION_INDIRECT_CALL.with_env();
    let instance = wgpu::Instance::new(descriptor);
    sorted(pollster::block_on(
        instance.enumerate_adapters(Backends::all()),
    ))
}

/// Adapters in the order of [`adapters`].
fn sorted(adapters: Vec<wgpu::Adapter>) -> Vec<(AdapterSummary, wgpu::Adapter)> {
    let mut adapters: Vec<_> = adapters
        .into_iter()
        .map(|adapter| (AdapterSummary::new(&adapter), adapter))
        .collect();
    adapters.sort_by_cached_key(|(summary, adapter)| {
        let info = adapter.get_info();
        (
            summary.kind,
            order(info.backend),
            summary.name.to_lowercase(),
            summary.driver.clone(),
            info.device_pci_bus_id,
        )
    });
    adapters
}

/// Where one device is behind several interfaces, the one that all platforms share comes first.
fn order(backend: Backend) -> usize {
    let known = [Backend::Vulkan, Backend::Metal, Backend::Dx12];
    known
        .iter()
        .position(|&b| b == backend)
        .unwrap_or(known.len())
}

/// Drivers that compute on the CPU, some of which call themselves something else.
fn kind(device_type: DeviceType, name: &str) -> AdapterKind {
    let name = name.to_lowercase();
    let software = ["llvmpipe", "swiftshader", "software", "basic render"];
    if software.iter().any(|part| name.contains(part)) {
        return AdapterKind::Software;
    }
    match device_type {
        DeviceType::Cpu => AdapterKind::Software,
        DeviceType::DiscreteGpu => AdapterKind::Discrete,
        DeviceType::IntegratedGpu => AdapterKind::Integrated,
        DeviceType::VirtualGpu => AdapterKind::Virtual,
        DeviceType::Other => AdapterKind::Other,
    }
}

/// The first adapter in order that is what was asked for and can be used.
pub(crate) fn choose(
    request: &AdapterRequest,
) -> Result<(AdapterSummary, wgpu::Adapter), GpuError> {
    choose_from(found(), request, |_| true)
}

/// The same of adapters that somebody else has found, and of those the first that is fit. No more are asked.
pub(crate) fn choose_among(
    adapters: Vec<wgpu::Adapter>,
    request: &AdapterRequest,
    is_fit: impl Fn(&wgpu::Adapter) -> bool,
) -> Result<(AdapterSummary, wgpu::Adapter), GpuError> {
    choose_from(sorted(adapters), request, is_fit)
}

fn choose_from(
    found: Vec<(AdapterSummary, wgpu::Adapter)>,
    request: &AdapterRequest,
    is_fit: impl Fn(&wgpu::Adapter) -> bool,
) -> Result<(AdapterSummary, wgpu::Adapter), GpuError> {
    let names: Vec<String> = found.iter().map(|(s, _)| s.name.clone()).collect();
    let mut refusal = None;
    for (summary, adapter) in found {
        if !matches(request, &summary) {
            continue;
        }
        match check_limits(&summary.name, &adapter.limits(), request.storage_binding) {
            Ok(()) if is_fit(&adapter) => return Ok((summary, adapter)),
            Ok(()) => {}
            Err(error) => refusal = refusal.or(Some(error)),
        }
    }
    Err(refusal.unwrap_or(GpuError::NoAdapter {
        asked: request.name.clone(),
        found: names,
    }))
}

fn matches(request: &AdapterRequest, summary: &AdapterSummary) -> bool {
    match &request.name {
        Some(part) => summary
            .name
            .to_lowercase()
            .contains(part.to_lowercase().as_str()),
        None => request.allow_software || summary.kind != AdapterKind::Software,
    }
}

/// The limits that a device is opened with: those of every WebGPU device, and the adapter's own
/// where bodies grow with them.
pub(crate) fn limits_to_open(request: &AdapterRequest, adapter: &Limits) -> Limits {
    let portable = Limits::default();
    if request.portable_limits {
        return portable;
    }
    Limits {
        max_buffer_size: adapter.max_buffer_size,
        max_storage_buffer_binding_size: adapter.max_storage_buffer_binding_size,
        max_compute_invocations_per_workgroup: adapter.max_compute_invocations_per_workgroup,
        max_compute_workgroup_size_x: adapter.max_compute_workgroup_size_x,
        max_compute_workgroup_storage_size: adapter.max_compute_workgroup_storage_size,
        ..portable
    }
    // An adapter may have less than WebGPU asks for where this crate needs nothing, in textures say.
    .or_worse_values_from(adapter)
}

/// Whether an adapter or device named `name` has what the kernels need, and a storage binding of
/// `storage_binding` bytes.
pub(crate) fn check_limits(
    name: &str,
    have: &Limits,
    storage_binding: u64,
) -> Result<(), GpuError> {
    let need = Limits::default();
    macro_rules! limit {
        ($limit:ident, $need:expr) => {
            (stringify!($limit), u64::from($need), u64::from(have.$limit))
        };
        ($limit:ident) => {
            limit!($limit, need.$limit)
        };
    }
    let binding = need.max_storage_buffer_binding_size.max(storage_binding);
    let limits = [
        limit!(max_storage_buffers_per_shader_stage),
        limit!(max_bind_groups),
        limit!(max_dynamic_uniform_buffers_per_pipeline_layout),
        limit!(max_compute_invocations_per_workgroup),
        limit!(max_compute_workgroup_size_x),
        limit!(max_compute_workgroup_storage_size),
        limit!(max_compute_workgroups_per_dimension),
        limit!(max_uniform_buffer_binding_size),
        limit!(max_storage_buffer_binding_size, binding),
        limit!(max_buffer_size),
    ];
    match limits.into_iter().find(|(_, need, have)| have < need) {
        None => Ok(()),
        Some((limit, need, have)) => Err(GpuError::LimitTooSmall {
            adapter: name.to_owned(),
            name: limit,
            need,
            have,
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn software_is_seen_by_its_name_too() {
        for name in ["llvmpipe (LLVM 15.0.6, 256 bits)", "Google SwiftShader"] {
            assert_eq!(
                kind(DeviceType::Other, name),
                AdapterKind::Software,
                "{name}"
            );
        }
        let of = |device_type| kind(device_type, "Some GPU");
        assert_eq!(of(DeviceType::Cpu), AdapterKind::Software);
        assert_eq!(of(DeviceType::DiscreteGpu), AdapterKind::Discrete);
    }

    #[test]
    fn a_limit_that_is_too_small_is_named() {
        let have = Limits {
            max_storage_buffers_per_shader_stage: 4,
            ..Limits::default()
        };
        let error = check_limits("Old", &have, 0).expect_err("4 are too few");
        assert_eq!(
            error,
            GpuError::LimitTooSmall {
                adapter: "Old".to_owned(),
                name: "max_storage_buffers_per_shader_stage",
                need: 8,
                have: 4
            }
        );
        let bytes = 128 << 20;
        assert_eq!(check_limits("New", &Limits::default(), bytes), Ok(()));
        let error = check_limits("New", &Limits::default(), bytes + 1);
        let error = error.expect_err("one byte too much").to_string();
        assert!(error.contains("max_storage_buffer_binding_size"), "{error}");
    }

    #[test]
    fn limits_to_open_grow_only_as_the_adapter_does() {
        let small = Limits {
            max_texture_dimension_2d: 4096,
            max_buffer_size: 1 << 30,
            max_compute_workgroup_storage_size: 32 << 10,
            ..Limits::default()
        };
        let opened = limits_to_open(&AdapterRequest::default(), &small);
        assert_eq!(opened, small, "textures shrink, the rest grows");
        let portable = AdapterRequest {
            portable_limits: true,
            ..AdapterRequest::default()
        };
        assert_eq!(limits_to_open(&portable, &small), Limits::default());
    }
}
