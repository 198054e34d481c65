//! Parameters of scenes and materials by name.

use crate::handles::with;
use crate::memory::{output_text, put, text};
use crate::simulation::{Scene, SceneObject};
use crate::status::{Error, Status, call};
use incise::params::Value;
use std::ffi::c_char;
use std::mem::MaybeUninit;

/// Sets a parameter of a scene by name, from the next frame on: `"solver.substep"`, or a short
/// name such as `"substep"`. `docs/parameters.md` lists them.
///
/// `value` is a number, `true`, `false`, a name, numbers between commas, or `none` to switch an
/// optional parameter off. Numbers have a point in every locale. An unknown name or a value out of
/// range is an error, and nothing changes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn incise_scene_set(
    scene: *mut Scene,
    name: *const c_char,
    value: *const c_char,
) -> Status {
    call(|| {
        // SAFETY: the caller's contract, see the README.
        let (name, value) = unsafe { (text(name, "name")?, text(value, "value")?) };
        let value = Value::parse(value);
        with(scene, |scene: &mut SceneObject| scene.set(name, &value))
    })
}

/// Sets a parameter of a scene that is a number, see `incise_scene_set`; 1 and 0 are true and
/// false.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn incise_scene_set_number(
    scene: *mut Scene,
    name: *const c_char,
    value: f64,
) -> Status {
    call(|| {
        // SAFETY: the caller's contract, see the README.
        let name = unsafe { text(name, "name")? };
        with(scene, |scene: &mut SceneObject| {
            scene.set(name, &number_like(&scene.get(name)?, value))
        })
    })
}

/// Copies a parameter of a scene as a text that `incise_scene_set` accepts; see
/// `incise_mesh_warnings` for the other arguments.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn incise_scene_get(
    scene: *mut Scene,
    name: *const c_char,
    out: *mut c_char,
    capacity: usize,
    length: Option<&mut MaybeUninit<usize>>,
) -> Status {
    call(|| {
        // SAFETY: the caller's contract, see the README.
        let name = unsafe { text(name, "name")? };
        with(scene, |scene: &mut SceneObject| {
            let value = scene.get(name)?.to_string();
            // SAFETY: the caller's contract, see the README.
            unsafe { output_text(&value, out, capacity, length) }
        })
    })
}

/// Writes a parameter of a scene that is a number, 1 or 0 for true and false.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn incise_scene_get_number(
    scene: *mut Scene,
    name: *const c_char,
    out: Option<&mut MaybeUninit<f64>>,
) -> Status {
    call(|| {
        // SAFETY: the caller's contract, see the README.
        let name = unsafe { text(name, "name")? };
        with(scene, |scene: &mut SceneObject| {
            put(out, number(name, &scene.get(name)?)?, "out")
        })
    })
}

/// Sets a parameter of a body's material by name, from the next frame on: `"friction"`,
/// `"bending.compliance"` or `"volume.pressure"`; see `incise_scene_set`.
///
/// Refused as by `incise_body_set_material`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn incise_body_set(
    scene: *mut Scene,
    body: u32,
    name: *const c_char,
    value: *const c_char,
) -> Status {
    call(|| {
        // SAFETY: the caller's contract, see the README.
        let (name, value) = unsafe { (text(name, "name")?, text(value, "value")?) };
        let value = Value::parse(value);
        with(scene, |scene: &mut SceneObject| {
            scene.set_body(body, name, &value)
        })
    })
}

/// Sets a parameter of a body's material that is a number, see `incise_body_set`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn incise_body_set_number(
    scene: *mut Scene,
    body: u32,
    name: *const c_char,
    value: f64,
) -> Status {
    call(|| {
        // SAFETY: the caller's contract, see the README.
        let name = unsafe { text(name, "name")? };
        with(scene, |scene: &mut SceneObject| {
            let value = number_like(&scene.get_body(body, name)?, value);
            scene.set_body(body, name, &value)
        })
    })
}

/// Copies a parameter of a body's material as a text that `incise_body_set` accepts; see
/// `incise_mesh_warnings` for the other arguments.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn incise_body_get(
    scene: *mut Scene,
    body: u32,
    name: *const c_char,
    out: *mut c_char,
    capacity: usize,
    length: Option<&mut MaybeUninit<usize>>,
) -> Status {
    call(|| {
        // SAFETY: the caller's contract, see the README.
        let name = unsafe { text(name, "name")? };
        with(scene, |scene: &mut SceneObject| {
            let value = scene.get_body(body, name)?.to_string();
            // SAFETY: the caller's contract, see the README.
            unsafe { output_text(&value, out, capacity, length) }
        })
    })
}

/// Writes a parameter of a body's material that is a number, 1 or 0 for true and false.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn incise_body_get_number(
    scene: *mut Scene,
    body: u32,
    name: *const c_char,
    out: Option<&mut MaybeUninit<f64>>,
) -> Status {
    call(|| {
        // SAFETY: the caller's contract, see the README.
        let name = unsafe { text(name, "name")? };
        with(scene, |scene: &mut SceneObject| {
            put(out, number(name, &scene.get_body(body, name)?)?, "out")
        })
    })
}

/// Returns a number as the value of a parameter, true and false for 1 and 0 where it is a flag.
fn number_like(present: &Value, number: f64) -> Value {
    match present {
        Value::Flag(_) if number == 0.0 => Value::Flag(false),
        Value::Flag(_) if number == 1.0 => Value::Flag(true),
        _ => Value::Number(number),
    }
}

/// Returns a value as a number.
pub(crate) fn number(name: &str, value: &Value) -> Result<f64, Error> {
    let number = match value {
        Value::Flag(flag) => Some(f64::from(u8::from(*flag))),
        value => value.number(),
    };
    number.ok_or_else(|| {
        Error::argument(format_args!(
            "{name} is '{value}', which is no number; get it as a text"
        ))
    })
}
