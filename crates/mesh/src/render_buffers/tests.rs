use super::*;
use crate::geometry::to_f64;
use crate::shapes::{cube_sphere, icosphere, torus};
use crate::surface::Blend;
use std::collections::BTreeSet;

/// Asserts that the buffers show every triangle once, with its own values.
fn check(buffers: &RenderBuffers, surface: &Surface, params: RenderParams) {
    let mut shown = BTreeSet::new();
    let vertices: Vec<VertexId> = buffers.vertices(surface).collect();
    for (part, indices) in [buffers.skin_indices(), buffers.cap_indices()]
        .into_iter()
        .enumerate()
    {
        for (triangle, &t) in indices.chunks(3).zip(&buffers.triangles[part]) {
            let corners = surface.topology().triangle(t);
            for ((&i, v), h) in triangle.iter().zip(corners).zip(t.half_edges()) {
                let i = i as usize;
                assert_eq!(vertices[i], v);
                let [x, y, z, _] = surface.positions()[v.index()];
                assert_eq!(buffers.positions()[i], [x, y, z]);
                if let Some(uv) = surface.corner_uvs().get(h.index()) {
                    assert_eq!(buffers.uvs()[i], *uv);
                }
                for (own, channel) in buffers.channels().iter().zip(surface.channels()) {
                    let slot = match channel.domain() {
                        Domain::Vertex => v.index(),
                        Domain::Corner => h.index(),
                    };
                    assert_eq!(own.row(i), channel.row(slot), "{}", channel.name());
                }
            }
            let is_cap = surface.material(t) >= params.cap_material;
            assert_eq!(part == 1, is_cap);
            assert!(shown.insert(t), "{t} is shown once");
        }
    }
    let is_own = |t: &TriangleId| params.piece.is_none_or(|piece| surface.piece(*t) == piece);
    assert!(
        shown
            .into_iter()
            .eq(surface.topology().triangles().filter(is_own))
    );
    let used: BTreeSet<u32> = buffers.indices.iter().flatten().copied().collect();
    let live = (0..)
        .zip(&vertices)
        .filter(|(_, v)| !v.is_null())
        .map(|(i, _)| i);
    assert!(live.eq(used), "exactly the live vertices are used");
}

fn with_channels(mut surface: Surface) -> Surface {
    let corners = 3 * surface.topology().triangle_slots();
    let vertices = surface.topology().vertex_slots();
    let number = |i: usize| f32::from(u16::try_from(i).unwrap());
    for (name, domain, rows) in [
        ("a", Domain::Vertex, vertices),
        ("b", Domain::Corner, corners),
    ] {
        // A seam of the corner channel in every fourth triangle.
        let value = |i: usize| {
            if domain == Domain::Corner {
                number(i / 12 % 2)
            } else {
                number(i)
            }
        };
        let values = (0..rows).map(value).collect();
        let channel = Channel::new(name, domain, Blend::Linear, 1, values).unwrap();
        surface.set_channel(channel).unwrap();
    }
    surface
}

#[test]
fn creases_part_vertices_and_smooth_surfaces_have_one_each() {
    let mut ball = icosphere(2, 0.5);
    ball.set_corner_normals(Vec::new()).unwrap();
    let buffers = RenderBuffers::new(&ball, RenderParams::default());
    assert_eq!(buffers.positions().len(), 162);
    for (normal, &at) in buffers.normals().iter().zip(buffers.positions()) {
        let cosine = to_f64(*normal).dot(&to_f64(at).normalize());
        assert!(cosine > 0.999, "{cosine}");
    }
    let params = RenderParams {
        crease_angle: 0.0,
        ..RenderParams::default()
    };
    assert_eq!(RenderBuffers::new(&ball, params).positions().len(), 960);
    let cube = cube_sphere(1, 0.5);
    let buffers = RenderBuffers::new(&cube, RenderParams::default());
    assert_eq!(
        buffers.positions().len(),
        24,
        "three sides meet at eight corners"
    );
}

#[test]
fn tangents_follow_u() {
    let mut sheet = crate::shapes::sheet([1.0, 1.0], [2, 2]);
    let uv = sheet.topology().corners().iter().map(|v| {
        let [x, y, z] = sheet.rest_positions()[v.index()];
        [x, y + z]
    });
    let uv = uv.collect();
    sheet.set_corner_uvs(uv).unwrap();
    let params = RenderParams {
        tangents: true,
        ..RenderParams::default()
    };
    let buffers = RenderBuffers::new(&sheet, params);
    for (&[x, y, z, w], &n) in buffers.tangents().iter().zip(buffers.normals()) {
        assert!(
            (x - 1.0).abs() < 1e-6 && y.abs() + z.abs() < 1e-6,
            "{x} {y} {z}"
        );
        let bitangent = to_f64(n).cross(&to_f64([x, y, z])) * f64::from(w);
        assert!(bitangent.y + bitangent.z > 0.9, "{bitangent}");
    }
}

/// Regression: after the first of two channels was removed, the other one had its values.
#[test]
fn removed_channels_leave_the_buffers() {
    let mut surface = with_channels(torus(0.4, 0.15, 12, 8));
    let params = RenderParams::default();
    let mut buffers = RenderBuffers::new(&surface, params);
    surface.remove_channel("a").unwrap();
    let mut edit = surface.edit();
    let t = edit.surface().topology().triangles().next().unwrap();
    edit.flip_edge(t.half_edges()[0]).unwrap();
    let (delta, _) = edit.finish();
    buffers.update(&surface, &delta);
    let new = RenderBuffers::new(&surface, params);
    assert_eq!(buffers.channels().len(), 1);
    assert_eq!(buffers.channels()[0].values(), new.channels()[0].values());
}

#[test]
fn updates_equal_new_buffers() {
    let mut surface = with_channels(torus(0.4, 0.15, 12, 8));
    let params = RenderParams::default();
    let mut buffers = RenderBuffers::new(&surface, params);
    check(&buffers, &surface, params);
    let mut undos = Vec::new();
    for i in 0..30 {
        let mut edit = surface.edit();
        let count = edit.surface().topology().triangle_slots();
        let all = edit.surface().topology().triangles();
        let t = all.into_iter().nth(37 * i % count.min(150)).unwrap();
        let h = t.half_edges()[i % 3];
        let v = edit.surface().topology().origin(h);
        let position = edit.surface().positions()[v.index()];
        let rest = edit.surface().rest_positions()[v.index()];
        match i % 3 {
            0 => drop(edit.split_edge(h, position, rest, 0.5)),
            1 => drop(edit.flip_edge(h)),
            _ => drop(edit.collapse_edge(h)),
        }
        let (delta, undo) = edit.finish();
        undos.push(undo);
        buffers.update(&surface, &delta);
        check(&buffers, &surface, params);
        let new = RenderBuffers::new(&surface, params);
        let live = buffers.vertices(&surface).filter(|v| !v.is_null()).count();
        assert_eq!(live, new.positions().len(), "edit {i}");
    }
    for undo in undos.into_iter().rev() {
        let delta = undo.revert(&mut surface).unwrap();
        buffers.update(&surface, &delta);
        check(&buffers, &surface, params);
    }
}
