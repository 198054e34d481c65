//! Colliders from objects of JavaScript with the keys of scene files.

use crate::error::WebError;
use incise::params::{ParamError, Parameter, Value};
use incise::pbd::{Collider, ConstraintError};

const SHAPES: &str = "an object with one of the keys plane, sphere, capsule and box";

/// Reads a list of colliders, of which one is `{ sphere: { center: [0, 0, 0], radius: 1 } }` for
/// example.
pub(crate) fn colliders(values: &Value) -> Result<Vec<Collider>, WebError> {
    let Value::List(values) = values else {
        let error = ParamError::wrong_type(values, "a list of objects");
        return Err(error.named("colliders").into());
    };
    let read = values.iter().enumerate().map(|(number, value)| {
        let named = |error: ParamError| {
            let inner = error.name();
            let separator = if inner.is_empty() { "" } else { "." };
            error.named(&format!("colliders[{number}]{separator}{inner}"))
        };
        let collider = collider(value).map_err(named)?;
        match collider.is_valid() {
            true => Ok(collider),
            false => Err(ConstraintError::BadCollider { number }.into()),
        }
    });
    read.collect()
}

fn collider(value: &Value) -> Result<Collider, ParamError> {
    let shape = match value {
        Value::Map(entries) => match entries.as_slice() {
            [(shape, Value::Map(keys))] => Some((shape.as_str(), keys.as_slice())),
            _ => None,
        },
        _ => None,
    };
    let wrong = || ParamError::wrong_type(value, SHAPES);
    let (shape, keys) = shape.ok_or_else(wrong)?;
    let known = |names: &[&str]| {
        let unknown = keys.iter().find(|(key, _)| !names.contains(&key.as_str()));
        unknown.map_or(Ok(()), |(key, value)| {
            let names = format!("left out; {shape} has {}", names.join(", "));
            Err(ParamError::wrong_value(value, names).named(key))
        })
    };
    Ok(match shape {
        "plane" => {
            known(&["point", "normal"])?;
            Collider::Plane {
                point: number_of(keys, "point", None)?,
                normal: number_of(keys, "normal", None)?,
            }
        }
        "sphere" => {
            known(&["center", "radius"])?;
            Collider::Sphere {
                center: number_of(keys, "center", None)?,
                radius: number_of(keys, "radius", None)?,
            }
        }
        "capsule" => {
            known(&["ends", "radius"])?;
            Collider::Capsule {
                ends: number_of(keys, "ends", None)?,
                radius: number_of(keys, "radius", None)?,
            }
        }
        "box" => {
            known(&["center", "half", "axes"])?;
            let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
            Collider::Box {
                center: number_of(keys, "center", None)?,
                half: number_of(keys, "half", None)?,
                axes: number_of(keys, "axes", Some(axes))?,
            }
        }
        _ => return Err(wrong()),
    })
}

/// Returns a number or rows of numbers by key.
fn number_of<T: Parameter>(
    keys: &[(String, Value)],
    name: &str,
    default: Option<T>,
) -> Result<T, ParamError> {
    let given = keys.iter().find(|(key, _)| key == name);
    let mut number = T::initial();
    match (given, default) {
        (None, Some(default)) => return Ok(default),
        (None, None) => number.set_value(&Value::None),
        (Some((_, value)), _) => number.set_value(value),
    }
    .map_err(|error| error.named(name))?;
    Ok(number)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(entries: &[(&str, Value)]) -> Value {
        let entries = entries.iter();
        Value::Map(entries.map(|(k, v)| ((*k).to_owned(), v.clone())).collect())
    }

    fn vector(numbers: [f64; 3]) -> Value {
        Value::List(numbers.map(Value::Number).to_vec())
    }

    #[test]
    fn shapes_have_the_keys_of_scene_files() {
        let up = vector([0.0, 1.0, 0.0]);
        let at = vector([0.0, -0.5, 0.0]);
        let plane = map(&[(
            "plane",
            map(&[("point", at.clone()), ("normal", up.clone())]),
        )]);
        let ball = map(&[("center", at.clone()), ("radius", Value::Number(0.5))]);
        let ends = Value::List(vec![at.clone(), up]);
        let capsule = map(&[("ends", ends), ("radius", Value::Number(0.5))]);
        let half = vector([1.0; 3]);
        let cuboid = map(&[("center", at.clone()), ("half", half)]);
        let list = [
            plane,
            map(&[("sphere", ball)]),
            map(&[("capsule", capsule)]),
            map(&[("box", cuboid)]),
        ];
        let center = [0.0, -0.5, 0.0];
        let expected = [
            Collider::ground(-0.5),
            Collider::Sphere {
                center,
                radius: 0.5,
            },
            Collider::Capsule {
                ends: [center, [0.0, 1.0, 0.0]],
                radius: 0.5,
            },
            Collider::Box {
                center,
                half: [1.0; 3],
                axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            },
        ];
        assert_eq!(colliders(&Value::List(list.to_vec())).unwrap(), expected);
    }

    #[test]
    fn others_are_refused_with_their_place() {
        let sphere = |entries: &[(&str, Value)]| map(&[("sphere", map(entries))]);
        let center = ("center", vector([0.0; 3]));
        for (value, place) in [
            (map(&[("cone", map(&[]))]), "colliders[0]"),
            (Value::Number(1.0), "colliders[0]"),
            (sphere(std::slice::from_ref(&center)), "colliders[0].radius"),
            (
                sphere(&[center.clone(), ("radius", Value::from("big"))]),
                "colliders[0].radius",
            ),
            (
                sphere(&[center.clone(), ("height", Value::Number(1.0))]),
                "colliders[0].height",
            ),
            (
                sphere(&[center, ("radius", Value::Number(-1.0))]),
                "collider 0",
            ),
        ] {
            let text = colliders(&Value::List(vec![value])).unwrap_err();
            let text = text.to_string();
            assert!(text.contains(place), "{text}");
        }
        let text = colliders(&Value::Number(1.0)).unwrap_err().to_string();
        assert!(text.contains("a list of objects"), "{text}");
    }
}
