//! Writes Wavefront OBJ.

use crate::io::Warning;
use crate::surface::{Channel, Domain, Surface};
use std::io::{self, Write};

pub(super) fn write(surface: &Surface, out: &mut impl Write) -> io::Result<()> {
    let color = surface.channels().iter().find(|channel| is_color(channel));
    for (v, &[x, y, z, _]) in surface.positions.iter().enumerate() {
        match surface.file_position([x, y, z]) {
            None => write!(out, "v {x:?} {y:?} {z:?}")?,
            Some([x, y, z]) => write!(out, "v {x:?} {y:?} {z:?}")?,
        }
        if let Some(&[r, g, b, ..]) = color.map(|color| color.row(v)) {
            write!(out, " {r:?} {g:?} {b:?}")?;
        }
        writeln!(out)?;
    }
    let uv = distinct(&surface.corners.uv);
    for [u, v] in uv.iter().map(|uv| uv.map(f32::from_bits)) {
        writeln!(out, "vt {u:?} {v:?}")?;
    }
    let normals = distinct(&surface.corners.normal);
    for [x, y, z] in normals.iter().map(|n| n.map(f32::from_bits)) {
        writeln!(out, "vn {x:?} {y:?} {z:?}")?;
    }
    let mut triangles = surface.topology().triangles();
    let first = triangles.next().map(|t| surface.material(t));
    let differ = triangles.any(|t| Some(surface.material(t)) != first);
    let mut material = None;
    for t in surface.topology().triangles() {
        let own = Some(surface.material(t));
        if differ && own != material {
            writeln!(out, "usemtl material_{}", surface.material(t))?;
            material = own;
        }
        write!(out, "f")?;
        for h in t.half_edges() {
            write!(out, " {}", surface.topology().origin(h).0 + 1)?;
            let index_of_uv = index_in(&uv, surface.corners.uv.get(h.index()));
            let index_of_normal = index_in(&normals, surface.corners.normal.get(h.index()));
            match (index_of_uv, index_of_normal) {
                (None, None) => {}
                (Some(uv), None) => write!(out, "/{uv}")?,
                (None, Some(normal)) => write!(out, "//{normal}")?,
                (Some(uv), Some(normal)) => write!(out, "/{uv}/{normal}")?,
            }
        }
        writeln!(out)?;
    }
    Ok(())
}

fn distinct<const N: usize>(values: &[[f32; N]]) -> Vec<[u32; N]> {
    let mut out: Vec<[u32; N]> = values.iter().map(|value| value.map(f32::to_bits)).collect();
    out.sort_unstable();
    out.dedup();
    out
}

/// Returns the OBJ index of a value, which counts from 1.
fn index_in<const N: usize>(distinct: &[[u32; N]], value: Option<&[f32; N]>) -> Option<usize> {
    let value = value?.map(f32::to_bits);
    distinct.binary_search(&value).ok().map(|i| i + 1)
}

/// Returns warnings about the channels that OBJ cannot hold.
pub(super) fn dropped(surface: &Surface) -> Vec<Warning> {
    let dropped = surface.channels().iter().filter_map(|channel| {
        let name = channel.name();
        match (is_color(channel), channel.width()) {
            (true, 3) => None,
            (true, _) => Some(format!("{name} (alpha)")),
            (false, _) => Some(name.to_owned()),
        }
    });
    dropped.map(|name| Warning::Dropped { name }).collect()
}

/// Returns whether a channel has colors of vertices.
fn is_color(channel: &Channel) -> bool {
    channel.name() == "color" && channel.domain() == Domain::Vertex && channel.width() >= 3
}
