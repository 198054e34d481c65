//! Detection of gaps: open edges whose ends nearly coincide with other ends.

use super::links::Links;
use crate::geometry::to_f64;

/// Maximum size of a gap, relative to the mean open edge.
const NEAR: f64 = 0.01;
/// Width of a cell of the search grid, in maximum gaps.
const CELL: f64 = 16.0;
/// Number of vertices of a cell that are compared with each.
const LOOK: usize = 64;

/// Returns the distance within which most ends of open edges have another end \[m\], if there is
/// one.
///
/// Welding by that distance may close the mesh. Ends at equal positions do not count: they were
/// separated on purpose. A few pairs in different cells may be missed. O(n
/// log n).
pub(super) fn gap(links: &Links, position: impl Fn(u32) -> [f32; 3]) -> Option<f64> {
    let mut ends = Vec::new();
    let (mut sum, mut count) = (0.0, 0);
    for edge in links.edges().filter(|edge| edge.len() == 1) {
        let pair = edge[0].0.vertices();
        let [a, b] = pair.map(|v| to_f64(position(v.0)));
        sum += (b - a).norm();
        count += 1;
        ends.extend(pair.map(|v| v.0));
    }
    ends.sort_unstable();
    ends.dedup();
    let near = NEAR * sum / f64::from(u32::try_from(count).ok()?);
    if !(near > 0.0 && near.is_finite()) {
        return None;
    }
    let mut has_other = vec![false; ends.len()];
    let mut widest = 0.0_f64;
    // Pairs across a cell's border share a cell of the grid shifted by half a cell.
    for shift in [0.0, 0.5] {
        let cell = |v: u32| position(v).map(|x| (f64::from(x) / (CELL * near) + shift).floor());
        let mut cells: Vec<([f64; 3], u32)> =
            (0..).zip(&ends).map(|(i, &v)| (cell(v), i)).collect();
        cells.sort_unstable_by(|(p, i), (q, j)| {
            let order = |k: usize| p[k].total_cmp(&q[k]);
            order(0).then(order(1)).then(order(2)).then(i.cmp(j))
        });
        for cell in cells.chunk_by(|x, y| x.0 == y.0) {
            for (k, &(_, i)) in cell.iter().enumerate() {
                let p = to_f64(position(ends[i as usize]));
                for &(_, j) in cell[k + 1..].iter().take(LOOK) {
                    let distance = (to_f64(position(ends[j as usize])) - p).norm();
                    if distance > 0.0 && distance < near {
                        widest = widest.max(distance);
                        has_other[i as usize] = true;
                        has_other[j as usize] = true;
                    }
                }
            }
        }
    }
    let paired = has_other.iter().filter(|&&has| has).count();
    (2 * paired >= ends.len()).then_some(widest)
}
