//! Reader of Wavefront OBJ: `v`, `vt`, `vn`, `f`, and the material names that this crate writes.
//!
//! Groups and other materials are skipped.

use crate::io::build::{Builder, Corner, NONE};
use crate::io::data::{MeshData, Warning};
use crate::io::error::{ParseError, SourceLocation};
use crate::io::material_number;
use crate::io::origin::read_near_origin;

/// Statements that do not concern the shape of a triangle mesh.
const IGNORED: [&[u8]; 7] = [b"g", b"o", b"s", b"mtllib", b"usemap", b"maplib", b"vp"];

/// Reads an OBJ file.
///
/// Faces may precede their vertices. Relative indices count back from their own line. Three numbers
/// after the coordinates of a vertex are its color, the channel `color`; a single one is ignored.
///
/// # Errors
/// [`ParseError`] with the line.
pub fn read_obj(bytes: &[u8]) -> Result<MeshData, ParseError> {
    read_near_origin(|builder| read_statements(bytes, builder))
}

fn read_statements(bytes: &[u8], builder: &mut Builder) -> Result<(), ParseError> {
    builder.index_base = 1;
    let mut skipped = 0;
    let mut face = Vec::new();
    let mut lines = LogicalLines::new(bytes);
    while let Some((statement, number)) = lines.next_line() {
        let at = SourceLocation::Line(number);
        let mut words = statement
            .split(u8::is_ascii_whitespace)
            .filter(|word| !word.is_empty());
        let Some(keyword) = words.next() else {
            continue;
        };
        match keyword {
            b"v" => {
                let expected = "three coordinates after v";
                let mut coordinate = || {
                    let word = words.next().and_then(|word| std::str::from_utf8(word).ok());
                    word.and_then(|word| builder.coordinate(word))
                        .ok_or(ParseError::Syntax { at, expected })
                };
                let p = [coordinate()?, coordinate()?, coordinate()?];
                builder.position(p, at)?;
                if let Some(color) = color(words) {
                    builder.color(&color);
                }
            }
            b"vt" => {
                let expected = "one to three coordinates after vt";
                let u = number_of(words.next(), at, expected)?;
                let v = match words.next() {
                    Some(word) => number_of(Some(word), at, expected)?,
                    None => 0.0,
                };
                builder.uv([u, v]);
            }
            b"vn" => {
                let expected = "three coordinates after vn";
                builder.normal([
                    number_of(words.next(), at, expected)?,
                    number_of(words.next(), at, expected)?,
                    number_of(words.next(), at, expected)?,
                ]);
            }
            b"f" | b"fo" => {
                face.clear();
                for word in words {
                    face.push(corner(word, builder, at)?);
                }
                builder.face(&face, at)?;
            }
            b"usemtl" => builder.material = words.next().map_or(0, material_number),
            _ if IGNORED.contains(&keyword) => {}
            _ if keyword[0].is_ascii_alphabetic() => skipped += 1,
            _ => {
                return Err(ParseError::Syntax {
                    at,
                    expected: "an OBJ statement",
                });
            }
        }
    }
    if skipped > 0 {
        builder.warnings.push(Warning::Skipped { count: skipped });
    }
    Ok(())
}

/// Lines without comments, joined where they end in a backslash.
struct LogicalLines<'a> {
    rest: &'a [u8],
    number: usize,
    joined: Vec<u8>,
}

impl<'a> LogicalLines<'a> {
    fn new(bytes: &'a [u8]) -> Self {
        Self {
            rest: bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes),
            number: 0,
            joined: Vec::new(),
        }
    }

    /// Returns the next line and the number of its first physical line.
    fn next_line(&mut self) -> Option<(&[u8], usize)> {
        if self.rest.is_empty() {
            return None;
        }
        self.joined.clear();
        let first = self.number + 1;
        while !self.rest.is_empty() {
            let end = self.rest.iter().position(|&b| b == b'\n');
            let (line, rest) = match end {
                Some(end) => (&self.rest[..end], &self.rest[end + 1..]),
                None => (self.rest, &[][..]),
            };
            self.rest = rest;
            self.number += 1;
            let line = match line.iter().position(|&b| b == b'#') {
                Some(comment) => &line[..comment],
                None => line,
            };
            match line.trim_ascii_end().strip_suffix(b"\\") {
                Some(line) => {
                    self.joined.extend_from_slice(line);
                    self.joined.push(b' ');
                }
                None => {
                    self.joined.extend_from_slice(line);
                    break;
                }
            }
        }
        Some((&self.joined, first))
    }
}

/// Returns the color after the coordinates of a vertex, if exactly three numbers follow.
fn color<'a>(words: impl Iterator<Item = &'a [u8]>) -> Option<[f32; 3]> {
    let mut numbers = words.map(|word| std::str::from_utf8(word).ok()?.parse().ok());
    let color = [numbers.next()??, numbers.next()??, numbers.next()??];
    numbers.next().is_none().then_some(color)
}

fn number_of(
    word: Option<&[u8]>,
    at: SourceLocation,
    expected: &'static str,
) -> Result<f32, ParseError> {
    word.and_then(|word| std::str::from_utf8(word).ok())
        .and_then(|word| word.parse().ok())
        .ok_or(ParseError::Syntax { at, expected })
}

/// Parses a corner `v`, `v/vt`, `v//vn` or `v/vt/vn`.
fn corner(word: &[u8], builder: &Builder, at: SourceLocation) -> Result<Corner, ParseError> {
    let mut parts = word.split(|&b| b == b'/');
    let corner = Corner {
        position: index(parts.next(), builder.position_count(), at)?,
        uv: index(parts.next(), builder.uv_count(), at)?,
        normal: index(parts.next(), builder.normal_count(), at)?,
        row: NONE,
    };
    if corner.position == NONE || parts.next().is_some() {
        return Err(malformed_corner(at));
    }
    Ok(corner)
}

/// Converts an index from 1, or a negative relative one, to one from 0; [`NONE`] if absent.
fn index(part: Option<&[u8]>, count: usize, at: SourceLocation) -> Result<u32, ParseError> {
    let Some(part) = part.filter(|part| !part.is_empty()) else {
        return Ok(NONE);
    };
    let index: i64 = std::str::from_utf8(part)
        .ok()
        .and_then(|part| part.parse().ok())
        .ok_or_else(|| malformed_corner(at))?;
    let from_zero = if index > 0 {
        u32::try_from(index - 1).ok()
    } else {
        usize::try_from(index.unsigned_abs())
            .ok()
            .filter(|&back| back > 0)
            .and_then(|back| count.checked_sub(back))
            .and_then(|i| u32::try_from(i).ok())
    };
    from_zero
        .filter(|&i| i != NONE)
        .ok_or(ParseError::IndexOutOfRange { at, index, count })
}

fn malformed_corner(at: SourceLocation) -> ParseError {
    ParseError::Syntax {
        at,
        expected: "corners as v, v/vt, v//vn or v/vt/vn",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rare_syntax_is_read() {
        let text = "\u{feff}# comment \\\r\nmtllib none.mtl\r\nv\t0 0 0 1\r\nv 1 0 0 .5 .5 .5\r\n\
                    vt 0 0\nvt 1 0\nf 1/1 \\\r\n 2/2 3 # corner\nv 0 1 0\nl 1 2\np 3\nf -3 -1 -2";
        let data = read_obj(text.as_bytes()).unwrap();
        assert_eq!(data.triangles, [[0, 1, 2], [0, 2, 1]]);
        assert_eq!(data.corners.uv[..3], [[0.0, 0.0], [1.0, 0.0], [0.0, 0.0]]);
        assert_eq!(data.file_vertices, 5);
        assert_eq!(
            data.warnings,
            [
                Warning::Skipped { count: 2 },
                Warning::partial("texture coordinates", 4).unwrap(),
                Warning::partial("color", 2).unwrap(),
            ]
        );
        let gray = [1.0, 1.0, 1.0, 0.5, 0.5, 0.5, 1.0, 1.0, 1.0];
        assert_eq!(data.channels[0].values(), gray);
    }

    #[test]
    fn errors_name_their_line() {
        let error = |text: &str| read_obj(text.as_bytes()).unwrap_err();
        let v = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
        let line4 = SourceLocation::Line(4);
        assert!(matches!(
            error(&format!("{v}f 1 2 4")),
            ParseError::IndexOutOfRange { at, index: 4, count: 3 } if at == line4
        ));
        assert!(matches!(
            error(&format!("{v}f 0 1 2")),
            ParseError::IndexOutOfRange { at, index: 0, .. } if at == line4
        ));
        assert!(matches!(
            error(&format!("{v}f -4 1 2")),
            ParseError::IndexOutOfRange { at, index: -4, .. } if at == line4
        ));
        assert!(matches!(
            error(&format!("{v}f 1 2")),
            ParseError::TooFewCorners { at, corners: 2 } if at == line4
        ));
        assert!(matches!(
            error(&format!("{v}f 1 2 3 2")),
            ParseError::RepeatedVertex { at } if at == line4
        ));
        assert!(matches!(
            error(&format!("{v}f 1/1 2/1 3/1")),
            ParseError::IndexOutOfRange { at, index: 1, count: 0 } if at == line4
        ));
        assert!(matches!(
            error(&format!("{v}v 1,5 0 0")),
            ParseError::Syntax { at, .. } if at == line4
        ));
        assert!(matches!(
            error(&format!("{v}v 1e39 0 0")),
            ParseError::NotFinite { at } if at == line4
        ));
        assert!(matches!(error(v), ParseError::NoFaces));
        assert_eq!(
            error("v 0 0").to_string(),
            "line 1: expected three coordinates after v"
        );
    }

    #[test]
    fn materials_are_those_that_have_a_number() {
        let v = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
        let materials = |text: &str| read_obj(format!("{v}{text}").as_bytes()).unwrap().materials;
        assert_eq!(materials("usemtl material_0\nf 1 2 3\nf 1 3 4"), [0; 0]);
        assert_eq!(materials("f 1 2 3\nusemtl material_7\nf 1 3 4"), [0, 7]);
        let quad = "usemtl material_7\nf 1 2 3 4\nusemtl wood\nf 4 3 2";
        assert_eq!(materials(quad), [7, 7, 0]);
        let odd = "usemtl material_7\nf 1 2 3\nusemtl\nf 1 3 4\nusemtl material_x\nf 1 2 4";
        assert_eq!(materials(odd), [7, 0, 0]);
    }

    #[test]
    fn equal_positions_are_one_vertex() {
        let data =
            read_obj(b"v 0 0 0\nv 9 9 9\nv 1 0 0\nv 0 1 0\nv -0 0 0\nf 1 3 4\nf 5 4 3").unwrap();
        assert_eq!(data.positions.len(), 3);
        assert_eq!(data.triangles, [[0, 1, 2], [0, 2, 1]]);
        assert_eq!(data.file_vertices, 4);
        assert_eq!(data.warnings, [Warning::UnusedVertices { count: 1 }]);
    }
}
