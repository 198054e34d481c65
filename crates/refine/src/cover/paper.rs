//! The paper's refinement of a section (Algorithms A2, 4 and A3), part by part.
//!
//! A part is what its rings keep connected. One ring is cut up by Algorithm A2. Nested rings, and parts through which the
//! crease runs, are more than that listing can take; they start from the constrained Delaunay triangulation that is
//! there anyway, and the crease is divided first, as Algorithm 4 divides triangles only. From there on it is the
//! same: triangles divided at their centers and edges swapped, but for those on the crease.
//!
//! The listing's new vertices are means of means. Here each is told as the mean of three corners of the rings as well,
//! those of the triangle that holds it in their own triangulation.

use super::band::Band;
use super::cdt::{Cdt, NONE, id, wall};
use super::forbidden;
use super::lattice::Lattice;
use super::mean::mean_in;
use super::section::Rims;
use super::sheet::{INSIDE, Sheet};
use super::size::Targets;
use super::{Cover, InnerPoint};
use crate::edge_dictionary::EdgeDictionary;
use crate::patch::{Patch, RefineError, RefineParams, RefineReport};
use crate::refine::refine_edges;
use crate::triangulate::triangulate;
use incise_mesh::Vec3;

/// Vertices of a sheet's rings and their weights.
type Mean = ([u32; 3], [f64; 3]);

/// What is to be covered, and how.
pub(crate) struct Task<'a> {
    pub(crate) rims: &'a Rims,
    pub(crate) targets: &'a Targets,
    pub(crate) mirrored: bool,
    /// Rounds and the limit of triangles.
    pub(crate) refine: RefineParams,
}

/// Room for the way.
#[derive(Debug, Clone, Default)]
pub(crate) struct Paper {
    /// The triangulation of the rings alone, where parents are found.
    base: Cdt,
    seen: Vec<bool>,
    /// The part's number for each of the sheet's vertices.
    local: Vec<u32>,
}

/// A part on its way.
struct Part {
    /// The rings' vertices, in the sheet's order.
    corners: Vec<u32>,
    patch: Patch,
    /// What the patch's other vertices are means of.
    means: Vec<Mean>,
    /// Whether a vertex is on the crease; of those that are too new to be listed none is.
    on_crease: Vec<bool>,
}

impl Paper {
    /// Covers a clean sheet.
    pub(crate) fn cover(
        &mut self,
        task: &Task<'_>,
        sheet: &mut Sheet,
        lattice: &mut Lattice,
        band: &mut Band,
        joined: &impl Fn(u32, u32) -> bool,
        cover: &mut Cover,
    ) -> Result<(), RefineError> {
        self.base.copy_shape(&sheet.cdt);
        let names: Vec<u32> = (sheet.corner.iter())
            .map(|&corner| task.rims.ids[corner as usize])
            .collect();
        let joined = |v: u32, w: u32| joined(names[v as usize], names[w as usize]);
        for edge in forbidden::find(sheet, joined) {
            let may_flip = forbidden::can_flip(sheet, edge, joined);
            forbidden::replace(sheet, lattice, band, edge, may_flip);
        }
        self.seen.clear();
        self.seen.resize(sheet.cdt.triangles() as usize, false);
        let mut triangles = Vec::new();
        for first in 0..sheet.cdt.triangles() {
            self.flood(&sheet.cdt, first, &mut triangles);
            if triangles.is_empty() {
                continue;
            }
            let mut part = self.part(sheet, lattice, &triangles, &joined);
            if !task.targets.is_any() {
                self.refine(task, sheet, &mut part, &joined)?;
            }
            cover.report.unfinished +=
                usize::from(!task.targets.is_any() && !part.patch.report.converged);
            write(task, sheet, &names, &part, cover);
        }
        Ok(())
    }

    /// The triangles inside that are connected with `first`, if they were not listed before.
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
                if cdt.walls[h as usize] != wall::RIM && !self.seen[u as usize] {
                    self.seen[u as usize] = true;
                    out.push(u);
                }
            }
        }
    }

    /// A part as it is before refinement.
    fn part(
        &mut self,
        sheet: &Sheet,
        lattice: &Lattice,
        triangles: &[u32],
        joined: &impl Fn(u32, u32) -> bool,
    ) -> Part {
        let cdt = &sheet.cdt;
        let mut vertices: Vec<u32> = triangles.iter().flat_map(|&t| cdt.corners(t)).collect();
        vertices.sort_unstable();
        vertices.dedup();
        // Behind the rings' vertices come the box's corners, then what was inserted.
        let box_corner = id(sheet.corner.len());
        let rim = vertices.partition_point(|&v| v < box_corner);
        let inserted = vertices.split_off(rim);
        let corners = vertices;
        let place = |v: &u32| {
            let [x, y] = cdt.point(*v);
            Vec3::new(x, y, 0.0)
        };
        let points: Vec<Vec3> = corners.iter().map(place).collect();
        let half_edges = || {
            triangles
                .iter()
                .flat_map(|&t| [3 * t, 3 * t + 1, 3 * t + 2])
        };
        let has_crease = half_edges().any(|h| cdt.walls[h as usize] == wall::CREASE);
        let ring = |v: u32| sheet.ring[v as usize];
        if !has_crease && ring(corners[0]) == ring(corners[rim - 1]) {
            let joined = |a: u32, b: u32| joined(corners[a as usize], corners[b as usize]);
            let patch = triangulate(&points, Vec3::z(), &joined);
            let mean = |parents: &[u32; 3]| (parents.map(|p| corners[p as usize]), [1.0 / 3.0; 3]);
            return Part {
                means: patch.inner.iter().map(mean).collect(),
                on_crease: vec![false; patch.points.len()],
                corners,
                patch,
            };
        }
        self.local.resize(cdt.points.len(), NONE);
        for (local, &v) in (0..).zip(corners.iter().chain(&inserted)) {
            self.local[v as usize] = local;
        }
        let local = |v: u32| self.local[v as usize];
        let mut on_crease = vec![false; rim + inserted.len()];
        for h in half_edges().filter(|&h| cdt.walls[h as usize] == wall::CREASE) {
            on_crease[local(cdt.start(h)) as usize] = true;
            on_crease[local(cdt.end(h)) as usize] = true;
        }
        let mean = |v: &u32| {
            let point = (*v - box_corner - 4) as usize;
            (lattice.parents[point], lattice.weights[point])
        };
        let means: Vec<Mean> = inserted.iter().map(mean).collect();
        Part {
            patch: Patch {
                rim,
                points: points
                    .into_iter()
                    .chain(inserted.iter().map(place))
                    .collect(),
                inner: means
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
            on_crease,
        }
    }

    /// Algorithm 4, to the mean of the targets along the part's rings.
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^53 corners")]
    fn refine(
        &mut self,
        task: &Task<'_>,
        sheet: &Sheet,
        part: &mut Part,
        joined: &impl Fn(u32, u32) -> bool,
    ) -> Result<(), RefineError> {
        let Part {
            corners,
            patch,
            means,
            on_crease,
        } = part;
        let targets = corners
            .iter()
            .map(|&v| task.targets.at(sheet.corner[v as usize]));
        let alpha = targets.sum::<f64>() / corners.len() as f64;
        let limit = task.refine.max_triangles;
        let is_rim = |a: u32, b: u32| {
            let ends = corners.get(a as usize).zip(corners.get(b as usize));
            ends.is_some_and(|(&v, &w)| sheet.next[v as usize] == w || sheet.next[w as usize] == v)
        };
        let crease = Crease {
            means,
            on_crease,
            alpha,
            limit,
        };
        if !crease.divide(patch, corners, is_rim) {
            return Err(RefineError::TooManyTriangles { limit });
        }
        let is_fixed = |a: u32, b: u32| {
            let is_on_crease = |v: u32| on_crease.get(v as usize).is_some_and(|&on| on);
            is_on_crease(a) && is_on_crease(b)
        };
        let is_taken = |a: u32, b: u32| {
            let ends = corners.get(a as usize).zip(corners.get(b as usize));
            is_rim(a, b) || is_fixed(a, b) || ends.is_some_and(|(&v, &w)| joined(v, w))
        };
        let dictionary = EdgeDictionary::of(&patch.triangles, is_fixed);
        let base = &mut self.base;
        let place = |center: Vec3| {
            let mean = mean_in(base, [center.x, center.y]);
            means.extend(mean);
            mean.is_some()
        };
        let up = Vec3::z();
        refine_edges(patch, dictionary, up, alpha, &task.refine, &is_taken, place)
    }
}

/// Edges on the crease before they are divided.
struct Crease<'a> {
    means: &'a mut Vec<Mean>,
    on_crease: &'a mut Vec<bool>,
    alpha: f64,
    limit: usize,
}

impl Crease<'_> {
    /// Divides those that are longer than `alpha` evenly, and the triangles beside them with them. False when that
    /// takes more triangles than the limit.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_precision_loss,
        reason = "a count below the limit"
    )]
    fn divide(self, patch: &mut Patch, corners: &[u32], is_rim: impl Fn(u32, u32) -> bool) -> bool {
        // Edges that were divided: their ends, the smaller first, and the first point in between.
        let mut divided: Vec<([u32; 2], u32)> = Vec::new();
        for t in 0..patch.triangles.len() {
            let corner = |k: usize| patch.triangles[t][k % 3];
            let is_crease = |&k: &usize| {
                let [a, b] = [corner(k), corner(k + 1)];
                // A vertex in the middle of an edge is not one of the corners that others are means of.
                let is_old = a.max(b) < id(corners.len());
                is_old && [a, b].iter().all(|&v| self.on_crease[v as usize]) && !is_rim(a, b)
            };
            let Some(k) = (0..3).find(is_crease) else {
                continue;
            };
            let [a, b, apex] = [corner(k), corner(k + 1), corner(k + 2)];
            let [low, high] = [a.min(b), a.max(b)];
            let [p, q] = [low, high].map(|v| patch.points[v as usize]);
            let parts = ((q - p).norm() / self.alpha).ceil();
            if parts > self.limit as f64 {
                return false;
            }
            let between = (parts as u32).saturating_sub(1);
            if between == 0 {
                continue;
            }
            let known = divided.iter().find(|(ends, _)| *ends == [low, high]);
            let first = known.map_or_else(|| id(patch.points.len()), |&(_, first)| first);
            if known.is_none() {
                divided.push(([low, high], first));
                let parents = [low, high, low].map(|v| corners[v as usize]);
                for i in 1..=between {
                    let along = f64::from(i) / parts;
                    patch.points.push(p * (1.0 - along) + q * along);
                    patch.inner.push([low, high, low]);
                    self.means.push((parents, [1.0 - along, along, 0.0]));
                    self.on_crease.push(true);
                }
            }
            let mut row: Vec<u32> = (first..first + between).collect();
            if a == high {
                row.reverse();
            }
            row.push(b);
            patch.triangles[t] = [a, row[0], apex];
            let rest = row.windows(2).map(|pair| [pair[0], pair[1], apex]);
            patch.triangles.extend(rest);
        }
        true
    }
}

/// Writes a part's inner points and its triangles.
fn write(task: &Task<'_>, sheet: &Sheet, names: &[u32], part: &Part, cover: &mut Cover) {
    let rims = task.rims;
    let offset = id(rims.ids.len() + cover.inner.len());
    let side = if task.mirrored { -1.0 } else { 1.0 };
    let rim = part.corners.len();
    let inner = part.patch.points[rim..].iter().zip(&part.means);
    cover
        .inner
        .extend(inner.map(|(p, &(parents, weights))| InnerPoint {
            at: [side * p.x / rims.scale, p.y / rims.scale],
            parents: parents.map(|v| names[v as usize]),
            weights,
        }));
    let name = |v: u32| match part.corners.get(v as usize) {
        Some(&corner) => sheet.corner[corner as usize],
        None => offset + v - id(rim),
    };
    let triangles = part.patch.triangles.iter();
    cover.triangles.extend(triangles.map(|t| t.map(name)));
}
