//! [`MaterialFile`]: a material of a scene file, as changes to a preset.

use incise_pbd_gpu::{Density, InteriorSprings, Material, Stiffness, Volume};
use serde::Deserialize;

/// A material: a preset, and the keys that replace its values.
#[derive(Debug, Clone, Copy, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(in crate::simulate) struct MaterialFile {
    /// Where all other keys start from.
    pub(in crate::simulate) preset: Preset,
    /// Density, from which masses follow.
    pub(in crate::simulate) density: Option<DensityFile>,
    /// Stiffness of edges against a change of length.
    pub(in crate::simulate) stretch: Option<StiffnessFile>,
    /// Stiffness of edges against a change of angle.
    pub(in crate::simulate) bending: Option<StiffnessFile>,
    /// Resistance of closed pieces to a change of volume.
    pub(in crate::simulate) volume: Option<VolumeFile>,
    /// Springs through the body.
    pub(in crate::simulate) interior_springs: Option<InteriorSpringsFile>,
    /// Rate at which velocities decay [1/s].
    pub(in crate::simulate) damping: Option<f32>,
    /// Coulomb friction coefficient.
    pub(in crate::simulate) friction: Option<f32>,
}

/// A material of the solver.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(in crate::simulate) enum Preset {
    /// A solid that keeps its volume and its shape.
    #[default]
    SoftBody,
    /// A stiff shell that keeps its curvature.
    Shell,
    /// A shell that collapses under its weight.
    LimpShell,
    /// Cloth that does not stretch and bends freely.
    Cloth,
}

/// Density: mass per area [kg/m^2] or per volume of a closed body [kg/m^3].
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(in crate::simulate) enum DensityFile {
    PerArea(f32),
    PerVolume(f32),
}

/// Stiffness 0 to 1, or compliance: [m/N] for stretch and springs, [rad/(N m)] for bending.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(in crate::simulate) enum StiffnessFile {
    Stiffness(f32),
    Compliance(f32),
}

/// Resistance to a change of volume.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(in crate::simulate) struct VolumeFile {
    /// Inverse bulk modulus [1/Pa].
    compressibility: f32,
    /// Target volume over rest volume.
    pressure: f32,
}

/// Springs between opposite vertices.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(in crate::simulate) struct InteriorSpringsFile {
    /// Springs per vertex, 0 to 1.
    pub(in crate::simulate) density: f32,
    /// Stiffness; that of the solver's default without it.
    pub(in crate::simulate) stiffness: Option<StiffnessFile>,
}

impl Preset {
    const ALL: [Self; 4] = [Self::SoftBody, Self::Shell, Self::LimpShell, Self::Cloth];

    /// Returns the name in scene files.
    const fn name(self) -> &'static str {
        match self {
            Self::SoftBody => "soft-body",
            Self::Shell => "shell",
            Self::LimpShell => "limp-shell",
            Self::Cloth => "cloth",
        }
    }

    /// Returns the names of all presets.
    pub(super) fn names() -> String {
        Self::ALL.map(Self::name).join(", ")
    }

    /// Returns the preset of a name.
    pub(super) fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|preset| preset.name() == name)
    }

    /// Returns its material.
    pub(super) fn material(self) -> Material {
        match self {
            Self::SoftBody => Material::soft_body(),
            Self::Shell => Material::shell(),
            Self::LimpShell => Material::default(),
            Self::Cloth => Material::cloth(),
        }
    }
}

impl MaterialFile {
    /// Returns the material for the solver, which may be out of range.
    pub(super) fn material(&self) -> Material {
        let preset = self.preset.material();
        Material {
            density: self.density.map_or(preset.density, Density::from),
            stretch: self.stretch.map_or(preset.stretch, Stiffness::from),
            bending: self.bending.map(Stiffness::from).or(preset.bending),
            volume: self.volume.map(Volume::from).or(preset.volume),
            interior_springs: (self.interior_springs.map(InteriorSprings::from))
                .or(preset.interior_springs),
            damping: self.damping.unwrap_or(preset.damping),
            friction: self.friction.unwrap_or(preset.friction),
        }
    }
}

impl From<DensityFile> for Density {
    fn from(density: DensityFile) -> Self {
        match density {
            DensityFile::PerArea(value) => Self::Area(value),
            DensityFile::PerVolume(value) => Self::Volume(value),
        }
    }
}

impl From<StiffnessFile> for Stiffness {
    fn from(stiffness: StiffnessFile) -> Self {
        match stiffness {
            StiffnessFile::Stiffness(value) => Self::Pbd(value),
            StiffnessFile::Compliance(value) => Self::Compliance(value),
        }
    }
}

impl Default for VolumeFile {
    fn default() -> Self {
        let Volume {
            compressibility,
            pressure,
        } = Volume::default();
        Self {
            compressibility,
            pressure,
        }
    }
}

impl From<VolumeFile> for Volume {
    fn from(volume: VolumeFile) -> Self {
        Self {
            compressibility: volume.compressibility,
            pressure: volume.pressure,
        }
    }
}

impl Default for InteriorSpringsFile {
    fn default() -> Self {
        Self {
            density: InteriorSprings::default().density,
            stiffness: None,
        }
    }
}

impl From<InteriorSpringsFile> for InteriorSprings {
    fn from(springs: InteriorSpringsFile) -> Self {
        let default = Self::default();
        Self {
            density: springs.density,
            stiffness: (springs.stiffness).map_or(default.stiffness, Stiffness::from),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_presets_are_those_of_the_file() {
        for preset in Preset::ALL {
            let text = format!("preset = \"{}\"", preset.name());
            let file: MaterialFile = toml::from_str(&text).unwrap();
            assert_eq!(file.material(), preset.material());
            assert_eq!(Preset::from_name(preset.name()), Some(preset));
        }
    }

    #[test]
    fn keys_replace_values_of_the_preset() {
        let text = "preset = \"cloth\"\ndensity = { per_volume = 900 }\n\
                    bending = { stiffness = 0.5 }\nvolume = {}\n\
                    interior_springs = { stiffness = { compliance = 1e-5 } }\nfriction = 0.25";
        let file: MaterialFile = toml::from_str(text).unwrap();
        let expected = Material {
            density: Density::Volume(900.0),
            bending: Some(Stiffness::Pbd(0.5)),
            volume: Some(Volume::default()),
            interior_springs: Some(InteriorSprings {
                stiffness: Stiffness::Compliance(1e-5),
                ..InteriorSprings::default()
            }),
            friction: 0.25,
            ..Material::cloth()
        };
        assert_eq!(file.material(), expected);
    }
}
