//! A triangle surface in GPU buffers, ready to draw.

use super::error_scope::{create_buffer, scoped};
use super::pipelines::Pipelines;
use super::renderer::Renderer;
use super::uniforms::BodyUniform;
use crate::color::Color;
use crate::error::RenderError;
use incise_mesh::{Surface, TriangleId};
use std::ops::Range;
use wgpu::{BindGroup, Buffer, BufferUsages, Device, Queue, RenderPass};

/// Size of a position \[bytes\].
const POSITION: u64 = 16;

/// Weight of [`BodyView::set_back_face_color`] against the color of the triangle.
const BACK_FACE_WEIGHT: f32 = 0.8;

/// One surface on the GPU: triangles with colors, and uploaded or bound positions.
///
/// Call [`BodyView::update_topology`] after a cut and [`BodyView::update_positions`] after motion.
/// Positions that are bound from a solver's buffer need no update.
#[derive(Debug)]
pub struct BodyView {
    uniform: Buffer,
    corners: Buffer,
    colors: Buffer,
    uvs: Buffer,
    uploaded: Buffer,
    positions: Positions,
    group: BindGroup,
    /// Linear color of back faces and its weight.
    back_face: [f32; 4],
    /// Squares per unit of texture coordinates; 0 for plain colors.
    checkers: f32,
    triangle_slots: u32,
    vertex_slots: u64,
}

/// Source of the positions.
#[derive(Debug)]
enum Positions {
    /// Number of positions in the body's own buffer.
    Uploaded(u64),
    /// Range of another buffer \[bytes\].
    Bound(Buffer, Range<u64>),
}

impl BodyView {
    /// Creates a body without triangles and positions.
    ///
    /// # Errors
    /// An error of the device.
    pub fn new(renderer: &Renderer) -> Result<Self, RenderError> {
        let device = renderer.device();
        let usage = BufferUsages::UNIFORM | BufferUsages::COPY_DST;
        let uniform = create_buffer(device, "body", size_of::<BodyUniform>() as u64, usage)?;
        let storage = |what, bytes| create_buffer(device, what, bytes, STORAGE);
        let (corners, colors) = (storage("corners", 0)?, storage("colors", 0)?);
        let uvs = storage("texture coordinates", 0)?;
        let uploaded = storage("positions", 0)?;
        let binding = PositionBinding::whole(&uploaded);
        let group = create_bind_group(
            device,
            &renderer.pipelines,
            &uniform,
            &binding,
            [&corners, &colors, &uvs],
        )?;
        let mut body = Self {
            uniform,
            corners,
            colors,
            uvs,
            uploaded,
            positions: Positions::Uploaded(0),
            group,
            back_face: Color::rgb(92, 96, 108).linear(),
            checkers: 0.0,
            triangle_slots: 0,
            vertex_slots: 0,
        };
        body.back_face[3] = BACK_FACE_WEIGHT;
        body.write_uniform(renderer, 0)?;
        Ok(body)
    }

    /// Creates a body from a surface, with a color for each triangle.
    ///
    /// # Errors
    /// As [`BodyView::update_topology`].
    pub fn from_surface(
        renderer: &Renderer,
        surface: &Surface,
        colors: impl FnMut(TriangleId) -> Option<Color>,
    ) -> Result<Self, RenderError> {
        let mut body = Self::new(renderer)?;
        body.update_topology(renderer, surface, colors)?;
        body.update_positions(renderer, surface.positions())?;
        Ok(body)
    }

    /// Uploads the triangles of a surface and their colors.
    ///
    /// Triangles without a color, or with alpha 0, are not drawn; all others are opaque. The
    /// positions are unchanged: there must be one per vertex slot when the body is drawn next.
    ///
    /// # Errors
    /// [`RenderError::BufferTooLarge`], or an error of the device.
    pub fn update_topology(
        &mut self,
        renderer: &Renderer,
        surface: &Surface,
        mut colors: impl FnMut(TriangleId) -> Option<Color>,
    ) -> Result<(), RenderError> {
        let (device, queue) = (renderer.device(), renderer.queue());
        let topology = surface.topology();
        let slots = topology.triangle_slots();
        let mut packed = vec![[0_u8; 4]; slots];
        for t in topology.triangles() {
            let color = colors(t).filter(|color| color.0[3] > 0);
            packed[t.index()] = color.map_or([0; 4], |color| color.0);
        }
        let corners = bytemuck::cast_slice(topology.corners());
        let grown = upload(device, queue, &mut self.corners, "corners", corners)?;
        let colors = bytemuck::cast_slice(&packed);
        let grown = upload(device, queue, &mut self.colors, "colors", colors)? || grown;
        // Half-edges have 32-bit ids, so the corners fit in 32 bits.
        self.triangle_slots = u32::try_from(slots).unwrap_or(u32::MAX / 3);
        self.vertex_slots = topology.vertex_slots() as u64;
        if grown { self.rebind(renderer) } else { Ok(()) }
    }

    /// Uploads positions \[m\], shape \[vertex slots\], and replaces bound ones.
    ///
    /// The fourth component of each position is unused.
    ///
    /// # Errors
    /// [`RenderError::BufferTooLarge`], or an error of the device.
    pub fn update_positions(
        &mut self,
        renderer: &Renderer,
        positions: &[[f32; 4]],
    ) -> Result<(), RenderError> {
        let (device, queue) = (renderer.device(), renderer.queue());
        let bytes = bytemuck::cast_slice(positions);
        let grown = upload(device, queue, &mut self.uploaded, "positions", bytes)?;
        let was_uploaded = matches!(self.positions, Positions::Uploaded(_));
        self.positions = Positions::Uploaded(positions.len() as u64);
        if grown || !was_uploaded {
            self.rebind(renderer)
        } else {
            Ok(())
        }
    }

    /// Binds positions in another buffer of the same device, 16 bytes per vertex slot.
    ///
    /// The body is drawn with the values at the time of submission. A solver's buffer is replaced
    /// when it grows, so call this again after edits; the same buffer and range cost nothing.
    ///
    /// # Errors
    /// [`RenderError::InvalidPositionRange`] if the buffer is not a storage buffer, or the range is
    /// outside of it or not aligned to 16 bytes; [`RenderError::BufferTooLarge`]; an error of the
    /// device.
    pub fn bind_positions(
        &mut self,
        renderer: &Renderer,
        buffer: &Buffer,
        range: Range<u64>,
    ) -> Result<(), RenderError> {
        let is_storage = buffer.usage().contains(BufferUsages::STORAGE);
        let is_aligned = range.start.is_multiple_of(POSITION) && range.end.is_multiple_of(POSITION);
        if !is_storage || !is_aligned || range.start > range.end || range.end > buffer.size() {
            let Range { start, end } = range;
            return Err(RenderError::InvalidPositionRange { start, end });
        }
        if let Positions::Bound(old, old_range) = &self.positions
            && (old, old_range) == (buffer, &range)
        {
            return Ok(());
        }
        let old = std::mem::replace(&mut self.positions, Positions::Bound(buffer.clone(), range));
        let bound = self.rebind(renderer);
        if bound.is_err() {
            self.positions = old;
        }
        bound
    }

    /// Sets the color of back faces, which are visible where a surface is open.
    ///
    /// # Errors
    /// An error of the device.
    pub fn set_back_face_color(
        &mut self,
        renderer: &Renderer,
        color: Color,
    ) -> Result<(), RenderError> {
        let [red, green, blue, _] = color.linear();
        self.back_face = [red, green, blue, BACK_FACE_WEIGHT];
        self.rebind(renderer)
    }

    /// Shades the colors by a checkerboard on the texture coordinates of a surface.
    ///
    /// It has `squares` squares per unit of these. Call it again after [`Self::update_topology`].
    /// With 0 squares, or a surface without texture coordinates, colors are plain.
    ///
    /// # Errors
    /// [`RenderError::BufferTooLarge`], or an error of the device.
    pub fn set_checkers(
        &mut self,
        renderer: &Renderer,
        surface: &Surface,
        squares: f32,
    ) -> Result<(), RenderError> {
        let (device, queue, uvs) = (renderer.device(), renderer.queue(), surface.corner_uvs());
        self.checkers = if uvs.is_empty() { 0.0 } else { squares };
        let bytes = bytemuck::cast_slice(uvs);
        upload(device, queue, &mut self.uvs, "texture coordinates", bytes)?;
        self.rebind(renderer)
    }

    /// Returns the number of triangle slots.
    #[must_use]
    pub const fn triangle_slots(&self) -> u32 {
        self.triangle_slots
    }

    /// Returns an error unless there is a position for every vertex slot.
    pub(super) fn check(&self) -> Result<(), RenderError> {
        let have = match &self.positions {
            Positions::Uploaded(count) => *count,
            Positions::Bound(_, range) => (range.end - range.start) / POSITION,
        };
        if self.triangle_slots > 0 && have < self.vertex_slots {
            let need = self.vertex_slots;
            return Err(RenderError::TooFewPositions { need, have });
        }
        Ok(())
    }

    pub(super) fn draw(&self, pass: &mut RenderPass<'_>) {
        if self.triangle_slots > 0 {
            pass.set_bind_group(1, &self.group, &[]);
            pass.draw(0..3 * self.triangle_slots, 0..1);
        }
    }

    /// Recreates the bind group after a buffer was replaced.
    fn rebind(&mut self, renderer: &Renderer) -> Result<(), RenderError> {
        let device = renderer.device();
        let binding = match &self.positions {
            Positions::Uploaded(_) => PositionBinding::whole(&self.uploaded),
            // An empty range cannot be bound, and nothing is drawn with it.
            Positions::Bound(_, range) if range.is_empty() => {
                PositionBinding::whole(&self.uploaded)
            }
            Positions::Bound(buffer, range) => PositionBinding::new(device, buffer, range)?,
        };
        let group = create_bind_group(
            device,
            &renderer.pipelines,
            &self.uniform,
            &binding,
            [&self.corners, &self.colors, &self.uvs],
        )?;
        let first = binding.first_vertex;
        self.group = group;
        self.write_uniform(renderer, first)
    }

    fn write_uniform(&self, renderer: &Renderer, first_vertex: u32) -> Result<(), RenderError> {
        let uniform = BodyUniform {
            back_face: self.back_face,
            first_vertex,
            checkers: self.checkers,
            pad: [0; 2],
        };
        scoped(renderer.device(), "writing a body", || {
            let bytes = bytemuck::bytes_of(&uniform);
            renderer.queue().write_buffer(&self.uniform, 0, bytes);
        })
    }
}

const STORAGE: BufferUsages = BufferUsages::STORAGE.union(BufferUsages::COPY_DST);

/// The bound range of a position buffer, and the index of vertex 0 in it.
struct PositionBinding<'a> {
    buffer: &'a Buffer,
    range: Range<u64>,
    first_vertex: u32,
}

impl<'a> PositionBinding<'a> {
    fn whole(buffer: &'a Buffer) -> Self {
        Self {
            buffer,
            range: 0..buffer.size(),
            first_vertex: 0,
        }
    }

    /// Rounds the start down to the offset alignment of the device.
    fn new(device: &Device, buffer: &'a Buffer, range: &Range<u64>) -> Result<Self, RenderError> {
        let limits = device.limits();
        let alignment = u64::from(limits.min_storage_buffer_offset_alignment).max(1);
        let start = range.start / alignment * alignment;
        let (bytes, limit) = (range.end - start, limits.max_storage_buffer_binding_size);
        if bytes > limit {
            let what = "bound positions";
            return Err(RenderError::BufferTooLarge { what, bytes, limit });
        }
        let first = (range.start - start) / POSITION;
        Ok(Self {
            buffer,
            range: start..range.end,
            // Less than the alignment, which has 32 bits.
            first_vertex: u32::try_from(first).unwrap_or_default(),
        })
    }
}

fn create_bind_group(
    device: &Device,
    pipelines: &Pipelines,
    uniform: &Buffer,
    binding: &PositionBinding<'_>,
    [corners, colors, uvs]: [&Buffer; 3],
) -> Result<BindGroup, RenderError> {
    let positions = wgpu::BufferBinding {
        buffer: binding.buffer,
        offset: binding.range.start,
        size: wgpu::BufferSize::new(binding.range.end - binding.range.start),
    };
    let resources = [
        uniform.as_entire_binding(),
        wgpu::BindingResource::Buffer(positions),
        corners.as_entire_binding(),
        colors.as_entire_binding(),
        uvs.as_entire_binding(),
    ];
    let entries: Vec<wgpu::BindGroupEntry<'_>> = (0..)
        .zip(resources)
        .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource })
        .collect();
    scoped(device, "binding a body", || {
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("body"),
            layout: &pipelines.body_layout,
            entries: &entries,
        })
    })
}

/// Writes `bytes` at the start of a buffer, and replaces a buffer that is too small.
///
/// A new buffer has a quarter more room. Returns true if the buffer was replaced.
fn upload(
    device: &Device,
    queue: &Queue,
    target: &mut Buffer,
    what: &'static str,
    bytes: &[u8],
) -> Result<bool, RenderError> {
    let need = bytes.len() as u64;
    let grows = need > target.size();
    if grows {
        let with_slack = create_buffer(device, what, need + need / 4, STORAGE);
        // The slack is optional.
        *target = with_slack.or_else(|_| create_buffer(device, what, need, STORAGE))?;
    }
    scoped(device, what, || queue.write_buffer(target, 0, bytes))?;
    Ok(grows)
}
