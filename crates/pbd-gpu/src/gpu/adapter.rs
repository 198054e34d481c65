//! Enumeration of GPU adapters and the choice of one.

use super::error::GpuError;
use wgpu::{Backend, Backends, DeviceType, Features, InstanceFlags, Limits};

/// A request for an adapter and its device limits.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct AdapterRequest {
    /// Substring of the adapter's name, ignoring case. A named adapter may be a software adapter.
    pub name: Option<String>,
    /// Allows software adapters if there is no GPU.
    ///
    /// They give the results of a GPU but are slower than [`Solver::step`](crate::Solver::step).
    pub allow_software: bool,
    /// Minimum size of a storage binding \[bytes\].
    pub storage_binding: u64,
    /// Opens the device with the default limits of WebGPU instead of those of the adapter.
    pub portable_limits: bool,
}

impl AdapterRequest {
    /// Returns a request for the named or the best adapter, software adapters included.
    #[must_use]
    pub fn any(name: Option<String>) -> Self {
        Self {
            name,
            allow_software: true,
            ..Self::default()
        }
    }
}

/// Type of an adapter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum AdapterKind {
    /// A GPU with dedicated memory.
    Discrete,
    /// A GPU that shares the CPU's memory.
    Integrated,
    /// A GPU of a virtual machine.
    Virtual,
    /// The driver reports no type.
    Other,
    /// A software implementation on the CPU.
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

/// The limits of an adapter that bound bodies and kernels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct AdapterLimits {
    /// Maximum size of a storage binding \[bytes\].
    pub storage_binding: u64,
    /// Maximum size of a buffer \[bytes\].
    pub buffer: u64,
    /// Storage buffers per shader stage.
    pub storage_buffers: u32,
    /// Bind groups per pipeline.
    pub bind_groups: u32,
    /// Invocations per workgroup.
    pub workgroup_lanes: u32,
    /// Workgroup memory \[bytes\].
    pub workgroup_memory: u32,
}

/// Description of an adapter.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct AdapterSummary {
    /// Name from the driver.
    pub name: String,
    /// Name and version of the driver.
    pub driver: String,
    /// Graphics API: `vulkan`, `metal` or `dx12`.
    pub backend: &'static str,
    /// Type of the adapter.
    pub kind: AdapterKind,
    /// Limits of the adapter.
    pub limits: AdapterLimits,
    /// True if the adapter supports timestamp queries.
    pub timestamps: bool,
    /// Reason why this crate cannot use the adapter; `None` if it can.
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

/// Returns all adapters: discrete first, software last, then by name and driver.
///
/// The order is deterministic.
pub fn adapters() -> Vec<AdapterSummary> {
    found().into_iter().map(|(summary, _)| summary).collect()
}

/// Enumerates the adapters of the graphics APIs that this crate is built for, in order.
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

/// Sorts adapters in the order of [`adapters`].
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

/// Returns the rank of a graphics API among several for the same GPU.
fn order(backend: Backend) -> usize {
    let known = [Backend::Vulkan, Backend::Metal, Backend::Dx12];
    known
        .iter()
        .position(|&b| b == backend)
        .unwrap_or(known.len())
}

/// Returns the type of an adapter; some software adapters are detected by name.
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

/// Returns the first usable adapter that matches a request.
pub(crate) fn choose(
    request: &AdapterRequest,
) -> Result<(AdapterSummary, wgpu::Adapter), GpuError> {
    choose_from(found(), request, |_| true)
}

/// Returns the first usable adapter of a list that matches a request and satisfies `is_fit`.
///
/// Adapters after it are not passed to `is_fit`.
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

/// Returns the limits to open a device with.
///
/// They are the WebGPU defaults, and the adapter's own for buffer sizes.
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
    // An adapter may have less than WebGPU asks for where this crate needs nothing, in textures
    // say.
    .or_worse_values_from(adapter)
}

/// Returns an error if limits are below those of the kernels or of `storage_binding` bytes.
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
    fn software_adapters_are_detected_by_name() {
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
    fn errors_name_the_limit_that_is_too_small() {
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
    fn limits_do_not_exceed_those_of_the_adapter() {
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
