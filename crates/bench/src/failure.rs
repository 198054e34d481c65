//! [`Failure`]: errors of one kind in a row, counted.

use serde::Serialize;
use std::fmt::{self, Debug, Display};

/// Failures of one kind.
#[derive(Debug, Serialize)]
pub(crate) struct Failure {
    /// The error's name.
    kind: String,
    pub(crate) count: usize,
    /// Place and message of the first.
    first: String,
}

impl Failure {
    /// Counts a failure.
    pub(crate) fn add(all: &mut Vec<Self>, kind: &str, first: impl FnOnce() -> String) {
        if let Some(known) = all.iter_mut().find(|failure| failure.kind == kind) {
            known.count += 1;
        } else {
            all.push(Self {
                kind: kind.to_owned(),
                count: 1,
                first: first(),
            });
        }
    }

    /// Counts an error by the name of its variant.
    pub(crate) fn add_error(
        all: &mut Vec<Self>,
        error: &(impl Debug + Display),
        at: fmt::Arguments<'_>,
    ) {
        let kind = format!("{error:?}");
        let end = kind.find(|c: char| !c.is_alphanumeric());
        let kind = &kind[..end.unwrap_or(kind.len())];
        Self::add(all, kind, || format!("{at}: {error}"));
    }

    /// Adds the count to those of the same kind.
    pub(crate) fn merge_into(self, all: &mut Vec<Self>) {
        match all.iter_mut().find(|failure| failure.kind == self.kind) {
            Some(known) => known.count += self.count,
            None => all.push(self),
        }
    }
}
