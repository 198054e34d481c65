//! Arguments of JavaScript: names, rows of numbers, and typed arrays of any length.

use crate::error::WebError;
use incise::cut::CutParams;
use incise::mesh::{MeshData, read_gltf, read_obj, read_ply, read_stl};
use incise::params::{ParamError, Params, Value};
use incise::pbd::Material;
use incise_models::Model;
use js_sys::{Array, Float32Array, Float64Array, Object, Uint8Array, Uint32Array};
use wasm_bindgen::{JsCast, JsValue};

/// Returns the parameters of a cut: the defaults with values by name, or without them.
pub(crate) fn cut_params(values: &Value) -> Result<CutParams, WebError> {
    let mut params = CutParams::default();
    set(&mut params, values)?;
    params.check()?;
    Ok(params)
}

/// Sets parameters by name.
pub(crate) fn set<P: Params>(params: &mut P, values: &Value) -> Result<(), WebError> {
    match values {
        Value::None => Ok(()),
        Value::Map(_) => Ok(params.set_value(values)?),
        _ => Err(ParamError::wrong_type(values, P::KIND)
            .named("the argument")
            .into()),
    }
}

/// Returns a material: a name, or values by name with or without the name `preset`. Replaces the
/// values of the default without one.
pub(crate) fn material(values: &Value, default: Material) -> Result<Material, WebError> {
    let (preset, values) = match values {
        Value::Map(entries) => {
            let preset = entries.iter().find(|(name, _)| name == "preset");
            let others = entries.iter().filter(|(name, _)| name != "preset");
            let values = Value::Map(others.cloned().collect());
            (
                preset.map_or(Value::None, |(_, preset)| preset.clone()),
                values,
            )
        }
        preset => (preset.clone(), Value::None),
    };
    let mut material = match &preset {
        Value::None => default,
        preset => Material::preset(&preset.to_string()).ok_or_else(|| {
            let names = format!("one of {}", Material::PRESETS.join(", "));
            ParamError::wrong_value(preset, names).named("preset")
        })?,
    };
    set(&mut material, &values)?;
    Ok(material)
}

/// Maximum depth of an object of parameters.
const MAX_DEPTH: usize = 8;

/// Converts a value of JavaScript; properties that are undefined are left out.
pub(crate) fn value(js: &JsValue) -> Result<Value, WebError> {
    value_within(js, MAX_DEPTH)
}

fn value_within(js: &JsValue, depth: usize) -> Result<Value, WebError> {
    let depth = depth.checked_sub(1).ok_or(WebError::TooDeep)?;
    if js.is_null() || js.is_undefined() {
        return Ok(Value::None);
    }
    if let Some(flag) = js.as_bool() {
        return Ok(Value::Flag(flag));
    }
    if let Some(number) = js.as_f64() {
        return Ok(Value::Number(number));
    }
    if let Some(text) = js.as_string() {
        return Ok(Value::Text(text));
    }
    if let Ok(Some(values)) = js_sys::try_iter(js) {
        let values = values.map(|value| value_within(&value.unwrap_or_default(), depth));
        return Ok(Value::List(values.collect::<Result<_, _>>()?));
    }
    let Some(object) = js.dyn_ref::<Object>() else {
        return Err(WebError::NoParameter);
    };
    let mut entries = Vec::new();
    for entry in Object::entries(object) {
        let entry = Array::from(&entry);
        let (name, value) = (entry.get(0), entry.get(1));
        if !value.is_undefined() {
            let name = name.as_string().unwrap_or_default();
            entries.push((name, value_within(&value, depth)?));
        }
    }
    Ok(Value::Map(entries))
}

/// Converts a value to JavaScript; none becomes null.
pub(crate) fn to_js(value: &Value) -> JsValue {
    #[expect(
        clippy::cast_precision_loss,
        reason = "numbers of JavaScript are doubles"
    )]
    match value {
        Value::None => JsValue::NULL,
        Value::Flag(flag) => JsValue::from_bool(*flag),
        Value::Count(count) => JsValue::from_f64(*count as f64),
        Value::Number(number) => JsValue::from_f64(*number),
        Value::Text(text) => JsValue::from_str(text),
        Value::List(values) => values.iter().map(to_js).collect::<Array>().into(),
        Value::Map(entries) => {
            let entry = |(name, value): &(String, Value)| {
                Array::of2(&JsValue::from_str(name), &to_js(value))
            };
            let entries: Array = entries.iter().map(entry).collect();
            Object::from_entries(&entries).map_or(JsValue::NULL, Into::into)
        }
    }
}

/// Returns the built-in model of a name.
pub(crate) fn model(name: &str) -> Result<Model, WebError> {
    let known = "Sphere20, Sphere80, Sphere768, Bunny, Octopus, Banana or Armadillo";
    let mut all = Model::ALL.into_iter();
    let found = all.find(|model| model.name().eq_ignore_ascii_case(name));
    found.ok_or_else(|| unknown(name, "model", known))
}

/// Reads a file of a format: `obj`, `ply`, `stl`, `glb` or `gltf` with all buffers inside.
pub(crate) fn read(bytes: &[u8], format: &str) -> Result<MeshData, WebError> {
    match format.to_ascii_lowercase().as_str() {
        "obj" => Ok(read_obj(bytes)?),
        "ply" => Ok(read_ply(bytes)?),
        "stl" => Ok(read_stl(bytes)?),
        "glb" | "gltf" => Ok(read_gltf(bytes, None)?),
        _ => Err(unknown(format, "file format", "obj, ply, stl, glb or gltf")),
    }
}

fn unknown(name: &str, kind: &'static str, expected: &'static str) -> WebError {
    // A name of any length is cut off: it goes into a message.
    let name = name.chars().take(40).collect();
    WebError::UnknownName {
        name,
        kind,
        expected,
    }
}

/// An expected length and its text.
type Length = (usize, &'static str);

pub(crate) const VECTOR: Length = (3, "3: x, y and z");
pub(crate) const EDGE: Length = (6, "6: start and end");

/// Returns an index of JavaScript, which may be any number, unless it has a fraction or a sign.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a whole number of 32 bits"
)]
pub(crate) fn index_of(value: f64) -> Option<usize> {
    let is_index = value.fract() == 0.0 && (0.0..f64::from(u32::MAX)).contains(&value);
    is_index.then_some(value as usize)
}

/// Refuses NaN and infinity.
pub(crate) fn finite(name: &'static str, numbers: &[f64]) -> Result<(), WebError> {
    let bad = numbers.iter().find(|x| !x.is_finite());
    bad.map_or(Ok(()), |&value| Err(WebError::NotFinite { name, value }))
}

/// Returns the numbers of a vector.
pub(crate) fn vector<T: Copy>(array: &'static str, numbers: &[T]) -> Result<[T; 3], WebError> {
    numbers.try_into().map_err(|_| WebError::ArrayLength {
        array,
        length: numbers.len(),
        expected: VECTOR.1,
    })
}

/// Returns the start and the end of a blade's edge.
pub(crate) fn edge(numbers: &[f32]) -> Result<[[f32; 3]; 2], WebError> {
    match *numbers {
        [a, b, c, x, y, z] => Ok([[a, b, c], [x, y, z]]),
        _ => Err(WebError::ArrayLength {
            array: "the edge",
            length: numbers.len(),
            expected: EDGE.1,
        }),
    }
}

/// Returns an array as rows of three.
pub(crate) fn rows<'a, T>(array: &'static str, numbers: &'a [T]) -> Result<&'a [[T; 3]], WebError> {
    match numbers.as_chunks() {
        (rows, []) => Ok(rows),
        _ => Err(WebError::ArrayLength {
            array,
            length: numbers.len(),
            expected: "a multiple of 3",
        }),
    }
}

/// Copies typed arrays, of an expected length or any.
///
/// One that is too long for memory is an error, not a trap.
macro_rules! copy_array {
    ($name:ident, $type:ident, $number:ty) => {
        pub(crate) fn $name(
            array: &'static str,
            from: &$type,
            expected: Option<Length>,
        ) -> Result<Vec<$number>, WebError> {
            if !from.is_instance_of::<$type>() {
                let expected = stringify!($type);
                return Err(WebError::ArrayType { array, expected });
            }
            let length = from.length() as usize;
            if let Some((_, expected)) = expected.filter(|&(expected, _)| expected != length) {
                return Err(WebError::ArrayLength {
                    array,
                    length,
                    expected,
                });
            }
            let mut numbers = Vec::new();
            if numbers.try_reserve_exact(length).is_err() {
                return Err(WebError::TooLarge { array, length });
            }
            numbers.resize(length, <$number>::default());
            from.copy_to(&mut numbers);
            Ok(numbers)
        }
    };
}

copy_array!(copy_f32, Float32Array, f32);
copy_array!(copy_f64, Float64Array, f64);
copy_array!(copy_u32, Uint32Array, u32);
copy_array!(copy_u8, Uint8Array, u8);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_models_are_found_and_others_refused() {
        for expected in Model::ALL {
            assert_eq!(model(expected.name()).unwrap(), expected);
        }
        assert_eq!(model("bunny").unwrap(), Model::Bunny);
        let text = model(&"x".repeat(1000)).unwrap_err().to_string();
        assert!(
            text.ends_with(
                "use Sphere20, Sphere80, Sphere768, Bunny, Octopus, Banana or Armadillo"
            )
        );
        assert!(text.len() < 150, "{text}");
    }

    #[test]
    fn absent_names_are_the_defaults() {
        assert_eq!(cut_params(&Value::None).unwrap(), CutParams::default());
        let material = |values: &Value| material(values, Material::soft_body());
        assert_eq!(material(&Value::None).unwrap(), Material::soft_body());
        let values = |entries: &[(&str, Value)]| {
            let entries = entries
                .iter()
                .map(|(name, value)| ((*name).to_owned(), value.clone()));
            Value::Map(entries.collect())
        };
        let level = ("level", Value::from("0.7"));
        let caps = ("caps", Value::from("none"));
        let params = cut_params(&values(&[level, caps])).unwrap();
        assert_eq!(params.refine.level.z(), 0.7);
        assert_eq!(params.caps.name(), "none");
        for bad in [
            &[("level", Value::Number(-1.0))][..],
            &[("level", Value::from("finest"))],
            &[("snap", Value::Number(0.7))],
        ] {
            assert!(cut_params(&values(bad)).is_err(), "{bad:?}");
        }
        let cloth = [
            ("preset", Value::from("cloth")),
            ("damping", Value::Number(2.0)),
        ];
        let expected = Material {
            damping: 2.0,
            ..Material::cloth()
        };
        assert_eq!(material(&values(&cloth)).unwrap(), expected);
        assert_eq!(material(&Value::from("cloth")).unwrap(), Material::cloth());
        let error = material(&Value::from("steel")).unwrap_err().to_string();
        let names = Material::PRESETS.join(", ");
        assert_eq!(
            error,
            format!("preset is 'steel'; it must be one of {names}")
        );
    }

    #[test]
    fn indices_are_whole_numbers_of_32_bits() {
        assert_eq!((index_of(0.0), index_of(7.0)), (Some(0), Some(7)));
        for bad in [-1.0, 0.5, f64::NAN, f64::INFINITY, 4294967296.0] {
            assert_eq!(index_of(bad), None, "{bad}");
        }
    }

    #[test]
    fn lengths_are_checked() {
        assert_eq!(vector("v", &[1, 2, 3]).unwrap(), [1, 2, 3]);
        assert!(vector("v", &[1, 2]).is_err());
        assert_eq!(
            edge(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]).unwrap()[1],
            [4.0, 5.0, 6.0]
        );
        assert!(edge(&[]).is_err());
        assert_eq!(rows("r", &[0; 6]).unwrap().len(), 2);
        let text = rows("positions", &[0; 7]).unwrap_err().to_string();
        assert_eq!(text, "positions has 7 numbers; pass a multiple of 3");
    }
}
