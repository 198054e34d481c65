//! [`WebError`]: errors of the binding, which JavaScript catches as exceptions with their text.

use incise::cut::CutError;
use incise::mesh::{NotCuttable, ParseError, UndoError};
use incise::params::ParamError;
use incise::pbd::ConstraintError;
use incise::scene::{LoadError, SaveError, SceneError};
use wasm_bindgen::JsValue;

/// An error of the binding or of the libraries below it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WebError {
    /// An array has a wrong type.
    #[error("{array} is not a {expected}; convert it with {expected}.from")]
    ArrayType {
        /// The argument.
        array: &'static str,
        /// The type.
        expected: &'static str,
    },
    /// An array has a wrong length.
    #[error("{array} has {length} numbers; pass {expected}")]
    ArrayLength {
        /// The argument.
        array: &'static str,
        /// Its length.
        length: usize,
        /// The expected length.
        expected: &'static str,
    },
    /// A value is neither a number, a text, a list nor an object.
    #[error("a parameter is a symbol or a function; pass a bool, a number, a string or an object")]
    NoParameter,
    /// An object of parameters contains itself, or is deep.
    #[error("an object of parameters is too deep; pass plain values by name")]
    TooDeep,
    /// An array is too large for the memory of WebAssembly.
    #[error("{array} has {length} numbers, and memory has no room for them; split the mesh")]
    TooLarge {
        /// The argument.
        array: &'static str,
        /// Its length.
        length: usize,
    },
    /// A name is unknown.
    #[error("'{name}' is no {kind}; use {expected}")]
    UnknownName {
        /// The name.
        name: String,
        /// The kind of name.
        kind: &'static str,
        /// The known names.
        expected: &'static str,
    },
    /// A mesh has no piece of this number.
    #[error("the mesh has no piece {piece}; use a number of pieceNumbers()")]
    UnknownPiece {
        /// The number.
        piece: f64,
    },
    /// A scene has no body of this number.
    #[error("the scene has no body {body}; use a number that addBody of this scene returned")]
    UnknownBody {
        /// The number.
        body: f64,
    },
    /// A scene has no blade of this number.
    #[error("the scene has no blade {blade}; use a number that addBlade of this scene returned")]
    UnknownBlade {
        /// The number.
        blade: f64,
    },
    /// A body has no vertex of this number.
    #[error("the body has no vertex {vertex}; use the vertex of a pick()")]
    UnknownVertex {
        /// The number.
        vertex: f64,
    },
    /// A number is NaN or infinite.
    #[error("{name} is not finite: it is or has {value}; pass finite numbers")]
    NotFinite {
        /// The argument.
        name: &'static str,
        /// The number.
        value: f64,
    },
    /// There is no cut to undo.
    #[error("there is no cut to undo; ask undoCount first")]
    NothingToUndo,
    /// The bytes are not a mesh.
    #[error(transparent)]
    Parse(#[from] ParseError),
    /// The mesh cannot be cut.
    #[error(transparent)]
    NotCuttable(#[from] NotCuttable),
    /// A parameter is unknown, has another type or is out of range.
    #[error(transparent)]
    Parameter(#[from] ParamError),
    /// A cut was refused.
    #[error(transparent)]
    Cut(#[from] CutError),
    /// A cut cannot be undone.
    #[error(transparent)]
    Undo(#[from] UndoError),
    /// A constraint or pin was refused.
    #[error(transparent)]
    Constraint(#[from] ConstraintError),
    /// A scene refused a call.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A scene cannot be saved.
    #[error(transparent)]
    Save(#[from] SaveError),
    /// Bytes are no saved scene.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] std::io::Error),
}

impl From<WebError> for JsValue {
    fn from(error: WebError) -> Self {
        js_sys::Error::new(&error.to_string()).into()
    }
}
