//! What a file says.

use crate::ids::{TriangleId, VertexId};
use crate::io::ParseError;
use crate::io::build::{Builder, Corner};
use crate::io::error::Place;
use crate::surface::CornerAttributes;
use serde::Serialize;
use std::fmt;

/// A mesh as a file has it, welded, before anything is required of it.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshData {
    /// The positions that faces use, in the file's order, each once: equal coordinates are one
    /// vertex, and -0 equals 0.
    pub positions: Vec<[f32; 3]>,
    /// Triangles over `positions`. A face with more corners is triangulated. Welding may make the
    /// corners of a triangle equal.
    pub triangles: Vec<[u32; 3]>,
    /// What the corners carry, if the file has it.
    pub corners: CornerAttributes,
    /// Every triangle's material, shape \[triangles\]: N of an OBJ file's `usemtl material_N`, as
    /// [`write_obj`](crate::write_obj) names them, else 0. Empty where all are 0.
    pub materials: Vec<u32>,
    /// Vertices as a renderer counts them: distinct tuples of the file's position, texture and
    /// normal index that faces use. For STL, which has no indices, distinct positions.
    pub file_vertices: usize,
    /// What the reader passed over.
    pub warnings: Vec<Warning>,
    /// Every triangle's component as the file's own indices connect them, before welding.
    pub(crate) file_components: Vec<u32>,
}

impl MeshData {
    /// Welds `triangles` over `positions` the way a reader does.
    ///
    /// # Errors
    /// [`ParseError`] when a coordinate is not finite, an index is out of range or there are no
    /// triangles.
    pub fn from_triangles(
        positions: &[[f32; 3]],
        triangles: &[[u32; 3]],
    ) -> Result<Self, ParseError> {
        let mut builder = Builder::default();
        for (i, &p) in positions.iter().enumerate() {
            builder.position(p, Place::Vertex(i))?;
        }
        for (i, t) in triangles.iter().enumerate() {
            builder.face(&t.map(Corner::position), Place::Face(i))?;
        }
        builder.finish()
    }
}

/// Something that was passed over or repaired, and does not stand in the way.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
#[non_exhaustive]
pub enum Warning {
    /// The file has vertices that no face uses.
    UnusedVertices {
        /// How many.
        count: usize,
    },
    /// The file goes on after its end.
    TrailingBytes {
        /// How many bytes.
        count: usize,
    },
    /// Some corners have texture coordinates or normals and some have none, or none that is finite;
    /// those got zeros.
    PartialAttributes {
        /// How many corners got zeros.
        corners: usize,
    },
    /// Points, lines or statements that are no part of a triangle mesh were passed over.
    Skipped {
        /// How many.
        count: usize,
    },
    /// Triangles with two corners in one place were taken out.
    Collapsed {
        /// The first.
        triangle: TriangleId,
        /// How many.
        count: usize,
    },
    /// Triangles that repeat another one were taken out.
    DuplicatesRemoved {
        /// The first.
        triangle: TriangleId,
        /// How many.
        count: usize,
    },
    /// Triangles wound against the rest of their component were flipped.
    Reoriented {
        /// The first.
        triangle: TriangleId,
        /// How many.
        count: usize,
    },
    /// All normals pointed inward; everything was flipped.
    Inverted,
    /// Vertices where parts touch in a single point were split.
    VerticesSplit {
        /// The first.
        vertex: VertexId,
        /// How many.
        count: usize,
    },
    /// Bodies that touch were kept apart, as the file has them.
    BodiesKeptApart {
        /// How many bodies the file's indices make.
        count: usize,
    },
    /// Most open edges have other ends beside theirs that are not the same vertices: what belongs together is not at
    /// the same place.
    NearlyMeeting {
        /// How many open edges there are.
        count: usize,
        /// Within which distance \[m\].
        gap: f64,
    },
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::UnusedVertices { count } => write!(f, "vertices that no face uses: {count}"),
            Self::TrailingBytes { count } => write!(f, "bytes after the end, ignored: {count}"),
            Self::PartialAttributes { corners } => {
                write!(
                    f,
                    "corners without usable attributes, set to zero: {corners}"
                )
            }
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
                "triangles wound against their neighbors, flipped: {count}, first {triangle}"
            ),
            Self::Inverted => write!(f, "the mesh was inside out and was flipped"),
            Self::VerticesSplit { vertex, count } => write!(
                f,
                "vertices where parts touch in a point, split: {count}, first {vertex}"
            ),
            Self::BodiesKeptApart { count } => {
                write!(f, "bodies that touch, kept apart: {count}")
            }
            Self::NearlyMeeting { count, gap } => write!(
                f,
                "open edges: {count}, most with other vertices beside their ends, up to {gap:.1e} away; these may be no \
                 holes: weld vertices that are so near to each other (Merge by Distance in Blender, Merge Close \
                 Vertices in MeshLab)"
            ),
        }
    }
}
