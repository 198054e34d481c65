//! [`ContactSet`]: the contacts of a frame by color, as the kernels read them.

#[cfg(feature = "serde")]
mod load;

use super::{Contact, FrictionAnchor, LoadRatio, SupportedSide};
use crate::constraints::coloring::{MAX_COLORS, VertexColors};
use incise_mesh::VertexId;

/// A contact as the kernels on the CPU and on the GPU read it.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[cfg_attr(feature = "gpu", derive(bytemuck::Pod, bytemuck::Zeroable))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct ContactRecord {
    /// The vertices; of a plane one vertex, then [`NO_VERTEX`].
    pub(crate) vertices: [u32; 4],
    /// Weights of the vertices, -1 to 1; those of a pair sum to zero.
    pub(crate) weights: [f32; 4],
    pub(crate) normal: [f32; 3],
    /// Distance that the substep keeps \[m\]; of a plane at the start of the frame.
    pub(crate) gap: f32,
    /// Rate at which the distance of a plane grows [m/s].
    pub(crate) gap_rate: f32,
    pub(crate) friction: f32,
    /// Minimum distance of a pair \[m\].
    pub(crate) thickness: f32,
    /// A [`ContactKind`](super::ContactKind).
    pub(crate) kind: u16,
    /// A [`SupportedSide`].
    pub(crate) carried: u16,
    /// Whether the last projection has separated the features.
    pub(crate) is_active: u32,
    /// Maximum sum of the corrections by friction in the substep \[m\].
    ///
    /// If it is positive at the start of the next one, friction has held the features; of contacts
    /// that are set as held it is 1.
    pub(crate) friction_bound: f32,
    /// Sum of the corrections by friction in the substep \[m\].
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) friction_sum: [f32; 3],
    /// Vector between the features of a pair as their last active projection left it \[m\].
    pub(crate) held_at: [f32; 3],
    /// Change of that vector by the rest of the last substep, which friction takes back \[m\].
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) drift: [f32; 3],
    /// Fills the last entry of the GPU's record.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) pad: u32,
}

impl ContactRecord {
    /// Returns the number of vertices: four, or one for a plane.
    #[inline(always)]
    pub(crate) fn vertex_count(&self) -> usize {
        if self.vertices[1] == NO_VERTEX { 1 } else { 4 }
    }

    /// Returns whether a vertex belongs to the carried feature, by the sign of its weight.
    #[inline(always)]
    pub(crate) fn is_carried(&self, weight: f32) -> bool {
        (self.carried == SupportedSide::First as u16 && weight > 0.0)
            || (self.carried == SupportedSide::Second as u16 && weight < 0.0)
    }

    /// Returns the vertices that it moves, and their number.
    fn moved(&self) -> ([VertexId; 4], usize) {
        (self.vertices.map(VertexId), self.vertex_count())
    }
}

/// Index of the vertices that a contact with a plane does not have.
pub(crate) const NO_VERTEX: u32 = VertexId::NULL.0;

/// The contacts of a frame by color.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ContactSet {
    /// One list per color; the last one, [`UNCOLORED`], is projected serially.
    pub(crate) colors: Vec<Vec<ContactRecord>>,
    #[cfg_attr(feature = "serde", serde(skip))]
    masks: VertexColors,
    press: LoadRatio,
    #[cfg_attr(feature = "serde", serde(skip))]
    generation: u64,
}

/// Index of the list of contacts that found no free color.
pub(crate) const UNCOLORED: usize = MAX_COLORS;

impl Default for ContactSet {
    fn default() -> Self {
        Self {
            colors: Vec::new(),
            masks: VertexColors::new(0),
            press: LoadRatio::NONE,
            generation: 0,
        }
    }
}

impl ContactSet {
    /// Returns the number of contacts.
    #[must_use]
    pub fn len(&self) -> usize {
        self.colors.iter().map(Vec::len).sum()
    }

    /// Returns true if there are no contacts.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.colors.iter().all(Vec::is_empty)
    }

    /// Returns the maxima of [`Contact::press`].
    pub(crate) fn press(&self) -> LoadRatio {
        self.press
    }

    /// Returns a number that changes whenever contacts are set.
    #[cfg(feature = "gpu")]
    pub(crate) fn generation(&self) -> u64 {
        self.generation
    }

    /// Returns the vertices of each pair that friction has held in the last substep, and where.
    ///
    /// A GPU returns this with the positions.
    pub fn held(&self) -> impl Iterator<Item = ([VertexId; 4], FrictionAnchor)> {
        let pairs = self.colors.iter().flatten();
        let held = pairs.filter(|pair| pair.friction_bound > 0.0 && pair.vertex_count() == 4);
        held.map(|pair| {
            let (weights, at) = (pair.weights, pair.held_at);
            (pair.vertices.map(VertexId), FrictionAnchor { weights, at })
        })
    }

    pub(crate) fn capacity(&self) -> usize {
        self.colors.iter().map(Vec::capacity).sum()
    }

    /// Replaces the contacts. They must be valid.
    pub(crate) fn set(&mut self, contacts: &[Contact], vertex_slots: usize) {
        self.clear();
        if self.masks.masks().is_empty() {
            self.masks = VertexColors::new(1);
        }
        self.masks.resize(vertex_slots);
        self.colors.resize_with(UNCOLORED + 1, Vec::new);
        for contact in contacts {
            self.press = self.press.max(contact.press);
            let held = contact.held.unwrap_or(FrictionAnchor {
                weights: [1.0, 0.0, 0.0, 0.0],
                at: [0.0; 3],
            });
            let record = ContactRecord {
                vertices: contact.vertices.map(|v| v.0),
                weights: held.weights,
                normal: contact.normal,
                gap: contact.gap,
                gap_rate: contact.gap_rate,
                friction: contact.friction,
                thickness: contact.gap,
                kind: contact.kind as u16,
                carried: contact.carried as u16,
                is_active: 0,
                friction_bound: if contact.held.is_some() { 1.0 } else { 0.0 },
                friction_sum: [0.0; 3],
                held_at: held.at,
                drift: [0.0; 3],
                pad: 0,
            };
            let (ids, count) = record.moved();
            let color = self.masks.claim(0, &ids[..count]).unwrap_or(UNCOLORED);
            self.colors[color].push(record);
        }
    }

    /// Removes all contacts.
    pub(crate) fn clear(&mut self) {
        self.generation += 1;
        self.press = LoadRatio::NONE;
        for (color, contacts) in self.colors.iter_mut().enumerate() {
            for contact in contacts.drain(..).filter(|_| color < UNCOLORED) {
                let (ids, count) = contact.moved();
                self.masks.release(&ids[..count], color);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contacts_of_a_color_share_no_vertex_and_clear_frees_colors() {
        let mut set = ContactSet::default();
        // All contacts share a vertex, and there are more of them than colors.
        let contact = |i: u32| {
            let corners = [i, i + 1, i + 2].map(VertexId);
            Contact::vertex_face(VertexId(0), corners, 0.1)
        };
        let contacts: Vec<Contact> = (1..100).map(contact).collect();
        for _ in 0..3 {
            set.set(&contacts, 200);
            assert_eq!(set.len(), 99);
            assert_eq!(set.colors[UNCOLORED].len(), 99 - MAX_COLORS);
            for color in &set.colors[..UNCOLORED] {
                assert_eq!(color.len(), 1);
            }
        }
        set.clear();
        assert!(set.is_empty());
        assert!(set.masks.masks()[0].iter().all(|&mask| mask == 0));
    }
}
