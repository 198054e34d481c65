//! Pinched sections: where the rim passes a point twice, the parts of the section share it.
//!
//! A plane through a saddle of the surface leaves two nodes there. On the side of the mesh vertex
//! an edge without length joins them. Where the section is empty between them, that edge is
//! contracted: after the caps, one fan of triangles is around the vertex. On the other side the
//! nodes keep a vertex each, where two ends of the part touch. Where the section is a neck without
//! width between them, the cut is made again with the other rule for ties, which opens the neck.

use super::contract::Opened;
use super::frames::Frames;
use super::rim::NO_NODE;
use incise_mesh::{HalfEdge, VertexId};
use robust::{Coord, orient2d};

/// Counters of pinched nodes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Pinched {
    /// Nodes that share the vertex of another one on a side.
    pub(super) nodes: usize,
    /// Necks of the section without width.
    pub(super) necks: usize,
}

/// Joins nodes at the same point. See the module.
pub(super) fn join_nodes(cut: &mut Opened<'_, '_>, frames: &Frames) -> Pinched {
    let mut done = Pinched::default();
    // By side, the vertices of the nodes; found once there is an edge without length.
    let mut places: Option<Vec<(VertexId, u32)>> = None;
    let mut fan: Vec<HalfEdge> = Vec::new();
    for node in 0..incise_mesh::index_u32(cut.nodes.len()) {
        let stays = |cut: &Opened<'_, '_>, node: u32| cut.is_near_end(node) || cut.rim.is_end(node);
        if cut.rim.is_removed[node as usize] || stays(cut, node) {
            continue;
        }
        for side in 0..2 {
            fan.clear();
            let topology = cut.edit.surface().topology();
            fan.extend(cut.rim.fan(topology, cut.sides, node, side));
            // Of vertices that differ by rounding, the caps would differ too.
            let at = |v: VertexId| cut.edit.surface().position(v);
            let own = at(cut.sides.vertices[node as usize][side]);
            let is_short = |h: &&HalfEdge| at(topology.target(**h)) == own;
            let Some(&chord) = fan.iter().skip(1).find(is_short) else {
                continue;
            };
            let places = places.get_or_insert_with(|| places_of_nodes(cut));
            let vertex = topology.target(chord);
            let Ok(place) = places.binary_search_by_key(&vertex, |p| p.0) else {
                continue;
            };
            let other = places[place].1;
            if stays(cut, other) {
                continue;
            }
            match is_neck(cut, frames, [node, other]) {
                Some(true) => done.necks += 1,
                Some(false) if contract(cut, [node, other], side, chord, &mut fan) => {
                    done.nodes += 1;
                }
                _ => {}
            }
        }
    }
    done
}

/// Returns the vertices of all nodes, sorted.
fn places_of_nodes(cut: &Opened<'_, '_>) -> Vec<(VertexId, u32)> {
    let nodes = (0..).zip(&cut.sides.vertices);
    let left = nodes.filter(|&(node, _)| !cut.rim.is_removed[node as usize]);
    let mut places: Vec<(VertexId, u32)> = left
        .flat_map(|(node, &vertices)| vertices.map(|v| (v, node)))
        .collect();
    places.sort_unstable();
    places
}

/// Returns whether the section is a neck between two nodes at one point.
///
/// It is if both edges of the second node leave into the section at the first one. None if only one
/// does, or if the nodes are on two facets, which may overlap.
fn is_neck(cut: &Opened<'_, '_>, frames: &Frames, [a, b]: [u32; 2]) -> Option<bool> {
    let around = [a, b].map(|n| [cut.rim.next[n as usize], cut.rim.prev[n as usize]]);
    let [own, other] = [a, b].map(|n| cut.nodes[n as usize].facet);
    if own != other || around.iter().flatten().any(|&n| n == NO_NODE) {
        return None;
    }
    let at = |n: u32| {
        let node = &cut.nodes[n as usize];
        let [x, y] = frames.flat(node.facet, frames.local(node.facet, node.position));
        Coord { x, y }
    };
    let center = at(a);
    let turn = |p: u32, q: u32| orient2d(center, at(p), at(q));
    let [[out, back], others] = around;
    let is_inside = |n: u32| {
        if turn(out, back) > 0.0 {
            turn(out, n) > 0.0 && turn(n, back) > 0.0
        } else {
            !(turn(back, n) >= 0.0 && turn(n, out) >= 0.0)
        }
    };
    let [first, second] = others.map(is_inside);
    (first == second).then_some(first)
}

/// Contracts the half-edge `chord` from the vertex of a node to that of another one, on a side.
///
/// Returns false where that is invalid. `fan` is scratch memory.
fn contract(
    cut: &mut Opened<'_, '_>,
    [a, b]: [u32; 2],
    side: usize,
    chord: HalfEdge,
    fan: &mut Vec<HalfEdge>,
) -> bool {
    let topology = cut.edit.surface().topology();
    let back = topology.twin(chord);
    let [kept, gone] = [a, b].map(|n| cut.sides.vertices[n as usize][side]);
    if back.is_null() || kept == gone {
        return false;
    }
    let (mut near, mut far) = (Vec::new(), Vec::new());
    (cut.rim).neighbors(topology, cut.sides, a, side, &mut near);
    (cut.rim).neighbors(topology, cut.sides, b, side, &mut far);
    // By triangle, the edges of the removed and of the kept vertex, and the half-edges across.
    let edges = [[chord.next(), chord.prev()], [back.prev(), back.next()]];
    let across = edges.map(|pair| pair.map(|h| topology.twin(h)));
    if near.iter().filter(|v| far.contains(v)).count() != 2 || across.contains(&[HalfEdge::NULL; 2])
    {
        return false;
    }
    fan.clear();
    fan.extend(cut.rim.fan(topology, cut.sides, b, side));
    let removed = [chord.triangle(), back.triangle()];
    for &h in &*fan {
        if !removed.contains(&h.triangle()) {
            cut.edit.set_corner(h, kept);
        }
    }
    for t in removed {
        cut.edit.remove_triangle(t);
    }
    for (own, [first, second]) in edges.into_iter().zip(across) {
        if !first.is_null() && !second.is_null() {
            cut.edit.set_twins(first, second);
            continue;
        }
        // The other one is on the rim now.
        let (old, new) = if first.is_null() {
            (own[0], second)
        } else {
            (own[1], first)
        };
        let beside = [a, b].map(|n| [n, cut.rim.prev[n as usize]]);
        for node in beside.into_iter().flatten() {
            let rim = &mut cut.sides.rim[node as usize][side];
            if *rim == old {
                *rim = new;
            }
        }
    }
    cut.sides.vertices[b as usize][side] = kept;
    cut.rim.pinches.push(([a, b], side));
    true
}
