//! [`Divided`]: where the parts of a cell with several of them are, for cells beside it.

use crate::cell::CellSolver;
use crate::content::Content;
use incise_mesh::{TriangleId, VertexId};

/// A triangle that lies in more than one cell.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Crossing {
    triangle: TriangleId,
    part: u32,
    /// The faces with cells behind them that the triangle may lie in, one bit each.
    faces: u8,
}

/// Where the parts of a cell with several of them meet its faces, and which vertices they have.
///
/// Stored, so that an edit beside the cell does not solve it again.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Divided {
    /// By face, the parts of the spans that pass it, by line.
    passing: Vec<u32>,
    /// By face, its first passing span.
    starts: [u16; 7],
    /// The triangles that lie in other cells as well, ascending.
    crossings: Vec<Crossing>,
    /// The vertices in the cell with their parts.
    pub(crate) vertices: Vec<(VertexId, u32)>,
}

impl Divided {
    /// Takes the result of a solver, of which the parts have the given numbers.
    pub(crate) fn new(solver: &CellSolver, content: &Content, parts: &[u32]) -> Self {
        let mut starts = [0; 7];
        let mut passing = Vec::with_capacity(solver.passing.iter().map(Vec::len).sum());
        for (face, own) in solver.passing.iter().enumerate() {
            passing.extend(own.iter().map(|&part| parts[part as usize]));
            starts[face + 1] = u16::try_from(passing.len()).unwrap_or(u16::MAX);
        }
        let part_of = |triangle: usize| parts[solver.part_of[triangle] as usize];
        let own = solver.triangles.iter().enumerate();
        let own = own.filter(|own| !solver.is_inner[own.0]);
        let crossings = own.filter_map(|(i, &triangle)| {
            let faces = content.faces_before(triangle, solver.cell);
            let part = part_of(i);
            (faces != 0).then_some(Crossing {
                triangle,
                part,
                faces,
            })
        });
        let vertices = solver.vertices.iter();
        Self {
            passing,
            starts,
            crossings: crossings.collect(),
            vertices: vertices.map(|&(v, i)| (v, part_of(i as usize))).collect(),
        }
    }

    /// Returns the parts of the spans that pass a face, by line.
    pub(crate) fn passing(&self, face: usize) -> &[u32] {
        &self.passing[usize::from(self.starts[face])..usize::from(self.starts[face + 1])]
    }

    /// Returns the triangles that may cross a face.
    pub(crate) fn crossing(&self, face: usize) -> impl Iterator<Item = TriangleId> {
        let own = self.crossings.iter();
        own.filter(move |own| own.faces >> face & 1 == 1)
            .map(|own| own.triangle)
    }

    /// Returns the part of a triangle that lies in other cells as well.
    pub(crate) fn part_of(&self, t: TriangleId) -> Option<u32> {
        let i = self.crossings.binary_search_by_key(&t, |own| own.triangle);
        Some(self.crossings[i.ok()?].part)
    }

    /// Returns whether its arrays can be indexed, given which parts and vertices it may name.
    #[cfg(feature = "serde")]
    pub(crate) fn is_valid(
        &self,
        is_part: impl Fn(u32) -> bool,
        is_vertex: impl Fn(VertexId) -> bool,
    ) -> bool {
        let crossings = &self.crossings;
        let ascending = crossings
            .windows(2)
            .all(|pair| pair[0].triangle < pair[1].triangle);
        self.starts.is_sorted()
            && usize::from(self.starts[6]) <= self.passing.len()
            && self.passing.iter().all(|&part| is_part(part))
            && ascending
            && crossings.iter().all(|own| is_part(own.part))
            && self
                .vertices
                .iter()
                .all(|own| is_vertex(own.0) && is_part(own.1))
    }
}
