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
        let mut out = 0.0;
        self.binary(1, kind, at, |value| out = value)?;
        Ok(out)
    }

    /// Passes the items of the next list to `item`.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a count is a whole number that does not exceed the number of bytes"
    )]
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
        // Every item takes a byte at least.
        if count > self.rest.len() as f64 {
            return Err(ParseError::Truncated { at });
        }
        let count = count as usize;
        if self.encoding != Encoding::Text {
            return self.binary(count, kind, at, item);
        }
        for _ in 0..count {
            item(self.next_word(kind, at)?);
        }
        Ok(())
    }

    /// Passes the next `count` numbers of a binary file to `item`.
    #[inline]
    fn binary(
        &mut self,
        count: usize,
        kind: Kind,
        at: SourceLocation,
        item: impl FnMut(f64),
    ) -> Result<(), ParseError> {
        match kind {
            Kind::I8 => self.numbers(count, at, |b| i8::from_ne_bytes(b).into(), item),
            Kind::U8 => self.numbers(count, at, |b| u8::from_ne_bytes(b).into(), item),
            Kind::I16 => self.numbers(count, at, |b| i16::from_ne_bytes(b).into(), item),
            Kind::U16 => self.numbers(count, at, |b| u16::from_ne_bytes(b).into(), item),
            Kind::I32 => self.numbers(count, at, |b| i32::from_ne_bytes(b).into(), item),
            Kind::U32 => self.numbers(count, at, |b| u32::from_ne_bytes(b).into(), item),
            Kind::F32 => self.numbers(count, at, |b| f32::from_ne_bytes(b).into(), item),
            Kind::F64 => self.numbers(count, at, f64::from_ne_bytes, item),
        }
    }

    /// Passes the next `count` numbers of N bytes to `item`, each decoded from native order.
    #[inline]
    fn numbers<const N: usize>(
        &mut self,
        count: usize,
        at: SourceLocation,
        decode: impl Fn([u8; N]) -> f64,
        mut item: impl FnMut(f64),
    ) -> Result<(), ParseError> {
        let is_swapped = (self.encoding == Encoding::BigEndian) != cfg!(target_endian = "big");
        let numbers = count.checked_mul(N);
        let Some((numbers, rest)) = numbers.and_then(|size| self.rest.split_at_checked(size))
        else {
            return Err(ParseError::Truncated { at });
        };
        self.rest = rest;
        for &(mut bytes) in numbers.as_chunks().0 {
            if is_swapped {
                bytes.reverse();
            }
            item(decode(bytes));
        }
        Ok(())
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
