//! The log of an edit: overwritten values, from which every byte can be restored.

use super::piece_move::{PieceMove, TriangleSet};
use crate::history::History;
use crate::ids::{HalfEdge, TriangleId, VertexId, index_u32};
use crate::surface::{Channel, Domain, Row, Surface, exchange};
use std::ops::Range;

/// The old values of one array, in the order of overwriting.
///
/// Entries beyond the array's old length need no log: they are truncated.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Track<T> {
    len: usize,
    old: Vec<(u32, T)>,
}

// Implemented by hand, because a derive would require `T: Default`.
impl<T> Default for Track<T> {
    fn default() -> Self {
        Self {
            len: 0,
            old: Vec::new(),
        }
    }
}

impl<T: Copy> Track<T> {
    fn new(array: &[T]) -> Self {
        Self {
            len: array.len(),
            old: Vec::new(),
        }
    }

    /// Returns the array's length before the edit.
    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// Overwrites an entry and logs its old value.
    pub(super) fn set(&mut self, array: &mut [T], at: u32, value: T) {
        let entry = &mut array[at as usize];
        if (at as usize) < self.len {
            self.old.push((at, *entry));
        }
        *entry = value;
    }

    /// Iterates over the indices of overwritten entries, with repetitions.
    pub(super) fn places(&self) -> impl Iterator<Item = u32> + '_ {
        self.old.iter().map(|entry| entry.0)
    }

    /// Returns the value of every overwritten entry before the edit, ascending by index.
    pub(super) fn before(&self) -> Vec<(u32, T)> {
        // Index and order in one number sort several times as fast as pairs, and stably.
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

    /// Iterates over all overwritten values with their indices, in the order of overwriting.
    pub(super) fn overwrites(&self) -> impl Iterator<Item = (u32, T)> + '_ {
        self.old.iter().copied()
    }

    fn put_back(&self, array: &mut Vec<T>, len: usize) {
        array.truncate(len);
        self.put_back_entries(array, 0..self.old.len());
    }

    /// Undoes some of the overwrites, the last one first.
    fn put_back_entries(&self, array: &mut [T], entries: Range<usize>) {
        for &(at, value) in self.old[entries].iter().rev() {
            if let Some(entry) = array.get_mut(at as usize) {
                *entry = value;
            }
        }
    }
}

/// The old rows of one channel, in the order of overwriting.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct RowTrack {
    /// The channel, without values.
    like: Channel,
    /// Length of its values before the edit.
    len: usize,
    /// Whether the edit added the channel.
    is_added: bool,
    places: Vec<u32>,
    old: Vec<f32>,
}

impl RowTrack {
    fn new(channel: &Channel) -> Self {
        Self {
            like: channel.with_values(Vec::new()),
            len: channel.values.len(),
            is_added: false,
            places: Vec::new(),
            old: Vec::new(),
        }
    }

    /// Returns the track of a channel that the edit adds.
    pub(super) fn of_added(channel: &Channel) -> Self {
        Self {
            len: 0,
            is_added: true,
            ..Self::new(channel)
        }
    }

    /// Overwrites a row and logs its old values; adds the row if it is the next one.
    pub(super) fn set(&mut self, channel: &mut Channel, slot: usize, row: &Row) {
        let width = channel.width();
        let first = slot * width;
        if first == channel.values.len() {
            channel.values.extend_from_slice(&row[..width]);
            return;
        }
        let values = &mut channel.values[first..first + width];
        if first < self.len {
            self.places.push(index_u32(slot));
            self.old.extend_from_slice(values);
        }
        values.copy_from_slice(&row[..width]);
    }

    fn put_back(&self, channel: &mut Channel) {
        let width = self.like.width();
        channel.values.truncate(self.len);
        for (&slot, row) in self.places.iter().zip(self.old.chunks_exact(width)).rev() {
            let first = slot as usize * width;
            channel.values[first..first + width].copy_from_slice(row);
        }
    }
}

/// The elements taken from a stack; those below the edit's low-water mark are still there.
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
    fn new(stack: &[T]) -> Self {
        Self {
            untouched: stack.len(),
            taken: Vec::new(),
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

/// The overwritten values of each array of a surface.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Log {
    pub(super) origin: Track<VertexId>,
    pub(super) twin: Track<HalfEdge>,
    pub(super) outgoing: Track<HalfEdge>,
    pub(super) positions: Track<[f32; 4]>,
    pub(super) rest: Track<[f32; 3]>,
    pub(super) uv: Track<[f32; 2]>,
    pub(super) normal: Track<[f32; 3]>,
    /// One per channel of the surface, in its order.
    pub(super) channels: Vec<RowTrack>,
    /// Single changes of pieces.
    pub(super) piece: Track<u32>,
    /// Moves of many triangles to another piece, in their order.
    moves: Vec<PieceMove>,
    pub(super) material: Track<u32>,
    pub(super) free_triangles: StackTrack<TriangleId>,
    pub(super) free_vertices: StackTrack<VertexId>,
    piece_bound: u32,
    history: History,
}

impl Log {
    /// Exchanges logged positions and rest positions, which are always overwritten together.
    pub(super) fn exchange_shapes(&mut self) {
        for (position, rest) in self.positions.old.iter_mut().zip(&mut self.rest.old) {
            debug_assert_eq!(
                position.0, rest.0,
                "positions and rest positions in one order"
            );
            exchange(&mut position.1, &mut rest.1);
        }
    }

    /// Returns an empty log. O(1).
    pub(super) fn new(surface: &Surface) -> Self {
        let topology = &surface.topology;
        Self {
            origin: Track::new(&topology.origin),
            twin: Track::new(&topology.twin),
            outgoing: Track::new(&topology.outgoing),
            positions: Track::new(&surface.positions),
            rest: Track::new(&surface.rest),
            uv: Track::new(&surface.corners.uv),
            normal: Track::new(&surface.corners.normal),
            channels: surface.channels.iter().map(RowTrack::new).collect(),
            piece: Track::new(&surface.piece),
            moves: Vec::new(),
            material: Track::new(&surface.material),
            free_triangles: StackTrack::new(&topology.free_triangles),
            free_vertices: StackTrack::new(&topology.free_vertices),
            piece_bound: surface.pieces.bound(),
            history: surface.history,
        }
    }

    /// Returns the bound of piece numbers before the edit.
    pub(super) fn piece_bound(&self) -> u32 {
        self.piece_bound
    }

    /// Logs that triangles of piece `from`, older than the edit, moved to piece `to`.
    pub(super) fn move_pieces(&mut self, triangles: TriangleSet, from: u32, to: u32) {
        self.moves.push(PieceMove {
            triangles,
            from,
            to,
            changes_before: self.piece.old.len(),
        });
    }

    /// Iterates over the pieces from which triangles moved, with repetitions.
    pub(super) fn left_pieces(&self) -> impl Iterator<Item = u32> + '_ {
        let single = self.piece.overwrites().map(|entry| entry.1);
        single.chain(self.moves.iter().map(|moved| moved.from))
    }

    /// Returns the piece before the edit of every triangle that moved, ascending by triangle.
    pub(super) fn pieces_before(&self) -> Vec<(u32, u32)> {
        let mut all = Track {
            len: self.piece.len,
            old: Vec::new(),
        };
        let mut at = 0;
        for moved in &self.moves {
            all.old
                .extend_from_slice(&self.piece.old[at..moved.changes_before]);
            all.old
                .extend(moved.triangles.iter().map(|t| (t.0, moved.from)));
            at = moved.changes_before;
        }
        all.old.extend_from_slice(&self.piece.old[at..]);
        all.before()
    }

    /// Restores the surface. O(k log k) for k overwritten entries.
    pub(super) fn put_back(&self, surface: &mut Surface) {
        let slots = self.touched_slots(surface);
        for &t in slots.iter().filter(|&&t| surface.topology.is_triangle(t)) {
            surface.pieces.remove(surface.piece[t.index()]);
        }
        self.put_back_pieces(surface, &slots);
        let topology = &mut surface.topology;
        self.origin.put_back(&mut topology.origin, self.origin.len);
        self.twin.put_back(&mut topology.twin, self.twin.len);
        let vertices = self.outgoing.len;
        self.outgoing.put_back(&mut topology.outgoing, vertices);
        self.positions.put_back(&mut surface.positions, vertices);
        self.rest.put_back(&mut surface.rest, vertices);
        // Attributes that the surface got after the edit stay for the remaining triangles.
        let corners = &mut surface.corners;
        let len = |old: usize| if old == 0 { self.origin.len } else { old };
        self.uv.put_back(&mut corners.uv, len(self.uv.len));
        self.normal
            .put_back(&mut corners.normal, len(self.normal.len));
        let added = || self.channels.iter().filter(|track| track.is_added);
        let is_added = |channel: &Channel| added().any(|track| track.like.is_like(channel));
        surface.channels.retain(|channel| !is_added(channel));
        for channel in &mut surface.channels {
            let is_own = |track: &&RowTrack| track.like.is_like(channel);
            match self.channels.iter().find(is_own) {
                Some(track) if track.len <= channel.values.len() => track.put_back(channel),
                _ => channel.fit(match channel.domain() {
                    Domain::Vertex => vertices,
                    Domain::Corner => self.origin.len,
                }),
            }
        }
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

    /// Restores the pieces of all triangles.
    ///
    /// Piece counts are updated for triangles outside `slots`; the caller updates the others.
    fn put_back_pieces(&self, surface: &mut Surface, slots: &[TriangleId]) {
        surface.piece.truncate(self.piece.len);
        let mut end = self.piece.old.len();
        for moved in self.moves.iter().rev() {
            let later = moved.changes_before..end;
            self.piece.put_back_entries(&mut surface.piece, later);
            end = moved.changes_before;
            for t in moved.triangles.iter() {
                surface.piece[t.index()] = moved.from;
            }
            let others = slots.iter().filter(|&&t| moved.triangles.contains(t));
            let count = moved.triangles.len() - others.count();
            (surface.pieces).shift(moved.to, moved.from, index_u32(count));
        }
        self.piece.put_back_entries(&mut surface.piece, 0..end);
    }

    /// Returns the triangle slots that changed one by one, each once.
    ///
    /// Triangles that only belong to a [`PieceMove`] are not included.
    fn touched_slots(&self, surface: &Surface) -> Vec<TriangleId> {
        let corners = self.origin.places().map(|h| HalfEdge(h).triangle());
        let pieces = self.piece.places().map(TriangleId);
        let new = (self.piece.len..surface.piece.len()).map(TriangleId::from_index);
        let mut slots: Vec<TriangleId> = corners.chain(pieces).chain(new).collect();
        // Most entries come in threes.
        slots.dedup();
        slots.sort_unstable();
        slots.dedup();
        slots
    }
}
