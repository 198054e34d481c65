//! Views of JavaScript into the memory of WebAssembly, without a copy.

#![allow(
    unsafe_code,
    reason = "js-sys marks views as unsafe, because Rust cannot see how long JavaScript uses them"
)]

use js_sys::{Float32Array, Uint8Array, Uint32Array};

/// Returns a view of an array.
pub(crate) fn view_f32(numbers: &[f32]) -> Float32Array {
    // SAFETY: the view becomes invalid when Rust moves or frees the array, and JavaScript reads
    // memory of this module then, as it may at any time: no memory of the process is reached.
    // Nothing in Rust depends on the content of the arrays that are viewed, and the module is
    // single-threaded. The README states the rule for users.
    unsafe { Float32Array::view(numbers) }
}

/// Returns a view of an array.
pub(crate) fn view_u32(numbers: &[u32]) -> Uint32Array {
    // SAFETY: see `view_f32`.
    unsafe { Uint32Array::view(numbers) }
}

/// Returns a view of an array.
pub(crate) fn view_u8(numbers: &[u8]) -> Uint8Array {
    // SAFETY: see `view_f32`.
    unsafe { Uint8Array::view(numbers) }
}
