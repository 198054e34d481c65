//! What can be wrong with a body, a frame or a set of constraints.

use incise_mesh::{EdgeKey, TriangleId, VertexId};

/// Why constraints cannot be made of a surface and a material, or follow its change.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ConstraintError {
    /// A position or rest position is not a number.
    #[error(
        "{vertex} has a position or rest position that is not finite; repair the surface first"
    )]
    NonFinitePosition {
        /// The vertex.
        vertex: VertexId,
    },
    /// The ends of an edge have the same rest position.
    #[error("the edge {a}-{b} has no length at rest; merge its ends")]
    ZeroRestLength {
        /// One end.
        a: VertexId,
        /// The other end.
        b: VertexId,
    },
    /// A compliance below zero or not a number.
    #[error("compliance {value} is not a finite number of at least 0")]
    NegativeCompliance {
        /// What was asked for.
        value: f32,
    },
    /// A stiffness outside of 0 to 1.
    #[error("stiffness {value} is not between 0 and 1")]
    StiffnessOutOfRange {
        /// What was asked for.
        value: f32,
    },
    /// A density that gives no mass.
    #[error("density {value} is not a finite number above 0")]
    BadDensity {
        /// What was asked for.
        value: f32,
    },
    /// A volume density for a surface that encloses nothing.
    #[error(
        "the surface encloses {volume} m^3 at rest; give an area density or turn it inside out"
    )]
    NoVolume {
        /// The rest volume [m^3].
        volume: f64,
    },
    /// No triangle of the surface has an area, so there is nothing to hang mass on.
    #[error("the surface has no area at rest")]
    NoArea,
    /// A damping or friction below zero or not a number.
    #[error("{name} {value} is not a finite number of at least 0")]
    NegativeCoefficient {
        /// Which one.
        name: &'static str,
        /// What was asked for.
        value: f32,
    },
    /// A collider that is no shape.
    #[error(
        "collider {number} has a number that is not finite, a size that is not above 0, or a direction of no length"
    )]
    BadCollider {
        /// Its place in the list.
        number: usize,
    },
    /// A contact that is none.
    #[error(
        "the contact of {vertex} has a number that is not finite, a normal that has not length 1, weights that do not sum to 1, or the vertex for a corner"
    )]
    BadContact {
        /// Its vertex.
        vertex: VertexId,
    },
    /// Struts for a body whose material has none.
    #[error("the body's material has no struts; make the body anew with them")]
    WithoutStruts,
    /// A density of struts that is no part of the vertices.
    #[error("{value} struts a vertex are not between 0 and 1")]
    BadStruts {
        /// What was asked for.
        value: f32,
    },
    /// Patches too small, too large or without a place for what is there.
    #[error(
        "patches of {vertices} vertices with room for {room} more; give 8 to {most} and less room than that",
        most = crate::PATCH_VERTICES
    )]
    BadPatches {
        /// The most vertices asked for.
        vertices: u32,
        /// The free places asked for.
        room: u32,
    },
    /// A vertex that no triangle uses, or that does not exist.
    #[error("{vertex} is not a vertex of the body")]
    UnknownVertex {
        /// The vertex.
        vertex: VertexId,
    },
    /// A target or velocity that is not a number.
    #[error("the value for {vertex} is not finite")]
    NonFiniteValue {
        /// The vertex.
        vertex: VertexId,
    },
    /// A mass that a vertex cannot have.
    #[error("mass {value} of {vertex} is not a number above 0 with an inverse")]
    BadMass {
        /// The vertex.
        vertex: VertexId,
        /// What was asked for \[kg\].
        value: f32,
    },
    /// A target for a vertex that is not pinned.
    #[error("{vertex} is not pinned; pin it before giving it a target")]
    NotPinned {
        /// The vertex.
        vertex: VertexId,
    },
    /// A delta removes a triangle that the solver does not know, so it has missed an earlier delta.
    #[error(
        "the delta removes {triangle}, which the solver does not know; apply every delta once, in order"
    )]
    DeltaMismatch {
        /// The triangle.
        triangle: TriangleId,
    },
    /// A delta adds a triangle that the surface does not have.
    #[error(
        "the delta adds {triangle}, which the surface does not have; apply a delta to the surface it was made from"
    )]
    DeltaUnknownTriangle {
        /// The triangle.
        triangle: TriangleId,
    },
}

/// Why a frame could not be stepped.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StepError {
    /// A time step that is not a positive number.
    #[error("time step {value} s is not a finite number above 0")]
    BadTimeStep {
        /// What was asked for \[s\].
        value: f32,
    },
    /// Substeps so short, or compliances so large, that `compliance / h^2` is no number any more.
    #[error(
        "compliance over the square of a substep of {h} s is no number: take fewer substeps, longer steps or less compliance"
    )]
    TooShort {
        /// The substep \[s\].
        h: f32,
    },
    /// No iterations or no substeps.
    #[error("a step needs at least one {name}")]
    NoneOf {
        /// Of what there must be one.
        name: &'static str,
    },
    /// Gravity or the height of the ground is not a number.
    #[error("{name} is not finite")]
    NonFiniteParameter {
        /// Which one.
        name: &'static str,
    },
    /// A residual that no motion can be compared with.
    #[error(
        "residual {value} m is not a finite number of 0 or more; give none to do all iterations"
    )]
    BadResidual {
        /// What was asked for \[m\].
        value: f32,
    },
    /// A part of its own weight that a constraint cannot be projected against.
    #[error("the own weight {value} is not from 1/2 to 1")]
    BadOwnWeight {
        /// What was asked for.
        value: f32,
    },
    /// A device steps by implicit Euler only.
    #[error("a device steps by implicit Euler; step on the CPU, or take Integrator::Euler")]
    NotOnDevice,
    /// The surface was edited and the solver has not been told.
    #[error(
        "the surface has {surface} vertex slots, the solver {solver}; apply the delta of the edit first"
    )]
    SurfaceMismatch {
        /// Vertex slots of the surface.
        surface: usize,
        /// Vertex slots of the solver.
        solver: usize,
    },
    /// A position is not a number before the step.
    #[error("{vertex} has a position that is not finite; set it again, nothing was stepped")]
    NonFiniteInput {
        /// The first such vertex.
        vertex: VertexId,
    },
    /// A position stopped being a number. The body must be set up again.
    #[error(
        "{vertex} left the numbers in substep {substep}; use smaller steps or check its velocity"
    )]
    NonFinitePosition {
        /// The first such vertex.
        vertex: VertexId,
        /// In which substep of the frame.
        substep: u32,
    },
}

/// How the constraints differ from those that the surface would get if built from scratch, found by
/// [`Solver::validate`](crate::Solver::validate).
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("{rule} does not hold at {edge:?}")]
pub struct InvalidConstraints {
    /// The broken rule.
    pub rule: &'static str,
    /// The edge of the constraint, if one is to blame.
    pub edge: Option<EdgeKey>,
}
