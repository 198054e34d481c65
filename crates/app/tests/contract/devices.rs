//! Tests of `incise devices`: text, JSON, and machines without a GPU.

use std::process::{Command, Output};

/// Runs the command with the installed GPU drivers, or with none.
fn devices(options: &[&str], drivers: bool) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_incise"));
    command.arg("devices").args(options);
    if !drivers {
        for name in ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"] {
            command.env(name, "/nonexistent/driver.json");
        }
    }
    command.output().unwrap()
}

#[cfg(not(feature = "gpu"))]
#[test]
fn a_build_without_gpu_support_is_an_error() {
    for options in [&[][..], &["--json"]] {
        let output = devices(options, true);
        assert_eq!(output.status.code(), Some(1));
        assert_eq!(output.stdout, b"");
        let err = String::from_utf8(output.stderr).unwrap();
        assert!(err.contains("no GPU support"), "{err}");
        assert!(err.contains("feature gpu"), "{err}");
    }
}

#[cfg(feature = "gpu")]
mod listed {
    use super::devices;
    use incise_pbd_gpu::adapters;
    use serde_json::Value;

    fn text(options: &[&str], drivers: bool) -> String {
        let output = devices(options, drivers);
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        String::from_utf8(output.stdout).unwrap()
    }

    #[test]
    fn json_has_every_device_in_order() {
        let json: Vec<Value> = serde_json::from_str(&text(&["--json"], true)).unwrap();
        let found = adapters();
        assert_eq!(json.len(), found.len());
        for (json, adapter) in json.iter().zip(&found) {
            let names: Vec<&str> = json
                .as_object()
                .unwrap()
                .keys()
                .map(String::as_str)
                .collect();
            let mut expected = [
                "name",
                "kind",
                "driver",
                "backend",
                "storage_binding",
                "buffer",
                "storage_buffers",
                "bind_groups",
                "workgroup_lanes",
                "workgroup_memory",
                "timestamps",
                "usable",
                "refusal",
            ];
            expected.sort_unstable();
            let mut names = names;
            names.sort_unstable();
            assert_eq!(names, expected);
            assert_eq!(json["name"], adapter.name.as_str());
            assert_eq!(json["storage_binding"], adapter.limits.storage_binding);
            assert_eq!(json["workgroup_memory"], adapter.limits.workgroup_memory);
            assert_eq!(json["usable"], adapter.refusal.is_none());
            assert_eq!(json["usable"], json["refusal"].is_null());
        }
    }

    #[test]
    fn text_lists_every_device_and_whether_it_is_usable() {
        let out = text(&[], true);
        let found = adapters();
        for adapter in &found {
            assert!(out.lines().any(|line| line == adapter.name), "{out}");
        }
        let usable = found.iter().filter(|a| a.refusal.is_none()).count();
        let yes = "usable                yes";
        assert_eq!(out.matches(yes).count(), usable, "{out}");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_machine_without_a_gpu_is_no_error() {
        let out = text(&[], false);
        assert!(
            out.contains("no GPU; bodies are stepped on the CPU"),
            "{out}"
        );
        assert!(out.contains("mesa-vulkan-drivers"), "{out}");
        assert_eq!(text(&["--json"], false), "[]\n");
    }
}
