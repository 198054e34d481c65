//! Slits that lie inside a hit triangle as a whole.

use super::{Corner, EdgeRole, PolygonEdge, Projection, position, turn};
use crate::intersection::node::Node;
use crate::intersection::trace::Chord;
use incise_mesh::Vec3;

/// Joins a slit that lies inside the triangle to the polygon around it, by a bridge.
pub(super) fn join_slit(
    polygons: &mut [Vec<PolygonEdge>],
    slit: &Chord,
    nodes: &[Node],
    corners: &[Vec3; 3],
    plane: Projection,
) {
    let point = |edge: &PolygonEdge| plane.project(position(edge.corner, nodes, corners));
    let own: Vec<u32> = slit.nodes().collect();
    let along = own
        .iter()
        .map(|&n| plane.project(nodes[n as usize].position));
    let along: Vec<[f64; 2]> = along.collect();
    let start = along[0];
    // The shortest bridge that meets nothing else; rounding may leave none.
    let mut best = (false, f64::INFINITY, 0, 0);
    for (p, polygon) in polygons.iter().enumerate() {
        let outline = || polygon.iter().map(&point);
        let corner = |i: usize| point(&polygon[i % polygon.len()]);
        let sides = || outline().zip(outline().cycle().skip(1));
        let is_around = sides()
            .filter(|&(a, b)| is_crossed_upward(a, b, start))
            .count()
            % 2
            == 1;
        for (i, from) in outline().enumerate() {
            let is_crossed = |a, b| do_cross([from, start], [a, b]);
            let around = [corner(i + polygon.len() - 1), corner(i + 1)];
            let is_free = is_around
                && is_inward(from, around, start)
                && !sides().any(|(a, b)| is_crossed(a, b))
                && !along.windows(2).any(|pair| is_crossed(pair[0], pair[1]));
            let length = (start[0] - from[0]).hypot(start[1] - from[1]);
            if (!is_free, length) < (!best.0, best.1) {
                best = (is_free, length, p, i);
            }
        }
    }
    let (_, _, p, i) = best;
    let polygon = &mut polygons[p];
    let mut detour = vec![PolygonEdge {
        corner: polygon[i].corner,
        role: None,
    }];
    let mut add = |node: u32, side: usize, role| {
        let corner = Corner::Node { node, side };
        detour.push(PolygonEdge { corner, role });
    };
    for pair in own.windows(2) {
        let side = 1;
        add(
            pair[0],
            side,
            Some(EdgeRole::Rim {
                node: pair[0],
                side,
            }),
        );
    }
    for pair in own.windows(2).rev() {
        let side = 0;
        add(
            pair[1],
            side,
            Some(EdgeRole::Rim {
                node: pair[0],
                side,
            }),
        );
    }
    // Both sides share the vertices of the ends.
    let side = 1;
    add(own[0], side, None);
    polygon.splice(i..i, detour);
}

/// Returns whether a bridge leaves a corner of the polygon into the inside, on the left.
///
/// A slit has two corners at each point, one on either side.
fn is_inward(corner: [f64; 2], [before, after]: [[f64; 2]; 2], to: [f64; 2]) -> bool {
    let is_left = |a, b| turn(corner, a, b) > 0.0;
    if is_left(after, before) {
        is_left(after, to) && is_left(to, before)
    } else {
        is_left(after, to) || is_left(to, before)
    }
}

/// Returns whether the ray from `p` to the right crosses an edge.
fn is_crossed_upward(a: [f64; 2], b: [f64; 2], p: [f64; 2]) -> bool {
    (a[1] > p[1]) != (b[1] > p[1]) && (turn(a, b, p) > 0.0) == (b[1] > a[1])
}

/// Returns whether two segments cross in a point inside both.
fn do_cross([a, b]: [[f64; 2]; 2], [c, d]: [[f64; 2]; 2]) -> bool {
    turn(a, b, c) * turn(a, b, d) < 0.0 && turn(c, d, a) * turn(c, d, b) < 0.0
}
