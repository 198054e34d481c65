//! What a reference cannot do.

use thiserror::Error;

/// Why there is no reference.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[non_exhaustive]
pub enum ReferenceError {
    /// The stiffness of position based dynamics depends on iterations and belongs to no energy.
    #[error("a stiffness of {k} belongs to no energy; take a compliance, or a stiffness of 1")]
    NoEnergy {
        /// The stiffness.
        k: f32,
    },
    /// Friction belongs to no energy.
    #[error(
        "friction of {coefficient} belongs to no energy; take 0 for a body that meets the ground"
    )]
    Friction {
        /// Coulomb's coefficient.
        coefficient: f32,
    },
    /// Arrays of a model do not fit one another.
    #[error("constraint {constraint} names vertex {vertex} of {vertices}")]
    VertexOutOfRange {
        /// The constraint.
        constraint: usize,
        /// The vertex.
        vertex: usize,
        /// How many vertices there are.
        vertices: usize,
    },
    /// A piece that is to keep a volume has a boundary.
    #[error(
        "the edge from vertex {from} to {to} has not two triangles, one each way; a piece without a closed surface has no volume"
    )]
    Open {
        /// Where the edge begins.
        from: usize,
        /// Where it ends.
        to: usize,
    },
    /// A vertex that can move was told where to be.
    #[error("vertex {vertex} has a mass, so it cannot be put anywhere; only one without is held")]
    NotHeld {
        /// The vertex.
        vertex: usize,
    },
    /// A state, a mass, a rest value or a time step is not a number that it can be.
    #[error("{name} is not finite or out of its range")]
    BadNumber {
        /// What is wrong.
        name: &'static str,
    },
    /// A step came to no end.
    #[error(
        "after {newton_steps} steps of Newton's method the decrement is {decrement:e} of the first one; \
         take a smaller time step"
    )]
    NotConverged {
        /// Steps made.
        newton_steps: usize,
        /// The last decrement over the first.
        decrement: f64,
    },
    /// The linear algebra gave up.
    #[error("the matrix of {unknowns} unknowns could not be factored")]
    NotFactored {
        /// Its size.
        unknowns: usize,
    },
}
