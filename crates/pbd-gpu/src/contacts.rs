//! Contacts: vertices that must not come through triangles of the same body, or through planes.
//!
//! A contact holds for a frame: whoever can search the surface finds where a vertex is nearest to a triangle, and from then
//! on the vertex stays on its side of a plane that goes with that point of the triangle. There are as many as
//! there is touching, so they are colored anew whenever they are set.

use crate::coloring::{MAX_COLORS, VertexColors};
use crate::error::ConstraintError;
use crate::solver::Solver;
use incise_mesh::VertexId;

/// A vertex above something.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// The vertex.
    pub vertex: VertexId,
    /// What it is above.
    pub above: Above,
    /// The way out: a unit vector.
    pub normal: [f32; 3],
    /// How far along the normal the vertex stays from what it is above at the beginning of the frame \[m\].
    pub gap: f32,
    /// How fast that grows, where the two are to part [m/s]. What it does to them is that velocity.
    pub rise: f32,
}

/// What a contact keeps its vertex above.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Above {
    /// A point of a triangle of the same body, which gives way by its mass and rubs.
    Triangle {
        /// The corners; the vertex is none of them.
        corners: [VertexId; 3],
        /// What they weigh at the point, 0 to 1; they sum to 1.
        weights: [f32; 3],
    },
    /// A plane at right angles to the normal that nothing moves; it rubs as if it did not move along itself.
    Plane {
        /// How far along the normal it is from the origin at the beginning of the frame \[m\].
        height: f32,
    },
}

impl Contact {
    /// The vertices that it moves: its own, then the triangle's.
    fn vertices(&self) -> [Option<VertexId>; 4] {
        match self.above {
            Above::Triangle {
                corners: [a, b, c], ..
            } => [self.vertex, a, b, c].map(Some),
            Above::Plane { .. } => [Some(self.vertex), None, None, None],
        }
    }

    fn is_sound(&self) -> bool {
        let off = |sum: f32| (sum - 1.0).abs() <= SLACK;
        let is_on = match self.above {
            Above::Triangle { corners, weights } => {
                !corners.contains(&self.vertex)
                    && weights.iter().all(|&w| w >= -SLACK)
                    && off(weights.iter().sum())
            }
            Above::Plane { height } => height.is_finite(),
        };
        let square = self.normal.iter().map(|n| n * n).sum();
        is_on && off(square) && self.gap.is_finite() && self.rise.is_finite()
    }
}

/// How far weights and normals may be from what they are to be: they were rounded.
const SLACK: f32 = 1e-3;

/// A contact as kernels read it, on the processor and on a device.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[cfg_attr(feature = "gpu", derive(bytemuck::Pod, bytemuck::Zeroable))]
pub(crate) struct ContactRecord {
    /// The vertex, then the triangle's corners, or [`NO_CORNER`] for a plane.
    pub(crate) vertices: [u32; 4],
    /// Of the second and the third corner; the first one has what is left of 1.
    pub(crate) weights: [f32; 2],
    pub(crate) rise: f32,
    pub(crate) normal: [f32; 3],
    pub(crate) gap: f32,
    /// What friction has left of the substep \[m\].
    pub(crate) held: f32,
}

impl ContactRecord {
    /// The vertices that it moves, the first so many.
    fn moved(&self) -> ([VertexId; 4], usize) {
        let count = if self.vertices[1] == NO_CORNER { 1 } else { 4 };
        (self.vertices.map(VertexId), count)
    }
}

/// The corners of a plane.
pub(crate) const NO_CORNER: u32 = u32::MAX;

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
            let (weights, base) = match contact.above {
                Above::Triangle { weights, .. } => ([weights[1], weights[2]], 0.0),
                Above::Plane { height } => ([0.0; 2], height),
            };
            let record = ContactRecord {
                vertices: contact.vertices().map(|v| v.map_or(NO_CORNER, |v| v.0)),
                weights,
                rise: contact.rise,
                normal: contact.normal,
                gap: base + contact.gap,
                held: 0.0,
            };
            let (ids, count) = record.moved();
            let color = self.masks.claim(0, &ids[..count]).unwrap_or(UNCOLORED);
            self.colors[color].push(record);
        }
    }

    /// Has none any more.
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

impl Solver {
    /// The contacts that the next frame has.
    #[must_use]
    pub fn contacts(&self) -> &ContactSet {
        &self.contacts
    }

    /// Sets the contacts of the frames to come, in place of those before. An edit takes all of them.
    ///
    /// # Errors
    /// [`ConstraintError::UnknownVertex`]; [`ConstraintError::BadContact`] for one whose vertex is a corner of its triangle, whose
    /// weights do not sum to 1, whose normal has not length 1, or that is not finite. Nothing is changed then.
    pub fn set_contacts(&mut self, contacts: &[Contact]) -> Result<(), ConstraintError> {
        for contact in contacts {
            let mut vertices = contact.vertices().into_iter().flatten();
            if let Some(vertex) = vertices.find(|&v| !self.is_vertex(v)) {
                return Err(ConstraintError::UnknownVertex { vertex });
            }
            if !contact.is_sound() {
                let vertex = contact.vertex;
                return Err(ConstraintError::BadContact { vertex });
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
    use crate::material::Material;
    use incise_mesh::{Model, build_model};

    #[test]
    fn a_contact_that_is_none_is_refused() {
        let mut surface = build_model(Model::Sphere80);
        let mut solver = Solver::new(&mut surface, &Material::default()).unwrap();
        let corners = [1, 2, 3].map(VertexId);
        let above = |weights| Above::Triangle { corners, weights };
        let sound = Contact {
            vertex: VertexId(0),
            above: above([0.5, 0.25, 0.25]),
            normal: [0.6, 0.0, 0.8],
            gap: 0.1,
            rise: 0.0,
        };
        let plane = Contact {
            above: Above::Plane { height: 1.0 },
            ..sound
        };
        solver.set_contacts(&[sound, plane]).unwrap();
        let bad = [
            Contact {
                vertex: VertexId(2),
                ..sound
            },
            Contact {
                above: above([0.5, 0.5, 0.5]),
                ..sound
            },
            Contact {
                above: above([1.5, -0.5, 0.0]),
                ..sound
            },
            Contact {
                above: above([f32::NAN, 0.5, 0.5]),
                ..sound
            },
            Contact {
                above: Above::Plane {
                    height: f32::INFINITY,
                },
                ..sound
            },
            Contact {
                normal: [0.6, 0.0, 0.7],
                ..plane
            },
            Contact {
                normal: [f32::NAN, 0.0, 1.0],
                ..sound
            },
            Contact {
                gap: f32::NAN,
                ..plane
            },
            Contact {
                rise: f32::INFINITY,
                ..sound
            },
        ];
        for contact in bad {
            let refused = solver.set_contacts(&[sound, contact]);
            let vertex = contact.vertex;
            assert_eq!(refused, Err(ConstraintError::BadContact { vertex }));
            assert_eq!(solver.contacts().len(), 2, "nothing is changed");
        }
    }

    #[test]
    fn contacts_of_a_color_share_no_vertex_and_colors_come_back() {
        let mut set = ContactSet::default();
        // All over one vertex: more than there are colors.
        let contact = |i: u32| Contact {
            vertex: VertexId(0),
            above: Above::Triangle {
                corners: [i, i + 1, i + 2].map(VertexId),
                weights: [1.0, 0.0, 0.0],
            },
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
