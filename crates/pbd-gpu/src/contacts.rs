//! Contacts: vertices that must not come through triangles of the same body.
//!
//! A contact holds for a frame: whoever can search the surface finds where a vertex is nearest to a triangle, and from then
//! on the vertex stays on its side of a plane that goes with that point of the triangle. There are as many as
//! there is touching, so they are colored anew whenever they are set.

use crate::coloring::{MAX_COLORS, VertexColors};
use crate::error::ConstraintError;
use crate::solver::Solver;
use incise_mesh::VertexId;

/// A vertex above a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// The vertex.
    pub vertex: VertexId,
    /// The corners of the triangle; the vertex is none of them.
    pub corners: [VertexId; 3],
    /// What they weigh at the point that the vertex is above, 0 to 1; they sum to 1.
    pub weights: [f32; 3],
    /// The way out: a unit vector.
    pub normal: [f32; 3],
    /// How far along the normal the vertex stays from that point at the beginning of the frame \[m\].
    pub gap: f32,
    /// How fast that grows, where the two are to part [m/s]. What it does to them is that velocity.
    pub rise: f32,
}

/// A contact as kernels read it, on the processor and on a device.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[cfg_attr(feature = "gpu", derive(bytemuck::Pod, bytemuck::Zeroable))]
pub(crate) struct ContactRecord {
    /// The vertex, then the triangle's corners.
    pub(crate) vertices: [u32; 4],
    /// Of the second and the third corner; the first one has what is left of 1.
    pub(crate) weights: [f32; 2],
    pub(crate) rise: f32,
    pub(crate) normal: [f32; 3],
    pub(crate) gap: f32,
    /// What friction has left of the substep \[m\].
    pub(crate) held: f32,
}

/// The contacts of a frame, by color.
#[derive(Debug, Clone)]
pub struct ContactSet {
    /// One list a color; the last one is of those that found none, to be projected one by one.
    pub(crate) colors: Vec<Vec<ContactRecord>>,
    masks: VertexColors,
    generation: u64,
}

/// The number of the list of contacts without a color.
pub(crate) const UNCOLORED: usize = MAX_COLORS;

impl Default for ContactSet {
    fn default() -> Self {
        Self {
            colors: Vec::new(),
            masks: VertexColors::new(1),
            generation: 0,
        }
    }
}

impl ContactSet {
    /// How many there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.colors.iter().map(Vec::len).sum()
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.colors.iter().all(Vec::is_empty)
    }

    /// How often they were set.
    #[cfg(feature = "gpu")]
    pub(crate) fn generation(&self) -> u64 {
        self.generation
    }

    pub(crate) fn capacity(&self) -> usize {
        self.colors.iter().map(Vec::capacity).sum()
    }

    /// Forgets what friction had left.
    pub(crate) fn reset(&mut self) {
        for contact in self.colors.iter_mut().flatten() {
            contact.held = 0.0;
        }
    }

    /// Takes other contacts; a vertex's colors are given back before.
    fn set(&mut self, contacts: &[Contact], vertex_slots: usize) {
        self.clear();
        self.masks.resize(vertex_slots);
        self.colors.resize_with(UNCOLORED + 1, Vec::new);
        for contact in contacts {
            let [a, b, c] = contact.corners;
            let vertices = [contact.vertex, a, b, c];
            let color = self.masks.claim(0, &vertices).unwrap_or(UNCOLORED);
            self.colors[color].push(ContactRecord {
                vertices: vertices.map(|v| v.0),
                weights: [contact.weights[1], contact.weights[2]],
                rise: contact.rise,
                normal: contact.normal,
                gap: contact.gap,
                held: 0.0,
            });
        }
    }

    /// Has none any more.
    pub(crate) fn clear(&mut self) {
        self.generation += 1;
        for (color, contacts) in self.colors.iter_mut().enumerate() {
            for contact in contacts.drain(..).filter(|_| color < UNCOLORED) {
                self.masks.release(&contact.vertices.map(VertexId), color);
            }
        }
    }
}

impl Solver {
    /// The contacts that the next frame has.
    #[must_use]
    pub fn contacts(&self) -> &ContactSet {
        &self.contacts
    }

    /// Sets the contacts of the frames to come, in place of those before. An edit takes all of them.
    ///
    /// # Errors
    /// [`ConstraintError::UnknownVertex`], [`ConstraintError::NonFiniteValue`]; nothing is changed then.
    pub fn set_contacts(&mut self, contacts: &[Contact]) -> Result<(), ConstraintError> {
        for contact in contacts {
            let mut vertices = contact.corners.iter().chain([&contact.vertex]);
            if let Some(&vertex) = vertices.find(|&&v| !self.is_vertex(v)) {
                return Err(ConstraintError::UnknownVertex { vertex });
            }
            let plane = [contact.gap, contact.rise];
            let mut numbers = (contact.weights.iter().chain(&contact.normal)).chain(&plane);
            if !numbers.all(|n| n.is_finite()) {
                let vertex = contact.vertex;
                return Err(ConstraintError::NonFiniteValue { vertex });
            }
        }
        if contacts.is_empty() && self.contacts.is_empty() {
            return Ok(());
        }
        self.contacts.set(contacts, self.mass.len());
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contacts_of_a_color_share_no_vertex_and_colors_come_back() {
        let mut set = ContactSet::default();
        // All over one vertex: more than there are colors.
        let contact = |i: u32| Contact {
            vertex: VertexId(0),
            corners: [i, i + 1, i + 2].map(VertexId),
            weights: [1.0, 0.0, 0.0],
            normal: [0.0, 1.0, 0.0],
            gap: 0.0,
            rise: 0.0,
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
