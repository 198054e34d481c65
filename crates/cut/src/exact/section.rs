//! The cross-section laid flat: loops of the rim in the plane of the sweep, target edge lengths.

use super::cap::Rims;
use incise_mesh::{Topology, index_u32};
use incise_refine::{
    RefineError, RefineParams, Section, SectionMesh, SectionMeshParams, SectionMeshScratch,
    SectionMeshSize, triangulate_section,
};

/// Number of neighbors to each side over which local edge lengths are averaged.
const SMOOTHING_NEIGHBORS: usize = 4;

/// The loops of the rim in the plane.
#[derive(Debug, Clone, Default)]
pub(super) struct CrossSection {
    /// Node of each point.
    pub(super) nodes: Vec<u32>,
    /// Positions in the plane \[m\].
    pub(super) points: Vec<[f64; 2]>,
    /// Points of each loop, counterclockwise around the section.
    pub(super) loops: Vec<Vec<u32>>,
    has_crease: bool,
    /// Target edge length at each point \[m\].
    lengths: Vec<f64>,
    scratch: SectionMeshScratch,
}

impl CrossSection {
    /// Projects the loops of the rim to the plane and sets the target edge lengths along them.
    pub(super) fn project(&mut self, rims: &Rims<'_>, refine: &RefineParams) {
        self.nodes.clear();
        self.lengths.clear();
        self.has_crease = rims.has_crease;
        self.points.clear();
        self.loops.resize(rims.rim.sizes.len(), Vec::new());
        for (i, points) in self.loops.iter_mut().enumerate() {
            points.clear();
            for node in rims.rim.ring(i) {
                points.push(index_u32(self.nodes.len()));
                self.nodes.push(node);
                self.points
                    .push(rims.unfold.flatten(&rims.nodes[node as usize]));
            }
            let own = &self.nodes[self.lengths.len()..];
            let local = |i: usize| rims.nodes[own[i % own.len()] as usize].local;
            let length = |i| {
                refine
                    .rim_length
                    .unwrap_or_else(|| smooth(local, i, own.len()))
            };
            let z = refine.level.z();
            self.lengths.extend((0..own.len()).map(|i| length(i) * z));
        }
    }

    /// Returns whether the sweep ends inside the body although no curve ends.
    ///
    /// `is_inside` returns whether the sweep's boundary is inside the body, and costs as much as
    /// `triangles` steps. It is called first if comparing all loops costs more.
    pub(super) fn ends_inside(&self, triangles: usize, is_inside: impl FnOnce() -> bool) -> bool {
        let is_hole = |points: &&Vec<u32>| {
            doubled_area(points.iter().map(|&p| self.points[p as usize])) < 0.0
        };
        let holes = self.loops.iter().filter(is_hole).count();
        let is_cheap = holes * self.points.len() <= triangles;
        holes > 0 && (!is_cheap || self.has_loose_hole()) && is_inside()
    }

    /// Returns whether a hole lies in no outer loop. The rim of a cavity in which the sweep ends is
    /// such a hole.
    fn has_loose_hole(&self) -> bool {
        let outline = |i: usize| self.loops[i].iter().map(|&p| self.points[p as usize]);
        (0..self.loops.len()).any(|i| {
            if doubled_area(outline(i)) >= 0.0 {
                return false;
            }
            let inside = self.points[self.loops[i][0] as usize];
            let others = (0..self.loops.len()).filter(|&j| j != i);
            others.map(|j| winding(outline(j), inside)).sum::<i32>() <= 0
        })
    }

    /// Returns the loops as the input of a triangulation.
    pub(super) fn section(&self) -> Section<'_> {
        Section {
            points: &self.points,
            loops: &self.loops,
            crease: self.has_crease,
        }
    }

    /// Returns the target edge length at each point \[m\].
    pub(super) fn lengths(&self) -> &[f64] {
        &self.lengths
    }

    /// Triangulates the section to the target edge lengths or, unless `is_refined`, without new
    /// points.
    ///
    /// # Errors
    /// As [`triangulate_section`].
    pub(super) fn triangulate(
        &mut self,
        rims: &Rims<'_>,
        topology: &Topology,
        refine: &RefineParams,
        is_refined: bool,
    ) -> Result<SectionMesh, RefineError> {
        let params = SectionMeshParams {
            method: refine.method,
            size: if is_refined {
                SectionMeshSize::Local(&self.lengths)
            } else {
                SectionMeshSize::Any
            },
            grading: refine.grading,
            max_rounds: refine.max_rounds,
            max_triangles: refine.max_triangles,
            ..SectionMeshParams::default()
        };
        let joined = |a: u32, b: u32| {
            let [a, b] = [a, b].map(|p| self.nodes[p as usize]);
            (0..2).any(|side| {
                let vertex = rims.sides.vertices[b as usize][side];
                let mut fan = rims.rim.fan(topology, rims.sides, a, side);
                fan.any(|h| topology.target(h) == vertex || topology.origin(h.prev()) == vertex)
            })
        };
        let section = Section {
            points: &self.points,
            loops: &self.loops,
            crease: self.has_crease,
        };
        triangulate_section(&section, &params, joined, &mut self.scratch)
    }
}

/// Returns the mean of `local` around place `i` of `n` on a loop.
///
/// So a single large triangle at the rim does not make the cap coarser.
#[expect(clippy::cast_precision_loss, reason = "few places")]
fn smooth(local: impl Fn(usize) -> f64, i: usize, n: usize) -> f64 {
    let reach = SMOOTHING_NEIGHBORS.min(n / 2);
    let places = i + n - reach..=i + n + reach;
    places.map(local).sum::<f64>() / (2 * reach + 1) as f64
}

/// Returns twice the signed area inside a closed outline.
fn doubled_area(outline: impl Iterator<Item = [f64; 2]> + Clone) -> f64 {
    let following = outline.clone().cycle().skip(1);
    (outline.zip(following))
        .map(|([ax, ay], [bx, by])| ax * by - ay * bx)
        .sum()
}

/// Returns the winding number of a closed outline around a point.
fn winding(outline: impl Iterator<Item = [f64; 2]> + Clone, [x, y]: [f64; 2]) -> i32 {
    let following = outline.clone().cycle().skip(1);
    (outline.zip(following))
        .map(|([ax, ay], [bx, by])| {
            let left = (bx - ax) * (y - ay) - (by - ay) * (x - ax);
            if ay <= y && by > y && left > 0.0 {
                1
            } else if ay > y && by <= y && left < 0.0 {
                -1
            } else {
                0
            }
        })
        .sum()
}
