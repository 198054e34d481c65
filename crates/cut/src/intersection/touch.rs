//! Detects curves that only touch the surface, so that no piece without volume is cut off.
//!
//! The lowest vertex, edge or face of a body that stands on the sweep is cut off only because a
//! tie or a rounded coordinate puts it on the other side. So is a part of a cap when the surface
//! is cut again along the same sweep.
//!
//! The sweep divides the surface into regions of vertices on one side. A region is flat if all of
//! it is within rounding of the sweep. Flat regions above the sweep count as below it, together
//! with the regions around them; then flat regions below count as above it. A curve between two
//! regions that are now on one side is dropped. All curves of a flat region are dropped with it,
//! so the curves that remain still bound a cross-section.
//!
//! A vertex is above the sweep if it is above the facet next to it, continued without end, and
//! above the facet across the next crease, or above either where the crease is a ridge.

use super::facets::{Facets, NO_FACET};
use super::node::{Node, On};
use incise_mesh::{Surface, TriangleId, Vec3, VertexId};

/// Rounding of a cap's vertices and of the sweep [of the largest coordinate].
const ROUNDING: f64 = 8.0 * f32::EPSILON as f64;

/// Maximum ratio of the coordinates of a sweep and of the surface of which rounding counts.
///
/// A larger sweep is no reason to take a thicker slice for rounding.
const MAX_SWEEP_RATIO: f64 = 4.0;

/// Maximum distance of a flat region from the sweep [mean edge length].
///
/// Bounds the slices that are dropped far from the origin, where edges are few roundings long.
const MAX_HEIGHT: f64 = 0.1;

/// The part of the surface around a vertex that is tested for flatness.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Part {
    /// The region of the vertex.
    Region,
    /// The region of a vertex below, with the flat regions above that border it and so on.
    Merged,
}

/// Flat regions of a surface, found as curves ask for them. Kept between cuts for its memory.
#[derive(Debug, Clone, Default)]
pub(crate) struct Touch {
    /// Distance from the sweep that is within rounding \[m\].
    tolerance: f64,
    /// By vertex and [`Part`], whether the part is flat, if known.
    is_flat: Vec<[Option<bool>; 2]>,
    /// Vertices with an entry.
    known: Vec<VertexId>,
    /// By [`Part`], the vertices of a search.
    queues: [Vec<VertexId>; 2],
}

impl Touch {
    /// Forgets the last cut and sets the tolerance for a cut through `triangles`.
    pub(crate) fn start(
        &mut self,
        surface: &Surface,
        facets: &Facets,
        triangles: impl Iterator<Item = TriangleId>,
    ) {
        for v in self.known.drain(..) {
            self.is_flat[v.index()] = [None; 2];
        }
        let (mut largest, mut length, mut count) = (f64::from(f32::MIN_POSITIVE), 0.0, 0.0);
        for t in triangles {
            let [a, b, c] = surface.triangle_positions(t);
            largest = [a, b, c].iter().fold(largest, |m, p| p.amax().max(m));
            let edges = [b - a, c - b, a - c];
            length += edges.iter().fold(0.0, |m, e| e.norm().max(m));
            count += 1.0;
        }
        let sweep = facets.largest_diagonal();
        let coordinate = largest.max(sweep.min(MAX_SWEEP_RATIO * largest));
        self.tolerance = (ROUNDING * coordinate).min(MAX_HEIGHT * length / count);
    }

    /// Returns whether a curve without ends inside a triangle only touches the surface. See the
    /// module.
    ///
    /// O(1) unless the curve begins within rounding of vertices. All curves of a cut together
    /// visit each vertex on the sweep a few times.
    pub(crate) fn is_touch(&mut self, surface: &Surface, facets: &Facets, nodes: &[Node]) -> bool {
        // Below, above.
        let mut is_near = [true; 2];
        for node in nodes {
            let Some(ends) = ends(node) else { continue };
            let mut near = ends.map(|v| self.is_near(surface, facets, v));
            if near == [false; 2] {
                return false;
            }
            if let Some((side, crease)) = passed_twice(surface, facets, ends) {
                near[1 - side] = self.is_edge_near(surface, facets, ends)
                    || self.is_near_both(facets, crease, node.position);
            }
            is_near = [0, 1].map(|side| is_near[side] && near[side]);
            if is_near == [false; 2] {
                return false;
            }
        }
        let has_crease = nodes.iter().any(|node| ends(node).is_none());
        let mut is_flat = |part: Part, side: usize| {
            let mut seeds = nodes
                .iter()
                .filter_map(|node| seed(surface, facets, node, side));
            // Without a vertex it is the part of an edge across the crease, or of a slice between
            // facets that overlap.
            is_near[side]
                && (has_crease || seeds.clone().next().is_some())
                && seeds.all(|v| self.is_flat(surface, facets, v, part))
        };
        is_flat(Part::Region, 1) || is_flat(Part::Merged, 0)
    }

    /// Returns whether a curve through a triangle only touches the surface there.
    pub(crate) fn is_touch_in(
        &mut self,
        surface: &Surface,
        facets: &Facets,
        triangle: TriangleId,
    ) -> bool {
        let corners = surface.topology().triangle(triangle);
        let side = |v| is_above(facets, surface.position(v));
        let mut is_flat = |part, is_above| {
            let mut seeds = corners.into_iter().filter(|&v| side(v) == is_above);
            seeds.clone().next().is_some() && seeds.all(|v| self.is_flat(surface, facets, v, part))
        };
        is_flat(Part::Region, true) || is_flat(Part::Merged, false)
    }

    /// Returns whether the part around `start` is flat.
    fn is_flat(&mut self, surface: &Surface, facets: &Facets, start: VertexId, part: Part) -> bool {
        if let Some(known) = self.get(start, part) {
            return known;
        }
        let mut queue = std::mem::take(&mut self.queues[part as usize]);
        queue.clear();
        queue.push(start);
        self.set(start, part, true);
        let mut is_flat = self.is_near(surface, facets, start);
        let mut next = 0;
        while is_flat && let Some(&v) = queue.get(next) {
            next += 1;
            for h in surface.topology().outgoing_fan(v) {
                let w = surface.topology().target(h);
                let Some(is_near) = self.step(surface, facets, [v, w], part) else {
                    continue;
                };
                let known = self.get(w, part);
                if !is_near || known == Some(false) {
                    is_flat = false;
                    break;
                }
                if known.is_none() {
                    self.set(w, part, true);
                    queue.push(w);
                }
            }
        }
        if !is_flat {
            // Searches that meet these vertices end there.
            for &v in &queue {
                self.set(v, part, false);
            }
        }
        self.queues[part as usize] = queue;
        is_flat
    }

    /// Returns whether the part of `from` stays within rounding of the sweep up to its neighbor
    /// `to`; none if `to` is beyond a curve.
    fn step(
        &mut self,
        surface: &Surface,
        facets: &Facets,
        [from, to]: [VertexId; 2],
        part: Part,
    ) -> Option<bool> {
        let ends = [from, to];
        let [was_above, is_above] = ends.map(|v| is_above(facets, surface.position(v)));
        if was_above == is_above {
            // The middle of an edge that passes twice is on the other side. Where another edge
            // bridges the crease the region itself is off the sweep.
            let is_twice = passed_twice(surface, facets, ends).is_some();
            return Some(if is_twice {
                self.is_near(surface, facets, to)
            } else {
                self.is_edge_near(surface, facets, ends)
            });
        }
        match part {
            Part::Region => None,
            Part::Merged if was_above => Some(self.is_near(surface, facets, to)),
            Part::Merged => {
                let is_merged = self.is_near(surface, facets, to)
                    && self.is_flat(surface, facets, to, Part::Region);
                is_merged.then_some(true)
            }
        }
    }

    /// Returns whether a vertex is within rounding of the sweep.
    fn is_near(&self, surface: &Surface, facets: &Facets, v: VertexId) -> bool {
        (0..facets.len()).any(|i| self.is_near_facet(facets, i, surface.position(v)))
    }

    /// Returns whether a point is within rounding of the planes of both facets beside a crease.
    fn is_near_both(&self, facets: &Facets, crease: u32, p: Vec3) -> bool {
        let is_near = |i| facets.height(i, p).abs() <= self.tolerance * facets.normal(i).norm();
        facets.edges()[crease as usize]
            .facets
            .into_iter()
            .all(is_near)
    }

    /// Returns whether a whole edge is within rounding of the sweep.
    fn is_edge_near(&self, surface: &Surface, facets: &Facets, ends: [VertexId; 2]) -> bool {
        let [p, q] = ends.map(|v| surface.position(v));
        let near = (0..facets.len()).filter(|&i| self.is_near_facet(facets, i, p));
        near.clone().any(|i| {
            // From one facet to the other: the edge has to pass the crease.
            let passes = |(k, edge): (usize, u32)| {
                let beyond = facets.beyond_edge(i, edge);
                if beyond == NO_FACET || !self.is_near_facet(facets, beyond, q) {
                    return false;
                }
                let [yp, yq] = [p, q].map(|x| facets.outside(i, k, x));
                facets.off_edge(edge, p + (q - p) * (yp / (yp - yq))) <= self.tolerance
            };
            self.is_near_facet(facets, i, q) || (0..).zip(facets.edges_of(i)).any(passes)
        })
    }

    fn is_near_facet(&self, facets: &Facets, i: u32, p: Vec3) -> bool {
        facets.exists(i) && facets.miss(i, p) <= self.tolerance
    }

    fn get(&self, v: VertexId, part: Part) -> Option<bool> {
        self.is_flat.get(v.index())?[part as usize]
    }

    fn set(&mut self, v: VertexId, part: Part, is_flat: bool) {
        if self.is_flat.len() <= v.index() {
            self.is_flat.resize(v.index() + 1, [None; 2]);
        }
        let entry = &mut self.is_flat[v.index()];
        if *entry == [None; 2] {
            self.known.push(v);
        }
        entry[part as usize] = Some(is_flat);
    }
}

/// Returns the ends of a node's edge below and above its facet.
fn ends(node: &Node) -> Option<[VertexId; 2]> {
    match node.on {
        On::Edge {
            ends: [a, b],
            rises,
            ..
        } => Some(if rises { [a, b] } else { [b, a] }),
        On::Face { .. } | On::Tip(_) => None,
    }
}

/// Returns whether a point is above the sweep, continued without end.
fn is_above(facets: &Facets, p: Vec3) -> bool {
    match facets.nearest(p) {
        Some((_, Some(crease))) => is_above_wedge(facets, crease, p),
        Some((facet, None)) => facets.is_above(facet, p),
        None => false,
    }
}

/// Returns whether a point is above the two facets beside a crease, continued without end.
fn is_above_wedge(facets: &Facets, crease: u32, p: Vec3) -> bool {
    let mut sides =
        (facets.edges()[crease as usize].facets.into_iter()).map(|facet| facets.is_above(facet, p));
    if facets.is_valley(crease) {
        sides.all(|is_above| is_above)
    } else {
        sides.any(|is_above| is_above)
    }
}

/// Returns the side of both ends of an edge that may pass two facets, so that its middle is on the
/// other side, and the crease between them.
fn passed_twice(surface: &Surface, facets: &Facets, ends: [VertexId; 2]) -> Option<(usize, u32)> {
    let [p, q] = ends.map(|v| surface.position(v));
    let (_, crease) = facets.nearest(p)?;
    let crease = crease?;
    let beside = facets.edges()[crease as usize].facets;
    let passes = |i: u32| facets.is_above(i, p) != facets.is_above(i, q);
    let side = is_above_wedge(facets, crease, p);
    let is_twice = beside.into_iter().all(passes) && side == is_above_wedge(facets, crease, q);
    is_twice.then_some((usize::from(side), crease))
}

/// Returns the end of a node's edge that is next to the node on a side, if there is one.
fn seed(surface: &Surface, facets: &Facets, node: &Node, side: usize) -> Option<VertexId> {
    let ends = ends(node)?;
    let passed = passed_twice(surface, facets, ends);
    let is_middle = passed.is_some_and(|(outer, _)| outer == 1 - side);
    (!is_middle).then_some(ends[side])
}
