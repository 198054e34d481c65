//! Triangle strips of PLY files, as in the original Stanford scans.

use super::header::Element;
use super::values::Values;
use super::vertex_index;
use crate::io::build::{Builder, Corner, NONE, strip_triangles};
use crate::io::error::{ParseError, SourceLocation};

/// The index that ends a strip; the next one starts after it.
const END: f64 = -1.0;

/// Reads the items of an element of triangle strips, the file's element `number`.
///
/// Triangles that repeat a vertex are skipped: strips use them to turn.
pub(super) fn read_strips(
    element: &Element<'_>,
    number: usize,
    values: &mut Values<'_>,
    builder: &mut Builder,
) -> Result<(), ParseError> {
    let names: [&[u8]; 2] = [b"vertex_indices", b"vertex_index"];
    let column = element
        .properties
        .iter()
        .position(|p| p.count.is_some() && names.contains(&p.name));
    if column.is_none() && element.count > 0 {
        return Err(ParseError::Syntax {
            at: SourceLocation::Header,
            expected: "the tristrips property vertex_indices",
        });
    }
    let (mut indices, mut strip) = (Vec::new(), Vec::new());
    for i in 0..element.count {
        let at = SourceLocation::Item(number, i);
        for (k, property) in element.properties.iter().enumerate() {
            let Some(count) = property.count else {
                values.next(property.kind, at)?;
                continue;
            };
            indices.clear();
            values.list(count, property.kind, at, |value| {
                if Some(k) == column {
                    indices.push(value);
                }
            })?;
            for part in indices.split(|&index| index == END) {
                strip.clear();
                for &index in part {
                    strip.push(vertex_index(index, builder, at)?);
                }
                add_strip(&strip, builder, at)?;
            }
        }
    }
    Ok(())
}

fn add_strip(strip: &[u32], builder: &mut Builder, at: SourceLocation) -> Result<(), ParseError> {
    if (1..3).contains(&strip.len()) {
        let corners = strip.len();
        return Err(ParseError::TooFewCorners { at, corners });
    }
    let (with_uv, with_normal) = (builder.uv_count() > 0, builder.normal_count() > 0);
    for t in strip_triangles(strip) {
        if t[0] == t[1] || t[1] == t[2] || t[2] == t[0] {
            continue;
        }
        let corners = t.map(|v| Corner {
            position: v,
            uv: if with_uv { v } else { NONE },
            normal: if with_normal { v } else { NONE },
            row: NONE,
        });
        builder.face(&corners, at)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use crate::io::{ParseError, SourceLocation, read_ply};

    const VERTICES: &str = "element vertex 6\nproperty float x\nproperty float y\n\
        property float z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n";
    const POINTS: [[f32; 3]; 6] = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 2.0, 0.0],
        [1.0, 2.0, 1.0],
    ];

    fn text(indices: &[i32]) -> Vec<u8> {
        let mut out = format!("ply\nformat ascii 1.0\n{VERTICES}");
        for [x, y, z] in POINTS {
            out += &format!("{x} {y} {z}\n");
        }
        out += &indices.len().to_string();
        for index in indices {
            out += &format!(" {index}");
        }
        out.into_bytes()
    }

    fn binary(indices: &[i32]) -> Vec<u8> {
        let mut out = format!("ply\nformat binary_big_endian 1.0\n{VERTICES}").into_bytes();
        out.extend(POINTS.as_flattened().iter().flat_map(|x| x.to_be_bytes()));
        out.extend(i32::try_from(indices.len()).unwrap().to_be_bytes());
        out.extend(indices.iter().flat_map(|i| i.to_be_bytes()));
        out
    }

    #[test]
    fn strips_restart_after_minus_one() {
        // A strip of three triangles, one that turns at a repeated vertex, and an empty one.
        let indices = [0, 1, 2, 3, 4, -1, 2, 3, 3, 5, 4, -1, -1];
        let data = read_ply(&text(&indices)).unwrap();
        assert_eq!(data, read_ply(&binary(&indices)).unwrap());
        let expected = [[0, 1, 2], [1, 3, 2], [2, 3, 4], [3, 5, 4]];
        assert_eq!(data.triangles[..3], expected[..3]);
        let (_, warnings) = read_ply(&text(&indices[..6]))
            .unwrap()
            .into_open_surface()
            .unwrap();
        assert!(warnings.len() == 1, "one unused vertex: {warnings:?}");
    }

    #[test]
    fn broken_strips_are_errors() {
        let error = |indices: &[i32]| read_ply(&text(indices)).unwrap_err();
        let at = SourceLocation::Item(1, 0);
        assert!(matches!(
            error(&[0, 1, 2, -1, 3, 4]),
            ParseError::TooFewCorners { at: place, corners: 2 } if place == at
        ));
        for index in [6, -2] {
            assert!(matches!(
                error(&[0, 1, index]),
                ParseError::IndexOutOfRange { at: place, index: i, .. }
                    if place == at && i == i64::from(index)
            ));
        }
        assert!(matches!(error(&[-1]), ParseError::NoFaces));
    }
}
