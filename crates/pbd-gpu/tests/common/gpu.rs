//! Tests that need a device. Without one they show as ignored; with `INCISE_REQUIRE_GPU` set they
//! fail instead. This file is also a module of `incise-tests`, for the packages above this one.
#![allow(dead_code, reason = "every test file uses a part of it")]
#![allow(unreachable_pub, reason = "it is public in one of its two packages")]

use incise_pbd_gpu::{AdapterRequest, AdapterSummary, Context, adapters};
use libtest_mimic::{Arguments, Completion, Failed, Trial};
use std::process::ExitCode;
use std::sync::OnceLock;

/// What kind of device a test needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Needs {
    /// Any at all: the first of the machine, so a real one where there is one.
    AnyDevice,
    /// One that rounds every operation by itself, as the CPU does, so that results can be equal to the
    /// bit. Drivers are free to contract and reorder; `SwiftShader` does not.
    Strict,
}

impl Needs {
    /// The request for such a device.
    pub fn request(self) -> AdapterRequest {
        AdapterRequest::any((self == Self::Strict).then(|| STRICT.to_owned()))
    }

    fn is_met(self) -> bool {
        // Listing loads every driver, and no test adds or takes one.
        static FOUND: OnceLock<Vec<AdapterSummary>> = OnceLock::new();
        let mut usable = FOUND
            .get_or_init(adapters)
            .iter()
            .filter(|adapter| adapter.refusal.is_none());
        usable.any(|adapter| self == Self::AnyDevice || adapter.name.contains(STRICT))
    }

    fn absent(self) -> &'static str {
        match self {
            Self::AnyDevice => {
                "there is no Vulkan, Metal or DX12 device; on Debian install mesa-vulkan-drivers and libvulkan1"
            }
            Self::Strict => {
                "there is no SwiftShader; on Debian install chromium and add /usr/lib/chromium/vk_swiftshader_icd.json to VK_DRIVER_FILES"
            }
        }
    }
}

const STRICT: &str = "SwiftShader";

/// A test on a device of its own, which passes unless it panics.
pub fn trial(name: &str, needs: Needs, test: impl FnOnce(Context) + Send + 'static) -> Trial {
    Trial::ignorable_test(name, move || {
        if !needs.is_met() {
            return without_device(needs);
        }
        let context = Context::open(&needs.request()).map_err(|error| error.to_string())?;
        test(context);
        Ok(Completion::Completed)
    })
}

fn without_device(needs: Needs) -> Result<Completion, Failed> {
    let required = std::env::var("INCISE_REQUIRE_GPU").unwrap_or_default();
    if ["", "0"].contains(&required.as_str()) {
        Ok(Completion::ignored_with(needs.absent()))
    } else {
        Err(format!("INCISE_REQUIRE_GPU is set, and {}", needs.absent()).into())
    }
}

/// Runs the tests of a file, as its `main`.
pub fn run(trials: Vec<Trial>) -> ExitCode {
    libtest_mimic::run(&Arguments::from_args(), trials).exit_code()
}
