//! Translucent triangles and lines over the bodies: a blade's sweep, a rim, a box.

use super::error_scope::{create_buffer, scoped};
use super::pipelines::Pipelines;
use super::renderer::Renderer;
use crate::color::Color;
use crate::error::RenderError;
use bytemuck::{Pod, Zeroable};
use wgpu::{Buffer, BufferUsages, RenderPass, VertexAttribute};

/// A translucent, unlit, two-sided triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OverlayTriangle {
    /// Corners \[m\].
    pub corners: [[f32; 3]; 3],
    /// Color; alpha is the opacity.
    pub color: Color,
}

/// A line segment of constant width in pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// Ends \[m\].
    pub ends: [[f32; 3]; 2],
    /// Color; alpha is the opacity.
    pub color: Color,
    /// Width \[px\].
    pub width: f32,
}

/// Translucent triangles and lines, drawn after the bodies with depth test but no depth write.
///
/// Triangles are blended in their order; lines follow.
#[derive(Debug)]
pub struct Overlay {
    triangles: Buffer,
    corner_count: u32,
    lines: Buffer,
    line_count: u32,
}

#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct TriangleCorner {
    position: [f32; 3],
    color: [u8; 4],
}

#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct LineRecord {
    ends: [[f32; 3]; 2],
    color: [u8; 4],
    width: f32,
}

/// Vertex attributes of a [`TriangleCorner`].
pub(super) const TRIANGLE_ATTRIBUTES: [VertexAttribute; 2] =
    wgpu::vertex_attr_array![0 => Float32x3, 1 => Unorm8x4];

/// Instance attributes of a [`LineRecord`].
pub(super) const LINE_ATTRIBUTES: [VertexAttribute; 4] =
    wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Unorm8x4, 3 => Float32];

impl Overlay {
    /// Uploads triangles and lines.
    ///
    /// # Errors
    /// [`RenderError::BufferTooLarge`], or an error of the device.
    pub fn new(
        renderer: &Renderer,
        triangles: &[OverlayTriangle],
        lines: &[Line],
    ) -> Result<Self, RenderError> {
        let corners = triangles.iter().flat_map(|triangle| {
            let color = triangle.color.0;
            triangle
                .corners
                .map(|position| TriangleCorner { position, color })
        });
        let records = lines.iter().map(|line| LineRecord {
            ends: line.ends,
            color: line.color.0,
            width: line.width,
        });
        let corners: Vec<_> = corners.collect();
        let (triangles, corner_count) = upload(renderer, "overlay triangles", &corners)?;
        let (lines, line_count) = upload(renderer, "lines", &records.collect::<Vec<_>>())?;
        Ok(Self {
            triangles,
            corner_count,
            lines,
            line_count,
        })
    }

    pub(super) fn draw(&self, pass: &mut RenderPass<'_>, pipelines: &Pipelines) {
        if self.corner_count > 0 {
            pass.set_pipeline(&pipelines.overlay_triangles);
            pass.set_vertex_buffer(0, self.triangles.slice(..));
            pass.draw(0..self.corner_count, 0..1);
        }
        if self.line_count > 0 {
            pass.set_pipeline(&pipelines.lines);
            pass.set_vertex_buffer(0, self.lines.slice(..));
            pass.draw(0..6, 0..self.line_count);
        }
    }
}

/// Creates a vertex buffer from records and returns it with their number.
fn upload<T: Pod>(
    renderer: &Renderer,
    what: &'static str,
    records: &[T],
) -> Result<(Buffer, u32), RenderError> {
    let bytes: &[u8] = bytemuck::cast_slice(records);
    let usage = BufferUsages::VERTEX | BufferUsages::COPY_DST;
    let size = bytes.len() as u64;
    let buffer = create_buffer(renderer.device(), what, size, usage)?;
    scoped(renderer.device(), what, || {
        renderer.queue().write_buffer(&buffer, 0, bytes);
    })?;
    let limit = u64::from(u32::MAX);
    let count = u32::try_from(records.len());
    let count = count.map_err(|_| RenderError::BufferTooLarge {
        what,
        bytes: size,
        limit,
    })?;
    Ok((buffer, count))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn attribute_offsets_match_the_records() {
        use std::mem::offset_of;
        let offsets = |attributes: &[VertexAttribute]| -> Vec<u64> {
            attributes.iter().map(|a| a.offset).collect()
        };
        let corner = [
            offset_of!(TriangleCorner, position),
            offset_of!(TriangleCorner, color),
        ];
        assert_eq!(offsets(&TRIANGLE_ATTRIBUTES), corner.map(|o| o as u64));
        assert_eq!(size_of::<TriangleCorner>(), 16);
        let ends = offset_of!(LineRecord, ends);
        let (color, width) = (offset_of!(LineRecord, color), offset_of!(LineRecord, width));
        let line = [ends, ends + 12, color, width];
        assert_eq!(offsets(&LINE_ATTRIBUTES), line.map(|o| o as u64));
        assert_eq!(size_of::<LineRecord>(), 32);
    }
}
