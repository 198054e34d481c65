//! Parameters from keyword arguments and dictionaries, by the names of the Rust libraries.

use crate::error::{OrRaise, refused};
use incise::cut::CutParams;
use incise::params::{Kind, Params, Value, all_fields, resolve};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};

/// Sets the parameters that keyword arguments name.
///
/// `None` is the default of a parameter that is not optional.
pub(crate) fn set<P: Params>(params: &mut P, keywords: Option<&Bound<'_, PyDict>>) -> PyResult<()> {
    let mut entries = Vec::new();
    for (key, value) in keywords.into_iter().flatten() {
        let name: String = key.extract()?;
        let value = match self::value(&value)? {
            Value::None => default_of::<P>(&name).unwrap_or(Value::None),
            value => value,
        };
        entries.push((name, value));
    }
    params.set_value(&Value::Map(entries)).or_raise()
}

/// Returns the default of a parameter that is not optional.
fn default_of<P: Params>(name: &str) -> Option<Value> {
    let path = resolve(P::FIELDS, name).ok()?;
    let (_, field) = all_fields(P::FIELDS)
        .into_iter()
        .find(|(own, _)| *own == path)?;
    let is_optional = matches!(field.kind, Kind::Optional(_));
    (!is_optional).then(|| (field.default)())
}

/// Reads the parameters of a cut.
pub(crate) fn cut_params(keywords: Option<&Bound<'_, PyDict>>) -> PyResult<CutParams> {
    let mut params = CutParams::default();
    set(&mut params, keywords)?;
    params.check().or_raise()?;
    Ok(params)
}

/// Converts a value of Python: None, a bool, text, a number, a sequence or a dictionary.
fn value(any: &Bound<'_, PyAny>) -> PyResult<Value> {
    if any.is_none() {
        return Ok(Value::None);
    }
    if let Ok(flag) = any.extract::<bool>() {
        return Ok(Value::Flag(flag));
    }
    if let Ok(text) = any.cast::<PyString>() {
        return Ok(Value::Text(text.extract()?));
    }
    if let Ok(dict) = any.cast::<PyDict>() {
        let entry = |(key, value): (Bound<'_, PyAny>, Bound<'_, PyAny>)| {
            Ok((key.extract()?, self::value(&value)?))
        };
        return Ok(Value::Map(dict.iter().map(entry).collect::<PyResult<_>>()?));
    }
    if any.len().is_ok() {
        let values = any.try_iter()?.map(|value| self::value(&value?));
        return Ok(Value::List(values.collect::<PyResult<_>>()?));
    }
    if let Ok(count) = any.extract::<u64>() {
        return Ok(Value::Count(count));
    }
    let number = any.extract().map(Value::Number);
    number.map_err(|_| {
        let kind = any.get_type();
        PyTypeError::new_err(format!(
            "{kind} is no parameter; pass a bool, a number, a str, a sequence or a dict"
        ))
    })
}

/// Reads one of a few names.
pub(crate) fn choice<T>(
    value: &Bound<'_, PyAny>,
    option: &str,
    names: &[&str],
    find: impl Fn(&str) -> Option<T>,
) -> PyResult<T> {
    let text: String = value
        .extract()
        .map_err(|_| PyTypeError::new_err(format!("{option} is no text; pass a str")))?;
    find(&text).ok_or_else(|| {
        refused(format_args!(
            "{option} is '{text}'; pass one of {}",
            names.join(", ")
        ))
    })
}
