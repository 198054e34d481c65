//! Named channels of values per vertex or per corner: colors, skin weights, vertex groups.

use super::Surface;
use std::sync::Arc;

/// The elements of a surface that have a row of a channel each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Domain {
    /// Vertices: one row per vertex slot.
    Vertex,
    /// Corners of triangles: three rows per triangle slot, in the order of half-edges.
    Corner,
}

/// The rule by which the rows of a channel are interpolated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Blend {
    /// The weighted mean of each component, which lies between the parents' values.
    Linear,
    /// Joints and their weights: the first half of a row numbers joints, the second half has the
    /// weight of each.
    ///
    /// Weights of equal joints are added, the largest ones are kept in descending order, and their
    /// sum is 1.
    Skin,
}

/// A named array of rows of `f32` values, one row per vertex or corner slot.
///
/// Edits interpolate the rows of new vertices and corners, and undo restores them bit for bit. The
/// meaning of a name is up to the caller; readers of files use `color`, `skin` and `uv1`.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Channel {
    name: Arc<str>,
    domain: Domain,
    blend: Blend,
    width: usize,
    pub(crate) values: Vec<f32>,
}

/// The error of a channel that does not fit itself or the surface.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ChannelError {
    /// The width is not allowed.
    #[error(
        "channel {name}: rows of {width} values; pass 1 to {MAX_WIDTH}, for skin weights 2, 4, 6 \
         or 8"
    )]
    Width {
        /// The channel.
        name: Arc<str>,
        /// Its width.
        width: usize,
    },
    /// The array has another length than the surface needs.
    #[error("channel {name}: {found} values; the surface needs {expected}, one row per slot")]
    Length {
        /// The channel.
        name: Arc<str>,
        /// Number of slots times width.
        expected: usize,
        /// Length of the array.
        found: usize,
    },
    /// Two surfaces have channels of one name with different domains, rules or widths.
    #[error("channel {name} is of another kind on the other surface; rename or remove one")]
    Mismatch {
        /// The channel.
        name: Arc<str>,
    },
    /// Two channels of a loaded surface have one name.
    #[error("there are two channels {name}")]
    Repeated {
        /// The channels.
        name: Arc<str>,
    },
}

/// Maximum number of values in a row.
pub const MAX_WIDTH: usize = 16;
/// Maximum number of values in a row of skin weights: four joints and four weights.
const MAX_SKIN_WIDTH: usize = 8;

/// A row on the stack; the values beyond a channel's width are 0.
pub(crate) type Row = [f32; MAX_WIDTH];

impl Channel {
    /// Creates a channel with `width` values per row.
    ///
    /// # Errors
    /// [`ChannelError::Width`].
    pub fn new(
        name: impl Into<Arc<str>>,
        domain: Domain,
        blend: Blend,
        width: usize,
        values: Vec<f32>,
    ) -> Result<Self, ChannelError> {
        let channel = Self {
            name: name.into(),
            domain,
            blend,
            width,
            values,
        };
        channel.check_width()?;
        Ok(channel)
    }

    /// Checks the width.
    ///
    /// # Errors
    /// [`ChannelError::Width`].
    pub(crate) fn check_width(&self) -> Result<(), ChannelError> {
        let width = self.width;
        let is_allowed = match self.blend {
            Blend::Linear => (1..=MAX_WIDTH).contains(&width),
            Blend::Skin => (2..=MAX_SKIN_WIDTH).contains(&width) && width.is_multiple_of(2),
        };
        if is_allowed {
            Ok(())
        } else {
            let name = self.name.clone();
            Err(ChannelError::Width { name, width })
        }
    }

    /// Returns the name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the elements with a row each.
    #[must_use]
    pub fn domain(&self) -> Domain {
        self.domain
    }

    /// Returns the rule of interpolation.
    #[must_use]
    pub fn blend(&self) -> Blend {
        self.blend
    }

    /// Returns the number of values in a row.
    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    /// Returns all values, shape \[slots x width\].
    #[must_use]
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// Returns [`Self::values`] for writing.
    #[must_use]
    pub fn values_mut(&mut self) -> &mut [f32] {
        &mut self.values
    }

    /// Returns the row of a vertex or corner; empty beyond the array.
    #[must_use]
    pub fn row(&self, slot: usize) -> &[f32] {
        let first = slot.saturating_mul(self.width);
        let row = first..first.saturating_add(self.width);
        self.values.get(row).unwrap_or_default()
    }

    /// Returns whether both have the same name, domain, rule and width.
    pub(crate) fn is_like(&self, other: &Self) -> bool {
        self.name == other.name
            && self.domain == other.domain
            && self.blend == other.blend
            && self.width == other.width
    }

    /// Returns a channel like this one with other values.
    pub(crate) fn with_values(&self, values: Vec<f32>) -> Self {
        Self {
            name: self.name.clone(),
            values,
            ..*self
        }
    }

    /// Returns the channel with rows for other elements.
    #[cfg(feature = "io")]
    pub(crate) fn with_domain(self, domain: Domain) -> Self {
        Self { domain, ..self }
    }

    /// Sets a row.
    pub(crate) fn set_row(&mut self, slot: usize, row: &[f32]) {
        self.values[slot * self.width..][..self.width].copy_from_slice(row);
    }

    /// Returns a copy of a row; zeros beyond the array.
    pub(crate) fn copy_row(&self, slot: usize) -> Row {
        let mut out = Row::default();
        let row = self.row(slot);
        out[..row.len()].copy_from_slice(row);
        out
    }

    /// Extends the array by rows of zeros.
    pub(crate) fn fit(&mut self, slots: usize) {
        self.values.resize(slots * self.width, 0.0);
    }

    /// Returns the default row of a vertex or corner without a value.
    ///
    /// Colors are opaque white, skin weights are joint 0 with weight 1, all others are 0.
    pub(crate) fn neutral_row(&self) -> Row {
        let mut out = Row::default();
        let number = self.name.strip_prefix("color");
        let is_color = number.is_some_and(|n| n.bytes().all(|b| b.is_ascii_digit()));
        match self.blend {
            Blend::Skin => out[self.width / 2] = 1.0,
            Blend::Linear if is_color && (3..=4).contains(&self.width) => out.fill(1.0),
            Blend::Linear => {}
        }
        out
    }

    /// Extends the array by neutral rows, to `slots` rows.
    pub(crate) fn fit_neutral(&mut self, slots: usize) {
        let neutral = self.neutral_row();
        let missing = slots.saturating_sub(self.values.len() / self.width);
        self.values.reserve(missing * self.width);
        for _ in 0..missing {
            self.values.extend_from_slice(&neutral[..self.width]);
        }
    }

    /// Returns the channel with the rows of `slots`, in their order.
    pub(crate) fn gather(&self, slots: impl Iterator<Item = usize>) -> Self {
        let mut values = Vec::with_capacity(slots.size_hint().0 * self.width);
        slots.for_each(|slot| values.extend_from_slice(&self.copy_row(slot)[..self.width]));
        self.with_values(values)
    }
}

impl Blend {
    /// Returns the interpolation of `rows` of `width` values, whose weights sum to 1.
    ///
    /// A row with the weight 1 is returned bit for bit.
    pub(crate) fn rows<const N: usize>(self, width: usize, rows: [(Row, f64); N]) -> Row {
        if let Some((row, _)) = rows.iter().find(|(_, weight)| *weight == 1.0) {
            return *row;
        }
        match self {
            Self::Linear => mean(width, &rows),
            Self::Skin => merged(width / 2, &rows),
        }
    }
}

/// Returns the weighted mean of each component, between the smallest and the largest value.
#[expect(clippy::cast_possible_truncation, reason = "rounded once to storage")]
fn mean(width: usize, rows: &[(Row, f64)]) -> Row {
    let mut out = Row::default();
    for (k, value) in out.iter_mut().take(width).enumerate() {
        let used = || rows.iter().filter(|(_, weight)| *weight != 0.0);
        let sum: f64 = used().map(|(row, weight)| weight * f64::from(row[k])).sum();
        let smallest = used().map(|(row, _)| row[k]).fold(f32::INFINITY, f32::min);
        let largest = used()
            .map(|(row, _)| row[k])
            .fold(f32::NEG_INFINITY, f32::max);
        *value = (sum as f32).min(largest).max(smallest);
    }
    out
}

/// Returns the largest weights of joints, normalized, in descending order.
#[expect(clippy::cast_possible_truncation, reason = "rounded once to storage")]
fn merged(joints: usize, rows: &[(Row, f64)]) -> Row {
    let mut found = smallvec::SmallVec::<[(f32, f64); 3 * MAX_SKIN_WIDTH / 2]>::new();
    for (row, share) in rows {
        for (&joint, &weight) in row[..joints].iter().zip(&row[joints..2 * joints]) {
            let weight = share * f64::from(weight);
            match found.iter_mut().find(|entry| entry.0 == joint) {
                Some(entry) => entry.1 += weight,
                None => found.push((joint, weight)),
            }
        }
    }
    found.retain(|entry| entry.1 > 0.0);
    found.sort_unstable_by(|a, b| b.1.total_cmp(&a.1).then(a.0.total_cmp(&b.0)));
    found.truncate(joints);
    let sum: f64 = found.iter().map(|entry| entry.1).sum();
    let mut out = Row::default();
    for (k, &(joint, weight)) in found.iter().enumerate() {
        out[k] = joint;
        out[joints + k] = (weight / sum) as f32;
    }
    out
}

impl Surface {
    /// Returns the channels in the order in which they were added.
    #[must_use]
    pub fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// Returns the channel of this name.
    #[must_use]
    pub fn channel(&self, name: &str) -> Option<&Channel> {
        self.channels.iter().find(|c| c.name() == name)
    }

    /// Returns the channel of this name for writing.
    #[must_use]
    pub fn channel_mut(&mut self, name: &str) -> Option<&mut Channel> {
        self.channels.iter_mut().find(|c| c.name() == name)
    }

    /// Adds a channel, or replaces the one of its name.
    ///
    /// # Errors
    /// [`ChannelError::Length`] unless it has a row for each slot; nothing changes then.
    pub fn set_channel(&mut self, channel: Channel) -> Result<(), ChannelError> {
        let (expected, found) = (
            self.slots(channel.domain) * channel.width,
            channel.values.len(),
        );
        if found != expected {
            return Err(ChannelError::Length {
                name: channel.name,
                expected,
                found,
            });
        }
        match self.channel_mut(&channel.name) {
            Some(old) => *old = channel,
            None => self.channels.push(channel),
        }
        Ok(())
    }

    /// Removes and returns the channel of this name.
    pub fn remove_channel(&mut self, name: &str) -> Option<Channel> {
        let at = self.channels.iter().position(|c| c.name() == name)?;
        Some(self.channels.remove(at))
    }

    /// Returns the number of rows that a channel needs.
    pub(crate) fn slots(&self, domain: Domain) -> usize {
        match domain {
            Domain::Vertex => self.topology.vertex_slots(),
            Domain::Corner => 3 * self.topology.triangle_slots(),
        }
    }

    /// Sets the rows of a slot to zeros, and adds rows for new slots.
    pub(super) fn clear_rows(&mut self, domain: Domain, slot: usize) {
        for channel in self.channels.iter_mut().filter(|c| c.domain == domain) {
            let first = slot * channel.width;
            if first < channel.values.len() {
                channel.values[first..first + channel.width].fill(0.0);
            } else {
                channel.fit(slot + 1);
            }
        }
    }

    /// Iterates over the channels with a row per corner.
    pub(crate) fn corner_channels(&self) -> impl Iterator<Item = &Channel> {
        let is_corner = |c: &&Channel| c.domain == Domain::Corner;
        self.channels.iter().filter(is_corner)
    }
}

#[cfg(test)]
mod tests;
