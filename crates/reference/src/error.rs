//! Errors of the reference.

use thiserror::Error;

/// An error of the reference.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[non_exhaustive]
pub enum ReferenceError {
    /// A stiffness of position based dynamics, which has no energy.
    #[error("a stiffness of {k} belongs to no energy; take a compliance, or a stiffness of 1")]
    NoEnergy {
        /// The stiffness.
        k: f32,
    },
    /// Damping of a material, which acts once a frame and not in a substep.
    #[error(
        "a damping of {damping}/s slows motion relative to rigid motion, which the reference does \
         not have; take 0, or the drag `Model::damping`"
    )]
    Damping {
        /// The damping [1/s].
        damping: f32,
    },
    /// Friction, which has no energy.
    #[error("friction of {coefficient} belongs to no energy; take 0 for a body that meets a plane")]
    Friction {
        /// The coefficient of friction.
        coefficient: f32,
    },
    /// Colliders other than one plane at rest.
    #[error("the reference supports one plane at rest and no other collider")]
    Collider,
    /// A constraint with a vertex that does not exist.
    #[error("constraint {constraint} names vertex {vertex} of {vertices}")]
    VertexOutOfRange {
        /// The constraint.
        constraint: usize,
        /// The vertex.
        vertex: usize,
        /// The number of vertices.
        vertices: usize,
    },
    /// A piece with a volume constraint that has a boundary.
    #[error(
        "the edge from vertex {from} to {to} does not have two triangles, one in each direction; \
         volume constraints need closed pieces"
    )]
    Open {
        /// The first vertex of the open edge.
        from: usize,
        /// The last vertex of the open edge.
        to: usize,
    },
    /// A target for a vertex that is not held.
    #[error("vertex {vertex} has a mass, so it cannot be put anywhere; only one without is held")]
    NotHeld {
        /// The vertex.
        vertex: usize,
    },
    /// A state, mass, rest value or time step out of range.
    #[error("{name} is not finite or out of its range")]
    BadNumber {
        /// The quantity.
        name: &'static str,
    },
    /// A model that rigid patches do not solve.
    #[error("rigid patches support no rigid constraints, plane or volumes; use another scheme")]
    NoPatches,
    /// A step that did not converge.
    #[error(
        "after {newton_steps} steps of Newton's method the decrement is {decrement:e} of the first \
         one; take a smaller time step"
    )]
    NotConverged {
        /// Newton steps made.
        newton_steps: usize,
        /// The last decrement over the first.
        decrement: f64,
    },
    /// A failed factorization.
    #[error("the matrix of {unknowns} unknowns could not be factored")]
    NotFactored {
        /// Its size.
        unknowns: usize,
    },
}
