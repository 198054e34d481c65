//! Colliders: rigid solid shapes that vertices are pushed out of.

use crate::error::ConstraintError;
use incise_mesh::Aabb;

/// A rigid solid shape that pushes bodies out, with the friction coefficient of the body.
///
/// Vertices are outside at the end of each substep. Triangles much larger than the shape may
/// intersect it, and vertices that pass it within a substep are not stopped. A collider that is
/// placed inside a body pushes the vertices out within one substep; see [`MovingCollider`] for one
/// that moves.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Collider {
    /// A half-space.
    Plane {
        /// A point on the boundary \[m\].
        point: [f32; 3],
        /// Outward normal, of any length above 0.
        normal: [f32; 3],
    },
    /// A ball.
    Sphere {
        /// Center \[m\].
        center: [f32; 3],
        /// Radius \[m\].
        radius: f32,
    },
    /// The points within a radius of a segment.
    Capsule {
        /// Ends of the segment \[m\].
        ends: [[f32; 3]; 2],
        /// Radius \[m\].
        radius: f32,
    },
    /// An oriented box.
    Box {
        /// Center \[m\].
        center: [f32; 3],
        /// Half extents \[m\].
        half: [f32; 3],
        /// Directions of the first two sides; they are orthonormalized, the first one first.
        axes: [[f32; 3]; 2],
    },
}

/// A collider with its motion within a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MovingCollider {
    /// The shape at the start of the frame.
    pub start: Collider,
    /// Velocity \[m/s\]. Friction drags bodies along.
    pub velocity: [f32; 3],
}

impl MovingCollider {
    /// Returns the collider that reaches its present place from a previous one in `dt` \[s\].
    ///
    /// It has its present size and directions from the start. It does not move if the previous one
    /// has another shape.
    #[must_use]
    pub fn between(previous: &Collider, present: &Collider, dt: f32) -> Self {
        let [from, to] = [previous, present].map(Collider::place);
        let is_one = std::mem::discriminant(previous) == std::mem::discriminant(present);
        if !is_one || from == to {
            return Self::from(*present);
        }
        let motion = [0, 1, 2].map(|k| to[k] - from[k]);
        Self {
            start: present.moved(motion.map(|c| -c)),
            velocity: motion.map(|c| c / dt),
        }
    }

    /// Returns the bounding box of the motion within `dt` \[s\].
    #[must_use]
    pub fn bounds(&self, dt: f32) -> Aabb {
        let end = self.start.moved(self.velocity.map(|v| v * dt));
        self.start.bounds().union(end.bounds())
    }

    /// Returns whether the collider comes within a distance `margin` \[m\] of a box in `dt` \[s\].
    #[expect(
        clippy::cast_possible_truncation,
        reason = "the margin is much larger than the rounding of corners"
    )]
    pub(crate) fn reaches(&self, bounds: &Aabb, margin: f64, dt: f32) -> bool {
        let Collider::Plane { point, normal } = self.start else {
            let grown = Aabb {
                min: bounds.min.map(|c| (f64::from(c) - margin) as f32),
                max: bounds.max.map(|c| (f64::from(c) + margin) as f32),
            };
            return self.bounds(dt).overlaps(&grown);
        };
        let sum = |of: &dyn Fn(usize) -> f64| [0, 1, 2].into_iter().map(of).sum::<f64>();
        let along = |k: usize| f64::from(normal[k]);
        let lowest = sum(&|k| {
            let corner = if normal[k] > 0.0 {
                bounds.min
            } else {
                bounds.max
            };
            along(k) * (f64::from(corner[k]) - f64::from(point[k]))
        });
        let rise = sum(&|k| along(k) * f64::from(self.velocity[k])) * f64::from(dt);
        lowest <= rise.max(0.0) + margin * sum(&|k| along(k) * along(k)).sqrt()
    }

    /// Returns the record of a valid collider.
    pub(crate) fn record(&self) -> Option<ColliderRecord> {
        let record = self.start.record()?;
        let is_finite = self.velocity.iter().all(|v| v.is_finite());
        is_finite.then_some(ColliderRecord {
            velocity: self.velocity,
            ..record
        })
    }
}

impl From<Collider> for MovingCollider {
    /// Returns the collider at rest.
    fn from(start: Collider) -> Self {
        Self {
            start,
            velocity: [0.0; 3],
        }
    }
}

/// A collider as the kernels on the CPU and on the GPU read it.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "gpu", derive(bytemuck::Pod, bytemuck::Zeroable))]
pub(crate) struct ColliderRecord {
    /// [`PLANE`], [`ROUND`] or [`BOX`].
    pub(crate) kind: u32,
    /// Radius of spheres and capsules \[m\].
    pub(crate) radius: f32,
    /// Point of a plane, center of a sphere, first end of a capsule, center of a box, at the start
    /// of the frame \[m\].
    pub(crate) origin: [f32; 3],
    /// Normal of a plane, segment of a capsule \[m\], half extents of a box \[m\].
    pub(crate) extent: [f32; 3],
    /// First two axes of a box; segment of a capsule over its squared length.
    pub(crate) axes: [[f32; 3]; 2],
    /// Velocity within the frame \[m/s\].
    pub(crate) velocity: [f32; 3],
    pub(crate) pad: u32,
}

impl ColliderRecord {
    /// Returns a position \[m\] relative to the origin at a time of the frame \[s\].
    #[inline(always)]
    pub(crate) fn relative(&self, x: [f32; 4], time: f32) -> [f32; 3] {
        let origin = self.origin_at(time);
        [0, 1, 2].map(|k: usize| x[k] - origin[k])
    }

    /// Returns the origin at a time of the frame \[s\].
    #[inline(always)]
    pub(crate) fn origin_at(&self, time: f32) -> [f32; 3] {
        [0, 1, 2].map(|k: usize| self.origin[k] + self.velocity[k] * time)
    }
}

pub(crate) const PLANE: u32 = 0;
pub(crate) const ROUND: u32 = 1;
pub(crate) const BOX: u32 = 2;

impl Collider {
    /// Returns the half-space below a height \[m\], whose normal is the y axis.
    #[must_use]
    pub const fn ground(height: f32) -> Self {
        Self::Plane {
            point: [0.0, height, 0.0],
            normal: [0.0, 1.0, 0.0],
        }
    }

    /// Returns the bounding box; that of a plane is unbounded.
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

    /// Returns a point that moves with the shape: of a capsule the middle \[m\].
    fn place(&self) -> [f32; 3] {
        match *self {
            Self::Plane { point, .. } => point,
            Self::Sphere { center, .. } | Self::Box { center, .. } => center,
            Self::Capsule { ends: [a, b], .. } => [0, 1, 2].map(|k| a[k] + (b[k] - a[k]) / 2.0),
        }
    }

    /// Returns the shape at another place, at a distance \[m\].
    fn moved(mut self, by: [f32; 3]) -> Self {
        let points = match &mut self {
            Self::Plane { point, .. } => std::slice::from_mut(point),
            Self::Sphere { center, .. } | Self::Box { center, .. } => std::slice::from_mut(center),
            Self::Capsule { ends, .. } => &mut ends[..],
        };
        for point in points {
            *point = [0, 1, 2].map(|k| point[k] + by[k]);
        }
        self
    }

    /// Returns true if all numbers are finite, sizes are positive and directions are not zero.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        self.record().is_some()
    }

    /// Returns the record of a valid collider.
    pub(crate) fn record(&self) -> Option<ColliderRecord> {
        let mut record = ColliderRecord {
            kind: ROUND,
            radius: 0.0,
            origin: [0.0; 3],
            extent: [0.0; 3],
            axes: [[0.0; 3]; 2],
            velocity: [0.0; 3],
            pad: 0,
        };
        match *self {
            Self::Plane { point, normal } => {
                record.kind = PLANE;
                record.origin = point;
                record.extent = unit(normal)?;
            }
            Self::Sphere { center, radius } => {
                record.origin = center;
                record.radius = radius;
            }
            Self::Capsule {
                ends: [a, b],
                radius,
            } => {
                record.origin = a;
                record.extent = [0, 1, 2].map(|k| b[k] - a[k]);
                let square = dot(record.extent, record.extent);
                if square > 0.0 {
                    record.axes[0] = record.extent.map(|c| c / square);
                }
                record.radius = radius;
            }
            Self::Box { center, half, axes } => {
                record.kind = BOX;
                record.origin = center;
                record.extent = half;
                let first = unit(axes[0])?;
                let across = dot(first, axes[1]);
                let second = [0, 1, 2].map(|k| axes[1][k] - across * first[k]);
                record.axes = [first, unit(second)?];
            }
        }
        let numbers = record.origin.iter().chain(&record.extent);
        let numbers = numbers.chain(record.axes.as_flattened());
        let sizes_are_positive = match self {
            Self::Plane { .. } => true,
            Self::Box { half, .. } => half.iter().all(|&c| c > 0.0),
            _ => record.radius > 0.0,
        };
        let is_valid = numbers.chain([&record.radius]).all(|n| n.is_finite()) && sizes_are_positive;
        is_valid.then_some(record)
    }
}

/// The colliders of a body, with their records.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Colliders {
    list: Vec<MovingCollider>,
    /// Planes come last, so that no other collider pushes a vertex into one.
    #[cfg_attr(feature = "serde", serde(skip))]
    records: Vec<ColliderRecord>,
    #[cfg_attr(feature = "serde", serde(skip))]
    generation: u64,
}

impl Colliders {
    /// Returns the colliders as they were set.
    pub(crate) fn list(&self) -> &[MovingCollider] {
        &self.list
    }

    /// Makes the records of colliders that were read with serde.
    ///
    /// # Errors
    /// [`ConstraintError::BadCollider`].
    #[cfg(feature = "serde")]
    pub(crate) fn finish_load(&mut self) -> Result<(), ConstraintError> {
        let list = std::mem::take(&mut self.list);
        self.set(&list)
    }

    /// Returns the records that kernels read; planes come last.
    pub(crate) fn records(&self) -> &[ColliderRecord] {
        &self.records
    }

    /// Returns the records of planes.
    pub(crate) fn planes(&self) -> &[ColliderRecord] {
        let first = self.records.partition_point(|record| record.kind != PLANE);
        &self.records[first..]
    }

    /// Returns a number that changes whenever colliders are set.
    #[cfg(feature = "gpu")]
    pub(crate) fn generation(&self) -> u64 {
        self.generation
    }

    /// Replaces the colliders.
    ///
    /// # Errors
    /// [`ConstraintError::BadCollider`]; nothing is changed then.
    pub(crate) fn set(&mut self, colliders: &[MovingCollider]) -> Result<(), ConstraintError> {
        if self.list == colliders {
            return Ok(());
        }
        if let Some(number) = colliders.iter().position(|c| c.record().is_none()) {
            return Err(ConstraintError::BadCollider { number });
        }
        self.list.clear();
        self.list.extend_from_slice(colliders);
        self.records.clear();
        self.records
            .extend(colliders.iter().filter_map(MovingCollider::record));
        self.records.sort_by_key(|record| record.kind == PLANE);
        self.generation += 1;
        Ok(())
    }
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
