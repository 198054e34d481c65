//! [`ColliderFile`]: a rigid obstacle of a scene file.

use super::{SceneFile, SceneFileError};
use crate::failure::Failure;
use crate::numbers::Numbers;
use incise_mesh::Vec3;
use incise_mesh::geometry::{round_to_f32, to_f32};
use incise_pbd_gpu::Collider;
use serde::Deserialize;

/// A static solid shape that pushes bodies out; all lengths in \[m\].
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub(in crate::simulate) enum ColliderFile {
    /// A half-space behind a plane.
    Plane {
        /// A point on the boundary.
        point: Numbers<3>,
        /// Outward normal of any length.
        normal: Numbers<3>,
    },
    /// A ball.
    Sphere { center: Numbers<3>, radius: f64 },
    /// The points within a radius of a segment.
    Capsule { ends: [Numbers<3>; 2], radius: f64 },
    /// An oriented box.
    Box {
        center: Numbers<3>,
        /// Half extents.
        half: Numbers<3>,
        /// Directions of the first two sides.
        #[serde(default = "first_axes")]
        axes: [Numbers<3>; 2],
    },
}

fn first_axes() -> [Numbers<3>; 2] {
    [Numbers([1.0, 0.0, 0.0]), Numbers([0.0, 1.0, 0.0])]
}

impl ColliderFile {
    /// Returns the half-space below a height.
    pub(in crate::simulate) fn ground(height: f64) -> Self {
        Self::Plane {
            point: Numbers([0.0, height, 0.0]),
            normal: Numbers([0.0, 1.0, 0.0]),
        }
    }

    /// Returns the collider relative to an origin; it may be invalid.
    fn collider(&self, origin: Vec3) -> Collider {
        let place = |Numbers(p): Numbers<3>| to_f32(Vec3::from(p) - origin);
        let direction = |Numbers(p): Numbers<3>| to_f32(Vec3::from(p));
        match *self {
            Self::Plane { point, normal } => Collider::Plane {
                point: place(point),
                normal: direction(normal),
            },
            Self::Sphere { center, radius } => Collider::Sphere {
                center: place(center),
                radius: round_to_f32(radius),
            },
            Self::Capsule { ends, radius } => Collider::Capsule {
                ends: ends.map(place),
                radius: round_to_f32(radius),
            },
            Self::Box { center, half, axes } => Collider::Box {
                center: place(center),
                half: direction(half),
                axes: axes.map(direction),
            },
        }
    }
}

impl SceneFile {
    /// Returns the colliders relative to an origin.
    pub(in crate::simulate) fn colliders(
        &self,
        origin: [f64; 3],
    ) -> Result<Vec<Collider>, Failure> {
        let checked = self.colliders.iter().map(|file| {
            let collider = file.get_ref().collider(origin.into());
            if collider.is_valid() {
                return Ok(collider);
            }
            let line = self.line(file).unwrap_or_default();
            Err(self.refuse(SceneFileError::Collider { line }))
        });
        checked.collect()
    }
}
