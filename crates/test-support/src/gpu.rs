//! Test runner for tests that need a GPU adapter.
//!
//! Without a suitable adapter the tests are ignored, or fail if `INCISE_REQUIRE_GPU` is set.

use incise_pbd_gpu::{AdapterRequest, AdapterSummary, Context, GpuError, adapters};
use libtest_mimic::{Arguments, Completion, Failed, Trial};
use std::cell::RefCell;
use std::process::ExitCode;
use std::sync::OnceLock;

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

    fn is_met(self) -> bool {
        // Cached, since listing adapters loads every driver.
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

/// Creates a test that passes unless it panics.
///
/// The tests of a thread share a device that works, so that each kernel is compiled once; software
/// adapters take seconds. It is leaked, since a thread's destructors cannot close a device of wgpu.
pub fn trial(name: &str, needs: Needs, test: impl FnOnce(Context) + Send + 'static) -> Trial {
    thread_local! {
        static OPEN: RefCell<[Option<&'static Context>; 2]> = const { RefCell::new([None; 2]) };
    }
    trial_with(name, needs, test, move || {
        OPEN.with_borrow_mut(|open| {
            let open = &mut open[needs as usize];
            let context = match *open {
                Some(context) if context.check().is_ok() => context,
                _ => Box::leak(Box::new(Context::open(&needs.request())?)),
            };
            *open = Some(context);
            Ok(context.clone())
        })
    })
}

/// Creates a test with its own device, for tests that lose it or count its kernels.
pub fn trial_alone(name: &str, needs: Needs, test: impl FnOnce(Context) + Send + 'static) -> Trial {
    trial_with(name, needs, test, move || Context::open(&needs.request()))
}

fn trial_with(
    name: &str,
    needs: Needs,
    test: impl FnOnce(Context) + Send + 'static,
    open: impl FnOnce() -> Result<Context, GpuError> + Send + 'static,
) -> Trial {
    Trial::ignorable_test(name, move || {
        if !needs.is_met() {
            return without_device(needs);
        }
        test(open().map_err(|error| error.to_string())?);
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
