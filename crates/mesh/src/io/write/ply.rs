//! Writes little-endian PLY.

use crate::ids::TriangleId;
use crate::io::Warning;
use crate::io::ply::{SKIN_LIST, keeps};
use crate::surface::{Blend, Channel, Domain, Surface};
use std::io::{self, Write};

/// The largest number of a color of 8 bits.
const BYTE: f32 = 255.0;

pub(super) fn write(surface: &Surface, out: &mut impl Write) -> io::Result<()> {
    let topology = surface.topology();
    let channels = |domain| {
        surface
            .channels()
            .iter()
            .filter(move |c| c.domain() == domain && keeps(c))
    };
    let has_materials = topology.triangles().any(|t| surface.material(t) != 0);
    let kind = if surface.origin == [0.0; 3] {
        "float"
    } else {
        "double"
    };
    write!(
        out,
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\n",
        topology.vertex_slots()
    )?;
    for axis in ["x", "y", "z"] {
        writeln!(out, "property {kind} {axis}")?;
    }
    let of_vertices: Vec<(&Channel, bool)> = channels(Domain::Vertex)
        .map(|channel| (channel, has_bytes(channel)))
        .collect();
    for &(channel, has_bytes) in &of_vertices {
        let kind = if has_bytes { "uchar" } else { "float" };
        for name in component_names(channel) {
            writeln!(out, "property {kind} {name}")?;
        }
    }
    write!(
        out,
        "element face {}\nproperty list uchar uint vertex_indices\n",
        topology.triangle_slots()
    )?;
    for (values, name) in [
        (surface.corners.uv.len(), "texcoord"),
        (surface.corners.normal.len(), "normal"),
    ] {
        if values > 0 {
            writeln!(out, "property list uchar float {name}")?;
        }
    }
    for channel in channels(Domain::Corner) {
        let suffix = if channel.blend() == Blend::Skin {
            SKIN_LIST
        } else {
            ""
        };
        writeln!(out, "property list uchar float {}{suffix}", channel.name())?;
    }
    if has_materials {
        writeln!(out, "property uint material")?;
    }
    writeln!(out, "end_header")?;
    for (v, &[x, y, z, _]) in surface.positions.iter().enumerate() {
        match surface.file_position([x, y, z]) {
            None => write_numbers(&[x, y, z], out)?,
            Some(p) => p.iter().try_for_each(|x| out.write_all(&x.to_le_bytes()))?,
        }
        for &(channel, has_bytes) in &of_vertices {
            for &x in channel.row(v) {
                match byte(x).filter(|_| has_bytes) {
                    Some(byte) => out.write_all(&[byte])?,
                    None => out.write_all(&x.to_le_bytes())?,
                }
            }
        }
    }
    for t in topology.triangles() {
        out.write_all(&[3])?;
        for v in topology.triangle(t) {
            out.write_all(&v.0.to_le_bytes())?;
        }
        write_list(t, &surface.corners.uv, out)?;
        write_list(t, &surface.corners.normal, out)?;
        for channel in channels(Domain::Corner) {
            write_count(3 * channel.width(), out)?;
            for h in t.half_edges() {
                write_numbers(channel.row(h.index()), out)?;
            }
        }
        if has_materials {
            out.write_all(&surface.material(t).to_le_bytes())?;
        }
    }
    Ok(())
}

/// Returns warnings about the channels that are not written: a reader would not find them again.
pub(super) fn dropped(surface: &Surface) -> Vec<Warning> {
    let dropped = surface.channels().iter().filter(|channel| !keeps(channel));
    dropped
        .map(|channel| Warning::dropped(channel.name().as_bytes()))
        .collect()
}

/// Returns the names of a channel's properties.
fn component_names(channel: &Channel) -> Vec<String> {
    let (name, width) = (channel.name(), channel.width());
    if is_color(channel) {
        let names = ["red", "green", "blue", "alpha"].iter().take(width);
        return names.map(|&name| name.to_owned()).collect();
    }
    let numbers = |part: &'static str, count| (0..count).map(move |k| format!("{name}{part}_{k}"));
    match (channel.blend(), width) {
        (Blend::Skin, _) => {
            let joints = width / 2;
            numbers("_joint", joints)
                .chain(numbers("_weight", joints))
                .collect()
        }
        (Blend::Linear, 1) => vec![name.to_owned()],
        (Blend::Linear, _) => numbers("", width).collect(),
    }
}

/// Returns whether a channel has colors with or without alpha.
fn is_color(channel: &Channel) -> bool {
    channel.name() == "color"
        && channel.blend() == Blend::Linear
        && (3..=4).contains(&channel.width())
}

/// Returns whether a channel has colors that bytes keep to the bit.
fn has_bytes(channel: &Channel) -> bool {
    is_color(channel) && channel.values().iter().all(|&x| byte(x).is_some())
}

/// Returns the byte of a fraction that readers divide by 255, if it keeps every bit.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a fraction that does not fit is none of a byte, and the comparison refuses it"
)]
fn byte(x: f32) -> Option<u8> {
    let byte = (x * BYTE).round() as u8;
    let back = (f64::from(byte) / f64::from(BYTE)) as f32;
    (back.to_bits() == x.to_bits()).then_some(byte)
}

fn write_list<const N: usize>(
    t: TriangleId,
    values: &[[f32; N]],
    out: &mut impl Write,
) -> io::Result<()> {
    if values.is_empty() {
        return Ok(());
    }
    write_count(3 * N, out)?;
    (t.half_edges().iter()).try_for_each(|h| write_numbers(&values[h.index()], out))
}

/// Writes the length of a list: three rows of a channel at most.
fn write_count(count: usize, out: &mut impl Write) -> io::Result<()> {
    let count = u8::try_from(count).map_err(io::Error::other)?;
    out.write_all(&[count])
}

fn write_numbers(values: &[f32], out: &mut impl Write) -> io::Result<()> {
    values
        .iter()
        .try_for_each(|x| out.write_all(&x.to_le_bytes()))
}
