//! [`OutOfRange`] and [`ParamError`]: the reasons why a parameter is refused.

use crate::Range;
use std::error::Error;
use std::fmt;

/// Maximum number of parts of a parameter's name.
const MAX_DEPTH: usize = 4;

/// A parameter that is out of its range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OutOfRange {
    /// The parts of the name, from the first; empty ones at the end.
    path: [&'static &'static str; MAX_DEPTH],
    /// The value.
    pub value: f64,
    /// The range.
    pub range: &'static Range,
}

impl OutOfRange {
    /// Creates the error of a value without a name.
    #[must_use]
    pub const fn new(value: f64, range: &'static Range) -> Self {
        Self {
            path: [&""; MAX_DEPTH],
            value,
            range,
        }
    }

    /// Puts a part in front of the name.
    #[must_use]
    pub fn within(mut self, part: &'static &'static str) -> Self {
        self.path.rotate_right(1);
        self.path[0] = part;
        self
    }

    /// Returns the dotted name of the parameter.
    #[must_use]
    pub fn name(&self) -> String {
        let count = self.path.iter().take_while(|part| !part.is_empty()).count();
        let parts: Vec<&str> = self.path[..count].iter().map(|part| **part).collect();
        parts.join(".")
    }
}

impl fmt::Display for OutOfRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { value, range, .. } = self;
        write!(f, "{} is {value}; it must be {range}", self.name())
    }
}

impl Error for OutOfRange {}

/// The reason why a parameter cannot be set by name.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum ParamError {
    /// No parameter has this name.
    Unknown {
        /// The name.
        name: String,
        /// The names that exist there.
        known: String,
    },
    /// Several parameters have this name.
    Ambiguous {
        /// The name.
        name: String,
        /// Their full names.
        known: String,
    },
    /// A parameter is given by two names.
    Repeated {
        /// The name.
        name: String,
        /// The other name.
        other: String,
    },
    /// The value has another type.
    WrongType {
        /// The name.
        name: String,
        /// The value.
        value: String,
        /// The values that are possible.
        expected: String,
    },
    /// The value has the right type, but is none of the possible ones.
    WrongValue {
        /// The name.
        name: String,
        /// The value.
        value: String,
        /// The values that are possible.
        expected: String,
    },
    /// The value is out of range.
    OutOfRange(OutOfRange),
}

impl ParamError {
    /// Creates the error of a value of another type, without a name.
    #[must_use]
    pub fn wrong_type(value: &crate::Value, expected: impl fmt::Display) -> Self {
        Self::WrongType {
            name: String::new(),
            value: value.to_string(),
            expected: expected.to_string(),
        }
    }

    /// Creates the error of a value that is not one of the possible ones, without a name.
    #[must_use]
    pub fn wrong_value(value: &crate::Value, expected: impl fmt::Display) -> Self {
        Self::WrongValue {
            name: String::new(),
            value: value.to_string(),
            expected: expected.to_string(),
        }
    }

    /// Returns the dotted name of the parameter.
    #[must_use]
    pub fn name(&self) -> String {
        match self {
            Self::Unknown { name, .. }
            | Self::Ambiguous { name, .. }
            | Self::Repeated { name, .. }
            | Self::WrongType { name, .. }
            | Self::WrongValue { name, .. } => name.clone(),
            Self::OutOfRange(error) => error.name(),
        }
    }

    /// Puts a part in front of the name.
    #[must_use]
    pub fn within(self, part: &'static &'static str) -> Self {
        if let Self::OutOfRange(error) = self {
            return Self::OutOfRange(error.within(part));
        }
        let name = match self.name() {
            name if name.is_empty() => (*part).to_owned(),
            name => format!("{part}.{name}"),
        };
        self.named(&name)
    }

    /// Replaces the name, except that of a number out of range.
    #[must_use]
    pub fn named(mut self, new: &str) -> Self {
        match &mut self {
            Self::Unknown { name, .. }
            | Self::Ambiguous { name, .. }
            | Self::Repeated { name, .. }
            | Self::WrongType { name, .. }
            | Self::WrongValue { name, .. } => new.clone_into(name),
            Self::OutOfRange(_) => {}
        }
        self
    }
}

impl fmt::Display for ParamError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unknown { name, known } => {
                write!(f, "there is no parameter '{name}'; the names are {known}")
            }
            Self::Ambiguous { name, known } => {
                write!(
                    f,
                    "'{name}' is the name of several parameters; use one of {known}"
                )
            }
            Self::Repeated { name, other } => {
                write!(
                    f,
                    "'{name}' and '{other}' are the same parameter; give one of them"
                )
            }
            Self::WrongType {
                name,
                value,
                expected,
            }
            | Self::WrongValue {
                name,
                value,
                expected,
            } => write!(f, "{name} is '{value}'; it must be {expected}"),
            Self::OutOfRange(error) => error.fmt(f),
        }
    }
}

impl Error for ParamError {}

impl From<OutOfRange> for ParamError {
    fn from(error: OutOfRange) -> Self {
        Self::OutOfRange(error)
    }
}
