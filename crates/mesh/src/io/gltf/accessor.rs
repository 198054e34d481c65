//! Typed numbers from glTF buffers.

use super::document::{Accessor, Document};
use crate::geometry::round_to_f32;
use crate::io::error::{ParseError, SourceLocation};

/// The accessors of a document over its buffers.
pub(super) struct Accessors<'a> {
    pub(super) document: &'a Document,
    pub(super) buffers: &'a [Vec<u8>],
}

/// The bytes of an accessor: `count` items of `components` numbers, `stride` bytes apart.
struct Items<'a> {
    bytes: &'a [u8],
    count: usize,
    components: usize,
    stride: usize,
    accessor: &'a Accessor,
}

impl Items<'_> {
    /// Returns a component of an item; normalized integers become fractions.
    fn number(&self, item: usize, component: usize) -> f64 {
        let kind = self.accessor.component_type;
        let size = component_size(kind).unwrap_or(1);
        let largest = match (self.accessor.normalized, kind) {
            (true, 5120) => 127.0,
            (true, 5121) => 255.0,
            (true, 5122) => 32767.0,
            (true, 5123) => 65535.0,
            _ => 1.0,
        };
        read_number(&self.bytes[item * self.stride + component * size..], kind) / largest
    }
}

/// Rows of `width` numbers, one after the other.
pub(super) struct Rows {
    pub(super) width: usize,
    /// Shape \[rows, width\].
    pub(super) values: Vec<f32>,
}

impl<'a> Accessors<'a> {
    /// Reads vectors of N numbers; normalized integers become fractions.
    pub(super) fn vectors<const N: usize>(
        &self,
        number: usize,
    ) -> Result<Vec<[f64; N]>, ParseError> {
        let shape = if N == 2 { "VEC2" } else { "VEC3" };
        let items = self.items(number, &[(shape, N)])?;
        let row = |i| std::array::from_fn(|k| items.number(i, k));
        Ok((0..items.count).map(row).collect())
    }

    /// Reads rows of one to four numbers.
    ///
    /// Normalized integers become fractions. At most `most` numbers are read.
    pub(super) fn rows(&self, number: usize, most: usize) -> Result<Rows, ParseError> {
        let shapes = [("SCALAR", 1), ("VEC2", 2), ("VEC3", 3), ("VEC4", 4)];
        let items = self.items(number, &shapes)?;
        let width = items.components;
        if items.count.saturating_mul(width) > most {
            return Err(ParseError::TooLarge);
        }
        let rows = (0..items.count).flat_map(|i| (0..width).map(move |k| (i, k)));
        let numbers = rows.map(|(i, k)| round_to_f32(items.number(i, k)));
        let values = numbers.collect();
        Ok(Rows { width, values })
    }

    /// Reads integers of 8, 16 or 32 bits.
    pub(super) fn indices(&self, number: usize) -> Result<Vec<u32>, ParseError> {
        let items = self.items(number, &[("SCALAR", 1)])?;
        let read: fn(&[u8]) -> u32 = match items.accessor.component_type {
            5121 => |b| u32::from(b[0]),
            5123 => |b| u32::from(u16::from_le_bytes([b[0], b[1]])),
            5125 => |b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]),
            _ => {
                return Err(ParseError::Syntax {
                    at: SourceLocation::Accessor(number),
                    expected: "unsigned integers as indices",
                });
            }
        };
        Ok((0..items.count)
            .map(|i| read(&items.bytes[i * items.stride..]))
            .collect())
    }

    /// Returns an accessor's bytes and checks its shape and that every item is within them.
    fn items(&self, number: usize, shapes: &[(&str, usize)]) -> Result<Items<'a>, ParseError> {
        let at = SourceLocation::Accessor(number);
        let syntax = |expected| ParseError::Syntax { at, expected };
        let accessor = self
            .document
            .accessors
            .get(number)
            .ok_or_else(|| syntax("an accessor with this number"))?;
        let shape = shapes.iter().find(|shape| accessor.shape == shape.0);
        let &(_, components) = shape.ok_or_else(|| {
            syntax("indices as SCALAR, positions and normals as VEC3, texture coordinates as VEC2")
        })?;
        let (None, Some(view_number)) = (&accessor.sparse, accessor.buffer_view) else {
            return Err(ParseError::Unsupported {
                what: "a sparse accessor",
            });
        };
        let size = components
            * component_size(accessor.component_type)
                .ok_or_else(|| syntax("a component type of the specification"))?;
        let view = self
            .document
            .buffer_views
            .get(view_number)
            .ok_or_else(|| syntax("a buffer view with this number"))?;
        let buffer = self.buffers.get(view.buffer).ok_or(ParseError::Syntax {
            at: SourceLocation::BufferView(view_number),
            expected: "a buffer with this number",
        })?;
        let bytes = buffer
            .get(view.byte_offset..)
            .and_then(|bytes| bytes.get(..view.byte_length))
            .ok_or(ParseError::Truncated {
                at: SourceLocation::BufferView(view_number),
            })?
            .get(accessor.byte_offset..)
            .ok_or(ParseError::Truncated { at })?;
        let stride = view.byte_stride.unwrap_or(size);
        if stride < size {
            return Err(syntax("a stride no shorter than an item"));
        }
        let fits = match accessor.count.checked_sub(1) {
            Some(last) => last
                .checked_mul(stride)
                .and_then(|start| start.checked_add(size))
                .is_some_and(|end| end <= bytes.len()),
            None => true,
        };
        if !fits {
            return Err(ParseError::Truncated { at });
        }
        Ok(Items {
            bytes,
            count: accessor.count,
            components,
            stride,
            accessor,
        })
    }
}

fn component_size(kind: u32) -> Option<usize> {
    Some(match kind {
        5120 | 5121 => 1,
        5122 | 5123 => 2,
        5125 | 5126 => 4,
        _ => return None,
    })
}

fn read_number(b: &[u8], kind: u32) -> f64 {
    match kind {
        5120 => f64::from(i8::from_le_bytes([b[0]])),
        5121 => f64::from(b[0]),
        5122 => f64::from(i16::from_le_bytes([b[0], b[1]])),
        5123 => f64::from(u16::from_le_bytes([b[0], b[1]])),
        5125 => f64::from(u32::from_le_bytes([b[0], b[1], b[2], b[3]])),
        _ => f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]])),
    }
}
