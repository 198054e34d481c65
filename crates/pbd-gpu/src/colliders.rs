//! Colliders: solid shapes that bodies stay out of, as they do of the ground.

use crate::error::ConstraintError;
use crate::solver::Solver;
use incise_mesh::Aabb;

/// A solid shape at a place. It pushes bodies and is pushed by none; friction is the body's.
///
/// Vertices are kept out of it, where they are at the end of each substep: triangles much larger than the shape may lie across it, and what moves
/// past it within a substep is not stopped. One that appears within a body, or jumps into it, pushes all of it out at once.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Collider {
    /// Everything on the far side of a plane.
    Plane {
        /// A point on it \[m\].
        point: [f32; 3],
        /// Out of the solid; of any length whose square is a number above 0.
        normal: [f32; 3],
    },
    /// A ball.
    Sphere {
        /// \[m\]
        center: [f32; 3],
        /// \[m\]
        radius: f32,
    },
    /// All that is no farther than the radius from a straight way.
    Capsule {
        /// Where the way begins and ends \[m\].
        ends: [[f32; 3]; 2],
        /// \[m\]
        radius: f32,
    },
    /// A box that may be turned.
    Box {
        /// \[m\]
        center: [f32; 3],
        /// Half of the sides \[m\].
        half: [f32; 3],
        /// Along the first two sides; the third is across both. Made unit vectors at right angles, from the first on.
        axes: [[f32; 3]; 2],
    },
}

/// A collider as kernels read it, on the processor and on a device.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "gpu", derive(bytemuck::Pod, bytemuck::Zeroable))]
pub(crate) struct ColliderRecord {
    /// [`PLANE`], [`ROUND`] or [`BOX`].
    pub(crate) kind: u32,
    /// Of round ones \[m\].
    pub(crate) radius: f32,
    /// A point of a plane, the first end of round ones, the middle of a box \[m\].
    pub(crate) at: [f32; 3],
    /// The normal of a plane; the way to the other end of round ones; half of a box's sides \[m\].
    pub(crate) along: [f32; 3],
    /// A box's first two axes; a round one's way over its square first.
    pub(crate) axes: [[f32; 3]; 2],
    pub(crate) pad: [u32; 2],
}

pub(crate) const PLANE: u32 = 0;
pub(crate) const ROUND: u32 = 1;
pub(crate) const BOX: u32 = 2;

impl Collider {
    /// The box around it; everything of a plane.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        let around = |center: [f32; 3], reach: [f32; 3]| Aabb {
            min: [0, 1, 2].map(|k| center[k] - reach[k]),
            max: [0, 1, 2].map(|k| center[k] + reach[k]),
        };
        match *self {
            Self::Plane { .. } => Aabb {
                min: [f32::NEG_INFINITY; 3],
                max: [f32::INFINITY; 3],
            },
            Self::Sphere { center, radius } => around(center, [radius; 3]),
            Self::Capsule {
                ends: [a, b],
                radius,
            } => {
                let ends = [around(a, [radius; 3]), around(b, [radius; 3])];
                Aabb {
                    min: [0, 1, 2].map(|k| ends[0].min[k].min(ends[1].min[k])),
                    max: [0, 1, 2].map(|k| ends[0].max[k].max(ends[1].max[k])),
                }
            }
            Self::Box { center, half, .. } => {
                let diagonal = norm(half);
                around(center, [diagonal; 3])
            }
        }
    }

    /// Whether it is a shape: its numbers are finite, its sizes above 0, and its directions have a length.
    #[must_use]
    pub fn is_sound(&self) -> bool {
        self.record().is_some()
    }

    /// The record, if all numbers are finite and directions are directions.
    pub(crate) fn record(&self) -> Option<ColliderRecord> {
        let mut record = ColliderRecord {
            kind: ROUND,
            radius: 0.0,
            at: [0.0; 3],
            along: [0.0; 3],
            axes: [[0.0; 3]; 2],
            pad: [0; 2],
        };
        match *self {
            Self::Plane { point, normal } => {
                record.kind = PLANE;
                record.at = point;
                record.along = unit(normal)?;
            }
            Self::Sphere { center, radius } => {
                record.at = center;
                record.radius = radius;
            }
            Self::Capsule {
                ends: [a, b],
                radius,
            } => {
                record.at = a;
                record.along = [0, 1, 2].map(|k| b[k] - a[k]);
                let square = dot(record.along, record.along);
                if square > 0.0 {
                    record.axes[0] = record.along.map(|c| c / square);
                }
                record.radius = radius;
            }
            Self::Box { center, half, axes } => {
                record.kind = BOX;
                record.at = center;
                record.along = half;
                let first = unit(axes[0])?;
                let across = dot(first, axes[1]);
                let second = [0, 1, 2].map(|k| axes[1][k] - across * first[k]);
                record.axes = [first, unit(second)?];
            }
        }
        let numbers = record.at.iter().chain(&record.along);
        let numbers = numbers.chain(record.axes.as_flattened());
        let sizes_are_positive = match self {
            Self::Plane { .. } => true,
            Self::Box { half, .. } => half.iter().all(|&c| c > 0.0),
            _ => record.radius > 0.0,
        };
        let is_sound = numbers.chain([&record.radius]).all(|n| n.is_finite()) && sizes_are_positive;
        is_sound.then_some(record)
    }
}

impl Solver {
    /// The colliders of the frames to come.
    #[must_use]
    pub fn colliders(&self) -> &[Collider] {
        &self.colliders.given
    }

    /// Sets the colliders of the frames to come, in place of those before. A pass over the vertices an iteration, and none
    /// without any.
    ///
    /// # Errors
    /// [`ConstraintError::BadCollider`] with the number of one that is none; nothing is changed then.
    pub fn set_colliders(&mut self, colliders: &[Collider]) -> Result<(), ConstraintError> {
        if self.colliders.given == colliders {
            return Ok(());
        }
        if let Some(number) = colliders.iter().position(|c| c.record().is_none()) {
            return Err(ConstraintError::BadCollider { number });
        }
        let Colliders {
            given,
            records,
            generation,
        } = &mut self.colliders;
        given.clear();
        given.extend_from_slice(colliders);
        records.clear();
        records.extend(colliders.iter().filter_map(Collider::record));
        *generation += 1;
        Ok(())
    }
}

/// The colliders of a body.
#[derive(Debug, Clone, Default)]
pub(crate) struct Colliders {
    given: Vec<Collider>,
    pub(crate) records: Vec<ColliderRecord>,
    /// How often they were set.
    pub(crate) generation: u64,
}

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn norm(a: [f32; 3]) -> f32 {
    dot(a, a).sqrt()
}

fn unit(a: [f32; 3]) -> Option<[f32; 3]> {
    let length = norm(a);
    (length > 0.0 && length.is_finite()).then(|| a.map(|c| c / length))
}
