//! The tip of an incision: the vertices along the current edge of the sweep inside the body.

use super::Exact;
use crate::incision::TipPoint;
use crate::intersection::facets::{EdgeKind, Facets};
use crate::intersection::node::On;
use crate::intersection::trace::Trace;
use incise_mesh::{Surface, Vec3, VertexId, index_u32};

/// Maximum distance of two parts of a tip that meet [local edge length].
const MAX_DISTANCE: f64 = 1e-3;

/// Minimum distance of neighbors along a tip [distance of two points of the sweep].
const MIN_SPACING: f64 = 1e-3;

/// A part of the tip: nodes joined by edges of the surface, or a single node in a sheet.
struct Part<'a> {
    /// Parameter of its first node on the blade.
    parameter: f64,
    edge: u32,
    nodes: &'a [u32],
}

impl Exact {
    /// Returns the tip along the previous or the current edge of the last sweep, whose points have
    /// `parameters` on the blade.
    pub(crate) fn tip(
        &self,
        surface: &Surface,
        facets: &Facets,
        trace: &Trace,
        parameters: &[f64],
        side: EdgeKind,
    ) -> Vec<TipPoint> {
        let local = trace.max_local();
        let ends = ends_in_sheets(trace);
        let chains = self.chains.chains.iter();
        let chains = chains.map(|chain| (chain.edge, &self.chains.nodes[chain.nodes.clone()]));
        let ends = ends.iter().map(|(edge, end)| (*edge, end.as_slice()));
        let own = chains
            .chain(ends)
            .filter(|&(edge, _)| facets.kind(edge) == side);
        let range = |edge: u32| {
            let pair = facets.pair_of(edge).unwrap_or_default() as usize;
            [parameters[pair], parameters[pair + 1]]
        };
        let parameter = |edge: u32, node: u32| {
            let [from, to] = range(edge);
            from + (to - from) * part_of(facets.ends(edge), surface.position(self.vertex(node)))
        };
        let mut parts: Vec<Part<'_>> = own
            .map(|(edge, nodes)| Part {
                parameter: parameter(edge, nodes[0]),
                edge,
                nodes,
            })
            .collect();
        parts.sort_by(|a, b| a.parameter.total_cmp(&b.parameter));
        let mut tip: Vec<TipPoint> = Vec::new();
        for Part { edge, nodes, .. } in parts {
            let [from, to] = range(edge);
            let min_step = MIN_SPACING * (to - from);
            for (i, &node) in nodes.iter().enumerate() {
                let vertex = self.vertex(node);
                let mut parameter = parameter(edge, node);
                match tip.last_mut() {
                    Some(last) if last.vertex == vertex => continue,
                    Some(last) if i > 0 => {
                        last.is_joined = true;
                        // The end of a curve may lie beside the corner that is next to it.
                        parameter = parameter.max(last.parameter + min_step);
                    }
                    // Across two walls that coincide the tip goes on.
                    Some(last) if self.meets(surface, last.vertex, nodes[0], local) => {
                        last.meets_next = true;
                        parameter = last.parameter;
                    }
                    // Tips in overlapping bodies end.
                    Some(last) if last.parameter >= parameter => break,
                    _ => {}
                }
                tip.push(TipPoint {
                    vertex,
                    rest: surface.rest_position(vertex),
                    parameter,
                    is_joined: false,
                    meets_next: false,
                    is_inner: node as usize >= trace.nodes.len(),
                });
            }
        }
        tip
    }

    /// Returns, for each end of a tip, the vertices at which both walls of the last cut meet, up to
    /// that end.
    ///
    /// They lie along the way of the blade's end, and along the blade before if that was inside.
    pub(crate) fn borders(&self, facets: &Facets, tip: &[TipPoint]) -> [Vec<VertexId>; 2] {
        let last = index_u32(facets.corner_count() / 2 - 1);
        let chains = self.chains.chains.iter().filter(|chain| chain.is_tip);
        let lines: Vec<(u32, Vec<VertexId>)> = chains
            .map(|chain| {
                let nodes = self.chains.nodes[chain.nodes.clone()].iter();
                (chain.edge, nodes.map(|&node| self.vertex(node)).collect())
            })
            .collect();
        [(0, tip.first()), (last, tip.last())].map(|(rib, end)| {
            let mut border = Vec::from_iter(end.map(|end| end.vertex));
            let is_behind = |edge: u32| edge == rib || facets.kind(edge) == EdgeKind::Previous;
            for _ in 0..lines.len() {
                let own = lines
                    .iter()
                    .filter(|line| is_behind(line.0))
                    .find_map(|(_, line)| {
                        let is_new = |v: &VertexId| !border.contains(v);
                        match line[..] {
                            [ref rest @ .., v] if border.first() == Some(&v) => {
                                rest.iter().all(is_new).then(|| rest.to_vec())
                            }
                            [v, ref rest @ ..] if border.first() == Some(&v) => {
                                let rest = rest.iter().rev();
                                rest.clone().all(is_new).then(|| rest.copied().collect())
                            }
                            _ => None,
                        }
                    });
                let Some(mut own) = own else { break };
                own.append(&mut border);
                border = own;
            }
            border
        })
    }

    /// Returns the vertices below and above the sweep that the cut has made of one of the tip.
    pub(crate) fn copies(&self, trace: &Trace, vertex: VertexId) -> Option<[VertexId; 2]> {
        let node = (trace.nodes.iter()).position(|node| node.on == On::Tip(vertex))?;
        Some(self.sides.vertices[node])
    }

    /// Returns the vertex of a node along the tip, which both walls share.
    fn vertex(&self, node: u32) -> VertexId {
        self.sides.vertices[node as usize][0]
    }

    /// Returns whether a part of the tip begins at `node` where another one ends, at `last`.
    fn meets(&self, surface: &Surface, last: VertexId, node: u32, local: f64) -> bool {
        let distance = surface.position(self.vertex(node)) - surface.position(last);
        distance.norm() <= MAX_DISTANCE * local
    }
}

/// Returns the ends of curves in sheets, each with the sweep edge on which it lies.
fn ends_in_sheets(trace: &Trace) -> Vec<(u32, [u32; 1])> {
    let sheets = trace.curves.iter().filter(|curve| !curve.is_capped);
    let ends = sheets.flat_map(|curve| [curve.nodes.start, curve.nodes.end - 1]);
    ends.filter(|&end| trace.nodes[end as usize].is_end)
        .filter_map(|end| Some((trace.nodes[end as usize].sweep_edge()?, [end])))
        .collect()
}

/// Returns the part of the way from the first end to the second at which a point lies, 0 to 1.
fn part_of([from, to]: [Vec3; 2], point: Vec3) -> f64 {
    let along = to - from;
    let part = along.dot(&(point - from)) / along.norm_squared();
    if part.is_nan() {
        0.0
    } else {
        part.clamp(0.0, 1.0)
    }
}
