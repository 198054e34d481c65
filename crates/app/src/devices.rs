//! `incise devices`: lists the GPUs, their limits, and whether incise can use them.

/// Lists the GPUs of this machine, hardware ones first, and says whether incise can use them.
#[derive(clap::Args)]
pub(crate) struct DevicesArguments {}

/// Returns an error: this build has no GPU support.
#[cfg(not(feature = "gpu"))]
pub(crate) fn run(
    _arguments: &DevicesArguments,
    _reporter: &mut crate::reporter::Reporter<impl std::io::Write>,
) -> Result<(), crate::failure::Failure> {
    Err(crate::failure::Failure::NoGpuSupport)
}

#[cfg(feature = "gpu")]
pub(crate) use list::run;

#[cfg(feature = "gpu")]
mod list {
    use super::DevicesArguments;
    use crate::failure::Failure;
    use crate::reporter::Reporter;
    use incise_pbd_gpu::{AdapterSummary, adapters};
    use serde::Serialize;
    use std::fmt::Display;
    use std::io::{self, Write};

    /// A device as JSON; sizes are bytes.
    #[derive(Serialize)]
    struct JsonDevice<'a> {
        name: &'a str,
        kind: String,
        driver: &'a str,
        backend: &'a str,
        storage_binding: u64,
        buffer: u64,
        storage_buffers: u32,
        bind_groups: u32,
        workgroup_lanes: u32,
        workgroup_memory: u32,
        timestamps: bool,
        usable: bool,
        refusal: Option<String>,
    }

    /// Runs the command.
    pub(crate) fn run(
        _arguments: &DevicesArguments,
        reporter: &mut Reporter<impl Write>,
    ) -> Result<(), Failure> {
        let devices = adapters();
        let report: Vec<JsonDevice<'_>> = devices.iter().map(as_json).collect();
        let written = reporter.report(&report, |_, out| {
            if devices.is_empty() {
                writeln!(
                    out,
                    "no GPU; bodies are stepped on the CPU. Install a driver: on Debian the \
                     packages mesa-vulkan-drivers and libvulkan1"
                )?;
            }
            devices.iter().try_for_each(|device| print(device, out))
        });
        Ok(written?)
    }

    fn as_json(device: &AdapterSummary) -> JsonDevice<'_> {
        let limits = &device.limits;
        JsonDevice {
            name: &device.name,
            kind: device.kind.to_string(),
            driver: &device.driver,
            backend: device.backend,
            storage_binding: limits.storage_binding,
            buffer: limits.buffer,
            storage_buffers: limits.storage_buffers,
            bind_groups: limits.bind_groups,
            workgroup_lanes: limits.workgroup_lanes,
            workgroup_memory: limits.workgroup_memory,
            timestamps: device.timestamps,
            usable: device.refusal.is_none(),
            refusal: device.refusal.as_ref().map(ToString::to_string),
        }
    }

    fn print(device: &AdapterSummary, out: &mut impl Write) -> io::Result<()> {
        writeln!(out, "{}", device.name)?;
        let mut line = |name: &str, value: &dyn Display| writeln!(out, "  {name:<22}{value}");
        let limits = &device.limits;
        line("kind", &device.kind.to_string())?;
        line("driver", &device.driver)?;
        line("backend", &device.backend)?;
        line("storage binding", &size(limits.storage_binding))?;
        line("buffer", &size(limits.buffer))?;
        line("storage buffers", &limits.storage_buffers)?;
        line("bind groups", &limits.bind_groups)?;
        line("workgroup lanes", &limits.workgroup_lanes)?;
        line(
            "workgroup memory",
            &size(u64::from(limits.workgroup_memory)),
        )?;
        let timestamps = if device.timestamps { "yes" } else { "no" };
        line("timestamps", &timestamps)?;
        match &device.refusal {
            None => line("usable", &"yes"),
            Some(reason) => line("usable", &format!("no: {reason}")),
        }
    }

    /// Formats bytes in the largest unit of which there are at least two.
    fn size(bytes: u64) -> String {
        let units = [("GiB", 30), ("MiB", 20), ("KiB", 10)];
        let unit = units.iter().find(|(_, shift)| bytes >> shift >= 2);
        match unit {
            Some((unit, shift)) => format!("{} {unit}", bytes >> shift),
            None => format!("{bytes} bytes"),
        }
    }

    #[cfg(test)]
    mod tests {
        use super::size;

        #[test]
        fn sizes_use_the_largest_unit() {
            assert_eq!(size(128 << 20), "128 MiB");
            assert_eq!(size(1 << 30), "1024 MiB");
            assert_eq!(size((2 << 30) - 1), "2047 MiB");
            assert_eq!(size(32 << 10), "32 KiB");
            assert_eq!(size(17), "17 bytes");
        }
    }
}
