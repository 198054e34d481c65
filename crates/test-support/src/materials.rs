//! Materials of tests.

use incise_pbd_gpu::{Density, InteriorSprings, Material, Stiffness, Volume};

/// Returns a stiff material with interior springs, for bodies in contact.
#[must_use]
pub fn firm(friction: f32, damping: f32) -> Material {
    Material {
        density: Density::Area(1.0),
        stretch: Stiffness::Compliance(0.0),
        bending: None,
        volume: Some(Volume::default()),
        interior_springs: Some(InteriorSprings {
            density: 1.0,
            stiffness: Stiffness::Compliance(1e-6),
        }),
        damping,
        friction,
    }
}
