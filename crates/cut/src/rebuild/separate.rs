//! Pieces by connectivity.

use incise_mesh::{Surface, TopologyDelta};

/// Gives every connected component of the pieces in `cut` a piece number of its own and writes the
/// new ones to `delta`. The component with the most triangles keeps the old number (of equals, the
/// one with the first triangle). O(n).
pub(crate) fn separate(surface: &mut Surface, cut: &[u32], delta: &mut TopologyDelta) {
    let labels = surface.topology().component_labels();
    let mut next = surface.piece_bound();
    // (piece, triangles, component), one entry a component of a piece that was cut.
    let mut sizes: Vec<(u32, usize)> = Vec::new();
    for t in surface.topology().triangles() {
        let label = labels[t.index()] as usize;
        if label >= sizes.len() {
            sizes.resize(label + 1, (surface.piece(t), 0));
        }
        sizes[label].0 = surface.piece(t);
        sizes[label].1 += 1;
    }
    let mut number: Vec<u32> = sizes.iter().map(|s| s.0).collect();
    for &piece in cut {
        let components: Vec<usize> = (0..sizes.len()).filter(|&c| sizes[c].0 == piece).collect();
        let Some(&keeps) = components
            .iter()
            .rev()
            .max_by_key(|&&component| sizes[component].1)
        else {
            delta.pieces_removed.push(piece);
            continue;
        };
        for component in components.into_iter().filter(|&c| c != keeps) {
            number[component] = next;
            delta.pieces_added.push((next, piece));
            next += 1;
        }
    }
    let triangles: Vec<_> = surface.topology().triangles().collect();
    for t in triangles {
        surface.set_piece(t, number[labels[t.index()] as usize]);
    }
    for added in &mut delta.vertices_added {
        let triangle = surface.topology().outgoing(added.vertex).triangle();
        added.piece = surface.piece(triangle);
    }
}
