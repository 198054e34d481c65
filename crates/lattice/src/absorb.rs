//! Small parts that belong to a neighbor.

use crate::fragments::{Fragments, ROUNDING};
use crate::grid::Grid;
use crate::overlap::clip;
use crate::parts::Parts;
use crate::skin::Skin;
use incise_mesh::{Vec3, index_u32};

/// Volume below which a part may belong to a neighbor [cells].
///
/// A node has the mass of one cell where eight full ones meet, and an eighth of its part's where it
/// has one copy: 0.015 of that at this volume. Chosen on a prototype, whose lightest nodes were
/// above a tenth of the mean with it.
const MAX_VOLUME: f64 = 0.12;

/// Maximum reach of such a part into its cell [cells].
///
/// Weights of a neighbor's corners extrapolate that far, to between -0.3 and 1.3.
const MAX_REACH: f64 = 0.3;

/// Returns, for each part, the part whose nodes carry it: itself or a neighbor.
///
/// A part that is the only bridge between its neighbors carries itself.
pub(crate) fn carriers(grid: &Grid, skin: &Skin, fragments: &Fragments, parts: &Parts) -> Vec<u32> {
    let count = parts.cells.len();
    let mut carriers: Vec<u32> = (0..index_u32(count)).collect();
    let limit = MAX_VOLUME * grid.cell_size().powi(3);
    let mut small: Vec<u32> = carriers
        .iter()
        .copied()
        .filter(|&part| parts.volumes[part as usize] < limit)
        .collect();
    let volume = |part: u32| parts.volumes[part as usize];
    small.sort_by(|&a, &b| volume(b).total_cmp(&volume(a)).then(a.cmp(&b)));
    let mut is_settled = vec![true; count];
    for &part in &small {
        is_settled[part as usize] = false;
    }
    let reaches = reaches(grid, skin, fragments, parts, &is_settled);
    settle(&small, &reaches, &mut is_settled, &mut carriers);
    keep_bridges(parts, &mut carriers);
    for part in 0..count {
        carriers[part] = last_carrier(&carriers, carriers[part]);
    }
    carriers
}

/// A neighbor of a small part, and how far that reaches into its cell from their common face
/// [cells].
#[derive(Debug, Clone, Copy)]
struct Reach {
    part: u32,
    neighbor: u32,
    reach: f64,
}

/// Returns the reaches of small parts, by part.
fn reaches(
    grid: &Grid,
    skin: &Skin,
    fragments: &Fragments,
    parts: &Parts,
    is_large: &[bool],
) -> Vec<Reach> {
    let size = grid.cell_size();
    let margin = Vec3::repeat(3.0 * ROUNDING * size);
    let empty = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
    let mut extents = vec![empty; parts.cells.len()];
    for fragment in 0..fragments.len() {
        let part = parts.of_element[fragment as usize] as usize;
        if is_large[part] {
            continue;
        }
        let low = grid.corner(grid.cell(fragments.cell(fragment)), 0);
        let high = low + Vec3::repeat(size);
        let corners = &skin.corners[fragments.triangle(fragment) as usize];
        for p in clip(corners, low - margin, high + margin) {
            let at = (p - low) / size;
            let extent = &mut extents[part];
            *extent = (extent.0.inf(&at), extent.1.sup(&at));
        }
    }
    let mut reaches = Vec::new();
    for join in &parts.joins {
        let mut add = |part: u32, neighbor: u32, reach: f64| {
            if !is_large[part as usize] && reach < MAX_REACH {
                reaches.push(Reach {
                    part,
                    neighbor,
                    reach,
                });
            }
        };
        let [low, high] = [join.low, join.high].map(|part| extents[part as usize]);
        add(join.low, join.high, 1.0 - low.0[join.axis]);
        add(join.high, join.low, high.1[join.axis]);
    }
    reaches.sort_by_key(|reach| (reach.part, reach.neighbor));
    reaches
}

/// Gives small parts to settled neighbors, from the large ones on.
///
/// Where no neighbor is near, the largest small part stays.
fn settle(small: &[u32], reaches: &[Reach], is_settled: &mut [bool], carriers: &mut [u32]) {
    let mut next = 0;
    loop {
        let mut found = Vec::new();
        for &part in small.iter().filter(|&&part| !is_settled[part as usize]) {
            let from = reaches.partition_point(|reach| reach.part < part);
            let own = reaches[from..]
                .iter()
                .take_while(|reach| reach.part == part);
            let near = own.filter(|reach| is_settled[reach.neighbor as usize]);
            let best = near.min_by(|a, b| a.reach.total_cmp(&b.reach));
            found.extend(best.map(|reach| (part, reach.neighbor)));
        }
        for &(part, neighbor) in &found {
            carriers[part as usize] = neighbor;
            is_settled[part as usize] = true;
        }
        if found.is_empty() {
            while small
                .get(next)
                .is_some_and(|&part| is_settled[part as usize])
            {
                next += 1;
            }
            match small.get(next) {
                Some(&part) => is_settled[part as usize] = true,
                None => return,
            }
        }
    }
}

/// Lets parts carry themselves where their neighbors would not be connected without them.
fn keep_bridges(parts: &Parts, carriers: &mut [u32]) {
    loop {
        let mut edges: Vec<[u32; 2]> = Vec::new();
        for join in &parts.joins {
            let ends = [join.low, join.high];
            if ends.iter().all(|&part| carriers[part as usize] == part) {
                edges.extend([ends, [ends[1], ends[0]]]);
            }
        }
        edges.sort_unstable();
        edges.dedup();
        let is_edge = |a: u32, b: u32| edges.binary_search(&[a, b]).is_ok();
        let has_way = |a: u32, b: u32| {
            let from = edges.partition_point(|edge| edge[0] < a);
            let mut beside = edges[from..].iter().take_while(|edge| edge[0] == a);
            is_edge(a, b) || beside.any(|edge| is_edge(edge[1], b))
        };
        let mut changed = Vec::new();
        for join in &parts.joins {
            let ends = [join.low, join.high];
            let [a, b] = ends.map(|part| last_carrier(carriers, part));
            if a != b && !has_way(a, b) {
                changed.extend(
                    ends.into_iter()
                        .filter(|&part| carriers[part as usize] != part),
                );
            }
        }
        if changed.is_empty() {
            return;
        }
        for part in changed {
            carriers[part as usize] = part;
        }
    }
}

/// Returns the part at the end of a chain of carriers.
fn last_carrier(carriers: &[u32], mut part: u32) -> u32 {
    while carriers[part as usize] != part {
        part = carriers[part as usize];
    }
    part
}
