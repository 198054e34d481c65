//! A material for bodies that touch.

use incise_pbd_gpu::{Density, Material, Stiffness, Struts, Volume};

/// What keeps its shape.
pub(crate) fn firm(friction: f32, damping: f32) -> Material {
    Material {
        density: Density::Area(1.0),
        stretch: Stiffness::Compliance(0.0),
        bending: None,
        volume: Some(Volume::default()),
        struts: Some(Struts {
            density: 1.0,
            stiffness: Stiffness::Compliance(1e-6),
        }),
        damping,
        friction,
    }
}
