//! Materials, contacts and colliders from Python dictionaries with the keys of scene files.

use crate::arrays::{edge, vector};
use crate::error::refused;
use crate::options::{choice, number};
use incise::mesh::geometry::round_to_f32;
use incise::pbd::{Collider, Density, InteriorSprings, Material, Stiffness, Volume};
use incise::scene::ContactParams;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Reads a material: the name of a preset.
pub(crate) fn preset(name: &Bound<'_, PyAny>) -> PyResult<Material> {
    let presets = [
        ("soft-body", Material::soft_body()),
        ("shell", Material::shell()),
        ("limp-shell", Material::default()),
        ("cloth", Material::cloth()),
    ];
    choice(name, "material", &presets)
}

/// Returns a material with the values that keys replace.
pub(crate) fn changed(
    mut material: Material,
    keys: Option<&Bound<'_, PyDict>>,
) -> PyResult<Material> {
    for (key, value) in keys.into_iter().flatten() {
        let key: String = key.extract()?;
        match key.as_str() {
            "density" => material.density = density(&value)?,
            "stretch" => material.stretch = stiffness(&value, &key)?,
            "bending" => material.bending = some(&value, |value| stiffness(value, &key))?,
            "volume" => material.volume = some(&value, volume)?,
            "interior_springs" => material.interior_springs = some(&value, interior_springs)?,
            "damping" => material.damping = real(&value, &key)?,
            "friction" => material.friction = real(&value, &key)?,
            _ => {
                return Err(PyTypeError::new_err(format!(
                    "unknown key '{key}' of a material; keys are density, stretch, bending, \
                     volume, interior_springs, damping and friction"
                )));
            }
        }
    }
    Ok(material)
}

/// Reads a value that may be None.
pub(crate) fn some<'py, T>(
    value: &Bound<'py, PyAny>,
    read: impl FnOnce(&Bound<'py, PyAny>) -> PyResult<T>,
) -> PyResult<Option<T>> {
    (!value.is_none()).then(|| read(value)).transpose()
}

/// Reads a number in 32 bits.
pub(crate) fn real(value: &Bound<'_, PyAny>, name: &str) -> PyResult<f32> {
    number(value, name).map(round_to_f32)
}

/// Iterates over the keys and values of a dictionary.
fn items<'py>(
    value: &Bound<'py, PyAny>,
    name: &str,
    example: &str,
) -> PyResult<Vec<(String, Bound<'py, PyAny>)>> {
    let dict = value.cast::<PyDict>();
    let dict = dict.map_err(|_| refused(format_args!("{name} is no dict; pass {example}")))?;
    dict.iter()
        .map(|(key, value)| Ok((key.extract()?, value)))
        .collect()
}

fn unknown_key(key: &str, name: &str, example: &str) -> PyErr {
    refused(format_args!(
        "{name} has the unknown key '{key}'; pass {example}"
    ))
}

/// Reads a dictionary with a single key.
fn single<'py>(
    value: &Bound<'py, PyAny>,
    name: &str,
    example: &str,
) -> PyResult<(String, Bound<'py, PyAny>)> {
    let [item] = <[_; 1]>::try_from(items(value, name, example)?).map_err(|items| {
        refused(format_args!(
            "{name} has {} keys; pass {example}",
            items.len()
        ))
    })?;
    Ok(item)
}

fn density(value: &Bound<'_, PyAny>) -> PyResult<Density> {
    let example = "{'per_area': 1.0} or {'per_volume': 1000.0}";
    let (key, value) = single(value, "density", example)?;
    match key.as_str() {
        "per_area" => Ok(Density::Area(real(&value, &key)?)),
        "per_volume" => Ok(Density::Volume(real(&value, &key)?)),
        _ => Err(unknown_key(&key, "density", example)),
    }
}

fn stiffness(value: &Bound<'_, PyAny>, name: &str) -> PyResult<Stiffness> {
    let example = "{'stiffness': 1.0} or {'compliance': 1e-4}";
    let (key, value) = single(value, name, example)?;
    match key.as_str() {
        "stiffness" => Ok(Stiffness::Pbd(real(&value, &key)?)),
        "compliance" => Ok(Stiffness::Compliance(real(&value, &key)?)),
        _ => Err(unknown_key(&key, name, example)),
    }
}

fn volume(value: &Bound<'_, PyAny>) -> PyResult<Volume> {
    let example = "{'compressibility': 0.0, 'pressure': 1.0}";
    let mut volume = Volume::default();
    for (key, value) in items(value, "volume", example)? {
        match key.as_str() {
            "compressibility" => volume.compressibility = real(&value, &key)?,
            "pressure" => volume.pressure = real(&value, &key)?,
            _ => return Err(unknown_key(&key, "volume", example)),
        }
    }
    Ok(volume)
}

fn interior_springs(value: &Bound<'_, PyAny>) -> PyResult<InteriorSprings> {
    let example = "{'density': 1.0, 'stiffness': {'compliance': 1e-3}}";
    let mut springs = InteriorSprings::default();
    for (key, value) in items(value, "interior_springs", example)? {
        match key.as_str() {
            "density" => springs.density = real(&value, &key)?,
            "stiffness" => springs.stiffness = stiffness(&value, "interior_springs")?,
            _ => return Err(unknown_key(&key, "interior_springs", example)),
        }
    }
    Ok(springs)
}

/// Reads contacts: None, True or False, or a dictionary.
pub(crate) fn contacts(value: &Bound<'_, PyAny>) -> PyResult<Option<ContactParams>> {
    if let Ok(enabled) = value.extract::<bool>() {
        return Ok(enabled.then(ContactParams::default));
    }
    some(value, |value| {
        let example = "True, or {'thickness': 0.1, 'self_collision': True}";
        let mut params = ContactParams::default();
        for (key, value) in items(value, "contacts", example)? {
            match key.as_str() {
                "thickness" => params.thickness = real(&value, &key)?,
                "self_collision" => params.self_collision = value.extract()?,
                _ => return Err(unknown_key(&key, "contacts", example)),
            }
        }
        Ok(params)
    })
}

/// Reads a collider, `{"sphere": {"center": ..., "radius": ...}}` for example.
pub(crate) fn collider(value: &Bound<'_, PyAny>, number: usize) -> PyResult<Collider> {
    let name = format!("colliders[{number}]");
    let shapes = "a dict with one of the keys plane, sphere, capsule and box";
    let (shape, keys) = single(value, &name, shapes)?;
    let example = match shape.as_str() {
        "plane" => "{'point': [0, 0, 0], 'normal': [0, 1, 0]}",
        "sphere" => "{'center': [0, 0, 0], 'radius': 1.0}",
        "capsule" => "{'ends': [[0, 0, 0], [0, 1, 0]], 'radius': 1.0}",
        "box" => "{'center': [0, 0, 0], 'half': [1, 1, 1]}",
        _ => return Err(unknown_key(&shape, &name, shapes)),
    };
    let name = format!("{name}['{shape}']");
    let mut keys = items(&keys, &name, example)?;
    let mut optional = |key: &str| {
        let at = keys.iter().position(|(own, _)| own == key)?;
        Some(keys.swap_remove(at).1)
    };
    let axes = (shape == "box").then(|| optional("axes")).flatten();
    let mut item = |key: &str| {
        let missing = || refused(format_args!("{name} has no {key}; pass {example}"));
        optional(key).ok_or_else(missing)
    };
    let collider = match shape.as_str() {
        "plane" => Collider::Plane {
            point: vector(&item("point")?, "point")?,
            normal: vector(&item("normal")?, "normal")?,
        },
        "sphere" => Collider::Sphere {
            center: vector(&item("center")?, "center")?,
            radius: real(&item("radius")?, "radius")?,
        },
        "capsule" => Collider::Capsule {
            ends: edge(&item("ends")?, "ends")?,
            radius: real(&item("radius")?, "radius")?,
        },
        _ => Collider::Box {
            center: vector(&item("center")?, "center")?,
            half: vector(&item("half")?, "half")?,
            axes: match axes {
                Some(axes) => edge(&axes, "axes")?,
                None => [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            },
        },
    };
    if let Some((key, _)) = keys.first() {
        return Err(unknown_key(key, &name, example));
    }
    if collider.is_valid() {
        Ok(collider)
    } else {
        Err(refused(format_args!(
            "{name} is no solid shape; pass finite numbers, sizes above 0 and directions of a \
             length"
        )))
    }
}
