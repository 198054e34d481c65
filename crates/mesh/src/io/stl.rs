//! Reader of STL, binary and text. Facet normals are ignored, because corners determine them.

use crate::io::build::{Builder, Corner};
use crate::io::data::{MeshData, Warning};
use crate::io::error::{ParseError, SourceLocation};
use crate::io::origin::read_near_origin;

/// Size of a binary file's header: free text, then the number of facets.
const HEADER: usize = 84;
/// Size of a facet: normal, three corners, two bytes of attributes.
const FACET: usize = 50;

/// Reads an STL file, which is binary if its size matches the header's number of facets.
///
/// # Errors
/// [`ParseError`] with the line or facet.
pub fn read_stl(bytes: &[u8]) -> Result<MeshData, ParseError> {
    let mut data = read_near_origin(|builder| {
        if is_text(bytes) {
            read_text(bytes, builder)
        } else {
            read_binary(bytes, builder)
        }
    })?;
    data.file_vertices = data.positions.len();
    Ok(data)
}

fn is_text(bytes: &[u8]) -> bool {
    let sized_as_binary = facet_count(bytes).is_some_and(|n| {
        n.checked_mul(FACET)
            .and_then(|size| size.checked_add(HEADER))
            == Some(bytes.len())
    });
    !sized_as_binary
        && bytes.trim_ascii_start().starts_with(b"solid")
        && !bytes.iter().take(HEADER).any(|&b| b == 0)
}

fn facet_count(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(HEADER - 4..HEADER)?.first_chunk::<4>()?;
    usize::try_from(u32::from_le_bytes(*count)).ok()
}

fn read_binary(bytes: &[u8], builder: &mut Builder) -> Result<(), ParseError> {
    let count = facet_count(bytes).ok_or(ParseError::Truncated {
        at: SourceLocation::Header,
    })?;
    let mut rest = &bytes[HEADER..];
    for i in 0..count {
        let at = SourceLocation::Face(i);
        let (facet, after) = rest
            .split_first_chunk::<FACET>()
            .ok_or(ParseError::Truncated { at })?;
        rest = after;
        let numbers = facet.as_chunks::<4>().0;
        let corners =
            [3, 6, 9].map(|k| [numbers[k], numbers[k + 1], numbers[k + 2]].map(f32::from_le_bytes));
        add_facet(corners.map(|p| p.map(f64::from)), at, builder)?;
    }
    if !rest.is_empty() {
        builder
            .warnings
            .push(Warning::TrailingBytes { count: rest.len() });
    }
    Ok(())
}

fn read_text(bytes: &[u8], builder: &mut Builder) -> Result<(), ParseError> {
    // The nesting of statements: outside any solid, inside one, inside a facet.
    #[derive(PartialEq)]
    enum Inside {
        Nothing,
        Solid,
        Facet,
    }
    let mut inside = Inside::Nothing;
    let mut corners: Vec<[f64; 3]> = Vec::new();
    let mut number = 0;
    for line in bytes.split(|&b| b == b'\n') {
        number += 1;
        let at = SourceLocation::Line(number);
        let mut words = line
            .split(u8::is_ascii_whitespace)
            .filter(|word| !word.is_empty());
        let Some(keyword) = words.next() else {
            continue;
        };
        inside = match (keyword.to_ascii_lowercase().as_slice(), inside) {
            (b"solid", Inside::Nothing) => Inside::Solid,
            (b"facet", Inside::Solid) => {
                corners.clear();
                Inside::Facet
            }
            (b"outer" | b"endloop", Inside::Facet) => Inside::Facet,
            (b"vertex", Inside::Facet) => {
                let mut coordinate = || {
                    words
                        .next()
                        .and_then(|word| std::str::from_utf8(word).ok())
                        .and_then(|word| builder.coordinate(word))
                        .ok_or(ParseError::Syntax {
                            at,
                            expected: "three coordinates after vertex",
                        })
                };
                corners.push([coordinate()?, coordinate()?, coordinate()?]);
                Inside::Facet
            }
            (b"endfacet", Inside::Facet) => {
                let facet = corners
                    .as_slice()
                    .try_into()
                    .map_err(|_| ParseError::Syntax {
                        at,
                        expected: "three vertices before endfacet",
                    })?;
                add_facet(facet, at, builder)?;
                Inside::Solid
            }
            (b"endsolid", Inside::Solid) => Inside::Nothing,
            (_, Inside::Nothing) => {
                return Err(ParseError::Syntax {
                    at,
                    expected: "solid",
                });
            }
            (_, Inside::Solid) => {
                return Err(ParseError::Syntax {
                    at,
                    expected: "facet or endsolid",
                });
            }
            (_, Inside::Facet) => {
                return Err(ParseError::Syntax {
                    at,
                    expected: "outer loop, vertex, endloop or endfacet",
                });
            }
        };
    }
    if inside != Inside::Nothing {
        return Err(ParseError::Truncated {
            at: SourceLocation::Line(number),
        });
    }
    Ok(())
}

fn add_facet(
    corners: [[f64; 3]; 3],
    at: SourceLocation,
    builder: &mut Builder,
) -> Result<(), ParseError> {
    let first = u32::try_from(builder.position_count()).map_err(|_| ParseError::TooLarge)?;
    for corner in corners {
        builder.position(corner, at)?;
    }
    builder.face(&[0, 1, 2].map(|k| Corner::position(first + k)), at)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "solid two words\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   \
                        vertex 1 0 0\n   vertex 0 1 0\n  endloop\n endfacet\nendsolid\n";

    fn binary(header: &[u8], facets: u32, count: u32) -> Vec<u8> {
        let mut out = header.to_vec();
        out.resize(80, 0);
        out.extend(count.to_le_bytes());
        for _ in 0..facets {
            for x in [0u8, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0] {
                out.extend(f32::from(x).to_le_bytes());
            }
            out.extend([0, 0]);
        }
        out
    }

    #[test]
    fn text_and_binary_say_the_same() {
        let text = read_stl(TEXT.as_bytes()).unwrap();
        let binary = read_stl(&binary(b"solid it is not", 1, 1)).unwrap();
        assert_eq!(text, binary);
        assert_eq!(text.file_vertices, 3);
    }

    #[test]
    fn a_wrong_facet_count_is_an_error() {
        assert!(matches!(
            read_stl(&binary(b"", 2, 3)).unwrap_err(),
            ParseError::Truncated {
                at: SourceLocation::Face(2)
            }
        ));
        assert_eq!(
            read_stl(&binary(b"", 2, 1)).unwrap().warnings,
            [Warning::TrailingBytes { count: 50 }]
        );
        assert!(matches!(
            read_stl(&binary(b"", 0, 0)).unwrap_err(),
            ParseError::NoFaces
        ));
        assert!(matches!(
            read_stl(&binary(b"", 0, u32::MAX)).unwrap_err(),
            ParseError::Truncated {
                at: SourceLocation::Face(0)
            }
        ));
    }

    #[test]
    fn text_cut_short_is_seen() {
        for end in [40, 80, 115] {
            assert!(
                matches!(
                    read_stl(&TEXT.as_bytes()[..end]).unwrap_err(),
                    ParseError::Truncated { .. } | ParseError::Syntax { .. }
                ),
                "cut at {end}"
            );
        }
    }
}
