//! Removal of triangles that add nothing: collapsed ones, duplicates and back sides.

use super::links::Links;
use super::repair::{Repaired, is_collapsed};
use super::tally::Tally;
use crate::bucket_sort::sort_in_buckets;
use crate::io::Warning;
use crate::partition::Partition;

impl Repaired {
    /// Keeps the triangles with three different corners that do not repeat an earlier one.
    pub(super) fn keep_distinct(&mut self, triangles: &[[u32; 3]]) {
        let (mut collapsed, mut duplicates) = (Tally::default(), Tally::default());
        let keyed = (0..)
            .zip(triangles)
            .filter(|(_, t)| !is_collapsed(t))
            .map(|(i, &[a, b, c])| ([a, b, c].min([b, c, a]).min([c, a, b]), i));
        let keyed = sort_in_buckets(keyed, self.vertices.len(), |(corners, _)| corners[0]);
        let mut repeats = vec![false; triangles.len()];
        self.triangles.reserve_exact(triangles.len());
        self.sources.reserve_exact(triangles.len());
        for pair in keyed.windows(2) {
            repeats[pair[1].1 as usize] = pair[0].0 == pair[1].0;
        }
        for (i, &t) in (0..).zip(triangles) {
            let is_new = !collapsed.note(is_collapsed(&t), i);
            if is_new && !duplicates.note(repeats[i as usize], i) {
                self.triangles.push(t);
                self.sources.push(i);
            }
        }
        self.flipped = vec![false; self.triangles.len()];
        if let Some((triangle, count)) = collapsed.found() {
            self.warnings.push(Warning::Collapsed { triangle, count });
        }
        if let Some((triangle, count)) = duplicates.found() {
            self.warnings
                .push(Warning::DuplicatesRemoved { triangle, count });
        }
    }

    /// Removes one of two triangles with the same corners and opposite orientations.
    ///
    /// Both stay where they are a wall between two bodies: where patches of such pairs end, an even
    /// number of other triangles continues, at least two.
    pub(super) fn remove_back_sides(&mut self) {
        let mates = self.mates();
        if mates.iter().all(Option::is_none) {
            return;
        }
        let mut patches = Partition::new(self.triangles.len());
        for (t, mate) in (0..).zip(&mates) {
            if let Some(mate) = *mate {
                patches.join(t, mate);
            }
        }
        let links = Links::new(&self.triangles);
        let is_paired = |t: u32| mates[t as usize].is_some();
        for edge in links.edges() {
            let of = |i: usize| edge[i].1.triangle().0;
            if (0..edge.len()).all(|i| is_paired(of(i))) {
                (1..edge.len()).for_each(|i| patches.join(of(0), of(i)));
            }
        }
        let mut ends_evenly = vec![false; self.triangles.len()];
        let mut ends_oddly = ends_evenly.clone();
        for edge in links.edges() {
            let triangles = || edge.iter().map(|&(_, h)| h.triangle().0);
            let others = triangles().filter(|&t| !is_paired(t)).count();
            for t in triangles().filter(|&t| others > 0 && is_paired(t)) {
                let patch = patches.find(t) as usize;
                ends_evenly[patch] |= others % 2 == 0;
                ends_oddly[patch] |= others % 2 == 1;
            }
        }
        let mut removed = Tally::default();
        let mut is_kept = vec![true; self.triangles.len()];
        for (t, mate) in (0..).zip(&mates) {
            let patch = patches.find(t) as usize;
            let is_wall = ends_evenly[patch] && !ends_oddly[patch];
            let is_back = mate.is_some_and(|mate| mate < t) && !is_wall;
            is_kept[t as usize] = !removed.note(is_back, self.sources[t as usize]);
        }
        self.retain_triangles(&is_kept);
        if let Some((triangle, count)) = removed.found() {
            self.warnings
                .push(Warning::BackSidesRemoved { triangle, count });
        }
    }

    /// Returns for every triangle the one with the same corners, if there is one.
    ///
    /// Only orientation tells them apart, because there are no duplicates.
    fn mates(&self) -> Vec<Option<u32>> {
        let corners = |&[a, b, c]: &[u32; 3]| {
            let mut corners = [a, b, c];
            corners.sort_unstable();
            corners
        };
        let triangles = self.triangles.iter().map(corners);
        let mut keyed: Vec<([u32; 3], u32)> = triangles.zip(0..).collect();
        keyed.sort_unstable();
        let mut mates = vec![None; keyed.len()];
        for pair in keyed.windows(2) {
            let [(p, t), (q, u)] = [pair[0], pair[1]];
            if p == q {
                mates[t as usize] = Some(u);
                mates[u as usize] = Some(t);
            }
        }
        mates
    }

    /// Removes the other triangles.
    pub(super) fn retain_triangles(&mut self, is_kept: &[bool]) {
        fn retain<T>(values: &mut Vec<T>, is_kept: &[bool]) {
            let mut is_kept = is_kept.iter();
            values.retain(|_| is_kept.next().is_none_or(|&kept| kept));
        }
        retain(&mut self.triangles, is_kept);
        retain(&mut self.sources, is_kept);
        retain(&mut self.flipped, is_kept);
    }
}
