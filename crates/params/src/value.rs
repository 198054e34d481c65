//! [`Value`]: the value of a parameter in a file, on a command line or in another language.

use std::fmt;

/// The value of a parameter, before it has the type of its field.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// No value: an optional parameter is off.
    None,
    /// True or false.
    Flag(bool),
    /// A whole number.
    Count(u64),
    /// A number.
    Number(f64),
    /// A name, or text of a command line.
    Text(String),
    /// Several values.
    List(Vec<Self>),
    /// Values by name.
    Map(Vec<(String, Self)>),
}

/// Number of characters of a text or list in a message.
const SHOWN: usize = 40;

impl Value {
    /// Returns whether this is no value, also as the text of a file or language without one.
    pub(crate) fn is_none(&self) -> bool {
        matches!(self, Self::None) || matches!(self, Self::Text(text) if text == "none")
    }

    /// Returns the value of a text.
    ///
    /// That is `none`, a flag, a number, numbers between commas, a name, or values by name in
    /// braces such as `{ compliance = 1e-4 }`.
    #[must_use]
    pub fn parse(text: &str) -> Self {
        let text = text.trim();
        match text {
            "none" => return Self::None,
            "true" => return Self::Flag(true),
            "false" => return Self::Flag(false),
            _ => {}
        }
        if let Ok(count) = text.parse() {
            return Self::Count(count);
        }
        if let Ok(number) = text.parse() {
            return Self::Number(number);
        }
        let inside = text.strip_prefix('{').and_then(|t| t.strip_suffix('}'));
        if let Some(entries) = inside.and_then(Self::parse_entries) {
            return Self::Map(entries);
        }
        if text.contains(',') {
            return Self::List(text.split(',').map(Self::parse).collect());
        }
        Self::Text(text.to_owned())
    }

    /// Returns the entries of a text of `name = value` between commas; none of any other text.
    fn parse_entries(text: &str) -> Option<Vec<(String, Self)>> {
        let mut entries: Vec<(String, String)> = Vec::new();
        let mut depth = 0_u32;
        for part in text.split(',') {
            match (depth, part.split_once('=')) {
                (0, Some((name, value))) => {
                    entries.push((name.trim().to_owned(), value.to_owned()));
                }
                // A comma of a list, or one within braces.
                _ => {
                    let (_, value) = entries.last_mut()?;
                    value.push(',');
                    value.push_str(part);
                }
            }
            for c in part.chars() {
                depth = match c {
                    '{' => depth + 1,
                    '}' => depth.checked_sub(1)?,
                    _ => depth,
                };
            }
        }
        let parsed = entries.into_iter();
        Some(
            parsed
                .map(|(name, value)| (name, Self::parse(&value)))
                .collect(),
        )
    }

    /// Returns the number, also of a text such as `1/60`.
    #[must_use]
    #[expect(clippy::cast_precision_loss, reason = "counts are rounded to doubles")]
    pub fn number(&self) -> Option<f64> {
        match self {
            Self::Count(count) => Some(*count as f64),
            Self::Number(number) => Some(*number),
            Self::Text(text) => {
                let number = |s: &str| s.trim().parse::<f64>().ok();
                match text.split_once('/') {
                    Some((above, below)) => Some(number(above)? / number(below)?),
                    None => number(text),
                }
            }
            _ => None,
        }
    }

    /// Returns the value at a dotted path of a map; `enabled` is whether there is one.
    #[must_use]
    pub fn at(&self, path: &str) -> Option<Self> {
        if path.is_empty() {
            return Some(self.clone());
        }
        let (head, rest) = path.split_once('.').unwrap_or((path, ""));
        match self {
            Self::Map(entries) => match entries.iter().find(|(name, _)| name == head) {
                Some((_, value)) => value.at(rest),
                None if path == "enabled" => Some(Self::Flag(true)),
                None => None,
            },
            Self::None if path == "enabled" => Some(Self::Flag(false)),
            _ => None,
        }
    }
}

impl From<bool> for Value {
    fn from(flag: bool) -> Self {
        Self::Flag(flag)
    }
}

impl From<f64> for Value {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl From<&str> for Value {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl fmt::Display for Value {
    /// Writes the value as [`Value::parse`] reads it; long ones are cut off.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::None => f.write_str("none"),
            Self::Flag(flag) => write!(f, "{flag}"),
            Self::Count(count) => write!(f, "{count}"),
            Self::Number(number) => write!(f, "{number}"),
            Self::Text(text) => text.chars().take(SHOWN).try_for_each(|c| write!(f, "{c}")),
            Self::List(values) => {
                for (i, value) in values.iter().take(SHOWN).enumerate() {
                    write!(f, "{}{value}", if i > 0 { "," } else { "" })?;
                }
                Ok(())
            }
            Self::Map(entries) => {
                f.write_str("{")?;
                for (i, (name, value)) in entries.iter().take(SHOWN).enumerate() {
                    write!(f, "{}{name} = {value}", if i > 0 { ", " } else { " " })?;
                }
                f.write_str(" }")
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_values() {
        for (text, value) in [
            ("none", Value::None),
            ("true", Value::Flag(true)),
            ("16", Value::Count(16)),
            ("-1.5", Value::Number(-1.5)),
            ("exact", Value::Text("exact".to_owned())),
            (
                "{ compliance = 0.5 }",
                Value::Map(vec![("compliance".to_owned(), Value::Number(0.5))]),
            ),
            (
                "{ a = { b = 1, c = none }, d = 2,3 }",
                Value::Map(vec![
                    (
                        "a".to_owned(),
                        Value::Map(vec![
                            ("b".to_owned(), Value::Count(1)),
                            ("c".to_owned(), Value::None),
                        ]),
                    ),
                    (
                        "d".to_owned(),
                        Value::List(vec![Value::Count(2), Value::Count(3)]),
                    ),
                ]),
            ),
            (
                "0,-9.81,0",
                Value::List(vec![Value::Count(0), Value::Number(-9.81), Value::Count(0)]),
            ),
        ] {
            assert_eq!(Value::parse(text), value);
            assert_eq!(value.to_string(), text);
        }
        for odd in ["{ 1 }", "{ a = } }", "{"] {
            assert_eq!(Value::parse(odd), Value::Text(odd.to_owned()));
        }
        assert_eq!(Value::parse("1/8").number(), Some(0.125));
        assert_eq!(Value::parse("exact").number(), None);
    }
}
