//! Numpy arrays of callers as vectors: conversion, and checks of shape, type and values.
//!
//! Every input is copied once, while the interpreter is held, so no later write to it matters.

use crate::error::refused;
use incise::mesh::geometry::round_to_f32;
use incise::mesh::{Aabb, nearby_origin};
use numpy::ndarray::ArrayViewD;
use numpy::{PyArrayDyn, PyArrayMethods, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::prelude::*;

/// A numpy array of numbers with its shape.
pub(crate) struct Numbers<T> {
    pub(crate) shape: Vec<usize>,
    /// The values in row-major order.
    pub(crate) values: Vec<T>,
}

/// Converts anything that numpy accepts to an array, and refuses other than the given kinds.
fn as_array<'py>(
    value: &Bound<'py, PyAny>,
    name: &str,
    kinds: &str,
    expected: &str,
) -> PyResult<Bound<'py, PyUntypedArray>> {
    let numpy = value.py().import("numpy")?;
    let array = numpy
        .call_method1("asarray", (value,))
        .map_err(|error| refused(format_args!("{name} is no array: {error}; pass {expected}")))?;
    let array = array.cast_into::<PyUntypedArray>()?;
    let dtype = array.dtype();
    let kind: char = dtype.getattr("kind")?.extract()?;
    // An empty list has no type of its own; numpy calls it float64.
    if !kinds.contains(kind) && !array.is_empty() {
        return Err(refused(format_args!(
            "{name} has dtype {dtype}; pass {expected}"
        )));
    }
    Ok(array)
}

/// Returns the array with elements of a dtype that holds all of its values.
fn cast<'py, T: numpy::Element>(
    array: &Bound<'py, PyUntypedArray>,
    dtype: &str,
) -> PyResult<Bound<'py, PyArrayDyn<T>>> {
    let cast = array.call_method1("astype", (dtype,))?;
    Ok(cast.cast_into::<PyArrayDyn<T>>()?)
}

fn copied<T: Copy, U>(view: &ArrayViewD<'_, T>, to: impl Fn(T) -> U) -> Vec<U> {
    match view.as_slice() {
        Some(values) => values.iter().map(|&x| to(x)).collect(),
        None => view.iter().map(|&x| to(x)).collect(),
    }
}

/// Reads real numbers, rounded once to 32 bits, and refuses NaN and infinity.
pub(crate) fn floats(value: &Bound<'_, PyAny>, name: &str) -> PyResult<Numbers<f32>> {
    let array = as_array(value, name, "fiu", "numbers, best of dtype float32")?;
    let values = if let Ok(array) = array.cast::<PyArrayDyn<f32>>() {
        copied(&array.try_readonly().map_err(refused)?.as_array(), |x| x)
    } else {
        let array = cast::<f64>(&array, "float64")?;
        copied(&array.readonly().as_array(), round_to_f32)
    };
    finite(values, array.shape().to_vec(), name)
}

/// Returns numbers with their shape, and refuses NaN and infinity.
fn finite(values: Vec<f32>, shape: Vec<usize>, name: &str) -> PyResult<Numbers<f32>> {
    if let Some(at) = values.iter().position(|x| !x.is_finite()) {
        let row = at / shape.iter().skip(1).product::<usize>().max(1);
        return Err(refused(format_args!(
            "{name}[{row}] is NaN, infinite or beyond the range of float32; pass finite numbers"
        )));
    }
    Ok(Numbers { shape, values })
}

/// Reads the rows of an array of shape (n, N).
pub(crate) fn float_rows<const N: usize>(
    value: &Bound<'_, PyAny>,
    name: &str,
) -> PyResult<Vec<[f32; N]>> {
    let numbers = floats(value, name)?;
    match *numbers.shape.as_slice() {
        [_, columns] if columns == N => Ok(numbers.values.as_chunks::<N>().0.to_vec()),
        _ => Err(wrong_shape(name, &numbers.shape, &format!("(n, {N})"))),
    }
}

/// Reads vertices of shape (n, 3) and their origin.
///
/// Vertices of other types than float32 that are far from zero become relative to a near point,
/// rounded once after the subtraction. Others have the origin zero.
pub(crate) fn vertices(value: &Bound<'_, PyAny>) -> PyResult<(Vec<[f32; 3]>, [f64; 3])> {
    let name = "vertices";
    let positions = float_rows::<3>(value, name)?;
    let origin = nearby_origin(&Aabb::around(positions.iter().copied()));
    let array = as_array(value, name, "fiu", "numbers")?;
    if origin == [0.0; 3] || array.cast::<PyArrayDyn<f32>>().is_ok() {
        return Ok((positions, [0.0; 3]));
    }
    let array = cast::<f64>(&array, "float64")?;
    let exact = copied(&array.readonly().as_array(), |x| x);
    let subtract = |p: &[f64; 3]| [0, 1, 2].map(|k| round_to_f32(p[k] - origin[k]));
    Ok((
        exact.as_chunks::<3>().0.iter().map(subtract).collect(),
        origin,
    ))
}

/// Reads faces of shape (m, 3), whose indices must be below `vertices`.
pub(crate) fn faces(value: &Bound<'_, PyAny>, vertices: usize) -> PyResult<Vec<[u32; 3]>> {
    let array = as_array(value, "faces", "iu", INTEGERS)?;
    let shape = array.shape().to_vec();
    if !matches!(*shape.as_slice(), [_, 3]) {
        return Err(wrong_shape("faces", &shape, "(m, 3)"));
    }
    let out_of_range = |at: usize, index: &dyn std::fmt::Display| {
        refused(format_args!(
            "faces[{}] has the index {index}; there are {vertices} vertices, so pass 0 to {}",
            at / 3,
            vertices.saturating_sub(1)
        ))
    };
    let values = if let Ok(array) = array.cast::<PyArrayDyn<u32>>() {
        copied(&array.try_readonly().map_err(refused)?.as_array(), |x| x)
    } else {
        // Indices beyond 63 bits become negative and are refused as well.
        let array = cast::<i64>(&array, "int64")?;
        let array = array.readonly();
        let view = array.as_array();
        let index = |(at, &x): (usize, &i64)| u32::try_from(x).map_err(|_| out_of_range(at, &x));
        view.iter()
            .enumerate()
            .map(index)
            .collect::<PyResult<_>>()?
    };
    if let Some(at) = values.iter().position(|&x| x as usize >= vertices) {
        return Err(out_of_range(at, &values[at]));
    }
    Ok(values.as_chunks::<3>().0.to_vec())
}

const INTEGERS: &str = "integers, best of dtype uint32";

/// Reads the material numbers of `m` faces.
pub(crate) fn materials(value: &Bound<'_, PyAny>, m: usize) -> PyResult<Vec<u32>> {
    let name = "materials";
    let array = as_array(value, name, "iu", INTEGERS)?;
    if array.shape() != [m] {
        return Err(wrong_shape(name, array.shape(), &format!("({m},)")));
    }
    let array = cast::<i64>(&array, "int64")?;
    let array = array.readonly();
    let number = |&x: &i64| {
        let text = format_args!("{name} has the number {x}; pass 0 to {}", u32::MAX - 1);
        let number = u32::try_from(x).ok().filter(|&x| x != u32::MAX);
        number.ok_or_else(|| refused(text))
    };
    array.as_array().iter().map(number).collect()
}

/// Reads a point or a direction in 64 bits: three finite numbers.
pub(crate) fn point(value: &Bound<'_, PyAny>, name: &str) -> PyResult<[f64; 3]> {
    let numpy = value.py().import("numpy")?;
    let list = numpy.call_method1("asarray", (value, "float64"));
    let list = list.and_then(|array| array.call_method0("tolist"));
    let point = list.and_then(|list| list.extract::<[f64; 3]>());
    let point =
        point.map_err(|_| refused(format_args!("{name} is no vector; pass three numbers")))?;
    if point.iter().all(|x| x.is_finite()) {
        return Ok(point);
    }
    Err(refused(format_args!(
        "{name} is {point:?}; pass finite numbers"
    )))
}

/// Reads a point or a direction: three numbers.
pub(crate) fn vector(value: &Bound<'_, PyAny>, name: &str) -> PyResult<[f32; 3]> {
    let numbers = floats(value, name)?;
    let vector = <[f32; 3]>::try_from(numbers.values);
    vector.map_err(|_| wrong_shape(name, &numbers.shape, "(3,)"))
}

/// Reads the two ends of an edge: shape (2, 3).
pub(crate) fn edge(value: &Bound<'_, PyAny>, name: &str) -> PyResult<[[f32; 3]; 2]> {
    let rows = float_rows::<3>(value, name)?;
    let count = rows.len();
    <[[f32; 3]; 2]>::try_from(rows).map_err(|_| wrong_shape(name, &[count, 3], "(2, 3)"))
}

/// Returns the error of an array of another shape.
pub(crate) fn wrong_shape(name: &str, shape: &[usize], expected: &str) -> PyErr {
    let lengths: Vec<String> = shape.iter().map(usize::to_string).collect();
    let comma = if shape.len() == 1 { "," } else { "" };
    refused(format_args!(
        "{name} has shape ({}{comma}); pass shape {expected}",
        lengths.join(", ")
    ))
}
