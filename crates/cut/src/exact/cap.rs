//! Both lips closed by the same triangles, one the mirror image of the other.

use super::node::Node;
use super::open::Lips;
use super::rest::CapRest;
use super::rim::Rim;
use super::unfold::Unfold;
use incise_mesh::geometry::round;
use incise_mesh::{Edit, Origin, Surface, Topology, TriangleId, VertexId};
use incise_refine::{
    Cover, CoverParams, CoverScratch, CoverSize, RefineError, RefineParams, Section, cover,
};

/// How many places to both sides along the rim the local edge length is taken from.
const AROUND: usize = 4;

/// The cross-section and its cover.
#[derive(Debug, Clone, Default)]
pub(crate) struct Cap {
    /// The node of each point of the section.
    nodes: Vec<u32>,
    flat: Flat,
    /// How long edges are to get at each point \[m\].
    lengths: Vec<f64>,
    scratch: CoverScratch,
    rest: CapRest,
    /// By lip, the vertices of the cover's points and the triangles of its triangles.
    vertices: [Vec<VertexId>; 2],
    corners: Vec<[VertexId; 3]>,
    pieces: Vec<u32>,
    twins: Vec<u32>,
    first: Vec<u32>,
    following: Vec<(u32, u32)>,
    parents: Vec<u32>,
    joined: Vec<usize>,
    pub(super) triangles: [Vec<TriangleId>; 2],
}

/// The rim's loops in the plane.
#[derive(Debug, Clone, Default)]
struct Flat {
    points: Vec<[f64; 2]>,
    loops: Vec<Vec<u32>>,
    has_crease: bool,
}

impl Flat {
    fn section(&self) -> Section<'_> {
        Section {
            points: &self.points,
            loops: &self.loops,
            crease: self.has_crease,
        }
    }
}

/// What closing needs to know of the cut.
pub(super) struct Rims<'a> {
    pub(super) nodes: &'a [Node],
    pub(super) lips: &'a Lips,
    pub(super) rim: &'a Rim,
    pub(super) unfold: &'a Unfold,
    pub(super) has_crease: bool,
}

/// Covers the section of `nodes`.
fn cover_to(
    flat: &Flat,
    nodes: &[u32],
    size: CoverSize<'_>,
    (rims, topology, refine): (&Rims<'_>, &Topology, &RefineParams),
    scratch: &mut CoverScratch,
) -> Result<Cover, RefineError> {
    let params = CoverParams {
        method: refine.method,
        size,
        grading: refine.grading,
        max_rounds: refine.max_rounds,
        max_triangles: refine.max_triangles,
        ..CoverParams::default()
    };
    let joined = |a: u32, b: u32| {
        let [a, b] = [a, b].map(|p| nodes[p as usize]);
        (0..2).any(|lip| {
            let vertex = rims.lips.vertices[b as usize][lip];
            let mut fan = rims.rim.fan(topology, rims.lips, a, lip);
            fan.any(|h| topology.target(h) == vertex || topology.origin(h.prev()) == vertex)
        })
    };
    cover(&flat.section(), &params, joined, scratch)
}

impl Cap {
    /// Lays the rim's loops flat and finds how long edges are to get along them.
    pub(super) fn flatten(&mut self, rims: &Rims<'_>, refine: &RefineParams) {
        self.nodes.clear();
        self.lengths.clear();
        self.flat.has_crease = rims.has_crease;
        self.flat.points.clear();
        self.flat.loops.resize(rims.rim.sizes.len(), Vec::new());
        for (i, points) in self.flat.loops.iter_mut().enumerate() {
            points.clear();
            for node in rims.rim.ring(i) {
                points.push(u32::try_from(self.nodes.len()).expect("nodes have 32-bit ids"));
                self.nodes.push(node);
                self.flat
                    .points
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

    /// Whether the sweep ends inside the body although no curve ends. `is_inside` tells whether its
    /// boundary is in the body, at the cost of `triangles`: asked at once where loops are so many that
    /// looking at them costs more.
    pub(super) fn ends_inside(&self, triangles: usize, is_inside: impl FnOnce() -> bool) -> bool {
        let is_hole = |points: &&Vec<u32>| {
            doubled_area(points.iter().map(|&p| self.flat.points[p as usize])) < 0.0
        };
        let holes = self.flat.loops.iter().filter(is_hole).count();
        let is_cheap = holes * self.flat.points.len() <= triangles;
        holes > 0 && (!is_cheap || self.has_loose_hole()) && is_inside()
    }

    /// Whether a loop runs around nothing of the section, as the rim of a cavity does in which a
    /// sweep without an end on the surface ends.
    fn has_loose_hole(&self) -> bool {
        let outline = |i: usize| {
            self.flat.loops[i]
                .iter()
                .map(|&p| self.flat.points[p as usize])
        };
        (0..self.flat.loops.len()).any(|i| {
            if doubled_area(outline(i)) >= 0.0 {
                return false;
            }
            let inside = self.flat.points[self.flat.loops[i][0] as usize];
            let others = (0..self.flat.loops.len()).filter(|&j| j != i);
            others.map(|j| winding(outline(j), inside)).sum::<i32>() <= 0
        })
    }

    /// Covers the section.
    ///
    /// # Errors
    /// As [`cover`].
    pub(super) fn cover(
        &mut self,
        rims: &Rims<'_>,
        topology: &Topology,
        refine: &RefineParams,
    ) -> Result<Cover, RefineError> {
        let size = CoverSize::Local(&self.lengths);
        cover_to(
            &self.flat,
            &self.nodes,
            size,
            (rims, topology, refine),
            &mut self.scratch,
        )
    }

    /// The loops that a cover of the section would join, by a loop that stands for all of them.
    ///
    /// # Errors
    /// As [`cover`].
    pub(super) fn groups(
        &mut self,
        rims: &Rims<'_>,
        topology: &Topology,
        refine: &RefineParams,
    ) -> Result<Vec<usize>, RefineError> {
        // Which loops are together is told by the loops alone.
        let given = (rims, topology, refine);
        let cover = cover_to(
            &self.flat,
            &self.nodes,
            CoverSize::Any,
            given,
            &mut self.scratch,
        )?;
        self.join_loops(&cover);
        Ok(self.joined.clone())
    }

    /// The loops that were joined last, as [`Self::groups`] gives them.
    pub(super) fn groups_joined(&self) -> &[usize] {
        &self.joined
    }

    /// What was covered last, and how long edges were to get at each point.
    pub(crate) fn section(&self) -> (Section<'_>, &[f64]) {
        (self.flat.section(), &self.lengths)
    }

    /// The loops that the cover joins, by a loop that stands for all of them.
    pub(super) fn join_loops(&mut self, cover: &Cover) {
        self.joined.clear();
        self.joined.extend(0..self.flat.loops.len());
        if self.flat.loops.len() == 1 {
            return;
        }
        // Points of one triangle are together; the smallest of them all stands for them.
        self.parents.clear();
        let count = u32::try_from(self.flat.points.len() + cover.inner.len());
        self.parents
            .extend(0..count.expect("points have 32-bit numbers"));
        for &[a, b, c] in &cover.triangles {
            let a = find(&mut self.parents, a);
            let b = find(&mut self.parents, b);
            let c = find(&mut self.parents, c);
            let least = a.min(b).min(c);
            for root in [a, b, c] {
                self.parents[root as usize] = least;
            }
        }
        let mut first_loop = vec![usize::MAX; self.flat.points.len()];
        for (i, points) in self.flat.loops.iter().enumerate() {
            let root = find(&mut self.parents, points[0]) as usize;
            if first_loop[root] == usize::MAX {
                first_loop[root] = i;
            }
            self.joined[i] = first_loop[root];
        }
    }

    /// The pairs of loops that the cover joins.
    pub(super) fn joined(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        (self.joined.iter().copied().enumerate()).filter(|&(i, first)| i != first)
    }

    /// Closes both lips with the cover. Pieces are those of the lips.
    pub(super) fn close(
        &mut self,
        edit: &mut Edit<'_>,
        rims: &Rims<'_>,
        cover: &Cover,
        material: u32,
    ) {
        self.find_twins(cover);
        let vertices = self.nodes.iter();
        let vertices = vertices.map(|&n| rims.lips.vertices[n as usize][0]);
        let section = self.flat.section();
        self.rest.find(edit.surface(), vertices, cover, &section);
        for lip in 0..2 {
            self.add_vertices(edit, rims, cover, lip);
            self.find_pieces(edit.surface(), rims, cover, lip);
            let vertices = &self.vertices[lip];
            self.corners.clear();
            self.corners.extend(cover.triangles.iter().map(|triangle| {
                let [a, b, c] = triangle.map(|p| vertices[p as usize]);
                if lip == 0 { [a, b, c] } else { [a, c, b] }
            }));
            if lip == 1 {
                self.mirror_twins();
            }
            self.triangles[lip].clear();
            edit.add_patch(
                &self.corners,
                &self.twins,
                &self.pieces,
                material,
                &mut self.triangles[lip],
            );
            self.join_rim(edit, rims, cover, lip);
            self.dress(edit, rims, cover, lip);
        }
    }

    /// The piece of each triangle of the cover.
    fn find_pieces(&mut self, surface: &Surface, rims: &Rims<'_>, cover: &Cover, lip: usize) {
        let first = |i: usize| rims.rim.first[i] as usize;
        let piece = |i: usize| surface.piece(rims.lips.rim[first(i)][lip].triangle());
        self.pieces.clear();
        if self.flat.loops.len() == 1 {
            self.pieces.resize(cover.triangles.len(), piece(0));
            return;
        }
        let mut of_root = vec![0; self.flat.points.len()];
        for (i, points) in self.flat.loops.iter().enumerate() {
            of_root[find(&mut self.parents, points[0]) as usize] = piece(i);
        }
        for &[a, ..] in &cover.triangles {
            let root = find(&mut self.parents, a);
            self.pieces.push(of_root[root as usize]);
        }
    }

    fn add_vertices(&mut self, edit: &mut Edit<'_>, rims: &Rims<'_>, cover: &Cover, lip: usize) {
        let vertices = &mut self.vertices[lip];
        vertices.clear();
        let own = self
            .nodes
            .iter()
            .map(|&n| rims.lips.vertices[n as usize][lip]);
        vertices.extend(own);
        for (i, inner) in cover.inner.iter().enumerate() {
            let parents = inner.parents.map(|p| vertices[p as usize]);
            let weights = inner.weights.map(|w| round([w, 0.0, 0.0].into())[0]);
            let origin = Origin::OnCap { parents, weights };
            let surface = edit.surface();
            let mean = origin.interpolate(|v| surface.rest[v.index()]);
            let rest = self.rest.of(i, round(mean.into()));
            let [w] = origin.interpolate(|v| [surface.positions[v.index()][3]]);
            let [x, y, z] = round(rims.unfold.lift(inner.at).0);
            let [w, ..] = round([w, 0.0, 0.0].into());
            vertices.push(edit.add_vertex([x, y, z, w], rest, origin));
        }
    }

    fn join_rim(&self, edit: &mut Edit<'_>, rims: &Rims<'_>, cover: &Cover, lip: usize) {
        for (t, triangle) in cover.triangles.iter().enumerate() {
            for (k, &point) in triangle.iter().enumerate() {
                let own = if lip == 0 { k } else { 2 - k };
                if self.twins[3 * t + own] == u32::MAX {
                    let node = self.nodes[point as usize];
                    let h = self.triangles[lip][t].half_edges()[own];
                    edit.join(h, rims.lips.rim[node as usize][lip]);
                }
            }
        }
    }

    /// The half-edge across each half-edge 3 t + k of the cover.
    fn find_twins(&mut self, cover: &Cover) {
        self.twins.clear();
        self.twins.resize(3 * cover.triangles.len(), u32::MAX);
        // The half-edges that leave each point, chained.
        self.first.clear();
        (self.first).resize(self.flat.points.len() + cover.inner.len(), u32::MAX);
        self.following.clear();
        let mut h = 0;
        for &[a, b, c] in &cover.triangles {
            for [from, to] in [[a, b], [b, c], [c, a]] {
                let mut back = self.first[to as usize];
                while let Some(&(next, target)) = self.following.get(back as usize) {
                    if target == from {
                        break;
                    }
                    back = next;
                }
                if back != u32::MAX {
                    self.twins[h as usize] = back;
                    self.twins[back as usize] = h;
                }
                let first = &mut self.first[from as usize];
                self.following.push((std::mem::replace(first, h), to));
                h += 1;
            }
        }
    }

    /// Makes the twins those of the mirror image. There corners stand in the order 0, 2, 1, so that the
    /// side from 0 to 1 is the last and the one from 1 to 2 the middle one.
    fn mirror_twins(&mut self) {
        for twins in self.twins.chunks_exact_mut(3) {
            twins.swap(0, 2);
            for twin in twins.iter_mut().filter(|twin| **twin != u32::MAX) {
                *twin = *twin / 3 * 3 + (2 - *twin % 3);
            }
        }
    }

    /// Texture coordinates are those of the sweep laid flat \[m\], normals the sweep's.
    fn dress(&self, edit: &mut Edit<'_>, rims: &Rims<'_>, cover: &Cover, lip: usize) {
        let attributes = &edit.surface().corners;
        if attributes.uv.is_empty() && attributes.normal.is_empty() {
            return;
        }
        for h in 0..3 * cover.triangles.len() {
            let point = cover.triangles[h / 3][h % 3] as usize;
            let at = match point.checked_sub(self.flat.points.len()) {
                Some(inner) => cover.inner[inner].at,
                None => self.flat.points[point],
            };
            let corner = self.triangles[lip][h / 3].half_edges();
            let corner = corner[if lip == 0 { h % 3 } else { (3 - h % 3) % 3 }];
            let [u, v] = at;
            let [u, v, _] = round([u, v, 0.0].into());
            edit.set_uv(corner, [u, v]);
            let normal = rims.unfold.lift(at).1;
            edit.set_normal(corner, round(if lip == 0 { normal } else { -normal }));
        }
    }
}

/// What `local` is around place `i` of `n` on a loop: one triangle that is larger than its neighbors is
/// no reason for larger ones in the cap.
#[expect(clippy::cast_precision_loss, reason = "a handful of places")]
fn smooth(local: impl Fn(usize) -> f64, i: usize, n: usize) -> f64 {
    let reach = AROUND.min(n / 2);
    let places = i + n - reach..=i + n + reach;
    places.map(local).sum::<f64>() / (2 * reach + 1) as f64
}

/// The smallest point that is together with `i`.
fn find(parents: &mut [u32], mut i: u32) -> u32 {
    while parents[i as usize] != i {
        let next = parents[parents[i as usize] as usize];
        parents[i as usize] = next;
        i = next;
    }
    i
}

fn doubled_area(outline: impl Iterator<Item = [f64; 2]> + Clone) -> f64 {
    let following = outline.clone().cycle().skip(1);
    (outline.zip(following))
        .map(|([ax, ay], [bx, by])| ax * by - ay * bx)
        .sum()
}

/// How often a closed outline runs around a point, counterclockwise.
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
