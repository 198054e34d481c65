//! [`Parts`]: the connected parts of a body in each cell.

use crate::fragments::{Fragments, ROUNDING};
use crate::grid::Grid;
use crate::overlap::clip;
use crate::scan::{Join, Lines, Scan};
use crate::skin::Skin;
use incise_mesh::geometry::area_vector;
use incise_mesh::{Partition, Vec3, index_u32};

/// No number yet.
const NONE: u32 = u32::MAX;

/// The connected parts of a body in each cell.
#[derive(Debug)]
pub(crate) struct Parts {
    /// The part of each element: of fragments, then of spans.
    pub(crate) of_element: Vec<u32>,
    /// By part, its cell and its volume \[m³\].
    pub(crate) cells: Vec<u32>,
    pub(crate) volumes: Vec<f64>,
    /// Pairs of parts that meet in a face of cells, the lower one first.
    pub(crate) joins: Vec<Join>,
}

impl Parts {
    /// Joins elements to parts: fragments of triangles with a common edge in the cell, and spans
    /// with the fragments at their ends.
    pub(crate) fn new(grid: &Grid, skin: &Skin, fragments: &Fragments, scan: &Scan) -> Self {
        let spans = scan.spans.iter().map(Vec::len).sum::<usize>();
        let mut sets = Partition::new(fragments.len() as usize + spans);
        fragments.join_along_edges(grid, skin, |a, b| sets.join(a, b));
        for &[a, b] in &scan.pairs {
            sets.join(a, b);
        }
        join_thin(grid, skin, fragments, &mut sets);
        let mut numbers = vec![NONE; fragments.len() as usize + spans];
        let mut cells = Vec::new();
        let own = (0..fragments.len()).map(|fragment| fragments.cell(fragment));
        let own = own.chain(scan.spans.iter().flatten().map(|span| span.cell));
        let of_element: Vec<u32> = (0..)
            .zip(own)
            .map(|(element, cell)| {
                let number = &mut numbers[sets.find(element) as usize];
                if *number == NONE {
                    *number = index_u32(cells.len());
                    cells.push(cell);
                }
                *number
            })
            .collect();
        let mut volumes = vec![0.0; cells.len()];
        let part = Lines::distance(grid).powi(2) / 3.0;
        let spans = of_element[fragments.len() as usize..].iter();
        for (&own, span) in spans.zip(scan.spans.iter().flatten()) {
            volumes[own as usize] += part * span.length();
        }
        let mut joins = scan.joins.clone();
        fragments.join_across_faces(grid, skin, |low, high, axis| {
            joins.push(Join { low, high, axis });
        });
        for join in &mut joins {
            join.low = of_element[join.low as usize];
            join.high = of_element[join.high as usize];
        }
        joins.sort_unstable_by_key(|join| (join.low, join.high, join.axis));
        joins.dedup_by_key(|join| (join.low, join.high, join.axis));
        Self {
            of_element,
            cells,
            volumes,
            joins,
        }
    }
}

/// Joins fragments that no scanline has met to the opposite fragments in the same cell.
///
/// They belong to corners of the body between scanlines.
fn join_thin(grid: &Grid, skin: &Skin, fragments: &Fragments, sets: &mut Partition) {
    let mut has_span = vec![false; sets.len()];
    for element in fragments.len()..index_u32(sets.len()) {
        has_span[sets.find(element) as usize] = true;
    }
    let lone: Vec<u32> = (0..fragments.len())
        .filter(|&fragment| !has_span[sets.find(fragment) as usize])
        .collect();
    let mut by_cell: Vec<(u32, u32)> = lone.iter().map(|&f| (fragments.cell(f), f)).collect();
    by_cell.sort_unstable();
    let is_near = |cell: u32| by_cell.binary_search_by_key(&cell, |own| own.0).is_ok();
    let mut others: Vec<(u32, u32)> = (0..fragments.len())
        .map(|fragment| (fragments.cell(fragment), fragment))
        .filter(|&(cell, _)| is_near(cell))
        .collect();
    others.sort_unstable();
    let size = grid.cell_size();
    let margin = Vec3::repeat(3.0 * ROUNDING * size);
    for (cell, fragment) in by_cell {
        let triangle = fragments.triangle(fragment) as usize;
        let low = grid.corner(grid.cell(cell), 0) - margin;
        let high = low + Vec3::repeat(size) + 2.0 * margin;
        let polygon = clip(&skin.corners[triangle], low, high);
        let inward = (-area_vector(skin.corners[triangle])).try_normalize(0.0);
        let (Some(inward), false) = (inward, polygon.is_empty()) else {
            continue;
        };
        #[expect(clippy::cast_precision_loss, reason = "few corners")]
        let center = polygon.iter().sum::<Vec3>() / polygon.len() as f64;
        let from = others.partition_point(|own| own.0 < cell);
        let to = others.partition_point(|own| own.0 <= cell);
        let facing = others[from..to].iter().filter_map(|&(_, other)| {
            let hit = fragments.triangle(other) as usize;
            let is_own = other == fragment || skin.pieces[hit] != skin.pieces[triangle];
            let at = (!is_own)
                .then(|| ray_hit(&skin.corners[hit], center, inward))
                .flatten()
                .filter(|at| *at > ROUNDING * size)?;
            let place = center + inward * at;
            let is_in_cell = (0..3).all(|k| (low[k]..=high[k]).contains(&place[k]));
            is_in_cell.then_some((at, other))
        });
        let nearest = facing.min_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((_, other)) = nearest {
            sets.join(fragment, other);
        }
    }
}

/// Returns the distance at which a ray leaves a body through a triangle \[m\].
fn ray_hit(corners: &[Vec3; 3], from: Vec3, along: Vec3) -> Option<f64> {
    let normal = area_vector(*corners);
    let speed = normal.dot(&along);
    if speed <= 0.0 {
        return None;
    }
    let at = normal.dot(&(corners[0] - from)) / speed;
    let place = from + along * at;
    let is_left = |k: usize| {
        let [a, b] = [corners[k], corners[(k + 1) % 3]];
        (b - a).cross(&(place - a)).dot(&normal) >= 0.0
    };
    (0..3).all(is_left).then_some(at)
}
