//! Errors of materials, constraints and steps.

use incise_lattice::LatticeError;
use incise_mesh::{EdgeKey, TriangleId, VertexId};
use incise_params::OutOfRange;

/// An error of creating or changing a solver.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ConstraintError {
    /// A number of a material is out of range.
    #[error(transparent)]
    Parameter(#[from] OutOfRange),
    /// The inside of a solid has no lattice.
    #[error(transparent)]
    Lattice(#[from] LatticeError),
    /// A position or rest position is not finite.
    #[error(
        "{vertex} has a position or rest position that is not finite; repair the surface first"
    )]
    NonFinitePosition {
        /// The vertex.
        vertex: VertexId,
    },
    /// The ends of an edge have the same rest position.
    #[error("the edge {a}-{b} has no rest length; merge its ends")]
    ZeroRestLength {
        /// One end.
        a: VertexId,
        /// The other end.
        b: VertexId,
    },
    /// A volume density was given, but the surface encloses no volume.
    #[error(
        "the surface encloses {volume} m^3 at rest; use an area density, or reverse its triangles"
    )]
    NoVolume {
        /// The rest volume [m^3].
        volume: f64,
    },
    /// The surface has no area, from which masses follow.
    #[error("the surface has no rest area; repair its degenerate triangles first")]
    NoArea,
    /// A collider is not a valid shape.
    #[error(
        "collider {number} has a number that is not finite, a size that is not positive, or a zero \
         direction"
    )]
    BadCollider {
        /// Index of the collider in the list.
        number: usize,
    },
    /// A contact is not valid.
    #[error(
        "the contact of {vertex} has a number that is not finite, a normal that is not of length \
         1, a number that is negative, or the same vertex twice"
    )]
    BadContact {
        /// Vertex of the contact.
        vertex: VertexId,
    },
    /// The material has no interior springs.
    #[error(
        "the material has no interior springs; create the body again with a material that does"
    )]
    NoInteriorSprings,
    /// A part of the material that cannot change once the body exists.
    #[error(
        "the {name} of a body cannot be changed, added or removed; create the body again with the \
         new material"
    )]
    FixedMaterial {
        /// The part.
        name: &'static str,
    },
    /// The size of patches is out of range.
    #[error(
        "patches of {vertices} vertices with {room} of them free; use 8 to {max} vertices, not all \
         of them free",
        max = crate::PATCH_VERTICES
    )]
    BadPatches {
        /// Requested maximum number of vertices.
        vertices: u32,
        /// Requested number of free places.
        room: u32,
    },
    /// The surface has another number of vertex slots than the solver.
    #[error(
        "the surface has {surface} vertex slots, the solver {solver}; pass the surface that the \
         solver was made for, and apply the delta of every edit"
    )]
    SurfaceMismatch {
        /// Vertex slots of the surface.
        surface: usize,
        /// Vertex slots of the solver.
        solver: usize,
    },
    /// The vertex does not exist or has no triangle.
    #[error("{vertex} is not a vertex of the body")]
    UnknownVertex {
        /// The vertex.
        vertex: VertexId,
    },
    /// A target or velocity is not finite.
    #[error("the value for {vertex} is not finite")]
    NonFiniteValue {
        /// The vertex.
        vertex: VertexId,
    },
    /// A mass or its inverse is not positive and finite.
    #[error("mass {value} of {vertex} is not positive, or it or its inverse is not finite")]
    BadMass {
        /// The vertex.
        vertex: VertexId,
        /// Requested mass \[kg\].
        value: f32,
    },
    /// The vertex is not pinned.
    #[error("{vertex} is not pinned; pin it first")]
    NotPinned {
        /// The vertex.
        vertex: VertexId,
    },
    /// A delta removes a triangle that is not in the solver, so an earlier delta was not applied.
    #[error(
        "the delta removes {triangle}, which is not in the solver; apply every delta once, in order"
    )]
    DeltaMismatch {
        /// The triangle.
        triangle: TriangleId,
    },
    /// A delta adds a triangle that is not in the surface.
    #[error(
        "the delta adds {triangle}, which is not in the surface; apply a delta with the surface \
         that it was made from"
    )]
    DeltaUnknownTriangle {
        /// The triangle.
        triangle: TriangleId,
    },
}

/// An error of stepping a frame.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StepError {
    /// A parameter is out of range.
    #[error(transparent)]
    Parameter(#[from] OutOfRange),
    /// The time step is not positive or not finite.
    #[error("the time step dt is {value} s; give a finite number above 0")]
    BadTimeStep {
        /// Requested time step \[s\].
        value: f32,
    },
    /// `h^2` is no normal number of 32 bits, `compliance / h^2` overflows, or a frame has more than
    /// [`MAX_COUNT`](crate::SolverParams::MAX_COUNT) substeps.
    #[error(
        "a substep of {h:e} s is too short: the minimum is {:e} s, a frame has 2^20 of them at \
         most, and compliance over its square must be finite; use longer substeps, shorter frames \
         or less compliance",
        crate::SolverParams::MIN_SUBSTEP
    )]
    SubstepTooShort {
        /// Length of the substep \[s\].
        h: f32,
    },
    /// The GPU backend supports implicit Euler only, and solids without contacts.
    #[error(
        "the GPU backend supports implicit Euler only, and solids without contacts; use \
         Integrator::Euler, or step on the CPU"
    )]
    UnsupportedOnGpu,
    /// The surface was edited, but the delta was not applied to the solver.
    #[error(
        "the surface has {surface} vertex slots, the solver {solver}; apply the delta of the edit \
         first"
    )]
    SurfaceMismatch {
        /// Vertex slots of the surface.
        surface: usize,
        /// Vertex slots of the solver.
        solver: usize,
    },
    /// The contacts of an island are for bodies with another number of vertex slots.
    #[error(
        "the contacts of the island are for {contacts} vertex slots, its bodies have {bodies}; \
         set the contacts again"
    )]
    ContactMismatch {
        /// Vertex slots that the contacts were set for.
        contacts: usize,
        /// Vertex slots of the bodies.
        bodies: usize,
    },
    /// A position is not finite before the step.
    #[error("{vertex} has a position that is not finite; nothing was stepped")]
    NonFiniteInput {
        /// The first such vertex.
        vertex: VertexId,
    },
    /// A position became infinite or NaN. The solver must be created again.
    #[error(
        "the position of {vertex} became infinite or NaN in substep {substep}; use shorter steps, \
         or check its velocity"
    )]
    NonFinitePosition {
        /// The first such vertex.
        vertex: VertexId,
        /// Substep of the frame.
        substep: u32,
    },
}

/// An error of a saved solver that does not belong to its surface, or is damaged.
#[cfg(feature = "serde")]
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum InvalidSolver {
    /// A number of the material or of a collider is out of range.
    #[error("the saved solver: {0}")]
    Constraint(#[from] ConstraintError),
    /// Constraints, colors or patches do not match the surface.
    #[error("the saved constraints: {0}")]
    Constraints(#[from] InvalidConstraints),
    /// An array has the wrong length, an unknown vertex, or a number out of range.
    #[error("the saved {array} do not fit the surface or have a number out of range")]
    Array {
        /// The array.
        array: &'static str,
    },
}

/// An error of loading a body.
#[cfg(feature = "serde")]
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LoadError {
    /// The file or its surface is invalid.
    #[error(transparent)]
    Archive(#[from] incise_mesh::ArchiveError),
    /// The solver is invalid.
    #[error(transparent)]
    Solver(#[from] InvalidSolver),
}

/// A difference to the constraints of a solver built from scratch, from
/// [`Solver::validate`](crate::Solver::validate).
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
#[error("{rule} does not hold at {edge:?}")]
pub struct InvalidConstraints {
    /// The broken rule.
    pub rule: &'static str,
    /// The edge of the first constraint that breaks it, if any.
    pub edge: Option<EdgeKey>,
}
