//! What can go wrong between this crate and a device.

use crate::StepError;

/// Why a device cannot be opened, does not take a call, or is gone.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GpuError {
    /// No adapter is what was asked for.
    #[error("{}", no_adapter(asked.as_deref(), found))]
    NoAdapter {
        /// The part of a name that was asked for.
        asked: Option<String>,
        /// The names of the adapters there are. Without a name asked for, all of them are software.
        found: Vec<String>,
    },
    /// The adapter or device can do less than what is needed.
    #[error(
        "{adapter} has {name} = {have}, {need} is needed; choose another adapter, or open the device with higher limits"
    )]
    LimitTooSmall {
        /// The adapter's name.
        adapter: String,
        /// The limit, as WebGPU calls it.
        name: &'static str,
        /// What is needed.
        need: u64,
        /// What the adapter or device has.
        have: u64,
    },
    /// More bytes than the device takes as one buffer or binding.
    #[error(
        "{what} would take {bytes} bytes, the device allows {limit}; use fewer or smaller bodies, or open it with the adapter's own limits"
    )]
    BufferTooLarge {
        /// What the buffer is for.
        what: String,
        /// Its size \[bytes\].
        bytes: u64,
        /// The largest that the device allows \[bytes\].
        limit: u64,
    },
    /// The device has no memory left.
    #[error("{what}: the device is out of memory; remove bodies or use smaller ones")]
    OutOfMemory {
        /// What was being done.
        what: String,
    },
    /// The device is gone, and all that lay on it.
    #[error("the device is lost ({reason}); open a new one and upload the bodies again")]
    DeviceLost {
        /// What the driver said.
        reason: String,
    },
    /// A shader or a call was refused. That is a defect of this crate, or of who shares its device.
    #[error("{what} was refused: {message}; this is a defect, please report it")]
    Validation {
        /// What was being done.
        what: String,
        /// Why it was refused.
        message: String,
    },
    /// The driver failed at something that is allowed.
    #[error("{what} failed in the driver: {message}; update the driver or choose another adapter")]
    Driver {
        /// What was being done.
        what: String,
        /// What it said.
        message: String,
    },
    /// The adapter is there but opens no device.
    #[error("{adapter} opens no device: {message}; choose another adapter or update its driver")]
    Request {
        /// The adapter's name.
        adapter: String,
        /// What the driver said.
        message: String,
    },
    /// Submitted work did not end in time.
    #[error(
        "the device did not finish within {seconds} s; use fewer substeps or iterations, or smaller bodies"
    )]
    Timeout {
        /// How long was waited \[s\].
        seconds: f64,
    },
    /// A frame of more dispatches than the host should put into one list.
    #[error(
        "the frame takes {dispatches} dispatches, {limit} are allowed; use fewer substeps or iterations"
    )]
    TooManyDispatches {
        /// What the frame takes.
        dispatches: u32,
        /// What is allowed.
        limit: u32,
    },
    /// A body that the backend does not have, or has no more.
    #[error("the body is not on this device; add it first")]
    UnknownBody,
    /// Surface or solver were edited and the device has not been told.
    #[error("the body was edited on the host; update the device's copy first")]
    StaleBody,
    /// A solver that is not the one that the body follows: another body's, or a copy.
    #[error("the solver is not the one that the body follows; update the body with it first")]
    ForeignSolver,
    /// The frame itself is wrong, or a body has left the numbers.
    #[error(transparent)]
    Step(#[from] StepError),
}

impl GpuError {
    /// An error of wgpu while doing `what`.
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

/// Says what was looked for, what there is and what helps.
fn no_adapter(asked: Option<&str>, found: &[String]) -> String {
    let install = "install a driver (on Debian mesa-vulkan-drivers and libvulkan1)";
    let names = found.join(", ");
    match (asked, found) {
        (None, []) => format!("there is no GPU adapter; {install}"),
        (Some(name), []) => format!("there is no GPU adapter, so none named '{name}'; {install}"),
        (None, _) => format!(
            "there are only software adapters ({names}); ask for one by name, allow software, or {install}"
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
