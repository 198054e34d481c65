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

/// Returns a material whose edges and angles do not pull, so that its volume acts alone.
#[must_use]
pub fn limp(volume: Volume) -> Material {
    Material {
        stretch: Stiffness::Pbd(0.0),
        bending: None,
        volume: Some(volume),
        ..Material::default()
    }
}

/// Returns an incompressible volume of a number of rest volumes.
#[must_use]
pub fn with_pressure(pressure: f32) -> Volume {
    Volume {
        pressure,
        ..Volume::default()
    }
}
