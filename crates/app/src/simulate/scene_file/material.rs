//! [`MaterialFile`]: a material of a scene file, as changes to a preset.

use incise_params::{ParamError, Parameter, Params, Value};
use incise_pbd_gpu::Material;
use serde::Deserialize;
use std::collections::BTreeMap;

/// A material: a preset, and the values that replace its own, by name.
#[derive(Debug, Clone, Default, Deserialize)]
pub(in crate::simulate) struct MaterialFile {
    /// The name of the preset, a soft body without one.
    pub(in crate::simulate) preset: Option<String>,
    #[serde(flatten)]
    pub(in crate::simulate) values: BTreeMap<String, Value>,
}

impl MaterialFile {
    /// Returns the material for the solver, whose numbers are in their ranges.
    pub(super) fn material(&self) -> Result<Material, ParamError> {
        let preset = self.preset.as_deref().unwrap_or("soft-body");
        let mut material = Material::preset(preset).ok_or_else(|| ParamError::WrongType {
            name: "preset".to_owned(),
            value: preset.to_owned(),
            expected: format!("one of {}", Material::PRESETS.join(", ")),
        })?;
        let values = self.values.iter();
        let values = values.map(|(name, value)| (name.clone(), value.clone()));
        material.set_value(&Value::Map(values.collect()))?;
        material.check_ranges()?;
        Ok(material)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use incise_pbd_gpu::{Density, Stiffness, Volume};

    #[test]
    fn keys_replace_values_of_the_preset() {
        let text = "preset = \"cloth\"\ndensity = { per_volume = 900 }\n\
                    bending = { stiffness = 0.5 }\nvolume = {}\n\
                    friction = 0.25";
        let file: MaterialFile = toml::from_str(text).unwrap();
        let expected = Material {
            density: Density::Volume(900.0),
            bending: Some(Stiffness::Pbd(0.5)),
            volume: Some(Volume::default()),
            friction: 0.25,
            ..Material::cloth()
        };
        assert_eq!(file.material(), Ok(expected));
        let error = toml::from_str::<MaterialFile>("preset = \"steel\"").unwrap();
        let error = error.material().unwrap_err().to_string();
        assert_eq!(
            error,
            "preset is 'steel'; it must be one of soft-body, shell, cloth, limp-shell, skin, \
             liver, muscle, jelly, rubber"
        );
    }
}
