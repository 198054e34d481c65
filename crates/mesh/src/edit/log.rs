//! What an edit overwrote: enough to put every byte back.

use crate::history::History;
use crate::ids::{HalfEdge, TriangleId, VertexId};
use crate::surface::Surface;

/// The old values of one array, in the order in which they were overwritten. What lies beyond the
/// array's old length needs no entry: it is cut off again.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Track<T> {
    len: usize,
    old: Vec<(u32, T)>,
}

// Derived, it would ask the same of the entries.
impl<T> Default for Track<T> {
    fn default() -> Self {
        Self {
            len: 0,
            old: Vec::new(),
        }
    }
}

impl<T: Copy> Track<T> {
    fn of(array: &[T]) -> Self {
        Self {
            len: array.len(),
            old: Vec::new(),
        }
    }

    /// The array's length before the edit.
    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// Overwrites an entry and remembers what it was.
    pub(super) fn set(&mut self, array: &mut [T], at: u32, value: T) {
        let entry = &mut array[at as usize];
        if (at as usize) < self.len {
            self.old.push((at, *entry));
        }
        *entry = value;
    }

    /// Where entries were overwritten, repeatedly perhaps.
    pub(super) fn places(&self) -> impl Iterator<Item = u32> + '_ {
        self.old.iter().map(|entry| entry.0)
    }

    /// The value before the edit of every entry that was overwritten, ascending by place.
    pub(super) fn before(&self) -> Vec<(u32, T)> {
        // Place and time in one number: that sorts several times as fast as pairs, stably.
        let numbered = (0_u32..).zip(&self.old);
        let mut order: Vec<u64> = numbered
            .map(|(time, &(at, _))| (u64::from(at) << 32) | u64::from(time))
            .collect();
        order.sort_unstable();
        order.dedup_by_key(|key| *key >> 32);
        #[expect(clippy::cast_possible_truncation, reason = "the lower half")]
        let time = |key: u64| key as u32 as usize;
        order.into_iter().map(|key| self.old[time(key)]).collect()
    }

    /// All values that were overwritten.
    pub(super) fn overwritten(&self) -> impl Iterator<Item = T> + '_ {
        self.old.iter().map(|entry| entry.1)
    }

    /// What was overwritten between two states of an array, entries compared by `key`.
    fn between<K: PartialEq>(before: &[T], after: &[T], key: impl Fn(T) -> K) -> Self {
        let pairs = (0..).zip(before.iter().zip(after));
        let changed = pairs.filter(|&(_, (&old, &new))| key(old) != key(new));
        Self {
            len: before.len(),
            old: changed.map(|(at, (&old, _))| (at, old)).collect(),
        }
    }

    fn put_back(&self, array: &mut Vec<T>, len: usize) {
        array.truncate(len);
        for &(at, value) in self.old.iter().rev() {
            if let Some(entry) = array.get_mut(at as usize) {
                *entry = value;
            }
        }
    }
}

/// What was taken from a stack: the part that an edit never reached is still there.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct StackTrack<T> {
    untouched: usize,
    taken: Vec<T>,
}

impl<T> Default for StackTrack<T> {
    fn default() -> Self {
        Self {
            untouched: 0,
            taken: Vec::new(),
        }
    }
}

impl<T: Copy> StackTrack<T> {
    fn of(stack: &[T]) -> Self {
        Self {
            untouched: stack.len(),
            taken: Vec::new(),
        }
    }

    /// What was taken between two states of a stack.
    fn between(before: &[T], after: &[T]) -> Self
    where
        T: PartialEq,
    {
        let same = before.iter().zip(after).take_while(|(old, new)| old == new);
        let untouched = same.count();
        Self {
            untouched,
            taken: before[untouched..].iter().rev().copied().collect(),
        }
    }

    pub(super) fn pop(&mut self, stack: &mut Vec<T>) -> Option<T> {
        let value = stack.pop()?;
        if stack.len() < self.untouched {
            self.untouched = stack.len();
            self.taken.push(value);
        }
        Some(value)
    }

    fn put_back(&self, stack: &mut Vec<T>) {
        stack.truncate(self.untouched);
        stack.extend(self.taken.iter().rev());
    }
}

/// What an edit overwrote in each array of a surface.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Log {
    pub(super) origin: Track<VertexId>,
    pub(super) twin: Track<HalfEdge>,
    pub(super) outgoing: Track<HalfEdge>,
    pub(super) positions: Track<[f32; 4]>,
    pub(super) rest: Track<[f32; 3]>,
    pub(super) uv: Track<[f32; 2]>,
    pub(super) normal: Track<[f32; 3]>,
    pub(super) piece: Track<u32>,
    pub(super) material: Track<u32>,
    pub(super) free_triangles: StackTrack<TriangleId>,
    pub(super) free_vertices: StackTrack<VertexId>,
    piece_bound: u32,
    history: History,
}

impl Log {
    /// Nothing overwritten yet. O(1).
    pub(super) fn of(surface: &Surface) -> Self {
        let topology = &surface.topology;
        Self {
            origin: Track::of(&topology.origin),
            twin: Track::of(&topology.twin),
            outgoing: Track::of(&topology.outgoing),
            positions: Track::of(&surface.positions),
            rest: Track::of(&surface.rest),
            uv: Track::of(&surface.corners.uv),
            normal: Track::of(&surface.corners.normal),
            piece: Track::of(&surface.piece),
            material: Track::of(&surface.material),
            free_triangles: StackTrack::of(&topology.free_triangles),
            free_vertices: StackTrack::of(&topology.free_vertices),
            piece_bound: surface.pieces.bound(),
            history: surface.history,
        }
    }

    /// What was overwritten between two states of a surface, none of whose slots went. O(n).
    pub(super) fn between(before: &Surface, after: &Surface) -> Self {
        let (old, new) = (&before.topology, &after.topology);
        let (corners, now) = (&before.corners, &after.corners);
        Self {
            origin: Track::between(&old.origin, &new.origin, |v| v),
            twin: Track::between(&old.twin, &new.twin, |h| h),
            outgoing: Track::between(&old.outgoing, &new.outgoing, |h| h),
            positions: Track::between(&before.positions, &after.positions, |p| p.map(f32::to_bits)),
            rest: Track::between(&before.rest, &after.rest, |p| p.map(f32::to_bits)),
            uv: Track::between(&corners.uv, &now.uv, |uv| uv.map(f32::to_bits)),
            normal: Track::between(&corners.normal, &now.normal, |n| n.map(f32::to_bits)),
            piece: Track::between(&before.piece, &after.piece, |p| p),
            material: Track::between(&before.material, &after.material, |m| m),
            free_triangles: StackTrack::between(&old.free_triangles, &new.free_triangles),
            free_vertices: StackTrack::between(&old.free_vertices, &new.free_vertices),
            piece_bound: before.pieces.bound(),
            history: before.history,
        }
    }

    /// The bound of piece numbers before the edit.
    pub(super) fn piece_bound(&self) -> u32 {
        self.piece_bound
    }

    /// Puts everything back. O(k log k) for k overwritten entries.
    pub(super) fn put_back(&self, surface: &mut Surface) {
        let slots = self.touched_slots(surface);
        for &t in slots.iter().filter(|&&t| surface.topology.is_triangle(t)) {
            surface.pieces.remove(surface.piece[t.index()]);
        }
        let topology = &mut surface.topology;
        self.origin.put_back(&mut topology.origin, self.origin.len);
        self.twin.put_back(&mut topology.twin, self.twin.len);
        let vertices = self.outgoing.len;
        self.outgoing.put_back(&mut topology.outgoing, vertices);
        self.positions.put_back(&mut surface.positions, vertices);
        self.rest.put_back(&mut surface.rest, vertices);
        // Attributes that the surface got after the edit stay, as far as there are triangles.
        let corners = &mut surface.corners;
        let len = |old: usize| if old == 0 { self.origin.len } else { old };
        self.uv.put_back(&mut corners.uv, len(self.uv.len));
        self.normal
            .put_back(&mut corners.normal, len(self.normal.len));
        self.piece.put_back(&mut surface.piece, self.piece.len);
        self.material
            .put_back(&mut surface.material, self.material.len);
        self.free_triangles.put_back(&mut topology.free_triangles);
        self.free_vertices.put_back(&mut topology.free_vertices);
        for &t in slots.iter().filter(|&&t| surface.topology.is_triangle(t)) {
            surface.pieces.add(surface.piece[t.index()]);
        }
        surface.pieces.set_bound(self.piece_bound);
        surface.history = self.history;
    }

    /// Triangle slots whose triangle or piece may differ from before, each once.
    fn touched_slots(&self, surface: &Surface) -> Vec<TriangleId> {
        let corners = self.origin.places().map(|h| HalfEdge(h).triangle());
        let pieces = self.piece.places().map(TriangleId);
        let new = (self.piece.len..surface.piece.len()).map(TriangleId::from_index);
        let mut slots: Vec<TriangleId> = corners.chain(pieces).chain(new).collect();
        // Most stand in threes.
        slots.dedup();
        slots.sort_unstable();
        slots.dedup();
        slots
    }
}
