//! Starting points for materials, with their sources.

use super::{Density, Material, Solid, Stiffness};
use incise_mesh::Surface;

/// Poisson's ratio of tissue, which is nearly incompressible.
const TISSUE: f32 = 0.45;

impl Material {
    /// Returns a solid with Young's modulus \[Pa\], Poisson's ratio and density [kg/m^3].
    #[must_use]
    pub fn solid(young_modulus: f32, poisson_ratio: f32, density: f32) -> Self {
        Self {
            density: Density::Volume(density),
            solid: Some(Solid {
                young_modulus,
                poisson_ratio,
                ..Solid::default()
            }),
            ..Self::default()
        }
    }

    /// Returns a solid as heavy as water, which a body of a meter holds in shape: 100 kPa.
    #[must_use]
    pub fn soft_body() -> Self {
        Self::solid(1e5, TISSUE, 1000.0)
    }

    /// Returns human skin of young adults: 420 kPa (Agache et al. 1980, by torsion in vivo), 1,090
    /// kg/m^3 (Goldman and Richards 1954).
    #[must_use]
    pub fn skin() -> Self {
        Self::solid(4.2e5, TISSUE, 1090.0)
    }

    /// Returns a healthy human liver: 5.4 kPa, three times the shear modulus of Palmeri et al.
    /// 2008, 1,060 kg/m^3 (Bamber and Hill 1981).
    #[must_use]
    pub fn liver() -> Self {
        Self::solid(5.4e3, TISSUE, 1060.0)
    }

    /// Returns relaxed skeletal muscle: 12 kPa (Engler et al. 2004), 1,060 kg/m^3 (Mendez and Keys
    /// 1960).
    #[must_use]
    pub fn muscle() -> Self {
        Self::solid(1.2e4, TISSUE, 1060.0)
    }

    /// Returns gelatin of 5 %: 12.5 kPa, three times the shear modulus of Nguyen et al. 2014, and
    /// the density of water.
    #[must_use]
    pub fn jelly() -> Self {
        Self::solid(1.25e4, TISSUE, 1000.0)
    }

    /// Returns natural rubber: 2,000 kPa, 930 kg/m^3 (Ashby 2011, tables of natural rubber).
    ///
    /// Poisson's ratio is 0.49; that of rubber is nearer to 1/2.
    #[must_use]
    pub fn rubber() -> Self {
        Self::solid(2e6, 0.49, 930.0)
    }

    /// Returns a soft body for a closed surface, and cloth for one with a boundary, which has no
    /// inside.
    ///
    /// Its own weight strains a body in proportion to its size. So one of more than a meter, such
    /// as a model in centimeters, is stiffer than [`Self::soft_body`] by its longest side in
    /// meters.
    #[must_use]
    pub fn for_surface(surface: &Surface) -> Self {
        if !surface.topology().is_closed() {
            return Self::cloth();
        }
        let bounds = surface.bounds();
        let side = |k: usize| bounds.max[k] - bounds.min[k];
        let longest = side(0).max(side(1)).max(side(2));
        let mut material = Self::soft_body();
        if let Some(solid) = &mut material.solid
            && longest.is_finite()
        {
            solid.young_modulus *= longest.max(1.0);
        }
        material
    }

    /// Returns a stiff shell of 1 kg/m^2 that keeps its curvature.
    #[must_use]
    pub fn shell() -> Self {
        Self {
            bending: Some(Stiffness::Pbd(1.0)),
            ..Self::default()
        }
    }

    /// Returns cloth of 0.2 kg/m^2 that does not stretch and bends freely.
    #[must_use]
    pub fn cloth() -> Self {
        Self {
            density: Density::Area(0.2),
            bending: None,
            ..Self::default()
        }
    }

    /// Names of the starting points, for files and other languages, which count them in this order.
    pub const PRESETS: [&'static str; 9] = [
        "soft-body",
        "shell",
        "cloth",
        "limp-shell",
        "skin",
        "liver",
        "muscle",
        "jelly",
        "rubber",
    ];

    /// Returns the starting point of a name; `None` for one that is not in [`Self::PRESETS`].
    #[must_use]
    pub fn preset(name: &str) -> Option<Self> {
        match name {
            "soft-body" => Some(Self::soft_body()),
            "skin" => Some(Self::skin()),
            "liver" => Some(Self::liver()),
            "muscle" => Some(Self::muscle()),
            "jelly" => Some(Self::jelly()),
            "rubber" => Some(Self::rubber()),
            "shell" => Some(Self::shell()),
            "limp-shell" => Some(Self::default()),
            "cloth" => Some(Self::cloth()),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_preset_is_valid_and_found_by_its_name() {
        for name in Material::PRESETS {
            assert_eq!(Material::preset(name).unwrap().check(), Ok(()), "{name}");
        }
        assert_eq!(Material::preset("steel"), None);
    }
}
