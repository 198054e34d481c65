//! Colliders from Python dictionaries with the keys of scene files.

use crate::arrays::{edge, vector};
use crate::error::refused;
use incise::mesh::geometry::round_to_f32;
use incise::pbd::Collider;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Reads a number in 32 bits.
fn real(value: &Bound<'_, PyAny>, name: &str) -> PyResult<f32> {
    let number = value.extract().map(round_to_f32);
    number.map_err(|_| PyTypeError::new_err(format!("{name} is no number; pass a float")))
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
