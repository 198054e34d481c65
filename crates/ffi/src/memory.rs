//! The caller's memory: the only place that dereferences its pointers.
//!
//! A pointer of a caller is NULL or valid for as many values as the function's documentation says,
//! for the length of the call. That contract is what each `unsafe fn` here requires.

use crate::status::{Error, Status};
use std::ffi::{CStr, c_char};
use std::mem::MaybeUninit;
use std::{ptr, slice};

/// Returns `count` values of the caller.
///
/// # Errors
/// NULL, unless `count` is 0; a count beyond memory; a misaligned pointer.
///
/// # Safety
/// `data` is NULL or valid for reads of `count` values during `'a`. The values do not change then.
pub(crate) unsafe fn input<'a, T: Copy>(
    data: *const T,
    count: usize,
    name: &str,
) -> Result<&'a [T], Error> {
    if count == 0 {
        return Ok(&[]);
    }
    check_array(data, count, name)?;
    // SAFETY: not NULL, aligned, no longer than memory; the caller promises the rest.
    Ok(unsafe { slice::from_raw_parts(data, count) })
}

/// Returns `N` values of the caller.
///
/// # Errors
/// As [`input`].
///
/// # Safety
/// As [`input`] for `N` values.
pub(crate) unsafe fn fixed<T: Copy, const N: usize>(
    data: *const T,
    name: &str,
) -> Result<[T; N], Error> {
    // SAFETY: the caller's promise is that of `input`.
    let values = unsafe { input(data, N, name)? };
    let array = values.first_chunk().copied();
    array.ok_or_else(|| Error::null(name))
}

/// Returns `count` rows of `N` values of the caller.
///
/// # Errors
/// As [`input`].
///
/// # Safety
/// As [`input`] for `count * N` values.
pub(crate) unsafe fn input_rows<'a, T: Copy, const N: usize>(
    data: *const T,
    count: usize,
    name: &str,
) -> Result<&'a [[T; N]], Error> {
    let values = count.checked_mul(N);
    let values = values.ok_or_else(|| too_many(name, count))?;
    // SAFETY: the caller's promise is that of `input`.
    let values = unsafe { input(data, values, name)? };
    Ok(values.as_chunks().0)
}

/// Copies `values` to a buffer of `capacity` values.
///
/// # Errors
/// [`Status::BufferTooSmall`], NULL unless there are no values, a misaligned pointer. Nothing is
/// written then.
///
/// # Safety
/// `out` is NULL or valid for writes of `capacity` values, none of them the library's.
pub(crate) unsafe fn output<T: Copy>(
    values: &[T],
    out: *mut T,
    capacity: usize,
    name: &str,
) -> Result<(), Error> {
    check_output(values, out, capacity, name)?;
    if values.is_empty() {
        return Ok(());
    }
    // SAFETY: `out` is aligned and has room by the promise; `values` is the library's own memory.
    unsafe { ptr::copy_nonoverlapping(values.as_ptr(), out, values.len()) };
    Ok(())
}

/// Checks that [`output`] can copy `values`.
///
/// # Errors
/// As [`output`].
pub(crate) fn check_output<T>(
    values: &[T],
    out: *mut T,
    capacity: usize,
    name: &str,
) -> Result<(), Error> {
    let needed = values.len();
    if needed == 0 {
        return Ok(());
    }
    check_array(out, needed, name)?;
    if capacity < needed {
        let text = format_args!("{name} has room for {capacity} values and needs {needed}");
        return Err(Error::new(Status::BufferTooSmall, text));
    }
    Ok(())
}

/// Returns a text of the caller.
///
/// # Errors
/// NULL, and a text that is not UTF-8.
///
/// # Safety
/// `text` is NULL or ends with a zero byte, and does not change during `'a`.
pub(crate) unsafe fn text<'a>(text: *const c_char, name: &str) -> Result<&'a str, Error> {
    if text.is_null() {
        return Err(Error::null(name));
    }
    // SAFETY: not NULL; the caller promises the zero byte.
    let text = unsafe { CStr::from_ptr(text) };
    (text.to_str()).map_err(|_| Error::argument(format_args!("{name} is not UTF-8")))
}

/// Copies bytes to a buffer of `capacity` bytes, and their number to `length`.
///
/// A buffer of 0 bytes only asks for the length.
///
/// # Errors
/// As [`output`]; the length is set all the same.
///
/// # Safety
/// As [`output`].
pub(crate) unsafe fn output_bytes(
    bytes: &[u8],
    out: *mut u8,
    capacity: usize,
    length: Option<&mut MaybeUninit<usize>>,
) -> Result<(), Error> {
    if let Some(length) = length {
        length.write(bytes.len());
    }
    if capacity == 0 {
        return Ok(());
    }
    // SAFETY: the caller's promise is that of `output`.
    unsafe { output(bytes, out, capacity, "out") }
}

/// Copies a text and a zero byte as [`output_bytes`] does; the zero byte is not part of its length.
///
/// # Errors
/// As [`output_bytes`].
///
/// # Safety
/// As [`output`].
pub(crate) unsafe fn output_text(
    text: &str,
    out: *mut c_char,
    capacity: usize,
    length: Option<&mut MaybeUninit<usize>>,
) -> Result<(), Error> {
    if let Some(length) = length {
        length.write(text.len());
    }
    if capacity == 0 {
        return Ok(());
    }
    let with_end: Vec<c_char> = (text.bytes().filter(|&byte| byte != 0))
        .chain([0])
        .map(|byte| c_char::from_ne_bytes([byte]))
        .collect();
    // SAFETY: the caller's promise is that of `output`.
    unsafe { output(&with_end, out, capacity, "text") }
}

/// Writes a value to a place of the caller.
pub(crate) fn put<T>(out: Option<&mut MaybeUninit<T>>, value: T, name: &str) -> Result<(), Error> {
    match out {
        Some(out) => {
            out.write(value);
            Ok(())
        }
        None => Err(Error::null(name)),
    }
}

fn check_array<T>(data: *const T, count: usize, name: &str) -> Result<(), Error> {
    if data.is_null() {
        return Err(Error::null(name));
    }
    let bytes = count.checked_mul(size_of::<T>());
    if bytes.is_none_or(|bytes| isize::try_from(bytes).is_err()) {
        return Err(too_many(name, count));
    }
    if !data.is_aligned() {
        return Err(Error::argument(format_args!("{name} is not aligned")));
    }
    Ok(())
}

fn too_many(name: &str, count: usize) -> Error {
    Error::argument(format_args!("{name} cannot have {count} rows or values"))
}

/// Checks that no value is NaN or infinite.
pub(crate) fn check_finite(values: &[f32], name: &str) -> Result<(), Error> {
    match values.iter().position(|value| !value.is_finite()) {
        Some(i) => Err(Error::argument(format_args!(
            "{name}[{i}] is {}; pass finite numbers",
            values[i]
        ))),
        None => Ok(()),
    }
}

/// Returns a number of elements as the interface has it; ids of the libraries have 32 bits.
pub(crate) fn count(elements: usize) -> u32 {
    u32::try_from(elements).unwrap_or(u32::MAX)
}
