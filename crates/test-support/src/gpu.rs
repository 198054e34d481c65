//! Test runner for tests that need a GPU adapter.
//!
//! Without a suitable adapter the tests are ignored, or fail if `INCISE_REQUIRE_GPU` is set.

use incise_pbd_gpu::{AdapterRequest, AdapterSummary, Context, GpuError, adapters};
use libtest_mimic::{Arguments, Completion, Failed, Trial};
use std::panic::AssertUnwindSafe;
use std::process::ExitCode;
use std::sync::{Mutex, OnceLock, PoisonError};

/// The adapter that a test needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Needs {
    /// Any adapter; hardware adapters come first.
    AnyDevice,
    /// An adapter that rounds every operation like the CPU, so that results are bit-identical.
    ///
    /// Drivers may fuse and reorder operations; `SwiftShader` does not.
    Strict,
}

impl Needs {
    /// Returns a request for such an adapter.
    #[must_use]
    pub fn request(self) -> AdapterRequest {
        AdapterRequest::any((self == Self::Strict).then(|| STRICT.to_owned()))
    }

    /// Returns a request for such an adapter with the default limits of WebGPU.
    #[must_use]
    pub fn portable_request(self) -> AdapterRequest {
        AdapterRequest {
            portable_limits: true,
            ..self.request()
        }
    }

    /// Returns the first such adapter.
    fn adapter(self) -> Option<&'static AdapterSummary> {
        usable().find(|adapter| self == Self::AnyDevice || adapter.name.contains(STRICT))
    }

    fn absent(self) -> &'static str {
        match self {
            Self::AnyDevice => {
                "no Vulkan, Metal or DX12 adapter found; on Debian install mesa-vulkan-drivers and \
                 libvulkan1"
            }
            Self::Strict => {
                "SwiftShader not found; on Debian install chromium and add \
                 /usr/lib/chromium/vk_swiftshader_icd.json to VK_DRIVER_FILES"
            }
        }
    }
}

const STRICT: &str = "SwiftShader";

/// Returns the adapters that the backend can use, in the order of [`adapters`].
fn usable() -> impl Iterator<Item = &'static AdapterSummary> {
    // Cached, since listing adapters loads every driver.
    static FOUND: OnceLock<Vec<AdapterSummary>> = OnceLock::new();
    let found = FOUND.get_or_init(adapters);
    found.iter().filter(|adapter| adapter.refusal.is_none())
}

/// Returns a working device that all tests of the program share, so that kernels compile once.
///
/// Software adapters take seconds to compile them. The device stays open until the program ends.
fn shared(adapter: &AdapterSummary) -> Result<Context, GpuError> {
    static OPEN: Mutex<Vec<Context>> = Mutex::new(Vec::new());
    let mut open = OPEN.lock().unwrap_or_else(PoisonError::into_inner);
    open.retain(|context| context.check().is_ok());
    if let Some(context) = open.iter().find(|c| c.adapter().name == adapter.name) {
        return Ok(context.clone());
    }
    let context = Context::open(&AdapterRequest::any(Some(adapter.name.clone())))?;
    open.push(context.clone());
    Ok(context)
}

/// Runs a test on every adapter, software adapters included.
///
/// # Panics
/// If an adapter cannot be opened.
pub fn on_every_adapter(test: impl Fn(Context)) {
    for adapter in usable() {
        let context = shared(adapter).expect("an adapter that was listed as usable");
        let run = || test(context);
        if let Err(panic) = std::panic::catch_unwind(AssertUnwindSafe(run)) {
            eprintln!("on {}:", adapter.name);
            std::panic::resume_unwind(panic);
        }
    }
}

/// Creates a test that passes unless it panics, on a device that tests share.
pub fn trial(name: &str, needs: Needs, test: impl FnOnce(Context) + Send + 'static) -> Trial {
    trial_with(name, needs, test, shared)
}

/// Creates a test with its own device, for tests that lose it or count its kernels.
pub fn trial_alone(name: &str, needs: Needs, test: impl FnOnce(Context) + Send + 'static) -> Trial {
    trial_with(name, needs, test, move |_| Context::open(&needs.request()))
}

/// Marks a test as one that takes long: it runs with `--ignored` or `--include-ignored` only.
#[must_use]
pub fn long(trial: Trial) -> Trial {
    trial.with_kind("long").with_ignored_flag(true)
}

fn trial_with(
    name: &str,
    needs: Needs,
    test: impl FnOnce(Context) + Send + 'static,
    open: impl FnOnce(&AdapterSummary) -> Result<Context, GpuError> + Send + 'static,
) -> Trial {
    Trial::ignorable_test(name, move || {
        let Some(adapter) = needs.adapter() else {
            return without_device(needs);
        };
        test(open(adapter).map_err(|error| error.to_string())?);
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

/// Runs the tests of a file; call it from `main`.
pub fn run(trials: Vec<Trial>) -> ExitCode {
    libtest_mimic::run(&Arguments::from_args(), trials).exit_code()
}
