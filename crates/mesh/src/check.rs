//! What a mesh is, and whether it can be cut.
//!
//! [`check`] measures the mesh as it was read. [`MeshData::into_surface`] repairs what has only one
//! repair and refuses the rest ([`MeshData::into_open_surface`] the same but for boundaries):
//!
//! - taken out: triangles whose corners coincide, triangles that repeat another one;
//! - flipped: triangles wound against the majority of their component, and everything when the
//!   volume is negative;
//! - split: vertices where parts touch in a point;
//! - kept apart: bodies that touch along edges or faces, where the file's own indices tell them apart;
//! - refused: boundaries, edges of more than two triangles, surfaces with one side, components
//!   without volume.

mod gaps;
mod links;
mod repair;
mod tally;
mod winding;

use crate::geometry::{Aabb, Vec3, area_vector, widen};
use crate::ids::{TriangleId, VertexId};
use crate::io::{MeshData, Warning};
use crate::measure::cone_volume;
use crate::partition::Partition;
use crate::quality::{AngleStats, EdgeStats};
use links::Links;
use robust::{Coord, orient2d};
use serde::Serialize;
use std::fmt;

/// Why a mesh cannot be cut. Vertices and triangles are those of the [`MeshData`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
#[non_exhaustive]
pub enum Defect {
    /// No triangle is left when those with coincident corners are out.
    Empty,
    /// Edges with one triangle.
    OpenEdge {
        /// The first one's first end.
        a: VertexId,
        /// Its second end.
        b: VertexId,
        /// Where `a` is \[m\].
        at: [f32; 3],
        /// How many.
        count: usize,
        /// Within which distance most of their ends have another vertex beside them \[m\], if they do: what belongs
        /// together is not at the same place then.
        gap: Option<f64>,
    },
    /// Edges with more than two triangles.
    NonManifoldEdge {
        /// The first one's first end.
        a: VertexId,
        /// Its second end.
        b: VertexId,
        /// Where `a` is \[m\].
        at: [f32; 3],
        /// How many.
        count: usize,
        /// How far apart coordinates of 32 bits are where the mesh is \[m\], if that is so far from the origin that
        /// vertices of its own may have become one.
        rounding: Option<f64>,
    },
    /// Components with only one side, as a Möbius strip.
    NonOrientable {
        /// A triangle that cannot agree with all its neighbors.
        triangle: TriangleId,
        /// How many components.
        count: usize,
    },
    /// Closed components that enclose nothing.
    ZeroVolume {
        /// The first one's first triangle.
        triangle: TriangleId,
        /// How many.
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
                "open edges: {count}, first {a}-{b} at {at:?}, most with other vertices beside their ends, up to {gap:.1e} \
                 away; weld vertices that are so near to each other (Merge by Distance in Blender, Merge Close \
                 Vertices in MeshLab)"
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
                "edges with more than two triangles: {count}, first {a}-{b} at {at:?}; so far from the origin \
                 coordinates are {rounding:.1e} apart, and vertices nearer than that have become one: move the mesh \
                 to the origin"
            ),
            Self::NonOrientable { triangle, count } => write!(
                f,
                "components with only one side: {count}, seen at {triangle}; remodel them"
            ),
            Self::ZeroVolume { triangle, count } => write!(
                f,
                "components without volume: {count}, first with {triangle}; remove them"
            ),
        }
    }
}

/// A mesh that cannot be cut, and every reason.
#[derive(Debug, Clone, PartialEq)]
pub struct NotFit {
    /// The reasons; never empty.
    pub defects: Vec<Defect>,
}

impl fmt::Display for NotFit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, defect) in self.defects.iter().enumerate() {
            let separator = if i == 0 {
                "not fit to cut: "
            } else {
                "; also "
            };
            write!(f, "{separator}{defect}")?;
        }
        Ok(())
    }
}

impl std::error::Error for NotFit {}

/// What a mesh is, measured as it was read and welded. Triangles that name a vertex twice count as
/// triangles and have no part in edges, components and what follows from them.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct MeshReport {
    /// Welded vertices that faces use.
    pub vertices: usize,
    /// Vertices as a renderer counts them, see [`MeshData::file_vertices`].
    pub file_vertices: usize,
    /// Triangles.
    pub triangles: usize,
    /// Edges.
    pub edges: usize,
    /// Parts that share no vertex.
    pub components: usize,
    /// Vertices - edges + triangles.
    pub euler_characteristic: i64,
    /// Handles of all components together, where the mesh is closed, manifold and oriented.
    pub genus: Option<i64>,
    /// Whether no edge is open.
    pub closed: bool,
    /// Whether no edge has more than two triangles and around each vertex there is one fan.
    pub manifold: bool,
    /// Whether triangles run along their common edges in opposite directions.
    pub oriented: bool,
    /// Edges with one triangle.
    pub open_edges: usize,
    /// Edges with more than two triangles.
    pub nonmanifold_edges: usize,
    /// Vertices where more than one fan of triangles meets.
    pub nonmanifold_vertices: usize,
    /// Directed edges that more than one triangle runs along.
    pub winding_conflicts: usize,
    /// Triangles without area, by an exact test.
    pub degenerate_triangles: usize,
    /// Area \[m^2\].
    pub area: f64,
    /// Volume \[m^3\]; meaningless unless the mesh is closed and oriented.
    pub volume: f64,
    /// The box around the vertices that faces use \[m\].
    pub bounds: Aabb,
    /// Angles \[degrees\].
    pub angles: AngleStats,
    /// Edge lengths \[m\].
    pub edge_lengths: EdgeStats,
    /// What the reader passed over, then what [`MeshData::into_surface`] repairs.
    pub warnings: Vec<Warning>,
    /// What [`MeshData::into_surface`] cannot repair.
    pub defects: Vec<Defect>,
}

impl MeshReport {
    /// Whether the mesh, repaired, is a body that can be cut: closed, manifold, oriented and with a
    /// volume. [`MeshData::into_surface`] succeeds exactly then.
    ///
    /// # Errors
    /// The defects.
    pub fn fit_to_cut(&self) -> Result<(), &[Defect]> {
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
    let corners = |t: &[u32; 3]| t.map(|v| widen(data.positions[v as usize]));
    let sound: Vec<[u32; 3]> = data
        .triangles
        .iter()
        .copied()
        .filter(|t| !repair::is_collapsed(t))
        .collect();
    let links = Links::new(&sound);
    let edges = links.edge_counts(&sound);
    let mut parts = Partition::new(data.positions.len());
    for t in &sound {
        parts.join(t[0], t[1]);
        parts.join(t[0], t[2]);
    }
    let mut used = vec![false; data.positions.len()];
    let mut roots: Vec<u32> = Vec::new();
    for &v in sound.iter().flatten() {
        if !std::mem::replace(&mut used[v as usize], true) && parts.find(v) == v {
            roots.push(v);
        }
    }
    let count = |n: usize| i64::try_from(n).expect("elements have 32-bit ids");
    let used = used.iter().filter(|&&used| used).count();
    let euler_characteristic = count(used) - count(edges.all) + count(sound.len());
    let nonmanifold_vertices = links.fans(&sound).split_vertices(&sound).len();
    let closed = edges.open == 0;
    let manifold = edges.nonmanifold == 0 && nonmanifold_vertices == 0;
    let oriented = edges.conflicts == 0;
    let bounds = Aabb::around(data.positions.iter().copied());
    let center = bounds.center();
    let repaired = repair::repair(data, false);
    MeshReport {
        vertices: data.positions.len(),
        file_vertices: data.file_vertices,
        triangles: data.triangles.len(),
        edges: edges.all,
        components: roots.len(),
        euler_characteristic,
        genus: (closed && manifold && oriented)
            .then(|| count(roots.len()) - euler_characteristic / 2),
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
        bounds,
        angles: AngleStats::of(data.triangles.iter().map(corners)),
        edge_lengths: EdgeStats::of(data.triangles.iter().map(corners)),
        warnings: [data.warnings.as_slice(), &repaired.warnings].concat(),
        defects: repaired.defects,
    }
}

/// Whether the corners lie on a line: exactly then they do so along every axis.
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
