//! The channels of glTF: colors, skin weights, further texture coordinates and custom attributes.
//!
//! `COLOR_0` is the channel `color`, `COLOR_N` is `colorN`, `TEXCOORD_N` is `uvN`, `_NAME` is
//! `NAME`. `JOINTS_0` and `WEIGHTS_0` together are `skin`, with which further sets are merged.

use super::accessor::{Accessors, Rows};
use super::document::Primitive;
use crate::io::build::Builder;
use crate::io::data::Warning;
use crate::io::error::ParseError;
use crate::surface::{Blend, Domain, Row};

/// Numbers of a skin row: four joints and four weights.
const SKIN: usize = 8;

/// Reads the other attributes of a primitive, whose `count` positions begin with number `first`.
///
/// Fails if the file unfolds to more than `most` numbers.
pub(super) fn read_channels(
    primitive: &Primitive,
    accessors: &Accessors<'_>,
    first: usize,
    count: usize,
    most: usize,
    builder: &mut Builder,
) -> Result<(), ParseError> {
    let attributes = &primitive.attributes.others;
    let mut skin: Vec<Row> = Vec::new();
    for (name, &accessor) in attributes {
        let left = most.saturating_sub(builder.channels.value_count());
        let set = name
            .strip_prefix("JOINTS_")
            .or(name.strip_prefix("WEIGHTS_"));
        if let Some(set) = set {
            let [joints, weights] =
                ["JOINTS_", "WEIGHTS_"].map(|kind| attributes.get(&format!("{kind}{set}")));
            let is_read = match (joints, weights) {
                (Some(_), Some(_)) if name.starts_with("WEIGHTS_") => continue,
                (Some(&joints), Some(&weights)) => {
                    let sets = [joints, weights].map(|at| accessors.rows(at, left));
                    let [joints, weights] = sets;
                    merge(&mut skin, &joints?, &weights?, count)
                }
                _ => false,
            };
            if !is_read || set != "0" {
                builder.warnings.push(Warning::dropped(name.as_bytes()));
            }
            continue;
        }
        let rows = match channel_of(name) {
            Some(channel) => Some((channel, accessors.rows(accessor, left)?)),
            None => None,
        };
        let is_read = rows.is_some_and(|((name, domain), rows)| {
            rows.values.len() == count * rows.width
                && add_rows(builder, &name, domain, Blend::Linear, first, &rows)
        });
        if !is_read {
            builder.warnings.push(Warning::dropped(name.as_bytes()));
        }
    }
    if !skin.is_empty() {
        let rows = Rows {
            width: SKIN,
            values: skin.iter().flat_map(|row| row[..SKIN].to_vec()).collect(),
        };
        if !add_rows(builder, "skin", Domain::Vertex, Blend::Skin, first, &rows) {
            builder.warnings.push(Warning::dropped(b"JOINTS_0"));
        }
    }
    Ok(())
}

/// Adds a set of joints and weights to the rows of earlier sets; returns whether it fits.
///
/// The largest four weights remain. A single set keeps every bit.
fn merge(skin: &mut Vec<Row>, joints: &Rows, weights: &Rows, count: usize) -> bool {
    let fits = |rows: &Rows| rows.width == SKIN / 2 && rows.values.len() == 4 * count;
    if !fits(joints) || !fits(weights) {
        return false;
    }
    let [joints, weights] = [joints, weights].map(|rows| rows.values.as_chunks::<4>().0);
    let sets = joints.iter().zip(weights);
    let rows = sets.map(|(joints, weights)| {
        let mut row = Row::default();
        row[..4].copy_from_slice(joints);
        row[4..8].copy_from_slice(weights);
        row
    });
    if skin.is_empty() {
        skin.extend(rows);
    } else {
        for (old, new) in skin.iter_mut().zip(rows) {
            *old = Blend::Skin.rows(SKIN, [(*old, 0.5), (new, 0.5)]);
        }
    }
    true
}

/// Adds rows of the positions from number `first`; returns whether the channel fits.
fn add_rows(
    builder: &mut Builder,
    name: &str,
    domain: Domain,
    blend: Blend,
    first: usize,
    rows: &Rows,
) -> bool {
    let channels = &mut builder.channels;
    let Some(channel) = channels.vertex_channel(name, domain, blend, rows.width, first) else {
        return false;
    };
    for (i, row) in rows.values.chunks(rows.width).enumerate() {
        channels.add_vertex_row(channel, first + i, row);
    }
    true
}

/// Returns the name and domain of an attribute's channel; none if it has no place.
fn channel_of(name: &str) -> Option<(String, Domain)> {
    let numbered = |base: &str, set: &str| match set.parse::<u32>().ok()? {
        0 => Some(base.to_owned()),
        n => Some(format!("{base}{n}")),
    };
    if let Some(own) = name.strip_prefix('_') {
        return (!own.is_empty()).then(|| (own.to_owned(), Domain::Vertex));
    }
    let (kind, set) = name.rsplit_once('_')?;
    let (base, domain) = match kind {
        "COLOR" => ("color", Domain::Vertex),
        "TEXCOORD" => ("uv", Domain::Corner),
        _ => return None,
    };
    Some((numbered(base, set)?, domain))
}
