//! Mesh data: the content of a mesh file, and warnings about it.

use crate::geometry::to_file;
use crate::ids::{TriangleId, VertexId};
use crate::io::ParseError;
use crate::io::build::{Builder, Corner};
use crate::io::error::SourceLocation;
use crate::surface::{Channel, CornerAttributes};
use std::fmt;

/// A welded mesh as read from a file, without further requirements.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshData {
    /// Positions that faces use, relative to `origin`, in the file's order, without duplicates.
    ///
    /// -0 equals 0.
    pub positions: Vec<[f32; 3]>,
    /// Origin of the positions in the file's coordinates \[m\].
    ///
    /// Zero unless the file's coordinates are far from its origin compared to the mesh's size.
    pub origin: [f64; 3],
    /// Triangles over `positions`. Faces with more corners are triangulated.
    ///
    /// Welding may make corners of a triangle equal.
    pub triangles: Vec<[u32; 3]>,
    /// Attributes of the corners, if the file has any.
    pub corners: CornerAttributes,
    /// Further attributes: one row per position, or one per corner of `triangles`.
    ///
    /// Colors are named `color`, skin weights `skin`, further texture coordinates `uv1`, `uv2` and
    /// so on. A channel of vertices whose rows differ where vertices were welded is one of corners.
    pub channels: Vec<Channel>,
    /// The welded vertex of each vertex of the file; `u32::MAX` where no face uses it.
    pub vertex_map: Vec<u32>,
    /// Material of every triangle: N of an OBJ file's `usemtl material_N`, else 0. Empty if all are
    /// 0.
    ///
    /// [`write_obj`](crate::write_obj) writes such names.
    pub materials: Vec<u32>,
    /// Number of vertices that a renderer needs: distinct position, texture and normal indices.
    ///
    /// For STL, which has no indices, the number of distinct positions.
    pub file_vertices: usize,
    /// Warnings of the reader.
    pub warnings: Vec<Warning>,
    /// Triangles over the file's own vertices; empty if welding merged none of them.
    pub(crate) file_triangles: Vec<[u32; 3]>,
    /// Part of the file of every triangle, such as a node of glTF; empty if there is one part.
    pub(crate) parts: Vec<u32>,
}

impl MeshData {
    /// Welds `triangles` over `positions`, like a reader.
    ///
    /// # Errors
    /// [`ParseError`] if a coordinate is not finite, an index is out of range or there are no
    /// triangles.
    pub fn from_triangles(
        positions: &[[f32; 3]],
        triangles: &[[u32; 3]],
    ) -> Result<Self, ParseError> {
        let mut builder = Builder::default();
        for (i, &p) in positions.iter().enumerate() {
            builder.position(p.map(f64::from), SourceLocation::Vertex(i))?;
        }
        for (i, t) in triangles.iter().enumerate() {
            builder.face(&t.map(Corner::position), SourceLocation::Face(i))?;
        }
        builder.finish()
    }

    /// Returns the position of a vertex in the file's coordinates, rounded to 32 bits \[m\].
    pub(crate) fn file_position(&self, vertex: u32) -> [f32; 3] {
        to_file(self.origin, self.positions[vertex as usize])
    }
}

/// A part of a mesh that was skipped or repaired.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(tag = "kind", rename_all = "snake_case"))]
#[non_exhaustive]
pub enum Warning {
    /// No face uses these vertices.
    UnusedVertices {
        /// Number of vertices.
        count: usize,
    },
    /// The file continues after its end.
    TrailingBytes {
        /// Number of bytes.
        count: usize,
    },
    /// The mesh is far from the origin; its positions are relative to a nearby point.
    OriginMoved {
        /// The point in the file's coordinates \[m\].
        origin: [f64; 3],
    },
    /// The format has coordinates of 32 bits, and those far from the origin lose digits.
    OriginRounded {
        /// Origin of the surface that was added to its positions \[m\].
        origin: [f64; 3],
    },
    /// Some corners or vertices lack finite values of an attribute, and got neutral ones.
    ///
    /// These are white, the joint 0 with the weight 1, the normal of the triangle, or else zeros.
    PartialAttributes {
        /// Name of the attribute.
        name: String,
        /// Number of corners or vertices that got neutral values.
        corners: usize,
    },
    /// An attribute was dropped: the file format or this crate has no place for it.
    Dropped {
        /// Name of the attribute.
        name: String,
    },
    /// Points, lines or statements that are no part of a triangle mesh were skipped.
    Skipped {
        /// Number of them.
        count: usize,
    },
    /// Triangles with two corners at one position were removed.
    Collapsed {
        /// The first triangle.
        triangle: TriangleId,
        /// Number of triangles.
        count: usize,
    },
    /// Duplicate triangles were removed.
    DuplicatesRemoved {
        /// The first triangle.
        triangle: TriangleId,
        /// Number of triangles.
        count: usize,
    },
    /// Triangles with another orientation than most of their component were flipped.
    Reoriented {
        /// The first triangle.
        triangle: TriangleId,
        /// Number of triangles.
        count: usize,
    },
    /// All normals pointed inward; all triangles were flipped.
    Inverted,
    /// Vertices at which parts touch in a single point were split.
    VerticesSplit {
        /// The first vertex.
        vertex: VertexId,
        /// Number of vertices.
        count: usize,
    },
    /// Bodies that touch were kept separate, by the file's own indices.
    BodiesKeptApart {
        /// Number of bodies.
        count: usize,
    },
    /// Closed bodies have several vertices at one position, and kept the file's own indices.
    IndicesKept {
        /// The first such vertex, as welded.
        vertex: VertexId,
        /// Number of positions.
        count: usize,
    },
    /// Triangles that another one covers with the opposite orientation were removed.
    BackSidesRemoved {
        /// The first triangle.
        triangle: TriangleId,
        /// Number of triangles.
        count: usize,
    },
    /// Edges of more than two triangles were split.
    EdgesSplit {
        /// One end of the first such edge.
        a: VertexId,
        /// Its other end.
        b: VertexId,
        /// Number of edges.
        count: usize,
    },
    /// Closed components that enclose no volume were removed.
    FlatComponentsRemoved {
        /// First triangle of the first such component.
        triangle: TriangleId,
        /// Number of components.
        count: usize,
    },
    /// Sheets that end at other triangles were detached and have a boundary there.
    SheetsDetached {
        /// First triangle of the first such sheet.
        triangle: TriangleId,
        /// Number of sheets.
        count: usize,
    },
    /// Most open edges have ends close to other ends: vertices that belong together differ.
    NearlyMeeting {
        /// Number of open edges.
        count: usize,
        /// Maximum distance of such ends \[m\].
        gap: f64,
    },
}

impl Warning {
    /// Returns the warning about an attribute that was dropped.
    pub(crate) fn dropped(name: &[u8]) -> Self {
        let name = String::from_utf8_lossy(name).into_owned();
        Self::Dropped { name }
    }

    /// Returns the warning about corners or vertices that lack an attribute, if there are any.
    pub(crate) fn partial(name: &str, corners: usize) -> Option<Self> {
        let name = name.to_owned();
        (corners > 0).then_some(Self::PartialAttributes { name, corners })
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::UnusedVertices { count } => write!(f, "vertices that no face uses: {count}"),
            Self::TrailingBytes { count } => write!(f, "bytes after the end, ignored: {count}"),
            Self::OriginMoved { origin } => {
                write!(f, "far from the origin, computed relative to {origin:?}")
            }
            Self::OriginRounded { origin } => write!(
                f,
                "coordinates near {origin:?} are rounded to 32 bits and the shape loses digits; \
                 write OBJ, PLY or GLB"
            ),
            Self::PartialAttributes { name, corners } => write!(
                f,
                "corners or vertices without a usable value of {name}, set to a neutral one: \
                 {corners}"
            ),
            Self::Dropped { name } => write!(f, "attribute that is not kept: {name}"),
            Self::Skipped { count } => {
                write!(f, "points, lines or unknown statements, ignored: {count}")
            }
            Self::Collapsed { triangle, count } => write!(
                f,
                "triangles with coincident corners, removed: {count}, first {triangle}"
            ),
            Self::DuplicatesRemoved { triangle, count } => {
                write!(f, "duplicate triangles, removed: {count}, first {triangle}")
            }
            Self::Reoriented { triangle, count } => write!(
                f,
                "triangles with inconsistent orientation, flipped: {count}, first {triangle}"
            ),
            Self::Inverted => write!(f, "the mesh was inside out and was flipped"),
            Self::VerticesSplit { vertex, count } => write!(
                f,
                "vertices where parts touch in a point, split: {count}, first {vertex}"
            ),
            Self::BodiesKeptApart { count } => {
                write!(f, "bodies that touch, kept separate: {count}")
            }
            Self::IndicesKept { vertex, count } => write!(
                f,
                "positions with several vertices, kept separate as in the file: {count}, first \
                 {vertex}"
            ),
            Self::BackSidesRemoved { triangle, count } => write!(
                f,
                "back sides of other triangles, removed: {count}, first {triangle}"
            ),
            Self::EdgesSplit { a, b, count } => write!(
                f,
                "edges with more than two triangles, split: {count}, first {a}-{b}"
            ),
            Self::FlatComponentsRemoved { triangle, count } => write!(
                f,
                "components without volume, removed: {count}, first with {triangle}"
            ),
            Self::SheetsDetached { triangle, count } => write!(
                f,
                "sheets that end at other triangles, detached: {count}, first with {triangle}"
            ),
            Self::NearlyMeeting { count, gap } => write!(
                f,
                "open edges: {count}; most of their ends have another vertex within {gap:.1e}, so \
                 they may be no holes; weld vertices within that distance (Merge by Distance in \
                 Blender, Merge Close Vertices in MeshLab)"
            ),
        }
    }
}
