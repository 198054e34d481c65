//! The paper's refinement of a section (Algorithms A2, 4 and A3), one connected part at a time.
//!
//! A part bounded by a single loop is triangulated by Algorithm A2. The listing has no nested
//! loops; parts with holes start from the constrained Delaunay triangulation of the loops. Then
//! Algorithms 4 and A3 run.
//!
//! In the listing, new vertices are means of means. Here, each also has three parents among the
//! corners of the loops: those of the triangle that contains it in the loops' triangulation.

use super::ear_clipping::triangulate;
use super::edge_dictionary::EdgeDictionary;
use super::subdivision::refine_edges;
use super::{Patch, RefineReport};
use crate::error::RefineError;
use crate::params::RefineParams;
use crate::section_mesh::barycentric_weights;
use crate::section_mesh::boundary_band::BoundaryBand;
use crate::section_mesh::cdt::{Cdt, NONE, constraint};
use crate::section_mesh::duplicate_edges;
use crate::section_mesh::lattice::Lattice;
use crate::section_mesh::loop_triangulation::{INSIDE, LoopTriangulation};
use crate::section_mesh::loops::SectionLoops;
use crate::section_mesh::target_length::TargetLengths;
use crate::section_mesh::{SectionMesh, SteinerPoint};
use incise_mesh::{Vec3, index_u32};

/// Three parents of a Steiner point among the triangulation's vertices, and their weights.
type Mean = ([u32; 3], [f64; 3]);

/// The input of triangulating a group of loops.
pub(crate) struct Task<'a> {
    pub(crate) loops: &'a SectionLoops,
    pub(crate) targets: &'a TargetLengths,
    pub(crate) mirrored: bool,
    /// Maximum rounds and triangles.
    pub(crate) refine: RefineParams,
}

/// Scratch memory of the paper's method.
#[derive(Debug, Clone, Default)]
pub(crate) struct SectionPaper {
    /// The triangulation of the loops alone, in which parents are found.
    base: Cdt,
    /// Whether each triangle belongs to a part already.
    seen: Vec<bool>,
    /// Index in the current part of each of the triangulation's vertices.
    local: Vec<u32>,
}

/// A connected part of a section during refinement.
struct Part {
    /// The vertices on loops, in the triangulation's order.
    corners: Vec<u32>,
    patch: Patch,
    /// Parents and weights of the patch's other vertices.
    means: Vec<Mean>,
}

impl SectionPaper {
    /// Triangulates and refines a valid group of loops.
    pub(crate) fn triangulate(
        &mut self,
        task: &Task<'_>,
        triangulation: &mut LoopTriangulation,
        lattice: &mut Lattice,
        band: &mut BoundaryBand,
        has_edge: &impl Fn(u32, u32) -> bool,
        mesh: &mut SectionMesh,
    ) -> Result<(), RefineError> {
        self.base.copy_triangles(&triangulation.cdt);
        let names: Vec<u32> = (triangulation.corner_of.iter())
            .map(|&corner| task.loops.point_ids[corner as usize])
            .collect();
        let has_edge = |v: u32, w: u32| has_edge(names[v as usize], names[w as usize]);
        for edge in duplicate_edges::find(triangulation, has_edge) {
            let may_flip = duplicate_edges::can_flip(triangulation, edge, has_edge);
            duplicate_edges::replace(triangulation, lattice, band, edge, may_flip);
        }
        self.seen.clear();
        self.seen
            .resize(triangulation.cdt.triangles() as usize, false);
        let mut triangles = Vec::new();
        for first in 0..triangulation.cdt.triangles() {
            self.flood(&triangulation.cdt, first, &mut triangles);
            if triangles.is_empty() {
                continue;
            }
            let mut part = self.part(triangulation, lattice, &triangles, &has_edge);
            if !task.targets.is_any() {
                self.refine(task, triangulation, &mut part, &has_edge)?;
            }
            mesh.report.unconverged +=
                usize::from(!task.targets.is_any() && !part.patch.report.converged);
            write(task, triangulation, &names, &part, mesh);
        }
        Ok(())
    }

    /// Collects the inside triangles connected to `first`, unless they belong to an earlier part.
    fn flood(&mut self, cdt: &Cdt, first: u32, out: &mut Vec<u32>) {
        out.clear();
        if self.seen[first as usize] || cdt.region[first as usize] != INSIDE {
            return;
        }
        self.seen[first as usize] = true;
        out.push(first);
        let mut at = 0;
        while let Some(&t) = out.get(at) {
            at += 1;
            for h in [3 * t, 3 * t + 1, 3 * t + 2] {
                let u = cdt.twin[h as usize] / 3;
                if cdt.constraints[h as usize] != constraint::LOOP && !self.seen[u as usize] {
                    self.seen[u as usize] = true;
                    out.push(u);
                }
            }
        }
    }

    /// Returns the unrefined part of the given triangles.
    fn part(
        &mut self,
        triangulation: &LoopTriangulation,
        lattice: &Lattice,
        triangles: &[u32],
        has_edge: &impl Fn(u32, u32) -> bool,
    ) -> Part {
        let cdt = &triangulation.cdt;
        let mut vertices: Vec<u32> = triangles.iter().flat_map(|&t| cdt.corners(t)).collect();
        vertices.sort_unstable();
        vertices.dedup();
        // The corners of the box follow the loops' vertices; inserted points come last.
        let box_corner = index_u32(triangulation.corner_of.len());
        let rim = vertices.partition_point(|&v| v < box_corner);
        let inserted = vertices.split_off(rim);
        let corners = vertices;
        let place = |v: &u32| {
            let [x, y] = cdt.point(*v);
            Vec3::new(x, y, 0.0)
        };
        let points: Vec<Vec3> = corners.iter().map(place).collect();
        let loop_of = |v: u32| triangulation.loop_of[v as usize];
        if loop_of(corners[0]) == loop_of(corners[rim - 1]) {
            let has_edge = |a: u32, b: u32| has_edge(corners[a as usize], corners[b as usize]);
            let patch = triangulate(&points, Vec3::z(), &has_edge);
            let mean = |parents: &[u32; 3]| (parents.map(|p| corners[p as usize]), [1.0 / 3.0; 3]);
            return Part {
                means: patch.parents.iter().map(mean).collect(),
                corners,
                patch,
            };
        }
        self.local.resize(cdt.points.len(), NONE);
        for (local, &v) in (0..).zip(corners.iter().chain(&inserted)) {
            self.local[v as usize] = local;
        }
        let local = |v: u32| self.local[v as usize];
        let mean = |v: &u32| {
            let point = (*v - box_corner - 4) as usize;
            (lattice.parents[point], lattice.weights[point])
        };
        let means: Vec<Mean> = inserted.iter().map(mean).collect();
        Part {
            patch: Patch {
                rim_len: rim,
                points: points
                    .into_iter()
                    .chain(inserted.iter().map(place))
                    .collect(),
                parents: means
                    .iter()
                    .map(|(parents, _)| parents.map(local))
                    .collect(),
                triangles: triangles
                    .iter()
                    .map(|&t| cdt.corners(t).map(local))
                    .collect(),
                report: RefineReport::default(),
            },
            corners,
            means,
        }
    }

    /// Runs Algorithm 4 with the mean target along the part's loops.
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^53 corners")]
    fn refine(
        &mut self,
        task: &Task<'_>,
        triangulation: &LoopTriangulation,
        part: &mut Part,
        has_edge: &impl Fn(u32, u32) -> bool,
    ) -> Result<(), RefineError> {
        let Part {
            corners,
            patch,
            means,
        } = part;
        let targets = corners
            .iter()
            .map(|&v| task.targets.at(triangulation.corner_of[v as usize]));
        let alpha = targets.sum::<f64>() / corners.len() as f64;
        let is_rim = |a: u32, b: u32| {
            let ends = corners.get(a as usize).zip(corners.get(b as usize));
            ends.is_some_and(|(&v, &w)| {
                triangulation.next[v as usize] == w || triangulation.next[w as usize] == v
            })
        };
        let is_taken = |a: u32, b: u32| {
            let ends = corners.get(a as usize).zip(corners.get(b as usize));
            is_rim(a, b) || ends.is_some_and(|(&v, &w)| has_edge(v, w))
        };
        let dictionary = EdgeDictionary::of(&patch.triangles);
        let base = &mut self.base;
        let place = |center: Vec3| {
            let mean = barycentric_weights(base, [center.x, center.y]);
            means.extend(mean);
            mean.is_some()
        };
        let up = Vec3::z();
        refine_edges(patch, dictionary, up, alpha, &task.refine, &is_taken, place)
    }
}

/// Appends a part's Steiner points and triangles to the mesh.
fn write(
    task: &Task<'_>,
    triangulation: &LoopTriangulation,
    names: &[u32],
    part: &Part,
    mesh: &mut SectionMesh,
) {
    let loops = task.loops;
    let offset = index_u32(loops.point_ids.len() + mesh.steiner_points.len());
    let side = if task.mirrored { -1.0 } else { 1.0 };
    let rim = part.corners.len();
    let inner = part.patch.points[rim..].iter().zip(&part.means);
    mesh.steiner_points
        .extend(inner.map(|(p, &(parents, weights))| SteinerPoint {
            position: [side * p.x / loops.scale, p.y / loops.scale],
            parents: parents.map(|v| names[v as usize]),
            weights,
        }));
    let name = |v: u32| match part.corners.get(v as usize) {
        Some(&corner) => triangulation.corner_of[corner as usize],
        None => offset + v - index_u32(rim),
    };
    let triangles = part.patch.triangles.iter();
    mesh.triangles.extend(triangles.map(|t| t.map(name)));
}
