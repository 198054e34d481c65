//! The numbers after the header of a PLY file.

use super::header::{Encoding, Kind};
use crate::io::error::{ParseError, SourceLocation};

/// The remaining numbers.
pub(super) struct Values<'a> {
    encoding: Encoding,
    rest: &'a [u8],
    line: usize,
    /// Whether words keep 64 bits.
    is_exact: bool,
}

impl<'a> Values<'a> {
    /// Returns the numbers of `body`, which `lines` lines precede.
    ///
    /// With `is_exact`, words of 32-bit properties keep 64 bits.
    pub(super) fn new(encoding: Encoding, body: &'a [u8], lines: usize, is_exact: bool) -> Self {
        Self {
            encoding,
            rest: body,
            line: lines + 1,
            is_exact,
        }
    }

    /// Returns the number of remaining bytes.
    pub(super) fn trailing(&self) -> usize {
        match self.encoding {
            Encoding::Text => self.rest.trim_ascii().len(),
            _ => self.rest.len(),
        }
    }

    /// Returns the next number, of the element `at`.
    pub(super) fn next(&mut self, kind: Kind, at: SourceLocation) -> Result<f64, ParseError> {
        if self.encoding == Encoding::Text {
            return self.next_word(kind, at);
        }
        Ok(match kind {
            Kind::I8 => f64::from(i8::from_ne_bytes(self.take(at)?)),
            Kind::U8 => f64::from(u8::from_ne_bytes(self.take(at)?)),
            Kind::I16 => f64::from(i16::from_ne_bytes(self.take(at)?)),
            Kind::U16 => f64::from(u16::from_ne_bytes(self.take(at)?)),
            Kind::I32 => f64::from(i32::from_ne_bytes(self.take(at)?)),
            Kind::U32 => f64::from(u32::from_ne_bytes(self.take(at)?)),
            Kind::F32 => f64::from(f32::from_ne_bytes(self.take(at)?)),
            Kind::F64 => f64::from_ne_bytes(self.take(at)?),
        })
    }

    /// Returns the items of the next list.
    pub(super) fn list(
        &mut self,
        count: Kind,
        kind: Kind,
        at: SourceLocation,
        mut item: impl FnMut(f64),
    ) -> Result<(), ParseError> {
        let count = self.next(count, at)?;
        if count < 0.0 || count.fract() != 0.0 || !count.is_finite() {
            return Err(ParseError::Syntax {
                at,
                expected: "a whole number of list items",
            });
        }
        let mut read = 0.0;
        while read < count {
            item(self.next(kind, at)?);
            read += 1.0;
        }
        Ok(())
    }

    /// Returns the next bytes in native order.
    fn take<const N: usize>(&mut self, at: SourceLocation) -> Result<[u8; N], ParseError> {
        let (bytes, rest) = self
            .rest
            .split_first_chunk()
            .ok_or(ParseError::Truncated { at })?;
        self.rest = rest;
        let mut bytes: [u8; N] = *bytes;
        let big = self.encoding == Encoding::BigEndian;
        if big != cfg!(target_endian = "big") {
            bytes.reverse();
        }
        Ok(bytes)
    }

    fn next_word(&mut self, kind: Kind, at: SourceLocation) -> Result<f64, ParseError> {
        let start = self
            .rest
            .iter()
            .position(|b| !b.is_ascii_whitespace())
            .ok_or(ParseError::Truncated { at })?;
        self.line += self.rest[..start].iter().filter(|&&b| b == b'\n').count();
        let rest = &self.rest[start..];
        let end = rest
            .iter()
            .position(u8::is_ascii_whitespace)
            .unwrap_or(rest.len());
        self.rest = &rest[end..];
        std::str::from_utf8(&rest[..end])
            .ok()
            .and_then(|word| match kind {
                // Rounded once, not first to 64 bits.
                Kind::F32 if !self.is_exact => word.parse::<f32>().ok().map(f64::from),
                _ => word.parse().ok(),
            })
            .ok_or(ParseError::Syntax {
                at: SourceLocation::Line(self.line),
                expected: "a number",
            })
    }
}
