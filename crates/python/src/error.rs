//! Python exceptions with the texts of the libraries' errors.

use incise::cut::CutError as LibraryCutError;
use incise::mesh::{NotCuttable, ReadError, TopologyError as LibraryTopologyError, WriteError};
use incise::params::ParamError;
use incise::refine::HoleError;
use incise::scene::{LoadError, SceneError as LibrarySceneError};
use pyo3::create_exception;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use std::fmt::Display;
use std::io;

create_exception!(
    incise,
    Error,
    PyValueError,
    "A refused call; the text says why and what to do. Base class of the package's exceptions."
);
create_exception!(
    incise,
    TopologyError,
    Error,
    "The faces do not form an oriented manifold. `Mesh.check` lists all defects."
);
create_exception!(
    incise,
    RepairError,
    Error,
    "The mesh has defects without a unique repair."
);
create_exception!(
    incise,
    CutError,
    Error,
    "A refused cut. Meshes and scenes are unchanged."
);
create_exception!(
    incise,
    FillError,
    Error,
    "Holes that cannot be filled. The mesh is unchanged."
);
create_exception!(
    incise,
    SceneError,
    Error,
    "A refused call of a scene, such as an unknown body or a parameter out of range."
);
create_exception!(
    incise,
    FileError,
    Error,
    "A file that is not a mesh. A file that cannot be opened is an `OSError`."
);

/// Adds the exceptions to the module.
pub(crate) fn add(m: &Bound<'_, PyModule>) -> PyResult<()> {
    let py = m.py();
    m.add("Error", py.get_type::<Error>())?;
    m.add("TopologyError", py.get_type::<TopologyError>())?;
    m.add("RepairError", py.get_type::<RepairError>())?;
    m.add("CutError", py.get_type::<CutError>())?;
    m.add("FillError", py.get_type::<FillError>())?;
    m.add("SceneError", py.get_type::<SceneError>())?;
    m.add("FileError", py.get_type::<FileError>())
}

/// Returns an [`Error`] with a text.
pub(crate) fn refused(text: impl Display) -> PyErr {
    Error::new_err(text.to_string())
}

/// An error of a library that has an exception of its own.
pub(crate) trait IntoException {
    /// Returns the exception with the error's text.
    fn exception(self) -> PyErr;
}

impl IntoException for LibraryTopologyError {
    fn exception(self) -> PyErr {
        TopologyError::new_err(self.to_string())
    }
}

impl IntoException for NotCuttable {
    fn exception(self) -> PyErr {
        RepairError::new_err(self.to_string())
    }
}

impl IntoException for LibraryCutError {
    fn exception(self) -> PyErr {
        CutError::new_err(self.to_string())
    }
}

impl IntoException for HoleError {
    fn exception(self) -> PyErr {
        FillError::new_err(self.to_string())
    }
}

impl IntoException for LibrarySceneError {
    fn exception(self) -> PyErr {
        SceneError::new_err(self.to_string())
    }
}

impl IntoException for LoadError {
    fn exception(self) -> PyErr {
        FileError::new_err(self.to_string())
    }
}

impl IntoException for ParamError {
    fn exception(self) -> PyErr {
        let is_keyword = |name: &str| !name.contains('.');
        match &self {
            Self::Unknown { name, .. } if is_keyword(name) => {
                PyTypeError::new_err(self.to_string())
            }
            Self::WrongType { .. } => PyTypeError::new_err(self.to_string()),
            _ => refused(self),
        }
    }
}

impl IntoException for ReadError {
    fn exception(self) -> PyErr {
        match &self {
            Self::File { source, .. } => os_error(source.kind(), &self),
            _ => FileError::new_err(self.to_string()),
        }
    }
}

impl IntoException for WriteError {
    fn exception(self) -> PyErr {
        os_error(self.source.kind(), &self)
    }
}

/// Returns the `OSError` of a kind, such as `FileNotFoundError`.
fn os_error(kind: io::ErrorKind, error: &dyn Display) -> PyErr {
    io::Error::new(kind, error.to_string()).into()
}

/// Turns results of the libraries into those of Python.
pub(crate) trait OrRaise<T> {
    /// Returns the value, or raises the error's exception.
    fn or_raise(self) -> PyResult<T>;
}

impl<T, E: IntoException> OrRaise<T> for Result<T, E> {
    fn or_raise(self) -> PyResult<T> {
        self.map_err(E::exception)
    }
}
