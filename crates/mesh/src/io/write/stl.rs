//! Writes binary STL.

use crate::geometry::{to_f32, unit_normal};
use crate::ids::index_u32;
use crate::io::Warning;
use crate::surface::Surface;
use std::io::{self, Write};

pub(super) fn write(surface: &Surface, out: &mut impl Write) -> io::Result<()> {
    let topology = surface.topology();
    let mut header = [b' '; 80];
    let title = b"binary STL of incise";
    header[..title.len()].copy_from_slice(title);
    out.write_all(&header)?;
    out.write_all(&index_u32(topology.triangle_count()).to_le_bytes())?;
    for t in topology.triangles() {
        let normal = unit_normal(surface.triangle_positions(t));
        let corners = topology.triangle(t).map(|v| {
            let [x, y, z, _] = surface.positions[v.index()];
            match surface.file_position([x, y, z]) {
                None => [x, y, z],
                Some(p) => to_f32(p.into()),
            }
        });
        for x in normal.iter().chain(corners.as_flattened()) {
            out.write_all(&x.to_le_bytes())?;
        }
        out.write_all(&[0; 2])?;
    }
    Ok(())
}

/// Returns warnings about all attributes but positions, and about an origin that is far away.
pub(super) fn dropped(surface: &Surface) -> Vec<Warning> {
    let has_materials = surface
        .topology()
        .triangles()
        .any(|t| surface.material(t) != 0);
    let fixed = [
        (!surface.corners.uv.is_empty(), "texture coordinates"),
        (!surface.corners.normal.is_empty(), "normals"),
        (has_materials, "materials"),
    ];
    let fixed = fixed.iter().filter(|entry| entry.0).map(|entry| entry.1);
    let names = fixed.chain(surface.channels().iter().map(|channel| channel.name()));
    let dropped = names.map(|name| Warning::Dropped {
        name: name.to_owned(),
    });
    let origin = surface.origin();
    let rounded = (origin != [0.0; 3]).then_some(Warning::OriginRounded { origin });
    dropped.chain(rounded).collect()
}
