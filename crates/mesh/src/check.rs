//! Checks and repairs of mesh data before it becomes a surface.
//!
//! [`check`] measures a mesh as read. [`MeshData::into_surface`] repairs whatever has a unique
//! repair and rejects the rest. [`MeshData::into_open_surface`] also accepts boundaries.
//!
//! - Removed: triangles with coincident corners, duplicate triangles;
//!   closed components without volume, if the mesh has boundaries.
//! - Flipped: triangles against the majority of their component, and all if the volume is negative.
//! - Split: vertices at which parts touch in a point.
//! - Kept separate: bodies that touch along edges or faces but have separate indices in the file,
//!   and coincident walls of one body.
//! - Rejected: boundaries, edges of more than two triangles, one-sided surfaces, components without
//!   volume.
//!
//! [`MeshData::repair`] can also separate sheets and bodies that share edges.

mod around;
mod counts;
mod duplicates;
mod gaps;
mod links;
mod repair;
mod separate;
mod tally;
mod weld;
mod winding;

use crate::geometry::{Aabb, Vec3, area_vector, to_f64};
use crate::ids::{TriangleId, VertexId};
use crate::io::{MeshData, Warning};
use crate::measure::cone_volume;
use crate::quality::{AngleStats, EdgeStats};
use counts::Counts;
pub use counts::RepairedCounts;
use links::Links;
pub use repair::RepairParams;
use robust::{Coord, orient2d};
use std::fmt;

/// A reason why a mesh cannot be cut. Ids are those of the [`MeshData`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(tag = "kind", rename_all = "snake_case"))]
#[non_exhaustive]
pub enum Defect {
    /// No triangle remains without those with coincident corners.
    Empty,
    /// Edges have only one triangle.
    OpenEdge {
        /// One end of the first such edge.
        a: VertexId,
        /// Its other end.
        b: VertexId,
        /// Position of `a` \[m\].
        at: [f32; 3],
        /// Number of such edges.
        count: usize,
        /// Distance within which most of their ends have another vertex \[m\], if there is one.
        ///
        /// Vertices that belong together then differ in position.
        gap: Option<f64>,
    },
    /// Edges have more than two triangles.
    NonManifoldEdge {
        /// One end of the first such edge.
        a: VertexId,
        /// Its other end.
        b: VertexId,
        /// Position of `a` \[m\].
        at: [f32; 3],
        /// Number of such edges.
        count: usize,
        /// Spacing of 32-bit coordinates at the mesh \[m\], if it may have merged vertices.
        ///
        /// That happens to meshes far from the origin.
        rounding: Option<f64>,
    },
    /// Components are one-sided, like a Möbius strip.
    NonOrientable {
        /// A triangle that conflicts with a neighbor in either orientation.
        triangle: TriangleId,
        /// Number of such components.
        count: usize,
    },
    /// Closed components enclose no volume.
    ZeroVolume {
        /// First triangle of the first such component.
        triangle: TriangleId,
        /// Number of such components.
        count: usize,
    },
}

impl fmt::Display for Defect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Empty => write!(f, "no triangle has three different corners"),
            Self::OpenEdge {
                a,
                b,
                at,
                count,
                gap: None,
            } => write!(
                f,
                "open edges: {count}, first {a}-{b} at {at:?}; close the holes"
            ),
            Self::OpenEdge {
                a,
                b,
                at,
                count,
                gap: Some(gap),
            } => write!(
                f,
                "open edges: {count}, first {a}-{b} at {at:?}; most of their ends have another \
                 vertex within {gap:.1e}; weld vertices within that distance (Merge by Distance in \
                 Blender, Merge Close Vertices in MeshLab)"
            ),
            Self::NonManifoldEdge {
                a,
                b,
                at,
                count,
                rounding: None,
            } => write!(
                f,
                "edges with more than two triangles: {count}, first {a}-{b} at {at:?}; \
                 separate the parts that meet there"
            ),
            Self::NonManifoldEdge {
                a,
                b,
                at,
                count,
                rounding: Some(rounding),
            } => write!(
                f,
                "edges with more than two triangles: {count}, first {a}-{b} at {at:?}; so far \
                 from the origin, coordinates are {rounding:.1e} apart and closer vertices were \
                 merged; move the mesh to the origin"
            ),
            Self::NonOrientable { triangle, count } => write!(
                f,
                "one-sided components: {count}, first at {triangle}; remodel them"
            ),
            Self::ZeroVolume { triangle, count } => write!(
                f,
                "components without volume: {count}, first with {triangle}; remove them"
            ),
        }
    }
}

/// The error of a mesh that cannot be cut, with all reasons.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct NotCuttable {
    /// The reasons; never empty.
    pub defects: Vec<Defect>,
}

impl From<&[Defect]> for NotCuttable {
    fn from(defects: &[Defect]) -> Self {
        Self {
            defects: defects.to_vec(),
        }
    }
}

impl fmt::Display for NotCuttable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, defect) in self.defects.iter().enumerate() {
            let separator = if i == 0 { "cannot be cut: " } else { "; also " };
            write!(f, "{separator}{defect}")?;
        }
        Ok(())
    }
}

impl std::error::Error for NotCuttable {}

/// Measures and defects of a mesh as read, with equal positions welded to one vertex.
///
/// Triangles that repeat a vertex count as triangles, but not in edges, components and derived
/// numbers. [`Self::repaired`] describes the surface that is cut.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct MeshReport {
    /// Number of welded vertices that faces use.
    pub vertices: usize,
    /// Number of vertices that a renderer needs, see [`MeshData::file_vertices`].
    pub file_vertices: usize,
    /// Number of triangles.
    pub triangles: usize,
    /// Number of edges.
    pub edges: usize,
    /// Number of parts that share no vertex.
    pub components: usize,
    /// Euler characteristic: vertices - edges + triangles.
    pub euler_characteristic: i64,
    /// Total genus, if the mesh is closed, manifold and oriented.
    pub genus: Option<i64>,
    /// Whether every edge has at least two triangles.
    pub closed: bool,
    /// Whether no edge has more than two triangles and every vertex has one fan.
    pub manifold: bool,
    /// Whether adjacent triangles have consistent orientations.
    pub oriented: bool,
    /// Number of edges with one triangle.
    pub open_edges: usize,
    /// Number of edges with more than two triangles.
    pub nonmanifold_edges: usize,
    /// Number of vertices with more than one fan of triangles.
    pub nonmanifold_vertices: usize,
    /// Number of directed edges of more than one triangle.
    pub winding_conflicts: usize,
    /// Number of triangles without area, by an exact test.
    pub degenerate_triangles: usize,
    /// Area \[m^2\].
    pub area: f64,
    /// Volume \[m^3\]; meaningless unless the mesh is closed and oriented.
    pub volume: f64,
    /// Origin of the bounding box in the file's coordinates, see [`MeshData::origin`] \[m\].
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "is_zero"))]
    pub origin: [f64; 3],
    /// Bounding box of the vertices that faces use, relative to `origin` \[m\].
    pub bounds: Aabb,
    /// Angles \[degrees\].
    pub angles: AngleStats,
    /// Edge lengths \[m\].
    pub edge_lengths: EdgeStats,
    /// Warnings of the reader, and repairs of [`MeshData::into_surface`].
    pub warnings: Vec<Warning>,
    /// Defects that [`MeshData::into_surface`] cannot repair.
    pub defects: Vec<Defect>,
    /// The repaired surface, if there are no defects.
    ///
    /// It differs from the mesh as read where walls or touching bodies stay separate.
    pub repaired: Option<RepairedCounts>,
}

impl MeshReport {
    /// Returns whether the repaired mesh is closed, manifold, oriented and has a volume.
    ///
    /// [`MeshData::into_surface`] succeeds exactly then.
    ///
    /// # Errors
    /// The defects.
    pub fn is_cuttable(&self) -> Result<(), &[Defect]> {
        if self.defects.is_empty() {
            Ok(())
        } else {
            Err(&self.defects)
        }
    }
}

/// Measures a mesh.
#[must_use]
pub fn check(data: &MeshData) -> MeshReport {
    check_with(data, RepairParams::default())
}

/// Measures a mesh, and lists the warnings and defects of [`MeshData::repair`] with `params`.
#[must_use]
pub fn check_with(data: &MeshData, params: RepairParams) -> MeshReport {
    let corners = |t: &[u32; 3]| t.map(|v| to_f64(data.positions[v as usize]));
    let repaired = repair::repair(data, params);
    let welded = data.triangles.iter().copied();
    let sound: Vec<[u32; 3]> = welded.filter(|t| !repair::is_collapsed(t)).collect();
    let links = Links::new(&sound);
    let counts = Counts::new(&sound, &links);
    let edges = &counts.edges;
    let nonmanifold_vertices = links.fans(&sound).split_vertices(&sound).len();
    let closed = edges.open == 0;
    let manifold = edges.nonmanifold == 0 && nonmanifold_vertices == 0;
    let oriented = edges.conflicts == 0;
    let bounds = Aabb::around(data.positions.iter().copied());
    let center = bounds.center();
    MeshReport {
        vertices: data.positions.len(),
        file_vertices: data.file_vertices,
        triangles: data.triangles.len(),
        edges: edges.all,
        components: counts.components,
        euler_characteristic: counts.euler_characteristic,
        genus: (closed && manifold && oriented).then(|| counts.genus()),
        closed,
        manifold,
        oriented,
        open_edges: edges.open,
        nonmanifold_edges: edges.nonmanifold,
        nonmanifold_vertices,
        winding_conflicts: edges.conflicts,
        degenerate_triangles: data
            .triangles
            .iter()
            .filter(|t| is_degenerate(corners(t)))
            .count(),
        area: data
            .triangles
            .iter()
            .map(|t| area_vector(corners(t)).norm() / 2.0)
            .sum(),
        volume: data
            .triangles
            .iter()
            .map(|t| cone_volume(corners(t), center))
            .sum(),
        origin: data.origin,
        bounds,
        angles: AngleStats::from_triangles(data.triangles.iter().map(corners)),
        edge_lengths: EdgeStats::from_triangles(data.triangles.iter().map(corners)),
        warnings: [data.warnings.as_slice(), &repaired.warnings].concat(),
        repaired: (repaired.defects.is_empty()).then(|| RepairedCounts::new(&repaired.triangles)),
        defects: repaired.defects,
    }
}

#[cfg(feature = "serde")]
fn is_zero(origin: &[f64; 3]) -> bool {
    *origin == [0.0; 3]
}

/// Returns whether the corners are collinear, which holds exactly if it does in each projection.
fn is_degenerate(corners: [Vec3; 3]) -> bool {
    (0..3).all(|axis| {
        let [a, b, c] = corners.map(|p| Coord {
            x: p[(axis + 1) % 3],
            y: p[(axis + 2) % 3],
        });
        orient2d(a, b, c) == 0.0
    })
}

#[cfg(test)]
mod tests;
