//! Groups of loops that can be triangulated apart: an outer loop each, with the holes in it.

use super::loops::SectionLoops;

/// Splits a group into outer loops, each with its holes.
///
/// Outer loops that touch each other need no common triangulation, so that only holes and slits
/// that touch their own outer loop need repair. A hole without one is a group of its own.
/// O(h k + n m) for h holes, k outer loops, n corners of holes and m corners of outer loops whose
/// boxes touch theirs.
pub(crate) fn split(loops: &SectionLoops, group: &[u32]) -> Vec<Vec<u32>> {
    let area = |index: u32| loops.area(loops.corners(index as usize));
    let (outer, holes): (Vec<u32>, Vec<u32>) = group.iter().partition(|&&index| area(index) > 0.0);
    let mut groups: Vec<Vec<u32>> = outer.iter().map(|&index| vec![index]).collect();
    let boxes: Vec<[[f64; 2]; 2]> = outer.iter().map(|&index| bounds(loops, index)).collect();
    for hole in holes {
        let [low, high] = bounds(loops, hole);
        let corners = loops.corners(hole as usize);
        // Corners of a hole may be on its outer loop, middles of its edges are so less often.
        let middles = (0..corners.len()).map(|k| {
            let ends = [corners[k], corners[(k + 1) % corners.len()]];
            let [p, q] = ends.map(|corner| loops.points[corner as usize]);
            [0, 1].map(|k| (p[k] + q[k]) / 2.0)
        });
        let samples: Vec<[f64; 2]> = (corners.iter())
            .map(|&corner| loops.points[corner as usize])
            .chain(middles)
            .collect();
        let count = |&index: &u32| {
            let around = loops.corners(index as usize);
            let is_inside = |point: &&[f64; 2]| loops.winding(around, **point) > 0;
            samples.iter().filter(is_inside).count()
        };
        let may_hold = |&i: &usize| {
            let [outer_low, outer_high] = boxes[i];
            (0..2).all(|k| outer_low[k] <= high[k] && low[k] <= outer_high[k])
        };
        let best = (0..outer.len())
            .filter(may_hold)
            .map(|i| (count(&outer[i]), i))
            .filter(|found| found.0 > 0)
            .max_by(|a, b| {
                let smaller = || area(outer[b.1]).total_cmp(&area(outer[a.1]));
                a.0.cmp(&b.0).then_with(smaller)
            });
        match best {
            Some((_, i)) => groups[i].push(hole),
            None => groups.push(vec![hole]),
        }
    }
    groups
}

/// Returns the corners of the box around a loop.
fn bounds(loops: &SectionLoops, index: u32) -> [[f64; 2]; 2] {
    let corners = loops.corners(index as usize).iter();
    let points = corners.map(|&corner| loops.points[corner as usize]);
    points.fold([[f64::MAX; 2], [f64::MIN; 2]], |[low, high], p| {
        [
            [low[0].min(p[0]), low[1].min(p[1])],
            [high[0].max(p[0]), high[1].max(p[1])],
        ]
    })
}
