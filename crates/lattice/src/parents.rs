//! The copies that held new parts before an edit, from which these take their motion.

use crate::cell::NONE;
use crate::lattice::Lattice;
use crate::work::{Solved, Work};

/// A new part without vertices, and its cell.
#[derive(Debug, Clone, Copy)]
struct Open<'a> {
    part: u32,
    solved: &'a Solved,
}

impl Lattice {
    /// Finds the copies that held the new parts before.
    ///
    /// Most of a part's vertices were in that copy. A part without vertices goes by the parts that
    /// it meets: it was in the copy of its cell that shared nodes with theirs or, where the cell
    /// was empty, beside one of these. Of two pieces that touched at rest, it is never the other
    /// one. A part that meets none, and of which no old vertex is left, was in the largest part
    /// there. A part that joins several copies takes over the largest one, which has kept its
    /// number since before the cut.
    pub(crate) fn find_parents(&mut self, work: &Work) {
        let parts = &mut self.state.parts;
        for &part in &work.old_parts {
            let old_copy = parts.carrying_copy(part);
            parts.get_mut(part).old_copy = old_copy;
        }
        if self.cells.is_empty() {
            return;
        }
        let mut open = self.find_by_vertices(work);
        let mut found = Vec::new();
        while !open.is_empty() {
            found.clear();
            let parents = open
                .iter()
                .map(|own| (own.part, self.parent_beside(work, *own)));
            found.extend(parents.filter(|own| own.1 != NONE));
            if found.is_empty() {
                break;
            }
            for &(part, parent) in &found {
                self.state.parts.get_mut(part).old_copy = parent;
            }
            open.retain(|own| self.state.parts.get(own.part).old_copy == NONE);
        }
        let parts = &mut self.state.parts;
        for Open { part, solved } in open {
            let old_parts = work.old_parts[solved.old_parts.clone()].iter();
            let size = |&&old: &&u32| parts.get(old).sums.length();
            let largest = old_parts.min_by(|a, b| size(b).total_cmp(&size(a)));
            if let Some(&largest) = largest {
                parts.get_mut(part).old_copy = parts.get(largest).old_copy;
            }
        }
        self.prefer_largest(work);
    }

    /// Gives parts that join several copies of their cell the largest one.
    fn prefer_largest(&mut self, work: &Work) {
        let mut found = Vec::new();
        for solved in &work.solved {
            let old_parts = &work.old_parts[solved.old_parts.clone()];
            if old_parts.len() < 2 {
                continue;
            }
            let parts = &self.state.parts;
            let size = |copy: u32| {
                let own = old_parts.iter().find(|&&old| parts.get(old).copy == copy);
                own.map_or(0.0, |&old| parts.get(old).sums.length())
            };
            for &part in &work.parts[solved.parts.clone()] {
                let met = self.met_beside(work, Open { part, solved });
                if let Some(met) = met.filter(|&met| size(met) > size(parts.get(part).old_copy)) {
                    found.push((part, met));
                }
            }
        }
        for (part, copy) in found {
            self.state.parts.get_mut(part).old_copy = copy;
        }
    }

    /// Finds the copies that held most of the vertices of each part. Returns the other parts.
    fn find_by_vertices<'a>(&mut self, work: &'a Work) -> Vec<Open<'a>> {
        let mut open = Vec::new();
        let mut votes: Vec<(u32, u32)> = Vec::new();
        for solved in &work.solved {
            let vertices = &work.vertices[solved.vertices.clone()];
            for &part in &work.parts[solved.parts.clone()] {
                votes.clear();
                for &(v, _) in vertices.iter().filter(|own| own.1 == part) {
                    let copy = self.vertex_copies[v.index()];
                    match votes.iter_mut().find(|own| own.0 == copy) {
                        Some(own) => own.1 += 1,
                        None if copy != NONE => votes.push((copy, 1)),
                        None => {}
                    }
                }
                let best = votes
                    .iter()
                    .min_by_key(|own| (std::cmp::Reverse(own.1), own.0));
                let parts = &mut self.state.parts;
                match best.copied() {
                    Some(best) => parts.get_mut(part).old_copy = best.0,
                    None => open.push(Open { part, solved }),
                }
            }
        }
        open
    }

    /// Returns the copy that held a part, by the parts that it meets; [`NONE`] if none of these is
    /// known.
    fn parent_beside(&self, work: &Work, own: Open<'_>) -> u32 {
        let known = self.met_beside(work, own);
        let first = self.beside(work, own).min().map(|own| own.1);
        known.or(first).unwrap_or(NONE)
    }

    /// Returns the largest copy of a part's cell that shared nodes with the copies of the parts
    /// that it meets.
    fn met_beside(&self, work: &Work, own: Open<'_>) -> Option<u32> {
        let parts = &self.state.parts;
        let shares_nodes = |a: u32, b: u32| {
            let [a, b] = [a, b].map(|copy| &self.nodes[copy as usize]);
            a.iter().any(|node| b.contains(node))
        };
        let old_parts = &work.old_parts[own.solved.old_parts.clone()];
        let met = old_parts.iter().filter(|&&old| {
            let copy = parts.get(old).old_copy;
            (self.beside(work, own)).any(|beside| shares_nodes(copy, beside.1))
        });
        // Parts that a neighbor carried have no copy in the cell.
        let size = |&&old: &&u32| match parts.carries_itself(old) {
            true => parts.get(old).sums.length(),
            false => 0.0,
        };
        // The first one of equal volume.
        let largest = met.min_by(|a, b| size(b).total_cmp(&size(a)));
        largest.map(|&old| parts.get(old).old_copy)
    }

    /// Returns the known copies before the edit of the parts that a part meets, with their orders.
    fn beside(&self, work: &Work, own: Open<'_>) -> impl Iterator<Item = ((u32, u32), u32)> {
        let parts = &self.state.parts;
        parts.get(own.part).links.iter().filter_map(|link| {
            let other = parts.get(link.part());
            let copy = if work.touched.contains(other.cell) {
                other.old_copy
            } else {
                parts.carrying_copy(link.part())
            };
            (copy != NONE).then(|| (parts.order(link.part()), copy))
        })
    }
}
