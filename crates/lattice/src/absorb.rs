//! Small parts that belong to a neighbor.
//!
//! They are settled cluster by cluster. A cluster is a set of small parts that meet in faces. It
//! depends on its own parts, on the large ones beside them, and on which of those meet each other
//! or a common large part. So an edit concerns clusters up to two parts away.

use crate::cell::NONE;
use crate::parts::Parts;
use crate::set::Set;

/// Maximum reach of a part into its cell by which a neighbor may carry it [cells].
///
/// Weights of a neighbor's corners extrapolate that far, to between -0.3 and 1.3.
const MAX_REACH: f32 = 0.3;

/// Memory that the search for clusters reuses.
#[derive(Debug, Default)]
pub(crate) struct Clusters {
    found: Set,
    /// Parts of all clusters found, one cluster after the other.
    pub(crate) members: Vec<u32>,
    ends: Vec<usize>,
    reaches: Vec<Reach>,
    by_volume: Vec<u32>,
    settled: Vec<(u32, u32)>,
}

/// A neighbor that could carry a small part.
#[derive(Debug, Clone, Copy)]
struct Reach {
    part: u32,
    neighbor: u32,
    /// Reach of the part from their common face [cells].
    reach: f32,
}

impl Clusters {
    /// Finds the clusters that some parts belong to or are beside.
    pub(crate) fn find(&mut self, parts: &Parts, near: impl Iterator<Item = u32>) {
        self.found.reset(parts.slots.len());
        self.members.clear();
        self.ends.clear();
        for part in near {
            self.add(parts, part);
            for link in &parts.get(part).links {
                self.add(parts, link.part());
            }
        }
    }

    /// Adds the cluster of a small part, unless it is known.
    fn add(&mut self, parts: &Parts, part: u32) {
        if !parts.get(part).is_small || !self.found.insert(part) {
            return;
        }
        let from = self.members.len();
        let mut next = from;
        self.members.push(part);
        while let Some(&part) = self.members.get(next) {
            next += 1;
            for link in &parts.get(part).links {
                let other = link.part();
                if parts.get(other).is_small && self.found.insert(other) {
                    self.members.push(other);
                }
            }
        }
        self.members[from..].sort_unstable_by_key(|&part| parts.order(part));
        self.ends.push(self.members.len());
    }

    /// Finds the carriers of all parts of the clusters found.
    pub(crate) fn settle(&mut self, parts: &mut Parts) {
        let mut from = 0;
        for &to in &self.ends {
            let members = &self.members[from..to];
            from = to;
            for &part in members {
                parts.get_mut(part).carrier = NONE;
            }
            self.reaches.clear();
            for &part in members {
                let own = parts.get(part);
                let start = self.reaches.len();
                for link in &own.links {
                    let reach = own.reaches[link.face()];
                    if reach < MAX_REACH {
                        let neighbor = link.part();
                        self.reaches.push(Reach {
                            part,
                            neighbor,
                            reach,
                        });
                    }
                }
                let order = |own: &Reach| parts.order(own.neighbor);
                self.reaches[start..].sort_unstable_by_key(order);
            }
            self.by_volume.clear();
            self.by_volume.extend(members);
            let volume = |part: &u32| parts.get(*part).sums.length();
            // Stable, so that equal ones stay in order.
            self.by_volume
                .sort_by(|a, b| volume(b).total_cmp(&volume(a)));
            settle(parts, &self.by_volume, &self.reaches, &mut self.settled);
            keep_bridges(parts, members);
            for &part in members {
                let carrier = last_carrier(parts, part);
                parts.get_mut(part).carrier = carrier;
            }
        }
    }
}

/// Gives the parts of a cluster to settled neighbors, from the large ones on.
///
/// Where no neighbor is near, the largest part stays.
fn settle(parts: &mut Parts, by_volume: &[u32], reaches: &[Reach], found: &mut Vec<(u32, u32)>) {
    let mut largest = by_volume.iter();
    loop {
        found.clear();
        for own in reaches.chunk_by(|a, b| a.part == b.part) {
            if parts.get(own[0].part).carrier != NONE {
                continue;
            }
            let is_settled = |reach: &&Reach| parts.get(reach.neighbor).carrier != NONE;
            let near = own.iter().filter(is_settled);
            let best = near.min_by(|a, b| a.reach.total_cmp(&b.reach));
            found.extend(best.map(|reach| (reach.part, reach.neighbor)));
        }
        if found.is_empty() {
            let Some(&part) = largest.find(|&&part| parts.get(part).carrier == NONE) else {
                return;
            };
            found.push((part, part));
        }
        for &(part, neighbor) in &*found {
            parts.get_mut(part).carrier = neighbor;
        }
    }
}

/// Lets parts of a cluster carry themselves where their neighbors would not be connected without
/// them.
///
/// Neighbors are connected directly or by one more part, which is large or of the cluster.
fn keep_bridges(parts: &mut Parts, members: &[u32]) {
    loop {
        let mut changed = Vec::new();
        for &part in members {
            for link in &parts.get(part).links {
                let ends = [part, link.part()];
                let [a, b] = ends.map(|part| last_carrier(parts, part));
                let order = |part: &u32| parts.order(*part);
                let is_own = |part: u32| members.binary_search_by_key(&order(&part), order).is_ok();
                if a == b || (a == ends[0] && b == ends[1]) || has_way(parts, a, b, is_own) {
                    continue;
                }
                let is_carried = |part: &u32| !parts.carries_itself(*part);
                changed.extend(ends.into_iter().filter(is_carried));
            }
        }
        if changed.is_empty() {
            return;
        }
        for part in changed {
            parts.get_mut(part).carrier = part;
        }
    }
}

/// Returns whether two parts meet, or meet a common part.
fn has_way(parts: &Parts, a: u32, b: u32, is_own: impl Fn(u32) -> bool) -> bool {
    parts.get(a).links.iter().any(|link| {
        let between = link.part();
        let counts = between != b
            && parts.carries_itself(between)
            && (!parts.get(between).is_small || is_own(between));
        between == b || (counts && parts.are_linked(between, b))
    })
}

/// Returns the part at the end of a chain of carriers.
fn last_carrier(parts: &Parts, mut part: u32) -> u32 {
    while !parts.carries_itself(part) {
        part = parts.get(part).carrier;
    }
    part
}
