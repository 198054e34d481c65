//! Contacts of vertices with triangles, of edges with edges, and of vertices with planes.
//!
//! All three are one constraint: four vertices with signed weights, whose weighted sum keeps a
//! distance along a normal. The caller detects contacts once a frame; kernels find weights and
//! normals in every substep. [`ContactSet`] colors contacts again whenever they are set.

mod set;

use crate::error::ConstraintError;
use incise_mesh::VertexId;
pub use set::ContactSet;
#[cfg(any(feature = "gpu", test))]
pub(crate) use set::NO_VERTEX;
pub(crate) use set::{ContactRecord, UNCOLORED};

/// A contact: two features, or a vertex and a plane, keep a distance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// The kind of the features.
    pub kind: ContactKind,
    /// The vertices of both features; of a plane's contact one vertex, then null ones.
    pub vertices: [VertexId; 4],
    /// Unit normal from the second feature or the plane to the first feature.
    ///
    /// Between edges only its side matters, and that of a triangle is its own.
    pub normal: [f32; 3],
    /// Minimum distance \[m\]; of a plane from the origin, at the start of the frame.
    pub gap: f32,
    /// Rate at which the distance of a plane grows [m/s]; it becomes velocity. Zero for others.
    pub gap_rate: f32,
    /// Coulomb friction coefficient.
    pub friction: f32,
    /// The feature whose piece is carried by the piece of the other feature.
    pub carried: SupportedSide,
    /// How one piece presses the other; nothing unless the caller sets it.
    pub press: LoadRatio,
    /// Where friction held the features before; none for features that have not touched.
    pub held: Option<FrictionAnchor>,
}

/// How a piece presses a thinner or lighter one that it meets within the frame.
///
/// An iteration has up to 24 rounds of contacts and volumes where a number is high. In a single
/// round a thin piece between heavy ones would be pressed flat.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct LoadRatio {
    /// Mass of the pressing piece relative to the pressed one, at least 1, by the thickness
    /// `2 V / A` of the pressed one [1/m].
    pub load: f32,
    /// Speed at which the features meet times the load [1/s].
    pub closing: f32,
}

impl LoadRatio {
    /// No pressing piece.
    pub const NONE: Self = Self {
        load: 0.0,
        closing: 0.0,
    };

    /// Returns the larger one of each number.
    pub(crate) fn max(self, other: Self) -> Self {
        Self {
            load: self.load.max(other.load),
            closing: self.closing.max(other.closing),
        }
    }

    /// Returns whether both numbers are finite and not negative.
    pub(crate) fn is_valid(self) -> bool {
        [self.load, self.closing]
            .iter()
            .all(|c| c.is_finite() && *c >= 0.0)
    }
}

/// The place of a pair's features relative to each other, as friction left it in a substep.
///
/// Other constraints of that substep have moved them on. Friction takes this back in the next one.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FrictionAnchor {
    /// Weights of the vertices, -1 to 1; those of a pair sum to zero, which is not checked.
    pub weights: [f32; 4],
    /// Weighted sum of their positions: the vector from the second feature to the first one \[m\].
    pub at: [f32; 3],
}

impl FrictionAnchor {
    /// Returns whether all numbers are finite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.weights.iter().chain(&self.at).all(|c| c.is_finite())
    }
}

/// The carried feature of a contact: its piece rests on the piece of the other feature.
///
/// While the contact is active, [volume constraints](crate::Volume) do not move the vertices of
/// this feature further down. Without this, a load travels through one piece per substep, and the
/// lowest pieces of a column collapse.
///
/// Missing distances recover by raising this feature only, and faster. Otherwise stacked sheets
/// sink into each other.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[repr(u16)]
pub enum SupportedSide {
    /// No feature is carried.
    #[default]
    Neither,
    /// The first feature is carried.
    First,
    /// The second feature is carried.
    Second,
    /// The upper feature is carried, without an effect on volumes; for sheets.
    Upper,
}

/// The features of a contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u16)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ContactKind {
    /// A vertex in front of the plane of a triangle.
    VertexFace,
    /// A vertex and the nearest point of a triangle, also on its edges.
    VertexPoint,
    /// The nearest points of two edges.
    EdgeEdge,
    /// A vertex and a plane of infinite mass.
    Plane,
}

impl Contact {
    /// Creates the contact of a vertex with the plane of a facing triangle, without friction.
    ///
    /// With [`ContactKind::VertexPoint`] it keeps its distance from the triangle instead.
    #[must_use]
    pub const fn vertex_face(vertex: VertexId, [a, b, c]: [VertexId; 3], gap: f32) -> Self {
        Self {
            kind: ContactKind::VertexFace,
            vertices: [vertex, a, b, c],
            normal: [0.0, 1.0, 0.0],
            gap,
            gap_rate: 0.0,
            friction: 0.0,
            carried: SupportedSide::Neither,
            press: LoadRatio::NONE,
            held: None,
        }
    }

    /// Creates the contact of two edges, the first on the side of the normal. It has no friction.
    #[must_use]
    pub const fn edge_edge(
        [[a, b], [c, d]]: [[VertexId; 2]; 2],
        normal: [f32; 3],
        gap: f32,
    ) -> Self {
        Self {
            kind: ContactKind::EdgeEdge,
            vertices: [a, b, c, d],
            normal,
            gap,
            gap_rate: 0.0,
            friction: 0.0,
            carried: SupportedSide::Neither,
            press: LoadRatio::NONE,
            held: None,
        }
    }

    /// Creates the contact of a vertex with a plane at a distance from the origin \[m\].
    ///
    /// It has no friction.
    #[must_use]
    pub const fn plane(vertex: VertexId, normal: [f32; 3], height: f32) -> Self {
        Self {
            kind: ContactKind::Plane,
            vertices: [vertex, VertexId::NULL, VertexId::NULL, VertexId::NULL],
            normal,
            gap: height,
            gap_rate: 0.0,
            friction: 0.0,
            carried: SupportedSide::Neither,
            press: LoadRatio::NONE,
            held: None,
        }
    }

    /// Checks the numbers of the contact and that `is_used` holds for its vertices.
    ///
    /// # Errors
    /// [`ConstraintError::UnknownVertex`], [`ConstraintError::BadContact`].
    pub(crate) fn check(&self, is_used: impl Fn(VertexId) -> bool) -> Result<(), ConstraintError> {
        let vertices = &self.vertices[..self.vertex_count()];
        if let Some(&vertex) = vertices.iter().find(|&&v| !is_used(v)) {
            return Err(ConstraintError::UnknownVertex { vertex });
        }
        if !self.is_valid() {
            let vertex = self.vertices[0];
            return Err(ConstraintError::BadContact { vertex });
        }
        Ok(())
    }

    /// Returns the number of vertices of the first feature.
    #[must_use]
    pub fn first_vertex_count(&self) -> usize {
        if self.kind == ContactKind::EdgeEdge {
            2
        } else {
            1
        }
    }

    /// Returns the number of vertices: four, or one for a plane.
    fn vertex_count(&self) -> usize {
        if self.kind == ContactKind::Plane {
            1
        } else {
            4
        }
    }

    fn is_valid(&self) -> bool {
        let is_distinct = |i: usize| !self.vertices[..i].contains(&self.vertices[i]);
        let is_kind_valid = match self.kind {
            ContactKind::Plane => self.vertices[1..].iter().all(|v| v.is_null()),
            _ => (1..4).all(is_distinct) && self.gap >= 0.0 && self.gap_rate == 0.0,
        };
        let square: f32 = self.normal.iter().map(|n| n * n).sum();
        is_kind_valid
            && (square - 1.0).abs() <= TOLERANCE
            && [self.gap, self.gap_rate].iter().all(|c| c.is_finite())
            && self.friction.is_finite()
            && self.friction >= 0.0
            && self.press.is_valid()
            && self.held.is_none_or(|held| held.is_finite())
    }
}

/// Tolerance of the length of normals, which are rounded.
const TOLERANCE: f32 = 1e-3;

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
        let [a, b, c, d] = [0, 1, 2, 3].map(VertexId);
        let normal = [0.6, 0.0, 0.8];
        let valid = Contact::vertex_face(a, [b, c, d], 0.1);
        let edges = Contact::edge_edge([[a, b], [c, d]], normal, 0.1);
        let plane = Contact::plane(a, normal, 1.0);
        solver.set_contacts(&[valid, edges, plane]).unwrap();
        let bad = [
            Contact::vertex_face(c, [b, c, d], 0.1),
            Contact::edge_edge([[a, b], [a, d]], normal, 0.1),
            Contact::vertex_face(a, [b, c, d], -0.1),
            Contact::vertex_face(a, [b, c, d], f32::NAN),
            Contact::edge_edge([[a, b], [c, d]], [0.6, 0.0, 0.7], 0.1),
            Contact::edge_edge([[a, b], [c, d]], [f32::NAN, 0.0, 1.0], 0.1),
            Contact::plane(a, normal, f32::INFINITY),
            Contact {
                vertices: [a, b, c, d],
                ..plane
            },
            Contact {
                gap_rate: f32::INFINITY,
                ..plane
            },
            Contact {
                gap_rate: 0.1,
                ..valid
            },
            Contact {
                friction: -0.5,
                ..valid
            },
            Contact {
                press: LoadRatio {
                    closing: f32::NAN,
                    load: 0.0,
                },
                ..valid
            },
            Contact {
                press: LoadRatio {
                    closing: 0.0,
                    load: -1.0,
                },
                ..valid
            },
        ];
        for contact in bad {
            let refused = solver.set_contacts(&[valid, contact]);
            let vertex = contact.vertices[0];
            assert_eq!(refused, Err(ConstraintError::BadContact { vertex }));
            assert_eq!(solver.contacts().len(), 3, "nothing is changed");
        }
    }
}
