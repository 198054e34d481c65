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
        solid: None,
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

/// Returns a shell of 1 kg/m^2 with compliances of stretch [m/N] and of bending [rad/(N m)].
#[must_use]
pub fn elastic_shell(stretch: f32, bending: f32) -> Material {
    Material {
        stretch: Stiffness::Compliance(stretch),
        bending: Some(Stiffness::Compliance(bending)),
        ..Material::default()
    }
}

/// Returns shells without compliance and with little: of stiffnesses, rigid, elastic.
#[must_use]
pub fn shells() -> [(&'static str, Material); 3] {
    let paper = Material {
        bending: Some(Stiffness::Pbd(1.0)),
        ..Material::default()
    };
    [
        ("stiffness 1", paper),
        ("compliance 0", elastic_shell(0.0, 0.0)),
        ("compliance 1e-5", elastic_shell(1e-5, 1e-2)),
    ]
}
