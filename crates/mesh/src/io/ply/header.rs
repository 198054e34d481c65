//! The header of a PLY file.

use crate::io::error::{ParseError, SourceLocation};

/// The encoding of the numbers after the header.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    LittleEndian,
    BigEndian,
}

/// The type of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

/// A property: a number, or a list preceded by its length.
pub(super) struct Property<'a> {
    pub(super) name: &'a [u8],
    pub(super) kind: Kind,
    /// The type of a list's length.
    pub(super) count: Option<Kind>,
}

/// A table of the file.
pub(super) struct Element<'a> {
    pub(super) name: &'a [u8],
    pub(super) count: usize,
    pub(super) properties: Vec<Property<'a>>,
}

/// The header, up to the numbers.
pub(super) struct Header<'a> {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element<'a>>,
    /// Offset of the numbers.
    pub(super) body: usize,
    /// Number of lines before them.
    pub(super) lines: usize,
}

pub(super) fn read_header(bytes: &[u8]) -> Result<Header<'_>, ParseError> {
    let mut encoding = None;
    let mut elements: Vec<Element<'_>> = Vec::new();
    let (mut start, mut number) = (0, 0);
    loop {
        let length = bytes[start..]
            .iter()
            .position(|&b| b == b'\n')
            .ok_or(if number == 0 {
                no_ply()
            } else {
                ParseError::Truncated {
                    at: SourceLocation::Header,
                }
            })?;
        let line = bytes[start..start + length].trim_ascii();
        start += length + 1;
        number += 1;
        let syntax = |expected| ParseError::Syntax {
            at: SourceLocation::Line(number),
            expected,
        };
        let words: Vec<&[u8]> = line
            .split(u8::is_ascii_whitespace)
            .filter(|word| !word.is_empty())
            .collect();
        match *words.as_slice() {
            _ if number == 1 => {
                if line != b"ply" {
                    return Err(no_ply());
                }
            }
            [b"format", format, _] => {
                encoding = Some(match format {
                    b"ascii" => Encoding::Text,
                    b"binary_little_endian" => Encoding::LittleEndian,
                    b"binary_big_endian" => Encoding::BigEndian,
                    _ => return Err(syntax("ascii, binary_little_endian or binary_big_endian")),
                });
            }
            [] | [b"comment" | b"obj_info", ..] => {}
            [b"element", name, count] => elements.push(Element {
                name,
                count: std::str::from_utf8(count)
                    .ok()
                    .and_then(|count| count.parse().ok())
                    .ok_or_else(|| syntax("a count after the element's name"))?,
                properties: Vec::new(),
            }),
            [b"property", ref property @ ..] => {
                let (name, kind, count) = match *property {
                    [b"list", count, kind, name] => (name, kind, Some(count)),
                    [kind, name] => (name, kind, None),
                    _ => return Err(syntax("a type and a name after property")),
                };
                let known = |kind| kind_of(kind).ok_or_else(|| syntax("a number type"));
                elements
                    .last_mut()
                    .ok_or_else(|| syntax("an element before its properties"))?
                    .properties
                    .push(Property {
                        name,
                        kind: known(kind)?,
                        count: count.map(known).transpose()?,
                    });
            }
            [b"end_header"] => break,
            _ => return Err(syntax("format, element, property, comment or end_header")),
        }
    }
    Ok(Header {
        encoding: encoding.ok_or(ParseError::Syntax {
            at: SourceLocation::Header,
            expected: "a format",
        })?,
        elements,
        body: start,
        lines: number,
    })
}

fn no_ply() -> ParseError {
    ParseError::Syntax {
        at: SourceLocation::Line(1),
        expected: "ply",
    }
}

fn kind_of(name: &[u8]) -> Option<Kind> {
    Some(match name {
        b"char" | b"int8" => Kind::I8,
        b"uchar" | b"uint8" => Kind::U8,
        b"short" | b"int16" => Kind::I16,
        b"ushort" | b"uint16" => Kind::U16,
        b"int" | b"int32" => Kind::I32,
        b"uint" | b"uint32" => Kind::U32,
        b"float" | b"float32" => Kind::F32,
        b"double" | b"float64" => Kind::F64,
        _ => return None,
    })
}
