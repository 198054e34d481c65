//! GPU storage of a body's volume constraints and of the half-edges that they traverse.

use super::arena::{Arena, with_slack};
use super::body::Host;
use super::context::Context;
use super::error::GpuError;
use super::layout::{CHUNK_ENTRIES, Entry, PIECE_ENTRIES};
use super::upload::Uploads;
use crate::constraints::volumes::VolumeSet;
use crate::kernels::volume::CHUNK;
use incise_mesh::{HalfEdge, Surface, index_u32};
use std::ops::Range;

/// Half-edges are uploaded individually if at most one in this many has changed.
const SCATTERED: usize = 8;

/// Offsets of a body's volume constraints in the entries.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct VolumePlaces {
    pub(super) first_piece: u32,
    pub(super) pieces: u32,
    pub(super) first_chunk: u32,
    pub(super) chunks: u32,
    pub(super) first_spoke: u32,
    pub(super) first_corner: u32,
    pub(super) corners: u32,
}

/// Pieces, chunks and spokes one after the other, and the surface's half-edges.
#[derive(Debug, Default)]
pub(super) struct DeviceVolumes {
    /// Allocated entries, slack included.
    list: Range<u32>,
    /// Allocated entries, slack included.
    corners: Range<u32>,
    /// Uploaded half-edges.
    known: Vec<Entry>,
    /// Generation of the uploaded volumes, 0 for none.
    generation: u64,
    pub(super) places: VolumePlaces,
}

impl DeviceVolumes {
    /// Frees all entries.
    pub(super) fn free(&mut self, arena: &mut Arena) {
        arena.free(std::mem::take(&mut self.list));
        arena.free(std::mem::take(&mut self.corners));
        *self = Self::default();
    }

    /// Uploads changed volumes; returns true if the number of pieces or chunks has changed.
    pub(super) fn update(
        &mut self,
        context: &Context,
        arena: &mut Arena,
        uploads: &mut Uploads,
        host: Host<'_>,
    ) -> Result<bool, GpuError> {
        let set = host.solver.volumes();
        if set.generation() == self.generation {
            return Ok(false);
        }
        if set.pieces().is_empty() {
            let had = self.places.pieces > 0;
            self.free(arena);
            self.generation = set.generation();
            return Ok(had);
        }
        self.send_corners(context, arena, uploads, host.surface)?;
        let before = self.places;
        uploads.entries.clear();
        let chunks = push_volumes(&mut uploads.entries, set);
        let count = uploads.entries.len();
        if count > self.list.len() {
            let (list, _) = arena.allocate(context, with_slack(count))?;
            arena.free(std::mem::replace(&mut self.list, list));
        }
        uploads.write(context, arena.buffer(0), u64::from(self.list.start) * 8);
        let pieces = index_u32(set.pieces().len());
        let first_chunk = self.list.start + pieces * index_u32(PIECE_ENTRIES);
        self.places = VolumePlaces {
            first_piece: self.list.start,
            pieces,
            first_chunk,
            chunks,
            first_spoke: first_chunk + chunks * index_u32(CHUNK_ENTRIES),
            first_corner: self.corners.start,
            corners: index_u32(self.known.len()),
        };
        self.generation = set.generation();
        Ok(before.pieces != pieces || before.chunks != chunks)
    }

    /// Uploads the half-edges that have changed.
    fn send_corners(
        &mut self,
        context: &Context,
        arena: &mut Arena,
        uploads: &mut Uploads,
        surface: &Surface,
    ) -> Result<(), GpuError> {
        let topology = surface.topology();
        let count = 3 * topology.triangle_slots();
        let corner = |h: HalfEdge| [topology.origin(h).0, topology.twin(h).0];
        let now = || (0..index_u32(count)).map(|h| corner(HalfEdge(h)));
        let differ = |known: &[Entry]| {
            let shared = known.iter().zip(now()).filter(|(known, now)| *known != now);
            shared.count() + count.saturating_sub(known.len())
        };
        let has_room = count <= self.corners.len();
        if has_room && differ(&self.known) <= count / SCATTERED {
            self.known.truncate(count);
            for (i, corner) in (0..).zip(now()) {
                let entry = self.corners.start + i;
                match self.known.get_mut(i as usize) {
                    Some(known) if *known == corner => continue,
                    Some(known) => *known = corner,
                    None => self.known.push(corner),
                }
                uploads.edit_entry(entry, corner);
            }
            return Ok(());
        }
        if !has_room {
            let (corners, _) = arena.allocate(context, with_slack(count))?;
            arena.free(std::mem::replace(&mut self.corners, corners));
        }
        self.known.clear();
        self.known.extend(now());
        let bytes = bytemuck::cast_slice(&self.known);
        let offset = u64::from(self.corners.start) * size_of::<Entry>() as u64;
        uploads.send(context, arena.buffer(0), offset, bytes);
        Ok(())
    }
}

/// Appends pieces, chunks and spokes; returns the number of chunks.
fn push_volumes(entries: &mut Vec<Entry>, set: &VolumeSet) -> u32 {
    let mut chunks = 0;
    for piece in set.pieces() {
        let count = index_u32(piece.vertices().div_ceil(CHUNK));
        let center = set.spokes[piece.first].vertex.0;
        let numbers = [piece.rest.to_bits(), piece.reach.to_bits()];
        entries.extend([[chunks, count], numbers, [0, 0], [center, 0]]);
        entries.extend([[0, 0]; 4]);
        chunks += count;
    }
    for (number, piece) in (0..).zip(set.pieces()) {
        for first in (piece.first..piece.end).step_by(CHUNK) {
            let spokes = index_u32(CHUNK.min(piece.end - first));
            entries.extend([[index_u32(first), spokes], [number, 0]]);
            entries.extend([[0, 0]; 4]);
        }
    }
    let spokes = set.spokes.iter();
    entries.extend(spokes.map(|spoke| [spoke.vertex.0, spoke.outgoing.0]));
    chunks
}
