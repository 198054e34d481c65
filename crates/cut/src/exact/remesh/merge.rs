//! Merges a node of the rim with the one beside it, on both sides.

use super::super::contract::Opened;
use super::ring::DisplacementBudget;
use super::{Candidate, MIN_GAIN, Remeshed, Remesher};
use incise_mesh::VertexId;

impl Remesher {
    /// Proposes merges of the node at a corner of the current triangle.
    pub(super) fn propose_merges(&mut self, cut: &Opened<'_, '_>, star: usize, node: u32) {
        let around = &mut self.stars[star];
        let mut sides = (0..2).zip(&mut *around);
        if cut.is_on_sweep_edge(node)
            || cut.rim.is_near_end(node)
            || !sides.all(|(side, around)| around.find_at_node(cut, &self.ring, node, side))
        {
            return;
        }
        let old = around[0].quality(0).min(around[1].quality(0));
        for onto_next in [true, false] {
            let on_side = |side: usize| {
                let around = &around[side];
                around.quality_onto(around.along_rim(side, onto_next), 0)
            };
            let new = on_side(0).min(on_side(1));
            if new > MIN_GAIN * old {
                let candidate = Candidate::Merge {
                    star,
                    node,
                    onto_next,
                };
                self.candidates.push((new, candidate));
            }
        }
    }

    /// Merges a node with one beside it if that is valid.
    pub(super) fn merge(
        &mut self,
        cut: &mut Opened<'_, '_>,
        number: usize,
        node: u32,
        onto_next: bool,
        done: &mut Remeshed,
    ) -> bool {
        let (next, prev) = (cut.rim.next[node as usize], cut.rim.prev[node as usize]);
        let (kept, edge) = if onto_next {
            (next, node)
        } else {
            (prev, prev)
        };
        if !cut.may_lose_edge(edge) {
            return false;
        }
        let surface = cut.edit.surface();
        let (mut budget, mut volume) = (None::<DisplacementBudget>, 0.0);
        for (side, star) in self.stars[number].iter_mut().enumerate() {
            let onto = star.along_rim(side, onto_next);
            let pin = |v: VertexId| surface.positions()[v.index()][3] == 0.0;
            let is_pinned = pin(cut.sides.vertices[node as usize][side]);
            self.near.clear();
            let topology = surface.topology();
            (cut.rim).neighbors(topology, cut.sides, kept, side, &mut self.near);
            let common = star.vertices.iter().filter(|v| self.near.contains(v));
            if common.count() != 1
                || star.joins_rim(onto)
                || (is_pinned && !pin(star.vertices[onto]))
                || (!star.is_at_rest() && star.quality_onto(onto, 1) < star.quality(1))
            {
                return false;
            }
            let distance = star.distance_onto(onto);
            let own = star
                .budget
                .zip(distance)
                .and_then(|(budget, d)| budget.after(d));
            let Some(own) = own else {
                return false;
            };
            budget = Some(budget.map_or(own, |budget| budget.with(own)));
            volume += star.volume_onto(onto);
        }
        let Some(budget) = budget else {
            return false;
        };
        done.nodes += 1;
        done.volume += volume;
        done.distance = done.distance.max(budget.moved);
        cut.merge_nodes(edge, kept, &mut self.fan);
        for side in 0..2 {
            let fan = std::mem::take(&mut self.stars[number][side].fan);
            self.follow(cut, &fan, budget);
            self.stars[number][side].fan = fan;
        }
        true
    }
}
