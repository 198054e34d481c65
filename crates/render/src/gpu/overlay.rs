//! Translucent sheets and lines: a blade's sweep, a rim, a box.

use super::pipelines::Pipelines;
use super::renderer::Renderer;
use super::scope::{buffer, scoped};
use crate::color::Color;
use crate::error::RenderError;
use bytemuck::{Pod, Zeroable};
use wgpu::{Buffer, BufferUsages, RenderPass, VertexAttribute};

/// A triangle that is seen from both sides, in its own color without any light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sheet {
    /// Its corners \[m\].
    pub corners: [[f32; 3]; 3],
    /// Its color; alpha says how much of it covers what is behind.
    pub color: Color,
}

/// A straight line that is as wide wherever it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// Its ends \[m\].
    pub ends: [[f32; 3]; 2],
    /// Its color; alpha says how much of it covers what is behind.
    pub color: Color,
    /// Its width \[px\].
    pub width: f32,
}

/// What lies over bodies and is hidden by what is in front of it. It hides nothing itself: sheets are mixed over each
/// other in the order that they have, and lines come last.
#[derive(Debug)]
pub struct Overlay {
    sheets: Buffer,
    sheet_corners: u32,
    lines: Buffer,
    line_count: u32,
}

#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct SheetCorner {
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

/// Of a [`SheetCorner`].
pub(super) const SHEET_ATTRIBUTES: [VertexAttribute; 2] =
    wgpu::vertex_attr_array![0 => Float32x3, 1 => Unorm8x4];

/// Of a [`LineRecord`].
pub(super) const LINE_ATTRIBUTES: [VertexAttribute; 4] =
    wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Unorm8x4, 3 => Float32];

impl Overlay {
    /// An overlay of sheets and lines.
    ///
    /// # Errors
    /// [`RenderError::BufferTooLarge`], and what the device says.
    pub fn new(renderer: &Renderer, sheets: &[Sheet], lines: &[Line]) -> Result<Self, RenderError> {
        let corners = sheets.iter().flat_map(|sheet| {
            let color = sheet.color.0;
            sheet
                .corners
                .map(|position| SheetCorner { position, color })
        });
        let records = lines.iter().map(|line| LineRecord {
            ends: line.ends,
            color: line.color.0,
            width: line.width,
        });
        let (sheets, sheet_corners) = upload(renderer, "sheets", &corners.collect::<Vec<_>>())?;
        let (lines, line_count) = upload(renderer, "lines", &records.collect::<Vec<_>>())?;
        Ok(Self {
            sheets,
            sheet_corners,
            lines,
            line_count,
        })
    }

    pub(super) fn draw(&self, pass: &mut RenderPass<'_>, pipelines: &Pipelines) {
        if self.sheet_corners > 0 {
            pass.set_pipeline(&pipelines.sheets);
            pass.set_vertex_buffer(0, self.sheets.slice(..));
            pass.draw(0..self.sheet_corners, 0..1);
        }
        if self.line_count > 0 {
            pass.set_pipeline(&pipelines.lines);
            pass.set_vertex_buffer(0, self.lines.slice(..));
            pass.draw(0..6, 0..self.line_count);
        }
    }
}

/// A buffer of these records, and how many they are.
fn upload<T: Pod>(
    renderer: &Renderer,
    what: &'static str,
    records: &[T],
) -> Result<(Buffer, u32), RenderError> {
    let bytes: &[u8] = bytemuck::cast_slice(records);
    let usage = BufferUsages::VERTEX | BufferUsages::COPY_DST;
    let size = bytes.len() as u64;
    let made = buffer(renderer.device(), what, size, usage)?;
    scoped(renderer.device(), what, || {
        renderer.queue().write_buffer(&made, 0, bytes);
    })?;
    let limit = u64::from(u32::MAX);
    let count = u32::try_from(records.len());
    let count = count.map_err(|_| RenderError::BufferTooLarge {
        what,
        bytes: size,
        limit,
    })?;
    Ok((made, count))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn attributes_are_where_the_records_have_them() {
        use std::mem::offset_of;
        let offsets = |attributes: &[VertexAttribute]| -> Vec<u64> {
            attributes.iter().map(|a| a.offset).collect()
        };
        let corner = [
            offset_of!(SheetCorner, position),
            offset_of!(SheetCorner, color),
        ];
        assert_eq!(offsets(&SHEET_ATTRIBUTES), corner.map(|o| o as u64));
        assert_eq!(size_of::<SheetCorner>(), 16);
        let ends = offset_of!(LineRecord, ends);
        let (color, width) = (offset_of!(LineRecord, color), offset_of!(LineRecord, width));
        let line = [ends, ends + 12, color, width];
        assert_eq!(offsets(&LINE_ATTRIBUTES), line.map(|o| o as u64));
        assert_eq!(size_of::<LineRecord>(), 32);
    }
}
