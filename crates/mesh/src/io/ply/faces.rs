//! The faces of a PLY file: indices, material, and lists with numbers for each corner.

use super::channels::CornerChannels;
use super::header::Element;
use super::values::Values;
use super::vertex_index;
use crate::geometry::round_to_f32;
use crate::io::build::{Builder, Corner, NONE};
use crate::io::data::Warning;
use crate::io::error::{ParseError, SourceLocation};
use rustc_hash::FxHashMap;

/// Reads the faces of a file.
pub(super) fn read_faces(
    element: &Element<'_>,
    values: &mut Values<'_>,
    builder: &mut Builder,
) -> Result<(), ParseError> {
    let list = |names: &[&[u8]]| {
        (element.properties.iter()).position(|p| p.count.is_some() && names.contains(&p.name))
    };
    let indices_column = list(&[b"vertex_indices", b"vertex_index"]);
    if indices_column.is_none() && element.count > 0 {
        return Err(ParseError::Syntax {
            at: SourceLocation::Header,
            expected: "the face property vertex_indices",
        });
    }
    let mut uv = CornerList::<2>::new(list(&[b"texcoord", b"texcoords"]));
    let mut normal = CornerList::<3>::new(list(&[b"normal", b"normals"]));
    let material_column =
        (element.properties.iter()).position(|p| p.count.is_none() && p.name == b"material");
    let lists = [indices_column, uv.column, normal.column];
    let used: Vec<usize> = lists.into_iter().flatten().collect();
    let mut channels = CornerChannels::new(element, &used);
    for (i, property) in element.properties.iter().enumerate() {
        let is_used = used.contains(&i) || channels.lists.iter().any(|list| list.column == i);
        if !is_used && material_column != Some(i) {
            builder.warnings.push(Warning::dropped(property.name));
        }
    }
    let (mut indices, mut corners) = (Vec::new(), Vec::new());
    for i in 0..element.count {
        let at = SourceLocation::Face(i);
        indices.clear();
        uv.values.clear();
        normal.values.clear();
        channels
            .lists
            .iter_mut()
            .for_each(|list| list.values.clear());
        for (k, property) in element.properties.iter().enumerate() {
            let Some(count) = property.count else {
                let value = values.next(property.kind, at)?;
                if Some(k) == material_column {
                    builder.material = material(value);
                }
                continue;
            };
            if Some(k) == indices_column {
                values.list(count, property.kind, at, |value| indices.push(value))?;
                continue;
            }
            let mut others = channels.lists.iter_mut().filter(|list| list.column == k);
            let list = if Some(k) == uv.column {
                Some(&mut uv.values)
            } else if Some(k) == normal.column {
                Some(&mut normal.values)
            } else {
                others.next().map(|list| &mut list.values)
            };
            match list {
                Some(list) => {
                    let push = |value| list.push(round_to_f32(value));
                    values.list(count, property.kind, at, push)?;
                }
                None => values.list(count, property.kind, at, |_| {})?,
            }
        }
        corners.clear();
        for &index in &indices {
            corners.push(Corner::position(vertex_index(index, builder, at)?));
        }
        let (with_uv, with_normal) = (builder.uv_count() > 0, builder.normal_count() > 0);
        let count = corners.len();
        for (k, corner) in corners.iter_mut().enumerate() {
            if let Some(value) = uv.of_corner(k, count) {
                corner.uv = uv.index(value, |value| builder.uv(value));
            } else if with_uv && uv.column.is_none() {
                corner.uv = corner.position;
            }
            if let Some(value) = normal.of_corner(k, count) {
                corner.normal = normal.index(value, |value| builder.normal(value));
            } else if with_normal && normal.column.is_none() {
                corner.normal = corner.position;
            }
            if !channels.lists.is_empty() {
                let row = channels.row(k, count, &mut builder.channels);
                corner.row = row.unwrap_or(NONE);
            }
        }
        builder.face(&corners, at)?;
    }
    builder.material = 0;
    let without = channels.lists.iter().filter(|list| list.channel.is_none());
    let dropped = without.map(|list| Warning::dropped(list.name.as_bytes()));
    builder.warnings.extend(dropped);
    Ok(())
}

/// A list with N numbers for each corner of a face.
struct CornerList<const N: usize> {
    column: Option<usize>,
    /// The numbers of the current face.
    values: Vec<f32>,
    /// The index of each distinct value, by its bits.
    known: FxHashMap<[u32; N], u32>,
}

impl<const N: usize> CornerList<N> {
    fn new(column: Option<usize>) -> Self {
        Self {
            column,
            values: Vec::new(),
            known: FxHashMap::default(),
        }
    }

    /// Returns the numbers of a corner, if the face has N for each corner.
    fn of_corner(&self, corner: usize, corners: usize) -> Option<[f32; N]> {
        let is_complete = self.values.len() == N * corners;
        is_complete.then(|| self.values.as_chunks::<N>().0[corner])
    }

    /// Returns the index of a value, which `add` adds if it is new.
    fn index(&mut self, value: [f32; N], add: impl FnOnce([f32; N]) -> u32) -> u32 {
        let key = value.map(f32::to_bits);
        *self.known.entry(key).or_insert_with(|| add(value))
    }
}

/// Returns the material of a face; 0 for a number that is none.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a number that does not fit is no material, and the comparison refuses it"
)]
fn material(value: f64) -> u32 {
    let number = value as u32;
    if f64::from(number) == value {
        number
    } else {
        0
    }
}
