//! Reader of PLY: text and binary of either byte order.
//!
//! Of vertices, `x y z`, texture coordinates (`s t`, `u v` or `texture_u texture_v`), normals
//! (`nx ny nz`) and all other numbers, which become channels, are read. Of faces, `vertex_indices`
//! (or `vertex_index`), `material`, and lists with the same count of numbers for each corner are
//! read: `texcoord` with two, `normal` with three, any other as a channel. Of `tristrips`,
//! `vertex_indices` are read as triangle strips that -1 ends. Everything else is dropped with a
//! warning.

mod channels;
mod faces;
mod header;
mod strips;
mod values;

use crate::geometry::round_to_f32;
use crate::io::build::{Builder, NONE};
use crate::io::data::{MeshData, Warning};
use crate::io::error::{ParseError, SourceLocation};
use crate::io::origin::read_near_origin;
use channels::VertexChannel;
pub(super) use channels::{SKIN_LIST, keeps};
use faces::read_faces;
use header::{Element, Header, read_header};
use strips::read_strips;
use values::Values;

/// Reads a PLY file.
///
/// # Errors
/// [`ParseError`] with the line, vertex or face.
pub fn read_ply(bytes: &[u8]) -> Result<MeshData, ParseError> {
    let header = read_header(bytes)?;
    read_near_origin(|builder| read_elements(bytes, &header, builder))
}

fn read_elements(
    bytes: &[u8],
    header: &Header<'_>,
    builder: &mut Builder,
) -> Result<(), ParseError> {
    // A second pass needs all digits of a text, even of numbers declared to have 32 bits.
    let is_exact = builder.origin != [0.0; 3];
    let body = &bytes[header.body..];
    let mut values = Values::new(header.encoding, body, header.lines, is_exact);
    for (number, element) in header.elements.iter().enumerate() {
        match element.name {
            b"vertex" => read_vertices(element, &mut values, builder)?,
            b"face" => read_faces(element, &mut values, builder)?,
            b"tristrips" => read_strips(element, number, &mut values, builder)?,
            _ => {
                if element.count > 0 && !element.properties.is_empty() {
                    builder.warnings.push(Warning::dropped(element.name));
                }
                skip(element, number, &mut values)?;
            }
        }
    }
    let count = values.trailing();
    if count > 0 {
        builder.warnings.push(Warning::TrailingBytes { count });
    }
    Ok(())
}

fn read_vertices(
    element: &Element<'_>,
    values: &mut Values<'_>,
    builder: &mut Builder,
) -> Result<(), ParseError> {
    let column = |names: &[&[u8]]| {
        element
            .properties
            .iter()
            .position(|p| p.count.is_none() && names.contains(&p.name))
    };
    let [Some(x), Some(y), Some(z)] = [&b"x"[..], b"y", b"z"].map(|name| column(&[name])) else {
        return Err(ParseError::Syntax {
            at: SourceLocation::Header,
            expected: "the vertex properties x, y and z",
        });
    };
    let uv = column(&[b"s", b"u", b"texture_u"]).zip(column(&[b"t", b"v", b"texture_v"]));
    let normal = column(&[b"nx"]).zip(column(&[b"ny"])).zip(column(&[b"nz"]));
    let mut used = vec![x, y, z];
    used.extend(uv.iter().flat_map(|&(u, v)| [u, v]));
    used.extend(normal.iter().flat_map(|&((x, y), z)| [x, y, z]));
    let channels = VertexChannel::find(element, &used, builder);
    let mut row = vec![0.0; element.properties.len()];
    for i in 0..element.count {
        let at = SourceLocation::Vertex(i);
        for (value, property) in row.iter_mut().zip(&element.properties) {
            match property.count {
                None => *value = values.next(property.kind, at)?,
                Some(count) => {
                    values.list(count, property.kind, at, |_| {})?;
                }
            }
        }
        builder.position([x, y, z].map(|k| row[k]), at)?;
        if let Some((u, v)) = uv {
            builder.uv([u, v].map(|k| round_to_f32(row[k])));
        }
        if let Some(((x, y), z)) = normal {
            builder.normal([x, y, z].map(|k| round_to_f32(row[k])));
        }
        for channel in &channels {
            channel.add(&row, builder);
        }
    }
    Ok(())
}

fn skip(element: &Element<'_>, number: usize, values: &mut Values<'_>) -> Result<(), ParseError> {
    // Items without properties take no bytes, so any number of them is read already.
    if element.properties.is_empty() {
        return Ok(());
    }
    for i in 0..element.count {
        let at = SourceLocation::Item(number, i);
        for property in &element.properties {
            match property.count {
                None => {
                    values.next(property.kind, at)?;
                }
                Some(count) => values.list(count, property.kind, at, |_| {})?,
            }
        }
    }
    Ok(())
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "an index that does not fit is no index, and the integral check refuses it"
)]
fn vertex_index(value: f64, builder: &Builder, at: SourceLocation) -> Result<u32, ParseError> {
    let index = value as i64;
    u32::try_from(index)
        .ok()
        .filter(|&i| i != NONE && f64::from(i) == value)
        .ok_or_else(|| ParseError::IndexOutOfRange {
            at,
            index,
            count: builder.position_count(),
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEADER: &str = "ply\nformat ascii 1.0\ncomment c\nelement vertex 4\nproperty double x\n\
        property float y\nproperty int z\nproperty list uchar int tags\n\
        element nothing 99999999999\nelement face 1\n\
        property list uchar uint vertex_index\nproperty list uchar float texcoord\n\
        property uchar flag\nend_header\n";

    #[test]
    fn text_with_every_kind_of_property_is_read() {
        let body = "0 0 0 0\n1 0 0 2 5 6\n1 1 0 0\n0 1 0 0\n4 0 1 2 3 8 0 0 1 0 1 1 0 0 7\n";
        let data = read_ply(format!("{HEADER}{body}").as_bytes()).unwrap();
        assert_eq!(data.positions.len(), 4);
        assert_eq!(data.triangles, [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(data.corners.uv[2], [1.0, 1.0]);
        assert_eq!(data.file_vertices, 4);
    }

    #[test]
    fn the_first_of_properties_of_one_channel_is_kept() {
        let cases = [
            ("heat", "heat", "heat", 1),
            ("heat", "heat_0", "heat", 1),
            ("red green blue", "color_0 color_1 color_2", "color", 3),
        ];
        for (first, second, channel, width) in cases {
            let header: String = ["x", "y", "z"]
                .into_iter()
                .chain(first.split(' '))
                .chain(second.split(' '))
                .map(|name| format!("property float {name}\n"))
                .collect();
            let file = format!(
                "ply\nformat ascii 1.0\nelement vertex 3\n{header}element face 1\n\
                 property list uchar int vertex_indices\nend_header\n"
            );
            let rows = ["0 0 0", "1 0 0", "0 1 0"].map(|position| {
                let numbers = [" 5", " 7"].map(|number| number.repeat(width));
                format!("{position}{}\n", numbers.concat())
            });
            let data = read_ply(format!("{file}{}3 0 1 2\n", rows.concat()).as_bytes()).unwrap();
            assert_eq!(data.channels.len(), 1, "{first}, {second}");
            assert_eq!(data.channels[0].name(), channel);
            assert_eq!(data.channels[0].values(), vec![5.0; 3 * width]);
            let name = second.split(' ').next().unwrap().to_owned();
            assert_eq!(data.warnings, [Warning::Dropped { name }]);
        }
    }

    #[test]
    fn the_first_of_lists_of_one_channel_is_kept() {
        let file = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n\
            property float y\nproperty float z\nproperty float heat\nelement face 1\n\
            property list uchar int vertex_indices\nproperty list uchar float wear\n\
            property list uchar float wear\nproperty list uchar float heat\nend_header\n\
            0 0 0 4\n1 0 0 4\n0 1 0 4\n3 0 1 2 3 1 2 3 3 7 8 9 3 5 5 5\n";
        let data = read_ply(file.as_bytes()).unwrap();
        let found = data.channels.iter().map(|c| (c.name(), c.values()));
        let expected = [
            ("heat", &[4.0, 4.0, 4.0][..]),
            ("wear", &[1.0, 2.0, 3.0][..]),
        ];
        assert_eq!(found.collect::<Vec<_>>(), expected);
        let dropped = ["wear", "heat"].map(|name| Warning::dropped(name.as_bytes()));
        assert_eq!(data.warnings, dropped);
    }

    #[test]
    fn errors_name_their_element() {
        let error = |body: &str| read_ply(format!("{HEADER}{body}").as_bytes()).unwrap_err();
        let vertices = "0 0 0 0\n1 0 0 0\n1 1 0 0\n0 1 0 0\n";
        assert!(matches!(
            error("0 0 0 0\n1e39 0 0 0\n"),
            ParseError::NotFinite {
                at: SourceLocation::Vertex(1)
            }
        ));
        assert!(matches!(
            error(&format!("{vertices}3 0 1 9 0 7\n")),
            ParseError::IndexOutOfRange {
                at: SourceLocation::Face(0),
                index: 9,
                count: 4
            }
        ));
        assert!(matches!(
            error(&format!("{vertices}3 0 1\n")),
            ParseError::Truncated {
                at: SourceLocation::Face(0)
            }
        ));
        assert!(matches!(
            error("0 0 0 0\nx 0 0 0\n"),
            ParseError::Syntax {
                at: SourceLocation::Line(16),
                ..
            }
        ));
        assert!(matches!(
            read_ply(b"ply\nformat ascii 1.0\nelement vertex\n").unwrap_err(),
            ParseError::Syntax {
                at: SourceLocation::Line(3),
                ..
            }
        ));
        assert!(matches!(
            read_ply(b"ply\nformat ascii 1.0\n").unwrap_err(),
            ParseError::Truncated {
                at: SourceLocation::Header
            }
        ));
    }

    #[test]
    fn byte_orders_agree() {
        let file = |big: bool| {
            let order = if big { "big" } else { "little" };
            let mut out = format!(
                "ply\r\nformat binary_{order}_endian 1.0\r\nelement vertex 3\r\n\
                 property float x\r\nproperty float y\r\nproperty float z\r\nelement face 1\r\n\
                 property list uchar int vertex_indices\r\nend_header\r\n"
            )
            .into_bytes();
            let words = [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.5, 0.0, 1.0, 0.0].map(f32::to_bits);
            let word = |w: u32| {
                if big {
                    w.to_be_bytes()
                } else {
                    w.to_le_bytes()
                }
            };
            out.extend(words.iter().flat_map(|&w| word(w)));
            out.push(3);
            out.extend([0u32, 1, 2].iter().flat_map(|&w| word(w)));
            out
        };
        let little = read_ply(&file(false)).unwrap();
        assert_eq!(little, read_ply(&file(true)).unwrap());
        assert_eq!(little.positions[1], [1.0, 0.0, 0.5]);
        let mut short = file(true);
        short.pop();
        assert!(matches!(
            read_ply(&short).unwrap_err(),
            ParseError::Truncated {
                at: SourceLocation::Face(0)
            }
        ));
    }
}
