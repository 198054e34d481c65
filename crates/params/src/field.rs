//! [`Field`] and [`Kind`]: the description of a parameter.

use crate::{Range, Value};
use std::fmt;

/// A parameter of a struct, or an alternative of an enum.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub struct Field {
    /// Name of the parameter.
    pub name: &'static str,
    /// Documentation in Markdown; the first line stands alone.
    pub doc: &'static str,
    /// Type of the values.
    pub kind: Kind,
    /// Range of the numbers.
    pub range: Range,
    /// Unit, empty without one.
    pub unit: &'static str,
    /// Returns the default; none for an alternative.
    pub default: fn() -> Value,
}

impl Field {
    /// Creates a field; for the macros.
    #[doc(hidden)]
    #[must_use]
    pub const fn new(
        name: &'static str,
        doc: &'static str,
        kind: Kind,
        range: Range,
        unit: &'static str,
        default: fn() -> Value,
    ) -> Self {
        Self {
            name,
            doc,
            kind,
            range,
            unit,
            default,
        }
    }

    /// Returns the first paragraph of the documentation as plain text.
    #[must_use]
    pub fn summary(&self) -> String {
        let lines = self.doc.lines().map(str::trim);
        let paragraph: Vec<&str> = lines.take_while(|line| !line.is_empty()).collect();
        plain(&paragraph.join(" "))
    }

    /// Returns the documentation as plain Markdown, without links to items.
    #[must_use]
    pub fn text(&self) -> String {
        let lines: Vec<String> = self.doc.lines().map(|line| plain(line.trim())).collect();
        lines.join("\n").trim().to_owned()
    }
}

/// Replaces links to items by their names.
fn plain(text: &str) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some((before, link)) = rest.split_once('[') {
        out.push_str(before);
        let Some((inner, after)) = link.split_once(']') else {
            rest = link;
            continue;
        };
        match after
            .strip_prefix('(')
            .and_then(|target| target.split_once(')'))
        {
            Some((_, after)) => {
                out.push_str(inner);
                rest = after;
            }
            None if inner.starts_with('`') => {
                out.push_str(&inner.replace("crate::", ""));
                rest = after;
            }
            None => {
                out.push('[');
                out.push_str(inner);
                out.push(']');
                rest = after;
            }
        }
    }
    out.push_str(rest);
    out
}

/// Type of a parameter.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub enum Kind {
    /// True or false.
    Flag,
    /// A number.
    Number,
    /// A whole number from 0.
    Count,
    /// A list of this many values.
    List(usize, &'static Self),
    /// One of a few names.
    Choice(&'static [&'static str]),
    /// One of several alternatives: a name alone, or a name with a value.
    Variants(&'static [Field]),
    /// Parameters of their own.
    Struct(&'static [Field]),
    /// A value, or none.
    Optional(&'static Self),
    /// Nothing: an alternative that is a name alone.
    Unit,
}

impl Kind {
    /// Returns the kind itself, or that of the value that may be absent.
    #[must_use]
    pub const fn inner(&self) -> &Self {
        match self {
            Self::Optional(inner) => inner,
            other => other,
        }
    }

    /// Returns the parameters of a struct that may be absent, or of this one.
    #[must_use]
    pub const fn fields(&self) -> Option<&'static [Field]> {
        match self.inner() {
            Self::Struct(fields) => Some(fields),
            _ => None,
        }
    }
}

impl fmt::Display for Kind {
    /// Writes the kind as in "it must be ...".
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Flag => f.write_str("true or false"),
            Self::Number => f.write_str("a number"),
            Self::Count => f.write_str("a whole number"),
            Self::List(count, Self::Number) => write!(f, "{count} numbers"),
            Self::List(count, inner) => write!(f, "{count} times {inner}"),
            Self::Choice(choices) => write!(f, "one of {}", choices.join(", ")),
            Self::Variants(variants) => {
                for (i, variant) in variants.iter().enumerate() {
                    f.write_str(if i > 0 { ", " } else { "one of " })?;
                    match variant.kind {
                        Self::Unit => f.write_str(variant.name)?,
                        ref kind => write!(f, "{{ {} = {kind} }}", variant.name)?,
                    }
                }
                Ok(())
            }
            Self::Struct(_) => f.write_str("values by name"),
            Self::Optional(inner) if matches!(inner, Self::Struct(_)) => {
                write!(f, "true, false or {inner}")
            }
            Self::Optional(inner) => write!(f, "{inner}, or none"),
            Self::Unit => f.write_str("a name alone"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_become_names() {
        for (text, expected) in [
            (
                "See [`Volume`](crate::Volume), [`crate::Press`] and [a page](b.md).",
                "See `Volume`, `Press` and a page.",
            ),
            ("A mass [kg/m^2] of 0 to 1.", "A mass [kg/m^2] of 0 to 1."),
        ] {
            assert_eq!(plain(text), expected);
        }
    }
}
