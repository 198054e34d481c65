//! Adapters and devices: enumeration, errors, and processes without a driver or memory.

mod adapters;
mod errors;
pub(crate) mod processes;

use incise_pbd_gpu::Context;

/// Adapters are chosen, and every error of a device is typed; the device is lost at the end.
pub(crate) fn adapters_and_errors(context: Context) {
    adapters::chosen(&context);
    errors::typed(&context);
}
