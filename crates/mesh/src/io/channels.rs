//! Channels of a file: rows per vertex of the file, or per corner of its faces.

use crate::ids::index_u32;
use crate::io::build::{Corner, NONE};
use crate::io::data::Warning;
use crate::surface::{Blend, Channel, Domain};

/// Maximum number of channels, so that a file with very many names does not take very long.
const MAX_CHANNELS: usize = 256;

/// The channels of a file while it is read.
#[derive(Debug, Default)]
pub(super) struct FileChannels {
    /// Channels with a row per position of the file.
    of_vertices: Vec<Channel>,
    /// Number of rows that were added to each of them.
    added: Vec<usize>,
    /// The first position of the attribute that fills each of them.
    filled_from: Vec<usize>,
    /// Channels with a row per entry of the table that corners refer to.
    of_corners: Vec<Channel>,
    /// Number of rows in that table.
    corner_rows: usize,
}

impl FileChannels {
    /// Returns the number of a channel with rows per position, which is added if it is new.
    ///
    /// The caller adds a row to every position from number `first`. None if another attribute fills
    /// the channel from there, if the width is not allowed, if the name has another width, rule or
    /// domain, or if there are too many channels.
    pub(super) fn vertex_channel(
        &mut self,
        name: &str,
        domain: Domain,
        blend: Blend,
        width: usize,
        first: usize,
    ) -> Option<usize> {
        if has_name(&self.of_corners, name) {
            return None;
        }
        let channel = find_or_add(&mut self.of_vertices, name, domain, blend, width)?;
        self.added.resize(self.of_vertices.len(), 0);
        self.filled_from.resize(self.of_vertices.len(), usize::MAX);
        let before = std::mem::replace(&mut self.filled_from[channel], first);
        (before != first).then_some(channel)
    }

    /// Returns the number of a channel with rows per corner, which is added if it is new.
    ///
    /// None as in [`Self::vertex_channel`]; the caller fills it with one list of a face at most.
    pub(super) fn corner_channel(
        &mut self,
        name: &str,
        blend: Blend,
        width: usize,
    ) -> Option<usize> {
        if has_name(&self.of_vertices, name) {
            return None;
        }
        find_or_add(&mut self.of_corners, name, Domain::Corner, blend, width)
    }

    /// Sets the row of the position with the number `position`, which has none yet.
    pub(super) fn add_vertex_row(&mut self, channel: usize, position: usize, row: &[f32]) {
        self.added[channel] += 1;
        let channel = &mut self.of_vertices[channel];
        channel.fit_neutral(position);
        channel.values.extend_from_slice(row);
    }

    /// Starts a row of all corner channels and returns its number; channels not set are neutral.
    pub(super) fn add_corner_row(&mut self) -> u32 {
        self.corner_rows += 1;
        index_u32(self.corner_rows - 1)
    }

    /// Sets a channel in the last row of [`Self::add_corner_row`].
    pub(super) fn set_corner_row(&mut self, channel: usize, row: &[f32]) {
        let channel = &mut self.of_corners[channel];
        channel.fit_neutral(self.corner_rows - 1);
        channel.values.extend_from_slice(row);
    }

    /// Returns the number of values in all channels.
    #[cfg(feature = "gltf")]
    pub(super) fn value_count(&self) -> usize {
        let all = self.of_vertices.iter().chain(&self.of_corners);
        all.map(|channel| channel.values.len()).sum()
    }

    /// Returns the channels over welded vertices and over corners.
    ///
    /// `welded` has the welded vertex of each position. A channel of vertices whose rows differ at
    /// one welded vertex becomes a channel of corners. Rows that are missing or have values that
    /// are not finite become neutral, with a warning for each channel.
    pub(super) fn finish(
        self,
        welded: &[u32],
        corners: &[Corner],
        warnings: &mut Vec<Warning>,
    ) -> Vec<Channel> {
        let mut firsts: Vec<usize> = Vec::new();
        for (i, &vertex) in welded.iter().enumerate() {
            if vertex as usize == firsts.len() {
                firsts.push(i);
            }
        }
        let mut out = Vec::with_capacity(self.of_vertices.len() + self.of_corners.len());
        for (mut channel, added) in self.of_vertices.into_iter().zip(self.added) {
            let missing = welded.len() - added + complete(&mut channel, welded.len());
            warnings.extend(Warning::partial(channel.name(), missing));
            let bits = |i: usize| channel.row(i).iter().map(|x| x.to_bits());
            let mut used = welded
                .iter()
                .enumerate()
                .filter(|(_, vertex)| **vertex != NONE);
            let is_unique = channel.domain() == Domain::Vertex
                && used.all(|(i, &vertex)| bits(i).eq(bits(firsts[vertex as usize])));
            out.push(if is_unique {
                channel.gather(firsts.iter().copied())
            } else {
                let corners = corners.iter().map(|corner| corner.position as usize);
                channel.gather(corners).with_domain(Domain::Corner)
            });
        }
        for mut channel in self.of_corners {
            // Corners without a row have the one after the last.
            let without = corners.iter().filter(|corner| corner.row == NONE).count();
            let missing = without + complete(&mut channel, self.corner_rows + 1);
            warnings.extend(Warning::partial(channel.name(), missing));
            let rows = corners.iter().map(|corner| corner.row as usize);
            out.push(channel.gather(rows.map(|row| row.min(self.corner_rows))));
        }
        out
    }
}

fn has_name(channels: &[Channel], name: &str) -> bool {
    channels.iter().any(|channel| channel.name() == name)
}

fn find_or_add(
    channels: &mut Vec<Channel>,
    name: &str,
    domain: Domain,
    blend: Blend,
    width: usize,
) -> Option<usize> {
    let new = Channel::new(name, domain, blend, width, Vec::new()).ok()?;
    match channels.iter().position(|channel| channel.name() == name) {
        Some(at) => channels[at].is_like(&new).then_some(at),
        None if channels.len() == MAX_CHANNELS => None,
        None => {
            channels.push(new);
            Some(channels.len() - 1)
        }
    }
}

/// Adds missing rows, makes rows neutral whose values are not finite, and returns their number.
fn complete(channel: &mut Channel, rows: usize) -> usize {
    channel.fit_neutral(rows);
    let (neutral, width) = (channel.neutral_row(), channel.width());
    let mut replaced = 0;
    for row in channel.values.chunks_exact_mut(width) {
        if row.iter().any(|x| !x.is_finite()) {
            row.copy_from_slice(&neutral[..width]);
            replaced += 1;
        }
    }
    replaced
}
