//! Tests that need a process of their own: without drivers, and without memory.

use crate::child_process::{child, this_program};
use incise_pbd_gpu::wgpu::BufferUsages;
use incise_pbd_gpu::{AdapterKind, AdapterRequest, Context, GpuError, adapters};
use incise_test_support::gpu::Needs;
use libtest_mimic::{Completion, Failed, Trial};
use std::process::{Command, ExitCode, Output};

/// A driver that is not there, so that the loader finds none.
const NOWHERE: &str = "/nonexistent/driver.json";

/// The trials, of which those that use the loader's variables exist on Linux only.
pub(crate) fn trials() -> [Trial; 2] {
    let no_drivers = || {
        assert_success(without_drivers(child("no_adapters")).output());
        ignored_or_failed();
        Ok(())
    };
    [
        Trial::test("a_process_without_drivers_has_no_adapter", no_drivers)
            .with_ignored_flag(!cfg!(target_os = "linux")),
        Trial::ignorable_test("exhausted_memory_is_an_error", out_of_memory),
    ]
}

/// Makes a process find no driver.
fn without_drivers(mut command: Command) -> Command {
    command.envs([("VK_DRIVER_FILES", NOWHERE), ("VK_ICD_FILENAMES", NOWHERE)]);
    command
}

fn assert_success(output: std::io::Result<Output>) {
    let output = output.expect("a child process starts");
    assert!(output.status.success(), "{output:?}");
}

/// Succeeds if there is no adapter and the error says what to install.
pub(crate) fn no_adapters() -> ExitCode {
    assert_eq!(adapters(), Vec::new(), "the loader finds no driver");
    for name in [None, Some("llvmpipe".to_owned())] {
        let request = AdapterRequest::any(name.clone());
        let error = Context::open(&request).expect_err("there is nothing to open");
        let text = error.to_string();
        assert!(text.contains("mesa-vulkan-drivers"), "{text}");
        let found = Vec::new();
        assert_eq!(error, GpuError::NoAdapter { asked: name, found });
    }
    ExitCode::SUCCESS
}

/// Runs one test where there is no driver: it is ignored unless a GPU is required.
fn ignored_or_failed() {
    for (required, ok, word) in [
        ("", true, "1 ignored"),
        ("0", true, "1 ignored"),
        ("1", false, "INCISE_REQUIRE_GPU is set"),
    ] {
        let output = without_drivers(this_program())
            .args(["--exact", crate::NEEDS_ANY_ADAPTER])
            .env("INCISE_REQUIRE_GPU", required)
            .output()
            .expect("a child process starts");
        let text = String::from_utf8_lossy(&output.stdout);
        assert_eq!(output.status.success(), ok, "{text}");
        assert!(text.contains(word), "{text}");
    }
}

/// Buffers of a software adapter are in process memory, which can be limited.
fn out_of_memory() -> Result<Completion, Failed> {
    if !cfg!(target_os = "linux") || software().is_none() {
        return Ok(Completion::ignored_with(
            "it needs a software adapter on Linux",
        ));
    }
    let exhaust = child("exhaust");
    let mut shell = Command::new("sh");
    shell.args(["-c", "ulimit -v 4000000 && exec \"$0\""]);
    shell.arg(exhaust.get_program());
    for (name, value) in exhaust.get_envs() {
        shell.env(name, value.unwrap_or_default());
    }
    assert_success(shell.output());
    Ok(Completion::Completed)
}

/// Returns the name of the first software adapter.
fn software() -> Option<String> {
    let mut found = adapters().into_iter();
    let software = found.find(|adapter| adapter.kind == AdapterKind::Software);
    software.map(|adapter| adapter.name)
}

/// Allocates more memory than the process may have.
pub(crate) fn exhaust() -> ExitCode {
    let request = AdapterRequest {
        name: software(),
        ..Needs::AnyDevice.portable_request()
    };
    let context = Context::open(&request).expect("this much memory is there");
    let mut buffers = Vec::new();
    let error = loop {
        match context.buffer("ballast", 128 << 20, BufferUsages::STORAGE) {
            Ok(buffer) => buffers.push(buffer),
            Err(error) => break error,
        }
        assert!(buffers.len() < 64, "8 GiB fit into 4");
    };
    assert!(
        matches!(&error, GpuError::OutOfMemory { what } if what == "ballast"),
        "{error:?}"
    );
    drop(buffers);
    context
        .buffer("pins", 16, BufferUsages::STORAGE)
        .expect("the device is as before");
    ExitCode::SUCCESS
}
