//! What can be wrong with a file, and where.

use std::fmt;
use std::path::PathBuf;

/// Where in a file. Lines count from 1, elements from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Place {
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

impl fmt::Display for Place {
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

/// Why bytes are not a mesh.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ParseError {
    /// Something else was expected.
    #[error("{at}: expected {expected}")]
    Syntax {
        /// Where.
        at: Place,
        /// What should stand there.
        expected: &'static str,
    },
    /// Text that should be JSON is not, or not glTF's.
    #[error("not glTF: {0}")]
    Json(#[from] serde_json::Error),
    /// The file ends too early.
    #[error("{at}: the file ends here; it was cut short")]
    Truncated {
        /// The element or line that is not complete.
        at: Place,
    },
    /// A coordinate is not a number, or too large for 32 bits.
    #[error("{at}: a coordinate is not a finite 32-bit number; scale or repair the mesh")]
    NotFinite {
        /// Where.
        at: Place,
    },
    /// An index names something that does not exist.
    #[error("{at}: index {index} is out of range, there are {count}")]
    IndexOutOfRange {
        /// The face or element that holds the index.
        at: Place,
        /// The index as the file has it.
        index: i64,
        /// How many there are.
        count: usize,
    },
    /// A face has fewer than three corners.
    #[error("{at}: a face needs 3 corners and has {corners}")]
    TooFewCorners {
        /// Where.
        at: Place,
        /// How many corners it has.
        corners: usize,
    },
    /// A face with more than three corners names a vertex twice.
    #[error("{at}: the face uses a vertex twice; split it")]
    RepeatedVertex {
        /// Where.
        at: Place,
    },
    /// No triangle anywhere.
    #[error("there are no faces")]
    NoFaces,
    /// More elements than can be read.
    #[error("more triangles or vertices than can be read; split the file")]
    TooLarge,
    /// A legal feature that this reader does not know.
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
        /// Why.
        source: std::io::Error,
    },
}

/// Why a file could not be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The file could not be opened or read.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The extension is none of the known ones.
    #[error("{}: unknown extension, expected obj, ply, stl, glb or gltf", path.display())]
    UnknownExtension {
        /// The file.
        path: PathBuf,
    },
    /// What it holds is not a mesh.
    #[error("{}: {source}", path.display())]
    Parse {
        /// The file.
        path: PathBuf,
        /// Why.
        source: ParseError,
    },
}

/// A file could not be written. Nothing is left of the attempt, and a file that was there before is
/// as it was.
#[derive(Debug, thiserror::Error)]
#[error("{}: {source}", path.display())]
pub struct WriteError {
    /// The file.
    pub path: PathBuf,
    /// Why.
    pub source: std::io::Error,
}
