//! The channels of a PLY file: which properties belong to which.
//!
//! Properties `NAME_0`, `NAME_1` and so on of vertices are the components of one channel;
//! `NAME_joint_0` and `NAME_weight_0` and so on are skin weights. `red`, `green`, `blue` and
//! `alpha` are the channel `color`, from 0 to 1. A list per face with rows for its corners is a
//! channel of corners, and one of skin weights if its name ends in `_skin`.

use super::header::{Element, Kind, Property};
use crate::geometry::round_to_f32;
use crate::io::build::Builder;
use crate::io::channels::FileChannels;
use crate::io::data::Warning;
use crate::surface::{Blend, Channel, Domain, MAX_WIDTH};
use rustc_hash::FxHashMap;

/// Names of properties that belong to no channel, or to the colors.
const RESERVED: [&str; 24] = [
    "x",
    "y",
    "z",
    "s",
    "t",
    "u",
    "v",
    "texture_u",
    "texture_v",
    "nx",
    "ny",
    "nz",
    "red",
    "green",
    "blue",
    "alpha",
    "texcoord",
    "texcoords",
    "normal",
    "normals",
    "vertex_index",
    "vertex_indices",
    "material",
    "",
];

/// Returns whether a reader of PLY finds a channel again, by the names of its properties.
pub(in crate::io) fn keeps(channel: &Channel) -> bool {
    let name = channel.name();
    let number = name.rsplit_once('_').map(|(_, number)| number);
    // Numbers of such names are read as joints and weights.
    let is_skin_part = channel.domain() == Domain::Vertex
        && channel.width() > 1
        && ["_joint", "_weight"]
            .iter()
            .any(|part| name.ends_with(part));
    name.bytes().all(|b| b.is_ascii_graphic())
        && !RESERVED.contains(&name)
        && !name.ends_with(SKIN_LIST)
        && !is_skin_part
        && number.is_none_or(|number| number.parse::<usize>().is_err())
}

/// Ends the name of a list of skin weights per corner.
pub(in crate::io) const SKIN_LIST: &str = "_skin";

/// A channel of vertices and the columns of its components.
pub(super) struct VertexChannel {
    channel: usize,
    columns: Vec<usize>,
    /// 1, or the largest value of integers that are fractions.
    divisor: f64,
}

impl VertexChannel {
    /// Finds the channels of an element's properties, except those in `used`.
    pub(super) fn find(element: &Element<'_>, used: &[usize], builder: &mut Builder) -> Vec<Self> {
        let properties = &element.properties;
        let column = |name: &[u8]| {
            let is_own = |p: &Property<'_>| p.count.is_none() && p.name == name;
            let at = properties.iter().position(is_own)?;
            (!used.contains(&at)).then_some(at)
        };
        let mut taken = used.to_vec();
        let mut out = Vec::new();
        let rgb = [&b"red"[..], b"green", b"blue"].map(column);
        if let [Some(red), Some(green), Some(blue)] = rgb {
            let mut columns = vec![red, green, blue];
            columns.extend(column(b"alpha"));
            let divisor = match properties[red].kind {
                Kind::U8 => 255.0,
                Kind::U16 => 65535.0,
                _ => 1.0,
            };
            let channel = vertex_channel(builder, "color", Blend::Linear, columns.len());
            out.extend(channel.map(|channel| Self {
                channel,
                columns: columns.clone(),
                divisor,
            }));
            taken.extend(columns);
        }
        for (i, property) in properties.iter().enumerate() {
            if taken.contains(&i) {
                continue;
            }
            let name = String::from_utf8_lossy(property.name).into_owned();
            let numbered = |base: &str| -> Vec<usize> {
                let columns = (0..).map(|k| column(format!("{base}{k}").as_bytes()));
                columns.map_while(|at| at).take(MAX_WIDTH).collect()
            };
            let (base, blend, columns) = if let Some(base) = name.strip_suffix("_joint_0") {
                let [joints, weights] =
                    ["joint", "weight"].map(|part| numbered(&format!("{base}_{part}_")));
                if joints.len() == weights.len() {
                    (base, Blend::Skin, [joints, weights].concat())
                } else {
                    (&*name, Blend::Linear, vec![i])
                }
            } else if let Some(base) = name.strip_suffix("_0") {
                (base, Blend::Linear, numbered(&format!("{base}_")))
            } else {
                (&*name, Blend::Linear, vec![i])
            };
            taken.extend(&columns);
            let is_scalar = columns.iter().all(|&k| properties[k].count.is_none());
            let channel = is_scalar.then(|| vertex_channel(builder, base, blend, columns.len()));
            match channel.flatten() {
                Some(channel) => out.push(Self {
                    channel,
                    columns,
                    divisor: 1.0,
                }),
                None => builder.warnings.push(Warning::dropped(property.name)),
            }
        }
        out
    }

    /// Adds the row of the last position.
    pub(super) fn add(&self, values: &[f64], builder: &mut Builder) {
        let mut row = [0.0; MAX_WIDTH];
        for (value, &column) in row.iter_mut().zip(&self.columns) {
            *value = round_to_f32(values[column] / self.divisor);
        }
        let position = builder.position_count() - 1;
        let row = &row[..self.columns.len()];
        (builder.channels).add_vertex_row(self.channel, position, row);
    }
}

fn vertex_channel(builder: &mut Builder, name: &str, blend: Blend, width: usize) -> Option<usize> {
    let first = builder.position_count();
    (builder.channels).vertex_channel(name, Domain::Vertex, blend, width, first)
}

/// A list of numbers per face that may be a channel of corners.
pub(super) struct CornerChannel {
    pub(super) column: usize,
    pub(super) name: String,
    /// The channel and its width, which the first face tells.
    pub(super) channel: Option<(usize, usize)>,
    /// The numbers of the current face.
    pub(super) values: Vec<f32>,
}

/// The lists of faces that are channels of corners, and the rows found so far.
pub(super) struct CornerChannels {
    pub(super) lists: Vec<CornerChannel>,
    /// The rows of corners by the bits of all lists.
    known: FxHashMap<Vec<u32>, u32>,
    key: Vec<u32>,
}

impl CornerChannels {
    /// Returns the lists of an element, except those in `used`.
    pub(super) fn new(element: &Element<'_>, used: &[usize]) -> Self {
        let is_list =
            |p: &Property<'_>| p.count.is_some() && matches!(p.kind, Kind::F32 | Kind::F64);
        let properties = element.properties.iter().enumerate();
        let lists = properties.filter(|(i, p)| is_list(p) && !used.contains(i));
        Self {
            lists: lists
                .map(|(column, property)| CornerChannel {
                    column,
                    name: String::from_utf8_lossy(property.name).into_owned(),
                    channel: None,
                    values: Vec::new(),
                })
                .collect(),
            known: FxHashMap::default(),
            key: Vec::new(),
        }
    }

    /// Returns the row of a corner of the current face; none if no list has one.
    pub(super) fn row(
        &mut self,
        corner: usize,
        corners: usize,
        channels: &mut FileChannels,
    ) -> Option<u32> {
        self.key.clear();
        for i in 0..self.lists.len() {
            let (before, rest) = self.lists.split_at_mut(i);
            let list = &mut rest[0];
            let width = list.values.len() / corners;
            if list.channel.is_none() && width > 0 {
                let (name, blend) = match list.name.strip_suffix(SKIN_LIST) {
                    Some(name) => (name, Blend::Skin),
                    None => (&*list.name, Blend::Linear),
                };
                let channel = channels.corner_channel(name, blend, width);
                let channel = channel.map(|channel| (channel, width));
                let is_free = |list: &CornerChannel| list.channel != channel;
                list.channel = channel.filter(|_| before.iter().all(is_free));
            }
            if let Some(row) = list.row(corner, corners) {
                self.key.extend(row.iter().map(|x| x.to_bits()));
            }
        }
        if self.key.is_empty() {
            return None;
        }
        if let Some(&row) = self.known.get(&self.key) {
            return Some(row);
        }
        let row = channels.add_corner_row();
        for list in &self.lists {
            if let (Some((channel, _)), Some(values)) = (list.channel, list.row(corner, corners)) {
                channels.set_corner_row(channel, values);
            }
        }
        self.known.insert(self.key.clone(), row);
        Some(row)
    }
}

impl CornerChannel {
    /// Returns the values of a corner, if the face has one row of the channel's width per corner.
    fn row(&self, corner: usize, corners: usize) -> Option<&[f32]> {
        let (_, width) = self.channel?;
        let is_complete = self.values.len() == corners * width;
        is_complete.then(|| &self.values[corner * width..(corner + 1) * width])
    }
}
