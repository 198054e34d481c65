//! Errors of reading and writing files, with their place in the file.

use std::fmt;
use std::path::PathBuf;

/// A place in a file. Lines count from 1, elements from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum SourceLocation {
    /// A line of a text file.
    Line(usize),
    /// The header.
    Header,
    /// A vertex.
    Vertex(usize),
    /// A face.
    Face(usize),
    /// An item of a PLY element that is neither vertex nor face: the element, then the item.
    Item(usize, usize),
    /// A primitive of a glTF mesh: the mesh, then the primitive.
    Primitive(usize, usize),
    /// A glTF accessor.
    Accessor(usize),
    /// A glTF buffer view.
    BufferView(usize),
    /// A glTF buffer.
    Buffer(usize),
    /// A glTF node.
    Node(usize),
}

impl fmt::Display for SourceLocation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(n) => write!(f, "line {n}"),
            Self::Header => write!(f, "header"),
            Self::Vertex(n) => write!(f, "vertex {n}"),
            Self::Face(n) => write!(f, "face {n}"),
            Self::Item(element, n) => write!(f, "item {n} of element {element}"),
            Self::Primitive(mesh, n) => write!(f, "primitive {n} of mesh {mesh}"),
            Self::Accessor(n) => write!(f, "accessor {n}"),
            Self::BufferView(n) => write!(f, "buffer view {n}"),
            Self::Buffer(n) => write!(f, "buffer {n}"),
            Self::Node(n) => write!(f, "node {n}"),
        }
    }
}

/// The error of bytes that are not a mesh.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ParseError {
    /// Another token or value was expected.
    #[error("{at}: expected {expected}")]
    Syntax {
        /// Where.
        at: SourceLocation,
        /// The expected token or value.
        expected: &'static str,
    },
    /// Invalid JSON, or JSON that is not glTF.
    #[cfg(feature = "gltf")]
    #[error("not glTF: {0}")]
    Json(#[from] serde_json::Error),
    /// The file ends early.
    #[error("{at}: the file ends early; download or export it again")]
    Truncated {
        /// The incomplete element or line.
        at: SourceLocation,
    },
    /// A coordinate is not a number, or exceeds 32 bits.
    #[error("{at}: a coordinate is not a finite 32-bit number; scale or repair the mesh")]
    NotFinite {
        /// Where.
        at: SourceLocation,
    },
    /// An index is out of range.
    #[error("{at}: index {index} is out of range; the file has {count} elements")]
    IndexOutOfRange {
        /// The face or element with the index.
        at: SourceLocation,
        /// The index, as in the file.
        index: i64,
        /// Number of elements.
        count: usize,
    },
    /// A face has fewer than three corners.
    #[error("{at}: the face has {corners} corners; it needs at least 3")]
    TooFewCorners {
        /// Where.
        at: SourceLocation,
        /// Number of corners.
        corners: usize,
    },
    /// A face with more than three corners repeats a vertex.
    #[error("{at}: the face uses a vertex twice; split it")]
    RepeatedVertex {
        /// Where.
        at: SourceLocation,
    },
    /// The file has no bytes.
    #[error("the file is empty; download or export it again")]
    Empty,
    /// The file has no triangles.
    #[error("the file has no faces")]
    NoFaces,
    /// The file has too many elements.
    #[error("the file has too many triangles or vertices; split it")]
    TooLarge,
    /// The file uses a feature that this reader does not support.
    #[error("{what} cannot be read; convert the file")]
    Unsupported {
        /// The feature.
        what: &'static str,
    },
    /// A file that this one refers to cannot be read.
    #[error("{}: {source}", path.display())]
    Buffer {
        /// The file.
        path: PathBuf,
        /// The cause.
        source: std::io::Error,
    },
}

/// The error of a file that cannot be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The file could not be opened or read.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The cause.
        source: std::io::Error,
    },
    /// The extension is unknown.
    #[error("{}: unknown extension, expected obj, ply, stl, glb or gltf", path.display())]
    UnknownExtension {
        /// The file.
        path: PathBuf,
    },
    /// The content is not a mesh.
    #[error("{}: {source}", path.display())]
    Parse {
        /// The file.
        path: PathBuf,
        /// The cause.
        source: ParseError,
    },
}

/// The error of a file that cannot be written. An existing file is then unchanged.
#[derive(Debug, thiserror::Error)]
#[error("{}: {source}", path.display())]
#[non_exhaustive]
pub struct WriteError {
    /// The file.
    pub path: PathBuf,
    /// The cause.
    pub source: std::io::Error,
}
