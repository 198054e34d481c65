//! Enumeration and opening of adapters, and their errors.
#![expect(
    clippy::missing_assert_message,
    reason = "these are tests, which the lint knows by an attribute only"
)]

use incise_pbd_gpu::{AdapterKind, AdapterRequest, Context, GpuError, adapters, wgpu};
use incise_test_support::external_device::{open, same_adapter};
use incise_test_support::gpu::{Needs, run, trial};
use libtest_mimic::Trial;
use std::process::{Command, ExitCode};

/// Tells a child process of this file to play its part.
const CHILD: &str = "INCISE_TEST_CHILD";

/// A driver that is not there, so that the loader finds none.
const NOWHERE: &str = "/nonexistent/driver.json";

fn main() -> ExitCode {
    if std::env::var_os(CHILD).is_some() {
        return without_drivers();
    }
    let any = Needs::AnyDevice;
    run(vec![
        on_linux("a_machine_without_drivers_has_no_adapter", no_drivers),
        on_linux(
            "without_a_device_a_test_is_ignored_unless_required",
            ignored_or_failed,
        ),
        Trial::test("an_unknown_name_lists_what_there_is", || {
            unknown_name();
            Ok(())
        }),
        trial("the_order_of_adapters_is_fixed", any, |_| order()),
        trial("an_adapter_is_opened_by_a_part_of_its_name", any, by_name),
        trial("software_is_not_taken_unasked", any, |_| unasked()),
        trial("a_strict_device_is_software", Needs::Strict, |context| {
            let kind = context.adapter().kind;
            assert_eq!(kind, AdapterKind::Software, "{:?}", context.adapter());
        }),
        trial("a_binding_no_adapter_has_is_refused", any, |_| {
            too_large_a_need()
        }),
        trial("portable_limits_are_kept", any, |_| portable()),
        trial("a_device_opened_with_too_little_is_refused", any, |c| {
            small(&c)
        }),
    ])
}

/// Returns a test of the loader's environment variables, which exist on Linux only.
fn on_linux(name: &str, test: fn()) -> Trial {
    Trial::test(name, move || {
        test();
        Ok(())
    })
    .with_ignored_flag(!cfg!(target_os = "linux"))
}

/// This file again, in a child process that finds no driver.
fn without_driver_files() -> Command {
    let mut command = Command::new(std::env::current_exe().expect("it runs"));
    command.envs([("VK_DRIVER_FILES", NOWHERE), ("VK_ICD_FILENAMES", NOWHERE)]);
    command
}

fn no_drivers() {
    let mut child = without_driver_files();
    let output = child.env(CHILD, "1").output();
    let output = output.expect("a child process starts");
    assert!(output.status.success(), "{output:?}");
}

/// Run in a child process: succeeds if there is no adapter and the error says what to install.
fn without_drivers() -> ExitCode {
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

/// Runs one test of this file where there is no driver, as a machine without one would.
fn ignored_or_failed() {
    for (required, ok, word) in [
        ("", true, "1 ignored"),
        ("0", true, "1 ignored"),
        ("1", false, "INCISE_REQUIRE_GPU is set"),
    ] {
        let output = without_driver_files()
            .args(["--exact", "portable_limits_are_kept"])
            .env("INCISE_REQUIRE_GPU", required)
            .output()
            .expect("a child process starts");
        let text = String::from_utf8_lossy(&output.stdout);
        assert_eq!(output.status.success(), ok, "{text}");
        assert!(text.contains(word), "{text}");
    }
}

fn unknown_name() {
    let asked = Some("no such device".to_owned());
    let request = AdapterRequest {
        name: asked.clone(),
        ..AdapterRequest::default()
    };
    let error = Context::open(&request).expect_err("none is named so");
    let found: Vec<String> = adapters().into_iter().map(|a| a.name).collect();
    let text = error.to_string();
    assert!(
        found.iter().all(|name| text.contains(name)),
        "{text} names {found:?}"
    );
    assert_eq!(error, GpuError::NoAdapter { asked, found });
}

fn order() {
    let found = adapters();
    assert_eq!(found, adapters(), "the second time too");
    assert!(
        found.is_sorted_by_key(|adapter| adapter.kind),
        "software comes last: {found:?}"
    );
}

fn by_name(first: Context) {
    drop(first);
    for adapter in adapters().into_iter().filter(|a| a.refusal.is_none()) {
        let part = adapter.name[..adapter.name.len().min(8)].to_uppercase();
        let request = AdapterRequest {
            name: Some(part.clone()),
            ..AdapterRequest::default()
        };
        let context = Context::open(&request).expect("it was listed as usable");
        let opened = context.adapter();
        assert!(
            opened.name.to_uppercase().contains(&part),
            "{part} gave {opened:?}"
        );
    }
}

fn unasked() {
    let found = adapters();
    let real = found.iter().find(|a| a.kind != AdapterKind::Software);
    match (Context::open(&AdapterRequest::default()), real) {
        (Ok(context), Some(real)) => assert_eq!(context.adapter(), real),
        (Err(error), None) => {
            let found = found.into_iter().map(|a| a.name).collect();
            assert_eq!(error, GpuError::NoAdapter { asked: None, found });
        }
        (opened, real) => panic!("there is {real:?}, opened {opened:?}"),
    }
}

fn too_large_a_need() {
    let need = 1 << 60;
    let request = AdapterRequest {
        storage_binding: need,
        ..Needs::AnyDevice.request()
    };
    let error = Context::open(&request).expect_err("an exabyte");
    let largest = adapters()[0].limits.storage_binding;
    assert_eq!(
        error,
        GpuError::LimitTooSmall {
            adapter: adapters()[0].name.clone(),
            name: "max_storage_buffer_binding_size",
            need,
            have: largest
        }
    );
}

fn portable() {
    let context = Context::open(&Needs::AnyDevice.portable_request())
        .expect("every adapter has these limits");
    assert_eq!(context.device().limits(), wgpu::Limits::default());
    let request = AdapterRequest {
        storage_binding: (128 << 20) + 4,
        ..Needs::AnyDevice.portable_request()
    };
    // The adapter is opened with lower limits, so the device is too small.
    let error = Context::open(&request).expect_err("a portable binding is smaller");
    assert!(
        matches!(error, GpuError::LimitTooSmall { need, .. } if need == request.storage_binding),
        "{error:?}"
    );
}

fn small(context: &Context) {
    let adapter = same_adapter(context);
    let (device, queue) = open(&adapter, wgpu::Limits::downlevel_defaults());
    let small = Context::from_device(&adapter, device, queue);
    assert!(
        matches!(
            small,
            Err(GpuError::LimitTooSmall {
                need: 8,
                have: 4,
                ..
            })
        ),
        "{small:?}"
    );
    let (device, queue) = open(&adapter, wgpu::Limits::default());
    let shared = Context::from_device(&adapter, device, queue).expect("this is enough");
    assert_eq!(shared.adapter(), context.adapter());
}
