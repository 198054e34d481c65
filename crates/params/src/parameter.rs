//! [`Parameter`] and [`Params`]: values that are set by name, for numbers, lists, options and the
//! structs of the macros.

use crate::{Field, Kind, OutOfRange, ParamError, Range, Value, names};
use std::num::NonZeroUsize;

/// The type of a parameter.
pub trait Parameter: Sized {
    /// The kind of its values.
    const KIND: Kind;

    /// Returns the value from which parts are set.
    fn initial() -> Self;

    /// Returns the value for files and other languages.
    fn value(&self) -> Value;

    /// Sets the value; in a map only the parameters that it names.
    ///
    /// # Errors
    /// [`ParamError`]; parts before the refused one may be set.
    fn set_value(&mut self, value: &Value) -> Result<(), ParamError>;

    /// Sets the part of a dotted name.
    ///
    /// # Errors
    /// [`ParamError`].
    fn set_part(&mut self, path: &str, value: &Value) -> Result<(), ParamError> {
        let _ = value;
        Err(ParamError::Unknown {
            name: path.to_owned(),
            known: "none".to_owned(),
        })
    }

    /// Checks that the numbers are in a range, those of parts in theirs.
    ///
    /// # Errors
    /// [`OutOfRange`] for the first one that is not.
    fn check_range(&self, range: &'static Range) -> Result<(), OutOfRange>;
}

/// A struct of parameters, made by [`params!`](crate::params).
pub trait Params: Parameter + Default {
    /// The parameters, in the order of the struct.
    const FIELDS: &'static [Field];

    /// Checks that all numbers are in their ranges.
    ///
    /// # Errors
    /// [`OutOfRange`] for the first one that is not.
    fn check_ranges(&self) -> Result<(), OutOfRange>;

    /// Sets a parameter by its dotted name, or a short one, see [`resolve`](crate::resolve).
    ///
    /// Ranges are not checked.
    ///
    /// # Errors
    /// [`ParamError`], and nothing has changed.
    fn set(&mut self, name: &str, value: &Value) -> Result<(), ParamError>
    where
        Self: Clone,
    {
        let entry = Value::Map(vec![(name.to_owned(), value.clone())]);
        let mut changed = self.clone();
        changed.set_value(&entry)?;
        *self = changed;
        Ok(())
    }

    /// Returns a parameter by its dotted name, or a short one.
    ///
    /// # Errors
    /// [`ParamError`].
    fn get(&self, name: &str) -> Result<Value, ParamError> {
        let path = names::resolve(Self::FIELDS, name)?;
        Ok(self.value().at(&path).unwrap_or(Value::None))
    }
}

/// Sets the part `rest` of a parameter with a range, or all of it.
///
/// # Errors
/// [`ParamError`].
pub fn set_part<T: Parameter>(
    parameter: &mut T,
    rest: &str,
    value: &Value,
    range: &'static Range,
) -> Result<(), ParamError> {
    match rest {
        "" => parameter.set_value(value).map_err(|error| match error {
            // The number does not even fit the type.
            ParamError::OutOfRange(error) if !range.contains(error.value) => {
                ParamError::OutOfRange(OutOfRange::new(error.value, range))
            }
            error => error,
        }),
        rest => parameter.set_part(rest, value),
    }
}

/// Sets the parameters of a struct that a map names, in an order that does not depend on the map's.
///
/// A struct is set before its parameters. What is switched off is set last, so that a part does not
/// switch it on again.
///
/// # Errors
/// [`ParamError`], with the name of the map; [`ParamError::Repeated`] for two names of a parameter.
pub fn set_map<P: Params>(params: &mut P, value: &Value) -> Result<(), ParamError> {
    let Value::Map(entries) = value else {
        return Err(ParamError::wrong_type(value, P::KIND));
    };
    let resolved = entries.iter().map(|(name, value)| {
        let path = names::resolve(P::FIELDS, name)?;
        let is_off = value.is_none() || *value == Value::Flag(false);
        Ok(((is_off, path.split('.').count()), path, name, value))
    });
    let mut resolved: Vec<_> = resolved.collect::<Result<_, ParamError>>()?;
    let mut given = Vec::new();
    names::append_given(&mut given, P::FIELDS, ["", ""], entries);
    given.sort();
    if let Some([first, second]) = given.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        let [name, other] = [first, second].map(|(_, name)| name.clone());
        return Err(ParamError::Repeated { name, other });
    }
    resolved.sort_by_key(|&(order, ..)| order);
    for (_, path, name, value) in resolved {
        set_below(params, &path, name, value)?;
    }
    Ok(())
}

/// Sets a parameter by its dotted name; errors have the name that was given.
fn set_below<P: Params>(
    params: &mut P,
    path: &str,
    name: &str,
    value: &Value,
) -> Result<(), ParamError> {
    params.set_part(path, value).map_err(|error| {
        let below = error.name();
        // The full name of the parameter, then that of a part within its value.
        match below
            .strip_prefix(path)
            .and_then(|rest| rest.strip_prefix('.'))
        {
            Some(rest) => error.named(&format!("{name}.{rest}")),
            None => error.named(name),
        }
    })
}

impl Parameter for bool {
    const KIND: Kind = Kind::Flag;

    fn initial() -> Self {
        false
    }

    fn value(&self) -> Value {
        Value::Flag(*self)
    }

    fn set_value(&mut self, value: &Value) -> Result<(), ParamError> {
        match value {
            Value::Flag(flag) => *self = *flag,
            _ => return Err(ParamError::wrong_type(value, Self::KIND)),
        }
        Ok(())
    }

    fn check_range(&self, _: &'static Range) -> Result<(), OutOfRange> {
        Ok(())
    }
}

impl Parameter for f64 {
    const KIND: Kind = Kind::Number;

    fn initial() -> Self {
        0.0
    }

    fn value(&self) -> Value {
        Value::Number(*self)
    }

    fn set_value(&mut self, value: &Value) -> Result<(), ParamError> {
        let number = value.number();
        *self = number.ok_or_else(|| ParamError::wrong_type(value, Self::KIND))?;
        Ok(())
    }

    fn check_range(&self, range: &'static Range) -> Result<(), OutOfRange> {
        match range.contains(*self) {
            true => Ok(()),
            false => Err(OutOfRange::new(*self, range)),
        }
    }
}

/// Returns the double of the shortest decimal that rounds to `x`.
fn shortest(x: f32) -> f64 {
    let exact = f64::from(x);
    let short = x.to_string().parse().unwrap_or(exact);
    if rounded(short).to_bits() == x.to_bits() {
        short
    } else {
        exact
    }
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "the nearest number of 32 bits is meant"
)]
fn rounded(x: f64) -> f32 {
    x as f32
}

impl Parameter for f32 {
    const KIND: Kind = Kind::Number;

    fn initial() -> Self {
        0.0
    }

    fn value(&self) -> Value {
        Value::Number(shortest(*self))
    }

    fn set_value(&mut self, value: &Value) -> Result<(), ParamError> {
        let mut double = 0.0;
        Parameter::set_value(&mut double, value)?;
        *self = rounded(double);
        Ok(())
    }

    fn check_range(&self, range: &'static Range) -> Result<(), OutOfRange> {
        match range.contains(f64::from(*self)) {
            true => Ok(()),
            false => Err(OutOfRange::new(shortest(*self), range)),
        }
    }
}

/// Returns a whole number in the range of a type, from 0 to `max`.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the number is whole and in the range of the type"
)]
fn count(value: &Value, max: u64, range: &'static Range) -> Result<u64, ParamError> {
    let number = match value {
        Value::Count(count) if *count <= max => return Ok(*count),
        _ => value.number(),
    };
    match number {
        Some(x) if x.fract() == 0.0 && range.contains(x) => Ok(x as u64),
        Some(x) if x.fract() == 0.0 => Err(OutOfRange::new(x, range).into()),
        _ => Err(ParamError::wrong_type(value, Kind::Count)),
    }
}

/// Implements [`Parameter`] for whole numbers.
macro_rules! whole {
    ($($type:ty),+) => {$(
        impl Parameter for $type {
            const KIND: Kind = Kind::Count;

            fn initial() -> Self {
                0
            }

            fn value(&self) -> Value {
                Value::Count(u64::try_from(*self).unwrap_or(u64::MAX))
            }

            #[allow(clippy::cast_precision_loss, reason = "the limit in a message")]
            fn set_value(&mut self, value: &Value) -> Result<(), ParamError> {
                let max = u64::try_from(Self::MAX).unwrap_or(u64::MAX);
                let range = const { &Range::NOT_NEGATIVE.up_to(Self::MAX as f64) };
                *self = Self::try_from(count(value, max, range)?).unwrap_or(Self::MAX);
                Ok(())
            }

            fn check_range(&self, range: &'static Range) -> Result<(), OutOfRange> {
                self.value().number().map_or(Ok(()), |number| number.check_range(range))
            }
        }
    )+};
}

whole!(u32, u64, usize);

impl Parameter for NonZeroUsize {
    const KIND: Kind = Kind::Count;

    fn initial() -> Self {
        Self::MIN
    }

    fn value(&self) -> Value {
        self.get().value()
    }

    fn set_value(&mut self, value: &Value) -> Result<(), ParamError> {
        let mut count = 0_usize;
        count.set_value(value)?;
        *self = Self::new(count)
            .ok_or_else(|| OutOfRange::new(0.0, const { &Range::at_least(1.0) }))?;
        Ok(())
    }

    fn check_range(&self, _: &'static Range) -> Result<(), OutOfRange> {
        Ok(())
    }
}

impl<T: Parameter + Copy, const N: usize> Parameter for [T; N] {
    const KIND: Kind = Kind::List(N, &T::KIND);

    fn initial() -> Self {
        [T::initial(); N]
    }

    fn value(&self) -> Value {
        Value::List(self.iter().map(T::value).collect())
    }

    fn set_value(&mut self, value: &Value) -> Result<(), ParamError> {
        match value {
            Value::List(values) if values.len() == N => {
                for (own, value) in self.iter_mut().zip(values) {
                    own.set_value(value)?;
                }
                Ok(())
            }
            Value::List(_) => Err(ParamError::wrong_value(value, Self::KIND)),
            _ => Err(ParamError::wrong_type(value, Self::KIND)),
        }
    }

    fn check_range(&self, range: &'static Range) -> Result<(), OutOfRange> {
        self.iter().try_for_each(|own| own.check_range(range))
    }
}

impl<T: Parameter> Parameter for Option<T> {
    const KIND: Kind = Kind::Optional(&T::KIND);

    fn initial() -> Self {
        None
    }

    fn value(&self) -> Value {
        self.as_ref().map_or(Value::None, T::value)
    }

    /// Sets the value; a struct also by true and false, and by the name `enabled`.
    fn set_value(&mut self, value: &Value) -> Result<(), ParamError> {
        let is_struct = matches!(T::KIND, Kind::Struct(_));
        match value {
            value if value.is_none() => *self = None,
            Value::Flag(is_on) if is_struct => match is_on {
                true => {
                    self.get_or_insert_with(T::initial);
                }
                false => *self = None,
            },
            Value::Map(entries) if is_struct => {
                let switch = |entry: &&(String, Value)| entry.0 == "enabled";
                let on = entries.iter().find(switch).map(|(_, on)| on);
                let others = entries.iter().filter(|entry| !switch(entry));
                let mut changed = self.take().unwrap_or_else(T::initial);
                changed.set_value(&Value::Map(others.cloned().collect()))?;
                *self = Some(changed);
                if let Some(on) = on {
                    self.set_part("enabled", on)?;
                }
            }
            _ => {
                let mut changed = self.take().unwrap_or_else(T::initial);
                changed.set_value(value).map_err(|error| match error {
                    ParamError::WrongType { name, value, .. } if name.is_empty() => {
                        let expected = Self::KIND.to_string();
                        ParamError::WrongType {
                            name,
                            value,
                            expected,
                        }
                    }
                    error => error,
                })?;
                *self = Some(changed);
            }
        }
        Ok(())
    }

    fn set_part(&mut self, path: &str, value: &Value) -> Result<(), ParamError> {
        match path {
            "enabled" if matches!(T::KIND, Kind::Struct(_)) => {
                let mut is_on = self.is_some();
                is_on
                    .set_value(value)
                    .map_err(|error| error.within(&"enabled"))?;
                self.set_value(&Value::Flag(is_on))
            }
            path => self.get_or_insert_with(T::initial).set_part(path, value),
        }
    }

    fn check_range(&self, range: &'static Range) -> Result<(), OutOfRange> {
        self.as_ref().map_or(Ok(()), |own| own.check_range(range))
    }
}
