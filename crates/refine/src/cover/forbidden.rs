//! Edges that the surface outside has already: two of them between the same vertices would put four
//! triangles on one edge. They are flipped, or split by a vertex in the middle.

use super::band::Band;
use super::cdt::{id, wall};
use super::lattice::Lattice;
use super::sheet::{INSIDE, Sheet};

/// Inner edges between corners of rings that `joined` has.
pub(crate) fn find(sheet: &Sheet, joined: impl Fn(u32, u32) -> bool) -> Vec<[u32; 2]> {
    let cdt = &sheet.cdt;
    let m = id(sheet.corner.len());
    (0..id(cdt.origin.len()))
        .filter(|&h| {
            cdt.region[(h / 3) as usize] == INSIDE
                && cdt.walls[h as usize] != wall::RIM
                && h < cdt.twin[h as usize]
        })
        .map(|h| [cdt.start(h), cdt.end(h)])
        .filter(|&[v, w]| v < m && w < m && joined(v, w))
        .collect()
}

/// Whether the other diagonal is as good.
pub(crate) fn can_flip(sheet: &Sheet, [v, w]: [u32; 2], joined: impl Fn(u32, u32) -> bool) -> bool {
    let cdt = &sheet.cdt;
    let Some(h) = cdt.find(v, w) else {
        return false;
    };
    let (c, d) = (cdt.apex(h), cdt.apex(cdt.twin[h as usize]));
    let m = id(sheet.corner.len());
    cdt.walls[h as usize] == wall::FREE
        && cdt.side(d, c, v) > 0.0
        && cdt.side(d, c, w) < 0.0
        && !(c < m && d < m && joined(c, d))
}

/// Puts the other diagonal or a vertex in the middle in the place of an edge.
pub(crate) fn replace(
    sheet: &mut Sheet,
    lattice: &mut Lattice,
    band: &mut Band,
    [v, w]: [u32; 2],
    flip: bool,
) {
    let cdt = &mut sheet.cdt;
    let Some(h) = cdt.find(v, w) else {
        return;
    };
    if flip {
        cdt.flip(h);
        return;
    }
    let (p, q) = (cdt.point(v), cdt.point(w));
    let at = [0, 1].map(|k| 0.5 * p[k] + 0.5 * q[k]);
    let (c, d) = (cdt.apex(h), cdt.apex(cdt.twin[h as usize]));
    let middle = cdt.push_point(at);
    let sound = [[c, v], [w, c], [d, w], [v, d]]
        .into_iter()
        .all(|[a, b]| cdt.side(a, b, middle) > 0.0);
    cdt.split_edge(h, middle);
    if sound {
        // Flips here make edges at the new vertex only, never one that `joined` has.
        cdt.legalize();
    } else {
        cdt.stack.clear();
    }
    band.lattice.push(id(lattice.points.len()));
    lattice.points.push(at);
    lattice.parents.push([v, w, sheet.next[v as usize]]);
    lattice.weights.push([0.5, 0.5, 0.0]);
}
