//! Errors of GPU devices and of the GPU backend.

use crate::StepError;

/// An error of opening or using a GPU device.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GpuError {
    /// No adapter matches the request.
    #[error("{}", no_adapter(asked.as_deref(), found))]
    NoAdapter {
        /// Requested part of a name.
        asked: Option<String>,
        /// Names of the available adapters; without a requested name, all are software adapters.
        found: Vec<String>,
    },
    /// A limit of the adapter or device is too low.
    #[error(
        "{adapter} has {name} = {have}, but {need} is required; choose another adapter, or open \
         the device with higher limits"
    )]
    LimitTooSmall {
        /// Name of the adapter.
        adapter: String,
        /// WebGPU name of the limit.
        name: &'static str,
        /// Required value.
        need: u64,
        /// Value of the adapter or device.
        have: u64,
    },
    /// A buffer or binding would be larger than the device allows.
    #[error(
        "{what} needs {bytes} bytes, but the GPU device allows {limit}; use fewer or smaller \
         bodies, or open the device with the adapter's own limits"
    )]
    BufferTooLarge {
        /// Purpose of the buffer.
        what: String,
        /// Required size \[bytes\].
        bytes: u64,
        /// Maximum size of the device \[bytes\].
        limit: u64,
    },
    /// GPU memory is exhausted.
    #[error("{what}: the GPU is out of memory; remove bodies or use smaller ones")]
    OutOfMemory {
        /// Operation that failed.
        what: String,
    },
    /// The device is lost, with all of its resources.
    #[error("the GPU device is lost ({reason}); open a new one and upload the bodies again")]
    DeviceLost {
        /// Message of the driver.
        reason: String,
    },
    /// wgpu rejected a shader or a call, because of a defect here or in another user of the device.
    #[error("{what}: wgpu rejected a call: {message}; this is a bug, please report it")]
    Validation {
        /// Operation that failed.
        what: String,
        /// Message of wgpu.
        message: String,
    },
    /// The driver failed at a valid call.
    #[error("{what} failed in the driver: {message}; update the driver or choose another adapter")]
    Driver {
        /// Operation that failed.
        what: String,
        /// Message of the driver.
        message: String,
    },
    /// The adapter failed to open a device.
    #[error(
        "{adapter} failed to open a device: {message}; choose another adapter or update its driver"
    )]
    Request {
        /// Name of the adapter.
        adapter: String,
        /// Message of the driver.
        message: String,
    },
    /// Submitted work was not finished in time.
    #[error(
        "the GPU did not finish within {seconds} s; use fewer substeps or iterations, or smaller \
         bodies"
    )]
    Timeout {
        /// Time limit \[s\].
        seconds: f64,
    },
    /// The frame exceeds the maximum number of dispatches.
    #[error(
        "the frame needs {dispatches} dispatches, but {limit} are allowed; use fewer substeps or \
         iterations"
    )]
    TooManyDispatches {
        /// Dispatches of the frame.
        dispatches: u32,
        /// Maximum number of dispatches.
        limit: u32,
    },
    /// The adapter ends loops too early for the pins, colliders or cells of a solid.
    #[error(
        "{adapter} ends loops too early for a solid with so many pins, or vertices and colliders; \
         choose another adapter, or step the solid on the CPU"
    )]
    LoopsTooShort {
        /// Name of the adapter.
        adapter: String,
    },
    /// The body is not in this backend, or was removed.
    #[error("the body is not in this GPU backend; add it first")]
    UnknownBody,
    /// Surface or solver were edited without [`GpuBackend::update`](crate::GpuBackend::update).
    #[error("the CPU copy of the body was edited; call `update` first")]
    StaleBody,
    /// The solver is not that of the body: it belongs to another body, or is a clone.
    #[error("the solver is not that of the GPU body; call `update` with it first")]
    ForeignSolver,
    /// The parameters of the frame are invalid, or a position is not finite.
    #[error(transparent)]
    Step(#[from] StepError),
}

impl GpuError {
    /// Converts an error of wgpu during operation `what`.
    pub(crate) fn of_call(what: &str, error: &wgpu::Error) -> Self {
        let what = what.to_owned();
        match error {
            wgpu::Error::OutOfMemory { .. } => Self::OutOfMemory { what },
            wgpu::Error::Validation { description, .. } => Self::Validation {
                what,
                message: description.trim().to_owned(),
            },
            wgpu::Error::Internal { description, .. } => Self::Driver {
                what,
                message: description.trim().to_owned(),
            },
        }
    }
}

/// Returns the message for a missing adapter: the request, the available adapters, and advice.
fn no_adapter(asked: Option<&str>, found: &[String]) -> String {
    let install = "install a driver (on Debian mesa-vulkan-drivers and libvulkan1)";
    let names = found.join(", ");
    match (asked, found) {
        (None, []) => format!("there is no GPU adapter; {install}"),
        (Some(name), []) => format!("there is no GPU adapter, so none named '{name}'; {install}"),
        (None, _) => format!(
            "there are only software adapters ({names}); request one by name, allow software \
             adapters, or {install}"
        ),
        (Some(name), _) => format!("no GPU adapter is named '{name}'; there are {names}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_adapter_says_what_there_is_and_what_helps() {
        let error = |asked: Option<&str>, found: &[&str]| {
            let asked = asked.map(str::to_owned);
            let found = found.iter().map(|&name| name.to_owned()).collect();
            GpuError::NoAdapter { asked, found }.to_string()
        };
        let install = "mesa-vulkan-drivers";
        assert!(error(None, &[]).contains(install), "nothing there");
        assert!(error(Some("x"), &[]).contains(install), "nothing to name");
        let software = error(None, &["llvmpipe"]);
        assert!(
            software.contains("llvmpipe") && software.contains("allow software"),
            "{software}"
        );
        let named = error(Some("Radeon"), &["llvmpipe", "SwiftShader"]);
        assert!(
            named.contains("'Radeon'") && named.contains("llvmpipe, SwiftShader"),
            "{named}"
        );
    }
}
