//! Contacts of vertices with triangles of the same body and with planes.
//!
//! The caller detects contacts once a frame. During the frame the vertex stays on its side of a
//! plane through the nearest point of the triangle. Contacts are colored again whenever they are
//! set.

use crate::constraints::coloring::{MAX_COLORS, VertexColors};
use crate::error::ConstraintError;
use incise_mesh::VertexId;

/// A contact between a vertex and a triangle of the same body, or a plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// The vertex.
    pub vertex: VertexId,
    /// The triangle or plane.
    pub target: ContactTarget,
    /// Unit normal from the target to the vertex's side.
    pub normal: [f32; 3],
    /// Minimum distance from the target along the normal at the start of the frame \[m\].
    pub gap: f32,
    /// Rate at which the minimum distance grows [m/s]; it becomes velocity.
    pub gap_rate: f32,
}

/// The object that a contact separates its vertex from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ContactTarget {
    /// A point of a triangle of the same body. It moves by its inverse mass, with friction.
    Triangle {
        /// Corners; the vertex must not be one of them.
        corners: [VertexId; 3],
        /// Barycentric coordinates of the point.
        weights: [f32; 3],
    },
    /// A plane perpendicular to the normal, of infinite mass, with friction as if it did not slide.
    Plane {
        /// Distance from the origin along the normal at the start of the frame \[m\].
        height: f32,
    },
}

impl Contact {
    /// Checks the numbers of the contact and that `is_used` holds for its vertices.
    ///
    /// # Errors
    /// [`ConstraintError::UnknownVertex`], [`ConstraintError::BadContact`].
    pub(crate) fn check(&self, is_used: impl Fn(VertexId) -> bool) -> Result<(), ConstraintError> {
        let mut vertices = self.vertices().into_iter().flatten();
        if let Some(vertex) = vertices.find(|&v| !is_used(v)) {
            return Err(ConstraintError::UnknownVertex { vertex });
        }
        if !self.is_valid() {
            let vertex = self.vertex;
            return Err(ConstraintError::BadContact { vertex });
        }
        Ok(())
    }

    /// Returns the vertices that it moves: its own, then those of the triangle.
    fn vertices(&self) -> [Option<VertexId>; 4] {
        match self.target {
            ContactTarget::Triangle {
                corners: [a, b, c], ..
            } => [self.vertex, a, b, c].map(Some),
            ContactTarget::Plane { .. } => [Some(self.vertex), None, None, None],
        }
    }

    fn is_valid(&self) -> bool {
        let is_one = |sum: f32| (sum - 1.0).abs() <= TOLERANCE;
        let is_target_valid = match self.target {
            ContactTarget::Triangle { corners, weights } => {
                !corners.contains(&self.vertex)
                    && weights.iter().all(|&w| w >= -TOLERANCE)
                    && is_one(weights.iter().sum())
            }
            ContactTarget::Plane { height } => height.is_finite(),
        };
        let square = self.normal.iter().map(|n| n * n).sum();
        is_target_valid && is_one(square) && self.gap.is_finite() && self.gap_rate.is_finite()
    }
}

/// Tolerance of the sum of weights and of the length of normals, which are rounded.
const TOLERANCE: f32 = 1e-3;

/// A contact as the kernels on the CPU and on the GPU read it.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[cfg_attr(feature = "gpu", derive(bytemuck::Pod, bytemuck::Zeroable))]
pub(crate) struct ContactRecord {
    /// The vertex, then the corners of the triangle, or [`NO_CORNER`] for a plane.
    pub(crate) vertices: [u32; 4],
    /// Weights of the second and third corner; all three sum to 1.
    pub(crate) weights: [f32; 2],
    pub(crate) gap_rate: f32,
    pub(crate) normal: [f32; 3],
    pub(crate) gap: f32,
    /// Remaining friction bound of the substep \[m\].
    pub(crate) friction_left: f32,
}

impl ContactRecord {
    /// Returns the vertices that it moves, and their number.
    fn moved(&self) -> ([VertexId; 4], usize) {
        let count = if self.vertices[1] == NO_CORNER { 1 } else { 4 };
        (self.vertices.map(VertexId), count)
    }
}

/// Corner index of a contact with a plane.
pub(crate) const NO_CORNER: u32 = u32::MAX;

/// The contacts of a frame by color.
#[derive(Debug, Clone)]
pub struct ContactSet {
    /// One list per color; the last one, [`UNCOLORED`], is projected serially.
    pub(crate) colors: Vec<Vec<ContactRecord>>,
    masks: VertexColors,
    generation: u64,
}

/// Index of the list of contacts that found no free color.
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

    /// Returns a number that changes whenever contacts are set.
    #[cfg(feature = "gpu")]
    pub(crate) fn generation(&self) -> u64 {
        self.generation
    }

    pub(crate) fn capacity(&self) -> usize {
        self.colors.iter().map(Vec::capacity).sum()
    }

    /// Resets the friction bounds at the start of a substep.
    pub(crate) fn reset_friction(&mut self) {
        for contact in self.colors.iter_mut().flatten() {
            contact.friction_left = 0.0;
        }
    }

    /// Replaces the contacts. They must be valid.
    pub(crate) fn set(&mut self, contacts: &[Contact], vertex_slots: usize) {
        self.clear();
        self.masks.resize(vertex_slots);
        self.colors.resize_with(UNCOLORED + 1, Vec::new);
        for contact in contacts {
            let (weights, offset) = match contact.target {
                ContactTarget::Triangle { weights, .. } => ([weights[1], weights[2]], 0.0),
                ContactTarget::Plane { height } => ([0.0; 2], height),
            };
            let record = ContactRecord {
                vertices: contact.vertices().map(|v| v.map_or(NO_CORNER, |v| v.0)),
                weights,
                gap_rate: contact.gap_rate,
                normal: contact.normal,
                gap: offset + contact.gap,
                friction_left: 0.0,
            };
            let (ids, count) = record.moved();
            let color = self.masks.claim(0, &ids[..count]).unwrap_or(UNCOLORED);
            self.colors[color].push(record);
        }
    }

    /// Removes all contacts.
    pub(crate) fn clear(&mut self) {
        self.generation += 1;
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
    use crate::material::Material;
    use crate::solver::Solver;
    use incise_models::{Model, build_model};

    #[test]
    fn invalid_contacts_are_refused() {
        let mut surface = build_model(Model::Sphere80);
        let mut solver = Solver::new(&mut surface, &Material::default()).unwrap();
        let corners = [1, 2, 3].map(VertexId);
        let target = |weights| ContactTarget::Triangle { corners, weights };
        let valid = Contact {
            vertex: VertexId(0),
            target: target([0.5, 0.25, 0.25]),
            normal: [0.6, 0.0, 0.8],
            gap: 0.1,
            gap_rate: 0.0,
        };
        let plane = Contact {
            target: ContactTarget::Plane { height: 1.0 },
            ..valid
        };
        solver.set_contacts(&[valid, plane]).unwrap();
        let bad = [
            Contact {
                vertex: VertexId(2),
                ..valid
            },
            Contact {
                target: target([0.5, 0.5, 0.5]),
                ..valid
            },
            Contact {
                target: target([1.5, -0.5, 0.0]),
                ..valid
            },
            Contact {
                target: target([f32::NAN, 0.5, 0.5]),
                ..valid
            },
            Contact {
                target: ContactTarget::Plane {
                    height: f32::INFINITY,
                },
                ..valid
            },
            Contact {
                normal: [0.6, 0.0, 0.7],
                ..plane
            },
            Contact {
                normal: [f32::NAN, 0.0, 1.0],
                ..valid
            },
            Contact {
                gap: f32::NAN,
                ..plane
            },
            Contact {
                gap_rate: f32::INFINITY,
                ..valid
            },
        ];
        for contact in bad {
            let refused = solver.set_contacts(&[valid, contact]);
            let vertex = contact.vertex;
            assert_eq!(refused, Err(ConstraintError::BadContact { vertex }));
            assert_eq!(solver.contacts().len(), 2, "nothing is changed");
        }
    }

    #[test]
    fn contacts_of_a_color_share_no_vertex_and_clear_frees_colors() {
        let mut set = ContactSet::default();
        // All contacts share a vertex, and there are more of them than colors.
        let contact = |i: u32| Contact {
            vertex: VertexId(0),
            target: ContactTarget::Triangle {
                corners: [i, i + 1, i + 2].map(VertexId),
                weights: [1.0, 0.0, 0.0],
            },
            normal: [0.0, 1.0, 0.0],
            gap: 0.0,
            gap_rate: 0.0,
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
