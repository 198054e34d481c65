//! Numpy arrays over the memory of immutable Python objects: no copy is made.

use crate::cut::CutResult;
use crate::error::refused;
use crate::mesh::Mesh;
use numpy::ndarray::{ArrayView, Dimension, IntoDimension};
use numpy::{Element, PyArray};
use pyo3::PyClass;
use pyo3::prelude::*;
use pyo3::pyclass::boolean_struct::True;

/// A frozen class whose arrays no method writes to or moves once an object exists.
///
/// `of` relies on it. A cache beside the arrays is allowed.
pub(crate) trait Immutable: PyClass<Frozen = True> + Sync {}

impl Immutable for Mesh {}
impl Immutable for CutResult {}

/// Returns a read-only array of shape `shape` over the values that `values` picks from an object.
///
/// The array keeps the object alive.
///
/// # Errors
/// Only if the values do not fill the shape, or numpy is out of memory.
#[expect(unsafe_code, reason = "numpy shares the memory of the object")]
pub(crate) fn of<'py, C: Immutable, T: Element, I: IntoDimension>(
    object: &Bound<'py, C>,
    values: impl FnOnce(&C) -> &[T],
    shape: I,
) -> PyResult<Bound<'py, PyAny>>
where
    I::Dim: Dimension,
{
    let view = ArrayView::from_shape(shape.into_dimension(), values(object.get()));
    let view = view.map_err(refused)?;
    // SAFETY: `values` borrows from the object for any lifetime, so the values belong to it or are
    // static. The class is `Immutable`: they are neither written nor moved, and live as long as the
    // object, which is the base object of the array. The array is made read-only before Python sees
    // it. Numpy refuses to make it writable again, because the base object is no writable buffer.
    let array = unsafe { PyArray::borrow_from_array(&view, object.clone().into_any()) };
    array.call_method1("setflags", (false,))?;
    Ok(array.into_any())
}
