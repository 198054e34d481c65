//! [`Status`] codes, the error text of each thread, and the one place that stops panics.

use incise::cut::CutError;
use incise::mesh::{NotCuttable, ParseError, ReadError, TopologyError, WriteError};
use incise::params::ParamError;
use incise::prelude::SceneError;
use incise::refine::HoleError;
use incise::scene::{LoadError, SaveError};
use std::cell::RefCell;
use std::ffi::{CStr, CString, c_char};
use std::fmt::Display;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// The result of a function. `incise_last_error` has the text.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// Success.
    Ok = 0,
    /// A pointer that must not be NULL is NULL.
    NullPointer = 1,
    /// A handle was freed, is of another kind, or never came from this library.
    InvalidHandle = 2,
    /// A buffer of the caller is too small. Nothing was written to it.
    BufferTooSmall = 3,
    /// A number is NaN, infinite or outside its range, or a text is not UTF-8.
    InvalidArgument = 4,
    /// An index of a vertex, piece, body or blade is out of range.
    OutOfRange = 5,
    /// The triangles form no surface that can be cut.
    InvalidMesh = 6,
    /// A file cannot be read or written.
    File = 7,
    /// A cut, fill or undo was refused. The object is what it was.
    Refused = 8,
    /// A body cannot be simulated.
    Simulation = 9,
    /// A defect of the library. Free the objects of the call and do not use them otherwise.
    Panic = 10,
}

/// A failed call: the code and a text that says what to do.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Error {
    pub(crate) status: Status,
    text: String,
}

impl Error {
    pub(crate) fn new(status: Status, text: impl Display) -> Self {
        Self {
            status,
            text: text.to_string(),
        }
    }

    pub(crate) fn null(name: &str) -> Self {
        Self::new(Status::NullPointer, format_args!("{name} is NULL"))
    }

    pub(crate) fn argument(text: impl Display) -> Self {
        Self::new(Status::InvalidArgument, text)
    }

    /// Returns the error of a constant that is none of the header's.
    pub(crate) fn constant(name: &str, value: u32) -> Self {
        let text = format_args!("{name} is {value}; use a constant of incise.h");
        Self::new(Status::InvalidArgument, text)
    }
}

impl From<TopologyError> for Error {
    fn from(error: TopologyError) -> Self {
        let status = match error {
            TopologyError::VertexOutOfRange { .. } => Status::OutOfRange,
            _ => Status::InvalidMesh,
        };
        Self::new(status, error)
    }
}

impl From<SceneError> for Error {
    fn from(error: SceneError) -> Self {
        let status = match error {
            SceneError::UnknownBody { .. } | SceneError::UnknownBlade { .. } => Status::OutOfRange,
            SceneError::Undo(_) | SceneError::NothingToUndo { .. } => Status::Refused,
            SceneError::BladeNotFinite { .. }
            | SceneError::BladeFaceNotFinite { .. }
            | SceneError::RayNotFinite { .. }
            | SceneError::Frame(_)
            | SceneError::Cut(_)
            | SceneError::Parameter(_) => Status::InvalidArgument,
            _ => Status::Simulation,
        };
        Self::new(status, error)
    }
}

/// Implements the conversion of a library's error to one status.
macro_rules! status_of {
    ($($error:ty => $status:ident),+ $(,)?) => {
        $(impl From<$error> for Error {
            fn from(error: $error) -> Self {
                Self::new(Status::$status, error)
            }
        })+
    };
}

status_of! {
    NotCuttable => InvalidMesh,
    ParseError => InvalidMesh,
    ReadError => File,
    WriteError => File,
    LoadError => File,
    SaveError => Simulation,
    CutError => Refused,
    ParamError => InvalidArgument,
    HoleError => Refused,
}

thread_local! {
    /// The text of this thread's last call; empty after a success.
    static LAST_ERROR: RefCell<CString> = RefCell::default();
}

/// Runs the body of an exported function: no panic crosses the border, and errors get their text.
pub(crate) fn call(body: impl FnOnce() -> Result<(), Error>) -> Status {
    let result = catch_unwind(AssertUnwindSafe(body)).unwrap_or_else(|payload| {
        let text = (payload.downcast_ref::<&str>().copied())
            .or_else(|| payload.downcast_ref::<String>().map(String::as_str))
            .unwrap_or("no text");
        let text = format_args!("internal error, please report it: {text}");
        Err(Error::new(Status::Panic, text))
    });
    let (status, text) = match result {
        Ok(()) => (Status::Ok, CString::default()),
        Err(Error { status, text }) => {
            let bytes = text.into_bytes().into_iter().filter(|&byte| byte != 0);
            (
                status,
                CString::new(bytes.collect::<Vec<u8>>()).unwrap_or_default(),
            )
        }
    };
    LAST_ERROR.set(text);
    status
}

/// Returns the text of the last call of this thread, as UTF-8; empty after a success.
///
/// The text belongs to the library and is valid until the thread's next call or end.
#[unsafe(no_mangle)]
pub extern "C" fn incise_last_error() -> *const c_char {
    LAST_ERROR.with_borrow(|text| text.as_ptr())
}

/// Returns the version of the interface, `INCISE_ABI_VERSION` of the header it was built with.
///
/// Structs and functions of one version never change. Compare it with the constant before the
/// first call.
#[unsafe(no_mangle)]
pub extern "C" fn incise_abi_version() -> u32 {
    INCISE_ABI_VERSION
}

/// The version of this header.
pub const INCISE_ABI_VERSION: u32 = 1;

/// Returns the version of the library, such as "0.1.0".
#[unsafe(no_mangle)]
pub extern "C" fn incise_version() -> *const c_char {
    const VERSION: &CStr =
        match CStr::from_bytes_with_nul(concat!(env!("CARGO_PKG_VERSION"), "\0").as_bytes()) {
            Ok(version) => version,
            Err(_) => c"",
        };
    VERSION.as_ptr()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn last_text() -> String {
        LAST_ERROR.with_borrow(|text| text.to_string_lossy().into_owned())
    }

    #[test]
    fn a_panic_is_a_status_with_its_text() {
        assert_eq!(call(|| panic!("at {}", 7)), Status::Panic);
        assert!(
            last_text().ends_with("please report it: at 7"),
            "{}",
            last_text()
        );
        assert_eq!(call(|| Ok(())), Status::Ok);
        assert_eq!(last_text(), "");
    }

    #[test]
    fn texts_belong_to_their_thread() {
        assert_eq!(call(|| Err(Error::null("a\0b"))), Status::NullPointer);
        let other = std::thread::spawn(last_text).join().expect("no panic");
        assert_eq!((last_text().as_str(), other.as_str()), ("ab is NULL", ""));
    }
}
