//! Rings that touch or cross: moved apart a little, cut in two, or taken out of their group.
//!
//! Where loops only touch, at a point or along edges, a move of the corners in question by far less
//! than an edge makes them disjoint; the rim itself stays where it is, only the triangles are found
//! on the moved one. Edges too short for that are cut off with a triangle, next to nothing. A ring that truly crosses itself is cut at the crossing: the two
//! edges that cross and two new ones make a bow tie of two triangles, and what is left on either
//! side is a ring again. What cannot be cut, or not in the time there is, becomes a disc as it is.

use super::cdt::id;
use super::offer::square;
use super::section::Rims;
use super::sheet::{Sheet, Trouble, Verdict};

/// How far corners are moved, in extents of the section: above the rounding of 32 bit positions in
/// the last step.
const MOVES: [f64; 3] = [1e-9, 1e-7, 1e-5];
/// No corner is moved by more than this much of an edge at it.
const MOST: f64 = 0.1;

/// What is left to do for a group of rings.
#[derive(Debug, Default)]
pub(crate) struct Parts {
    /// Groups to cover.
    pub(crate) groups: Vec<Vec<u32>>,
    /// Rings that are discs.
    pub(crate) discs: Vec<u32>,
    /// Rings of three or four corners around a crossing, discs as well.
    pub(crate) ties: Vec<Vec<u32>>,
    /// Triangles that cut off corners at very short edges.
    pub(crate) shaved: Vec<[u32; 3]>,
    /// Rings taken out of their group.
    pub(crate) apart: usize,
}

/// Builds the sheet of a group, with its corners moved where that makes the rings disjoint.
/// `work` is how many vertices may still be triangulated for the sake of bad rings.
pub(crate) fn build(
    rims: &mut Rims,
    sheet: &mut Sheet,
    rings: &[u32],
    mirrored: bool,
    crease: bool,
    work: &mut usize,
) -> Verdict {
    let verdict = sheet.build(rims, rings, mirrored, crease);
    let short = || culprits(sheet).any(|v| is_short(sheet, v));
    if sheet.trouble.is_empty() || crosses_for_good(sheet) || short() {
        return verdict;
    }
    let areas = areas(sheet);
    // Vertices to move and whether to the inside; nobody knows for a ring that meets itself.
    let mut movers: Vec<(u32, Option<bool>)> = Vec::new();
    'moves: for reach in MOVES {
        for inward in [true, false] {
            if *work < sheet.corner.len() {
                break 'moves;
            }
            *work -= sheet.corner.len();
            for &trouble in &sheet.trouble {
                add_movers(sheet, trouble, &areas, &mut movers);
            }
            movers.sort_unstable();
            movers.dedup_by_key(|mover| mover.0);
            if !inward && movers.iter().all(|mover| mover.1.is_some()) {
                continue;
            }
            rims.restore();
            nudge(rims, sheet, [mirrored, crease], reach, inward, &movers);
            let verdict = sheet.build(rims, rings, mirrored, crease);
            if sheet.trouble.is_empty() {
                return verdict;
            }
        }
    }
    rims.restore();
    sheet.build(rims, rings, mirrored, crease)
}

/// More than any corner is moved.
fn limit(sheet: &Sheet) -> f64 {
    let extent = [0, 1].map(|k| sheet.high[k] - sheet.low[k]);
    4.0 * MOVES[2] * extent[0].max(extent[1])
}

/// The vertices of all edges in trouble.
fn culprits(sheet: &Sheet) -> impl Iterator<Item = u32> {
    sheet
        .trouble
        .iter()
        .flat_map(|&trouble| trouble.vertices(sheet))
}

/// Whether an edge at a vertex is too short to move the vertex.
fn is_short(sheet: &Sheet, v: u32) -> bool {
    let p = sheet.cdt.point(v);
    [sheet.before(v), sheet.next[v as usize]]
        .into_iter()
        .any(|w| {
            let q = sheet.cdt.point(w);
            (q[0] - p[0]).hypot(q[1] - p[1]) < limit(sheet)
        })
}

/// Whether two edges cross by more than any corner is moved.
fn crosses_for_good(sheet: &Sheet) -> bool {
    let limit = limit(sheet);
    sheet.trouble.iter().any(|&trouble| {
        let Trouble::Cross(v, w) = trouble else {
            return false;
        };
        let [a, b] = [v, w].map(|v| [v, sheet.next[v as usize]].map(|v| sheet.cdt.point(v)));
        let off = |[p, q]: [[f64; 2]; 2], r: [f64; 2]| {
            let d = [q[0] - p[0], q[1] - p[1]];
            (d[0] * (r[1] - p[1]) - d[1] * (r[0] - p[0])).abs() / d[0].hypot(d[1])
        };
        let depths = [off(a, b[0]), off(a, b[1]), off(b, a[0]), off(b, a[1])];
        depths.into_iter().fold(f64::INFINITY, f64::min) > limit
    })
}

/// Signed area of each ring of a sheet, doubled.
fn areas(sheet: &Sheet) -> Vec<f64> {
    let mut areas = vec![0.0; sheet.bad.len()];
    for (v, &w) in sheet.next.iter().enumerate() {
        let [p, q] = [sheet.cdt.points[v], sheet.cdt.point(w)]
            .map(|p| [p[0] - sheet.low[0], p[1] - sheet.low[1]]);
        areas[sheet.ring[v] as usize] += p[0] * q[1] - p[1] * q[0];
    }
    areas
}

/// The vertices that are in trouble, and which way leads out: what lies between a hole and the loop
/// around it, or between two holes, must grow, so both go outward; what is left free between
/// islands, or between an island and the hole around it, must grow, so both go inward.
fn add_movers(
    sheet: &Sheet,
    trouble: Trouble,
    areas: &[f64],
    movers: &mut Vec<(u32, Option<bool>)>,
) {
    let (Trouble::Meet(a, b) | Trouble::Through(a, b) | Trouble::Cross(a, b)) = trouble;
    let [i, j] = [a, b].map(|v| sheet.ring[v as usize]);
    let inward = (i != j).then(|| {
        let (x, y) = (areas[i as usize], areas[j as usize]);
        let (large, small) = if x.abs() > y.abs() { (x, y) } else { (y, x) };
        // The larger one around the smaller one, or both beside each other.
        match (large > 0.0, small > 0.0) {
            (true, true) => true,
            (false, false) => false,
            (large_is_loop, _) => !large_is_loop || large == -small,
        }
    });
    movers.extend(trouble.vertices(sheet).map(|v| (v, inward)));
}

/// Moves corners away from what they touch. None leaves the crease or comes to it.
fn nudge(
    rims: &mut Rims,
    sheet: &Sheet,
    [mirrored, crease]: [bool; 2],
    reach: f64,
    otherwise: bool,
    movers: &[(u32, Option<bool>)],
) {
    rims.remember();
    let extent = [0, 1].map(|k| sheet.high[k] - sheet.low[k]);
    let reach = reach * extent[0].max(extent[1]);
    let side = if mirrored { -1.0 } else { 1.0 };
    for &(v, inward) in movers {
        let [o, p, q] = [sheet.before(v), v, sheet.next[v as usize]].map(|v| {
            let [x, y] = rims.original(sheet.corner[v as usize]);
            [side * x, y]
        });
        let (d, e) = ([p[0] - o[0], p[1] - o[1]], [q[0] - p[0], q[1] - p[1]]);
        let (a, b) = (d[0].hypot(d[1]), e[0].hypot(e[1]));
        let normal = [-d[1] / a - e[1] / b, d[0] / a + e[0] / b];
        let size = normal[0].hypot(normal[1]);
        let way = if inward.unwrap_or(otherwise) {
            1.0
        } else {
            -1.0
        };
        let step = way * reach.min(MOST * a.min(b)) / size;
        let mut at = [p[0] + step * normal[0], p[1] + step * normal[1]];
        if crease && at[1] * p[1] <= 0.0 {
            at[1] = p[1];
        }
        if at[0].is_finite() && at[1].is_finite() {
            rims.points[sheet.corner[v as usize] as usize] = [side * at[0], at[1]];
        }
    }
}

/// Takes a group in trouble to pieces.
pub(crate) fn part(
    rims: &mut Rims,
    sheet: &Sheet,
    rings: &[u32],
    joined: &impl Fn(u32, u32) -> bool,
    may_cut: bool,
) -> Parts {
    let mut parts = Parts::default();
    let ring_of = |v: u32| sheet.ring[v as usize] as usize;
    let mut gone = vec![false; rings.len()];
    let mut cut = Vec::new();
    if may_cut {
        parts.shaved = shave(rims, sheet, rings, joined, &mut gone, &mut cut);
    }
    if may_cut && parts.shaved.is_empty() {
        for &trouble in &sheet.trouble {
            let (Trouble::Meet(v, w) | Trouble::Through(v, w) | Trouble::Cross(v, w)) = trouble;
            let ring = ring_of(v);
            if ring == ring_of(w)
                && !gone[ring]
                && let Some((lobes, tie)) = split(rims, sheet, rings[ring], trouble, joined)
            {
                gone[ring] = true;
                // The longer one stays. Both in one group could be joined by more than the tie.
                let longer = lobes
                    .iter()
                    .copied()
                    .max_by_key(|&lobe| rims.ring(lobe as usize).len());
                cut.extend(longer);
                let others = lobes.into_iter().filter(|&lobe| Some(lobe) != longer);
                parts.groups.extend(others.map(|lobe| vec![lobe]));
                parts.ties.extend(tie);
            }
        }
        if cut.is_empty() && !gone.contains(&true) {
            // Of two rings that meet the shorter one goes.
            for &trouble in &sheet.trouble {
                let (Trouble::Meet(v, w) | Trouble::Through(v, w) | Trouble::Cross(v, w)) = trouble;
                let (a, b) = (ring_of(v), ring_of(w));
                if a != b && !gone[a] && !gone[b] {
                    let length = |i: usize| rims.ring(rings[i] as usize).len();
                    let out = if length(a) < length(b) { a } else { b };
                    gone[out] = true;
                    parts.apart += 1;
                    parts.groups.push(vec![rings[out]]);
                }
            }
        }
    }
    if !gone.contains(&true) {
        for (i, &ring) in rings.iter().enumerate() {
            if sheet.bad[i] {
                gone[i] = true;
                parts.discs.push(ring);
            }
        }
    }
    let rest = rings.iter().zip(&gone).filter(|(_, gone)| !**gone);
    cut.extend(rest.map(|(&ring, _)| ring));
    parts.groups.push(cut);
    parts
}

/// Cuts corners off at short edges that are in trouble: the triangles, and in `cut` the rings that
/// are left instead of those that are `gone`.
fn shave(
    rims: &mut Rims,
    sheet: &Sheet,
    rings: &[u32],
    joined: &impl Fn(u32, u32) -> bool,
    gone: &mut [bool],
    cut: &mut Vec<u32>,
) -> Vec<[u32; 3]> {
    let mut taken = vec![false; sheet.corner.len()];
    let mut left: Vec<usize> = rings.iter().map(|&r| rims.ring(r as usize).len()).collect();
    let mut triangles = Vec::new();
    let corner = |v: u32| sheet.corner[v as usize];
    for v in culprits(sheet) {
        let v = beside_crease(sheet, v);
        let (o, q) = (sheet.before(v), sheet.next[v as usize]);
        let ring = sheet.ring[v as usize] as usize;
        let free = ![o, v, q].iter().any(|&w| taken[w as usize]);
        let ids = [o, q].map(|w| rims.ids[corner(w) as usize]);
        if free && left[ring] > 3 && is_short(sheet, v) && !joined(ids[0], ids[1]) {
            taken[v as usize] = true;
            left[ring] -= 1;
            gone[ring] = true;
            triangles.push([o, v, q].map(corner));
        }
    }
    for ring in (0..rings.len()).filter(|&i| gone[i]) {
        cut.push(id(rims.rings()));
        let kept = (0u32..)
            .zip(&sheet.corner)
            .filter(|&(v, _)| sheet.ring[v as usize] as usize == ring && !taken[v as usize]);
        rims.push_ring(kept.map(|(_, &corner)| corner));
    }
    triangles
}

/// The vertex itself, or where its ring crosses the line y = 0 there the nearer one of its neighbors: without a
/// vertex on the crease a ring has an edge across it.
fn beside_crease(sheet: &Sheet, v: u32) -> u32 {
    let [o, q] = [sheet.before(v), sheet.next[v as usize]];
    let [from, at, to] = [o, v, q].map(|v| sheet.cdt.point(v));
    if at[1] != 0.0 || from[1] * to[1] >= 0.0 {
        return v;
    }
    if square(from, at) < square(at, to) {
        o
    } else {
        q
    }
}

/// Cuts a ring where it meets itself. Returns the rings on either side and the one around the
/// place, or `None` where the surface outside has one of the new edges already.
fn split(
    rims: &mut Rims,
    sheet: &Sheet,
    ring: u32,
    trouble: Trouble,
    joined: &impl Fn(u32, u32) -> bool,
) -> Option<(Vec<u32>, Option<Vec<u32>>)> {
    let corners = rims.ring(ring as usize).to_vec();
    let n = corners.len();
    let place = |v: u32| (v - sheet.first_of_ring(v)) as usize;
    // Two arcs that are rings when closed, each from its first place to its last, and the tie.
    let (arcs, tie) = match trouble {
        Trouble::Meet(v, w) => {
            let (v, w) = (place(v), place(w));
            ([[v, w], [w, v]], None)
        }
        Trouble::Through(v, w) => {
            let (v, w) = (place(v), place(w));
            let after = (v + 1) % n;
            ([[after, w], [w, v]], Some(vec![v, after, w]))
        }
        Trouble::Cross(v, w) => {
            let (v, w) = (place(v), place(w));
            let ends = [(v + 1) % n, (w + 1) % n];
            (
                [[ends[0], w], [ends[1], v]],
                Some(vec![v, ends[0], w, ends[1]]),
            )
        }
    };
    let length = |[from, to]: [usize; 2]| (to + n - from) % n + 1;
    for arc in arcs {
        let [a, b] = arc.map(|i| rims.ids[corners[i] as usize]);
        // An arc of two is an edge of the ring; one of all corners would cut nothing off.
        if length(arc) == n || a == b || (length(arc) > 2 && joined(a, b)) {
            return None;
        }
    }
    let mut lobes = Vec::new();
    for arc in arcs.into_iter().filter(|&arc| length(arc) > 2) {
        lobes.push(id(rims.rings()));
        rims.push_ring((0..length(arc)).map(|k| corners[(arc[0] + k) % n]));
    }
    let tie = tie.map(|places| places.into_iter().map(|i| corners[i]).collect());
    Some((lobes, tie))
}
