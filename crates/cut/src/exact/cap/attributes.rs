//! Texture coordinates and normals of caps and walls.

use super::Cap;
use crate::exact::frames::Frames;
use incise_mesh::Edit;
use incise_mesh::geometry::to_f32;
use incise_refine::SectionMesh;

impl Cap {
    /// Finds the texture coordinates of each point: its position in the sweep laid flat, scaled.
    pub(super) fn find_uvs(&mut self, frames: &Frames, i: usize, mesh: &SectionMesh, scale: f64) {
        self.uvs.clear();
        let section = &self.section.sections()[i];
        let inner = mesh.steiner_points.iter().map(|inner| inner.position);
        let points = section.points.iter().copied().chain(inner);
        self.uvs.extend(points.map(|at| {
            let [u, v] = frames.flat(section.facet, section.uncentered(at));
            let [u, v, _] = to_f32([scale * u, scale * v, 0.0].into());
            [u, v]
        }));
    }

    /// Sets the texture coordinates of [`Self::find_uvs`] and the normals of the sweep.
    pub(super) fn set_attributes(
        &self,
        edit: &mut Edit<'_>,
        frames: &Frames,
        i: usize,
        mesh: &SectionMesh,
        side: usize,
    ) {
        let has_normals = !edit.surface().corner_normals().is_empty();
        if self.uvs.is_empty() && !has_normals {
            return;
        }
        let normal = frames.normal(self.section.sections()[i].facet);
        let normal = to_f32(if side == 0 { normal } else { -normal });
        for (t, triangle) in self.added.iter().zip(&mesh.triangles) {
            let [a, b, c] = t.half_edges();
            let corners = if side == 0 { [a, b, c] } else { [a, c, b] };
            for (corner, &point) in corners.into_iter().zip(triangle) {
                if let Some(&uv) = self.uvs.get(point as usize) {
                    edit.set_uv(corner, uv);
                }
                if has_normals {
                    edit.set_normal(corner, normal);
                }
            }
        }
    }
}
