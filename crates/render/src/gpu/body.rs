//! A surface as the device draws it.

use super::pipelines::Pipelines;
use super::renderer::Renderer;
use super::scope::{buffer, scoped};
use super::uniforms::BodyUniform;
use crate::color::Color;
use crate::error::RenderError;
use incise_mesh::{Surface, TriangleId};
use std::ops::Range;
use wgpu::{BindGroup, Buffer, BufferUsages, Device, Queue, RenderPass};

/// Bytes of a position.
const POSITION: u64 = 16;

/// The inner side of a triangle is this much of [`BodyView::set_inside`]'s color, and else its own.
const INSIDE: f32 = 0.8;

/// One surface on the device: corners and a color a triangle, and positions of its own or somebody else's.
///
/// Whoever cuts the surface calls [`BodyView::update_topology`]; whoever moves it [`BodyView::update_positions`], or
/// nothing at all when the positions are a solver's on the same device.
#[derive(Debug)]
pub struct BodyView {
    uniform: Buffer,
    corners: Buffer,
    colors: Buffer,
    own: Buffer,
    positions: Positions,
    group: BindGroup,
    inside: [f32; 4],
    /// Slots of triangles and vertices.
    triangles: u32,
    vertices: u64,
}

/// Where positions are.
#[derive(Debug)]
enum Positions {
    /// So many, in the body's own buffer.
    Own(u64),
    /// In a part of another buffer \[bytes\].
    Borrowed(Buffer, Range<u64>),
}

impl BodyView {
    /// A body without triangles and positions.
    ///
    /// # Errors
    /// What the device says.
    pub fn new(renderer: &Renderer) -> Result<Self, RenderError> {
        let device = renderer.device();
        let usage = BufferUsages::UNIFORM | BufferUsages::COPY_DST;
        let uniform = buffer(device, "body", size_of::<BodyUniform>() as u64, usage)?;
        let storage = |what, bytes| buffer(device, what, bytes, STORAGE);
        let (corners, colors) = (storage("corners", 0)?, storage("colors", 0)?);
        let own = storage("positions", 0)?;
        let place = Place::whole(&own);
        let group = bind(
            device,
            &renderer.pipelines,
            &uniform,
            &place,
            &corners,
            &colors,
        )?;
        let mut body = Self {
            uniform,
            corners,
            colors,
            own,
            positions: Positions::Own(0),
            group,
            inside: Color::rgb(92, 96, 108).linear(),
            triangles: 0,
            vertices: 0,
        };
        body.inside[3] = INSIDE;
        body.write_uniform(renderer, 0)?;
        Ok(body)
    }

    /// A body of a surface: its triangles with these colors, and its positions.
    ///
    /// # Errors
    /// As [`BodyView::update_topology`].
    pub fn of(
        renderer: &Renderer,
        surface: &Surface,
        colors: impl FnMut(TriangleId) -> Option<Color>,
    ) -> Result<Self, RenderError> {
        let mut body = Self::new(renderer)?;
        body.update_topology(renderer, surface, colors)?;
        body.update_positions(renderer, &surface.positions)?;
        Ok(body)
    }

    /// Takes over a surface's triangles, each with a color or, without one, not drawn. Bodies are opaque: of a color's
    /// alpha only its absence counts. Positions stay as they are, and have to be as many as the surface's vertex slots
    /// when the body is drawn next.
    ///
    /// # Errors
    /// [`RenderError::BufferTooLarge`], and what the device says.
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
        let grown = fill(device, queue, &mut self.corners, "corners", corners)?;
        let colors = bytemuck::cast_slice(&packed);
        let grown = fill(device, queue, &mut self.colors, "colors", colors)? || grown;
        // Half-edges have 32-bit ids, so corners can be counted with 32 bits.
        self.triangles = u32::try_from(slots).unwrap_or(u32::MAX / 3);
        self.vertices = topology.vertex_slots() as u64;
        if grown { self.rebind(renderer) } else { Ok(()) }
    }

    /// Takes over positions \[m\], the fourth number of each unused, shape \[vertex slots\], in the place of borrowed ones.
    ///
    /// # Errors
    /// [`RenderError::BufferTooLarge`], and what the device says.
    pub fn update_positions(
        &mut self,
        renderer: &Renderer,
        positions: &[[f32; 4]],
    ) -> Result<(), RenderError> {
        let (device, queue) = (renderer.device(), renderer.queue());
        let bytes = bytemuck::cast_slice(positions);
        let grown = fill(device, queue, &mut self.own, "positions", bytes)?;
        let was_own = matches!(self.positions, Positions::Own(_));
        self.positions = Positions::Own(positions.len() as u64);
        if grown || !was_own {
            self.rebind(renderer)
        } else {
            Ok(())
        }
    }

    /// Uses positions where they are: in `part` of a buffer of the same device \[bytes\], 16 a vertex slot. They are
    /// drawn as they are when a picture's commands are done. A solver's buffer moves when it grows, so this is to be
    /// called again whenever its owner says that it may have; with the same buffer and part it costs nothing.
    ///
    /// # Errors
    /// [`RenderError::NoPositions`] if the buffer is no storage buffer, or the part is not in it or not a multiple of
    /// 16 bytes, [`RenderError::BufferTooLarge`], and what the device says.
    pub fn borrow_positions(
        &mut self,
        renderer: &Renderer,
        buffer: &Buffer,
        part: Range<u64>,
    ) -> Result<(), RenderError> {
        let is_storage = buffer.usage().contains(BufferUsages::STORAGE);
        let is_even = part.start.is_multiple_of(POSITION) && part.end.is_multiple_of(POSITION);
        if !is_storage || !is_even || part.start > part.end || part.end > buffer.size() {
            let Range { start, end } = part;
            return Err(RenderError::NoPositions { start, end });
        }
        if let Positions::Borrowed(old, old_part) = &self.positions
            && (old, old_part) == (buffer, &part)
        {
            return Ok(());
        }
        let old = std::mem::replace(
            &mut self.positions,
            Positions::Borrowed(buffer.clone(), part),
        );
        let bound = self.rebind(renderer);
        if bound.is_err() {
            self.positions = old;
        }
        bound
    }

    /// The color of triangles seen from their inner side, where a surface is open.
    ///
    /// # Errors
    /// What the device says.
    pub fn set_inside(&mut self, renderer: &Renderer, color: Color) -> Result<(), RenderError> {
        let [red, green, blue, _] = color.linear();
        self.inside = [red, green, blue, INSIDE];
        self.rebind(renderer)
    }

    /// Slots of triangles.
    #[must_use]
    pub const fn triangle_slots(&self) -> u32 {
        self.triangles
    }

    /// Whether every triangle has positions.
    pub(super) fn check(&self) -> Result<(), RenderError> {
        let have = match &self.positions {
            Positions::Own(count) => *count,
            Positions::Borrowed(_, part) => (part.end - part.start) / POSITION,
        };
        if self.triangles > 0 && have < self.vertices {
            let need = self.vertices;
            return Err(RenderError::TooFewPositions { need, have });
        }
        Ok(())
    }

    pub(super) fn draw(&self, pass: &mut RenderPass<'_>) {
        if self.triangles > 0 {
            pass.set_bind_group(1, &self.group, &[]);
            pass.draw(0..3 * self.triangles, 0..1);
        }
    }

    /// Tells the device where everything is.
    fn rebind(&mut self, renderer: &Renderer) -> Result<(), RenderError> {
        let device = renderer.device();
        let place = match &self.positions {
            Positions::Own(_) => Place::whole(&self.own),
            // A part of no bytes cannot be bound, and nothing is drawn with it.
            Positions::Borrowed(_, part) if part.is_empty() => Place::whole(&self.own),
            Positions::Borrowed(buffer, part) => Place::of(device, buffer, part)?,
        };
        let (corners, colors) = (&self.corners, &self.colors);
        let group = bind(
            device,
            &renderer.pipelines,
            &self.uniform,
            &place,
            corners,
            colors,
        )?;
        let first = place.first_vertex;
        self.group = group;
        self.write_uniform(renderer, first)
    }

    fn write_uniform(&self, renderer: &Renderer, first_vertex: u32) -> Result<(), RenderError> {
        let uniform = BodyUniform {
            inside: self.inside,
            first_vertex,
            pad: [0; 3],
        };
        scoped(renderer.device(), "a body", || {
            let bytes = bytemuck::bytes_of(&uniform);
            renderer.queue().write_buffer(&self.uniform, 0, bytes);
        })
    }
}

const STORAGE: BufferUsages = BufferUsages::STORAGE.union(BufferUsages::COPY_DST);

/// The part of a buffer that is bound, and where the first position is in it.
struct Place<'a> {
    buffer: &'a Buffer,
    part: Range<u64>,
    first_vertex: u32,
}

impl<'a> Place<'a> {
    fn whole(buffer: &'a Buffer) -> Self {
        Self {
            buffer,
            part: 0..buffer.size(),
            first_vertex: 0,
        }
    }

    /// Bindings begin at multiples of what the device says, which is more than one position on most.
    fn of(device: &Device, buffer: &'a Buffer, part: &Range<u64>) -> Result<Self, RenderError> {
        let limits = device.limits();
        let alignment = u64::from(limits.min_storage_buffer_offset_alignment).max(1);
        let start = part.start / alignment * alignment;
        let (bytes, limit) = (part.end - start, limits.max_storage_buffer_binding_size);
        if bytes > limit {
            let what = "borrowed positions";
            return Err(RenderError::BufferTooLarge { what, bytes, limit });
        }
        let first = (part.start - start) / POSITION;
        Ok(Self {
            buffer,
            part: start..part.end,
            // Below the alignment, which has 32 bits.
            first_vertex: u32::try_from(first).unwrap_or_default(),
        })
    }
}

fn bind(
    device: &Device,
    pipelines: &Pipelines,
    uniform: &Buffer,
    place: &Place<'_>,
    corners: &Buffer,
    colors: &Buffer,
) -> Result<BindGroup, RenderError> {
    let positions = wgpu::BufferBinding {
        buffer: place.buffer,
        offset: place.part.start,
        size: wgpu::BufferSize::new(place.part.end - place.part.start),
    };
    let resources = [
        uniform.as_entire_binding(),
        wgpu::BindingResource::Buffer(positions),
        corners.as_entire_binding(),
        colors.as_entire_binding(),
    ];
    let entries: Vec<wgpu::BindGroupEntry<'_>> = (0..)
        .zip(resources)
        .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource })
        .collect();
    scoped(device, "a body", || {
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("body"),
            layout: &pipelines.body_layout,
            entries: &entries,
        })
    })
}

/// Writes `bytes` at a buffer's beginning. Where there is no room for them it becomes another one with a quarter more;
/// returns whether it did.
fn fill(
    device: &Device,
    queue: &Queue,
    target: &mut Buffer,
    what: &'static str,
    bytes: &[u8],
) -> Result<bool, RenderError> {
    let need = bytes.len() as u64;
    let grows = need > target.size();
    if grows {
        let with_slack = buffer(device, what, need + need / 4, STORAGE);
        // Slack is nice to have.
        *target = with_slack.or_else(|_| buffer(device, what, need, STORAGE))?;
    }
    scoped(device, what, || queue.write_buffer(target, 0, bytes))?;
    Ok(grows)
}
