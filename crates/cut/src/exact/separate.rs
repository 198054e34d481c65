//! Pieces by connectivity, found from the lips.
//!
//! Searches run from all lips at once, in step with each other, and join where they meet. They end as
//! soon as no more than one part of each piece has not been seen to its end: it has what the others leave,
//! and if that is the most it keeps the piece's number and is never seen as a whole. Those on the side
//! that looks smaller go ahead, so that little is seen of the larger one.

use crate::sweep::Sweep;
use incise_mesh::{Edit, HalfEdge, Surface, Topology, TriangleId};

/// How many triangles a search looks at before the next one has its turn.
const TURN: usize = 1024;
/// How many times as long a turn is on the side that looks smaller.
const AHEAD: usize = 4;
/// How many triangles it looks at together.
const BATCH: usize = 32;
/// How many triangles of a body are looked at to tell which side is smaller.
const SAMPLES: usize = 64;

/// Memory of the searches.
#[derive(Debug, Clone, Default)]
pub(crate) struct Separator {
    /// By triangle slot: `epoch` + the number of the search that came there, or less.
    stamps: Vec<u32>,
    epoch: u32,
    /// The next epoch: above all stamps.
    next_epoch: u32,
    /// One a lip of a loop, lip 0 before lip 1.
    searches: Vec<Search>,
    /// The lip behind which less seems to be.
    smaller: usize,
    /// Searches, those of a part beside each other.
    members: Vec<usize>,
}

/// The triangles that were reached from one lip.
#[derive(Debug, Clone, Default)]
struct Search {
    reached: Vec<TriangleId>,
    /// How many of them were looked at.
    done: usize,
    /// The search that it was joined to, itself if none.
    root: usize,
    /// The piece that its lip was part of.
    piece: u32,
}

/// Searches that were joined.
#[derive(Debug, Clone, Copy)]
struct Part {
    /// Where its searches stand among the members.
    members: (usize, usize),
    /// The first of the pieces that its lips were part of, and whether there are others.
    piece: u32,
    is_mixed: bool,
    triangles: usize,
    is_finished: bool,
    first_triangle: TriangleId,
}

impl Separator {
    /// Gives every connected part of the pieces at `lips`, the boundary half-edges' triangles, a number of
    /// its own. The part with the most triangles keeps the old one (of equals, the one with the first
    /// triangle). Lips of `joined` numbers will be joined by a cap, so their parts are one.
    pub(super) fn separate(
        &mut self,
        edit: &mut Edit<'_>,
        sweep: &Sweep,
        lips: impl Iterator<Item = HalfEdge>,
        joined: impl Iterator<Item = (usize, usize)>,
    ) {
        self.begin(edit.surface(), lips);
        self.smaller = smaller_lip(edit.surface(), sweep, self.searches[0].piece);
        for (a, b) in joined {
            self.join(a, b);
        }
        let mut parts = Vec::new();
        loop {
            self.parts(&mut parts);
            let mut is_done = true;
            for group in parts.chunk_by(|a, b| a.piece == b.piece) {
                let finished = || group.iter().filter(|p| p.is_finished).map(|p| p.triangles);
                let open = group.iter().filter(|p| !p.is_finished).count();
                let rest = edit.surface().piece_triangles(group[0].piece);
                let rest = rest.saturating_sub(finished().sum());
                let is_largest = finished().all(|triangles| triangles < rest);
                for part in group.iter().filter(|p| !p.is_finished) {
                    if open > 1 || part.is_mixed || !is_largest {
                        is_done = false;
                        self.advance(edit.surface(), part);
                    }
                }
            }
            if is_done {
                break;
            }
        }
        self.number(edit, &parts);
    }

    fn begin(&mut self, surface: &Surface, lips: impl Iterator<Item = HalfEdge>) {
        let slots = surface.topology().triangle_slots();
        self.searches.iter_mut().for_each(|s| s.reached.clear());
        let seeds: Vec<TriangleId> = lips.map(HalfEdge::triangle).collect();
        self.searches.resize(seeds.len(), Search::default());
        self.stamps.resize(slots.max(self.stamps.len()), 0);
        // Stamps of earlier cuts are below the epoch, so nothing is cleared but once in a long while.
        let count = number(seeds.len());
        if self.next_epoch > u32::MAX - count {
            self.stamps.fill(0);
            self.next_epoch = 0;
        }
        self.epoch = self.next_epoch.max(1);
        self.next_epoch = self.epoch + count;
        for (i, &seed) in seeds.iter().enumerate() {
            let search = &mut self.searches[i];
            search.done = 0;
            search.root = i;
            search.piece = surface.piece(seed);
            let stamp = std::mem::replace(&mut self.stamps[seed.index()], self.epoch + number(i));
            if stamp < self.epoch {
                self.searches[i].reached.push(seed);
            } else {
                self.join(i, (stamp - self.epoch) as usize);
            }
        }
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.searches[a.max(b)].root = a.min(b);
    }

    fn root(&self, mut i: usize) -> usize {
        while self.searches[i].root != i {
            i = self.searches[i].root;
        }
        i
    }

    /// The parts that the searches make so far, sorted by piece, then by root.
    fn parts(&mut self, out: &mut Vec<Part>) {
        for i in 0..self.searches.len() {
            self.searches[i].root = self.root(i);
        }
        self.members.clear();
        self.members.extend(0..self.searches.len());
        let searches = &self.searches;
        self.members.sort_by_key(|&i| searches[i].root);
        out.clear();
        let mut from = 0;
        for own in self
            .members
            .chunk_by(|&a, &b| searches[a].root == searches[b].root)
        {
            let own_searches = || own.iter().map(|&i| &searches[i]);
            let pieces = || own_searches().map(|s| s.piece);
            let piece = pieces().min().unwrap_or_default();
            out.push(Part {
                members: (from, from + own.len()),
                piece,
                is_mixed: pieces().any(|p| p != piece),
                triangles: own_searches().map(|s| s.reached.len()).sum(),
                is_finished: own_searches().all(|s| s.done == s.reached.len()),
                first_triangle: TriangleId::NULL,
            });
            from += own.len();
        }
        // Stable, so that parts of a piece stay in the order of their roots.
        out.sort_by_key(|part| part.piece);
    }

    /// Lets the searches of a part look at some more triangles.
    fn advance(&mut self, surface: &Surface, part: &Part) {
        let topology = surface.topology();
        for k in part.members.0..part.members.1 {
            let i = self.members[k];
            let mut turn = if i % 2 == self.smaller {
                AHEAD * TURN
            } else {
                TURN
            };
            while turn > 0 && self.searches[i].done < self.searches[i].reached.len() {
                self.look_around(topology, i);
                turn -= BATCH;
            }
        }
    }

    /// Lets a search look at its next few triangles. Their neighbors are all read before any is judged,
    /// so that the reads do not wait for each other, and no branch depends on which of them are new.
    fn look_around(&mut self, topology: &Topology, i: usize) {
        let search = &mut self.searches[i];
        let mut near = [TriangleId::NULL; 3 * BATCH];
        let mut count = 0;
        let end = search.reached.len().min(search.done + BATCH);
        for &t in &search.reached[search.done..end] {
            for twin in t.half_edges().map(|h| topology.twin(h)) {
                near[count] = twin.triangle();
                count += usize::from(!twin.is_null());
            }
        }
        search.done = end;
        let own = self.epoch + number(i);
        let mut new = [TriangleId::NULL; 3 * BATCH];
        let mut fresh = 0;
        for &t in &near[..count] {
            let stamp = std::mem::replace(&mut self.stamps[t.index()], own);
            new[fresh] = t;
            fresh += usize::from(stamp < self.epoch);
            if stamp >= self.epoch && stamp != own {
                self.join(i, (stamp - self.epoch) as usize);
            }
        }
        self.searches[i].reached.extend_from_slice(&new[..fresh]);
    }

    fn number(&self, edit: &mut Edit<'_>, parts: &[Part]) {
        let mut parts = parts.to_vec();
        for part in parts.iter_mut().filter(|p| p.is_finished) {
            part.first_triangle = (self.of(part).min()).expect("a search has a triangle");
        }
        parts.sort_by_key(|part| (part.piece, part.first_triangle));
        for group in parts.chunk_by(|a, b| a.piece == b.piece) {
            // An unfinished part is larger than all others; of finished ones the first of the largest.
            let size = |p: &Part| {
                if p.is_finished {
                    p.triangles
                } else {
                    usize::MAX
                }
            };
            let kept = group.iter().rev().max_by_key(|p| size(p));
            let kept = kept.expect("a group has a part").members;
            for part in group {
                if part.members == kept && !part.is_mixed {
                    continue;
                }
                let number = if part.members == kept {
                    part.piece
                } else {
                    edit.new_piece(part.piece)
                };
                edit.set_pieces(self.of(part), number);
            }
        }
    }

    /// The triangles that the searches of a part reached.
    fn of(&self, part: &Part) -> impl Iterator<Item = TriangleId> + '_ {
        let own = &self.members[part.members.0..part.members.1];
        own.iter()
            .flat_map(|&i| self.searches[i].reached.iter().copied())
    }
}

/// The lip behind which less seems to be of a piece: the side of the sweep's plane with fewer of some
/// triangles that stand far apart. Only how long the searches take depends on it.
fn smaller_lip(surface: &Surface, sweep: &Sweep, piece: u32) -> usize {
    let (point, normal) = sweep.plane();
    let slots = surface.topology().triangle_slots();
    let samples = (0..SAMPLES).map(|i| TriangleId::from_index(i * slots / SAMPLES));
    let own = samples.filter(|&t| surface.topology().is_triangle(t) && surface.piece(t) == piece);
    let above: i32 = own
        .map(|t| {
            let [corner, ..] = surface.triangle_positions(t);
            if normal.dot(&(corner - point)) > 0.0 {
                1
            } else {
                -1
            }
        })
        .sum();
    usize::from(above <= 0)
}

fn number(search: usize) -> u32 {
    u32::try_from(search).expect("there are fewer lips than half-edges")
}
