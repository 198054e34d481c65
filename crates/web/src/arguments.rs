//! Arguments of JavaScript: names, rows of numbers, and typed arrays of any length.

use crate::error::WebError;
use incise::cut::{CutMethod, CutParams, PaperParams};
use incise::mesh::{MeshData, read_gltf, read_obj, read_ply, read_stl};
use incise::pbd::{Material, SolverParams};
use incise_models::Model;
use js_sys::{Float32Array, Float64Array, Uint8Array, Uint32Array};
use wasm_bindgen::JsCast;

/// Returns the parameters of a cut; absent names are the defaults of the library.
pub(crate) fn cut_params(level: Option<&str>, method: Option<&str>) -> Result<CutParams, WebError> {
    let mut params = CutParams::default();
    if let Some(level) = level {
        params.refine.level = level.parse()?;
    }
    if let Some(method) = method {
        params.method = cut_method(method)?;
    }
    Ok(params)
}

/// Returns the method of a name.
pub(crate) fn cut_method(name: &str) -> Result<CutMethod, WebError> {
    match name {
        "exact" => Ok(CutMethod::default()),
        "paper" => Ok(CutMethod::Paper(PaperParams::default())),
        _ => Err(unknown(name, "cut method", "exact or paper")),
    }
}

/// Returns the name of a method.
pub(crate) fn method_name(method: CutMethod) -> &'static str {
    match method {
        CutMethod::Exact(_) => "exact",
        CutMethod::Paper(_) => "paper",
    }
}

/// Returns the material of a name, a soft body if absent.
pub(crate) fn material(name: Option<&str>) -> Result<Material, WebError> {
    match name {
        None | Some("soft-body") => Ok(Material::soft_body()),
        Some("shell") => Ok(Material::shell()),
        Some("cloth") => Ok(Material::cloth()),
        Some(name) => Err(unknown(name, "material", "soft-body, shell or cloth")),
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

/// Returns a count of JavaScript, which may be any number.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a whole number of 20 bits"
)]
pub(crate) fn count(name: &'static str, value: f64) -> Result<u32, WebError> {
    let most = SolverParams::MAX_COUNT;
    if value.fract() == 0.0 && (1.0..=f64::from(most)).contains(&value) {
        return Ok(value as u32);
    }
    Err(WebError::Count { name, value, most })
}

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
    fn names_of_methods_round_trip() {
        for name in ["exact", "paper"] {
            assert_eq!(method_name(cut_method(name).unwrap()), name);
        }
        assert!(cut_method("Exact").is_err());
    }

    #[test]
    fn absent_names_are_the_defaults() {
        assert_eq!(cut_params(None, None).unwrap(), CutParams::default());
        assert_eq!(material(None).unwrap(), Material::soft_body());
        let params = cut_params(Some("0.7"), Some("paper")).unwrap();
        assert_eq!(params.refine.level.z(), 0.7);
        assert!(cut_params(Some("-1"), None).is_err());
    }

    #[test]
    fn counts_are_whole_numbers_in_range() {
        assert_eq!(count("substeps", 16.0).unwrap(), 16);
        for bad in [-1.0, 0.0, 1.5, f64::NAN, f64::INFINITY, 4294967295.0] {
            let text = count("substeps", bad).unwrap_err().to_string();
            assert_eq!(
                text,
                format!("substeps is {bad}; pass a whole number from 1 to 1048576")
            );
        }
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
